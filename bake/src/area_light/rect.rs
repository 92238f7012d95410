//! A rectangle light on one GGX lobe: linearly transformed cosines. f32, plain functions, as in WGSL.
//!
//! Heitz et al. 2016, section 4 and listing 2; Tao et al. 2021, section 3.1. Deviations of the form factor, which is Lambert's
//! sum over edges of the angle that an edge subtends times the vertical part of its plane's normal:
//! - Every edge is cut at the horizon plane by itself, and one edge along the horizon closes what is left, which needs no
//!   table of cases and no list of vertices.
//! - The angle comes from atan2, which is exact both for edges that are seen end on and for those that subtend nearly half a
//!   turn.
//! - A rectangle with a corner at the origin is seen edge on and gives nothing.
//! - A lobe that is longer along one direction has its cosine stretched, before M takes it to the shape of the BRDF, by the
//!   roughness along and across over their geometric mean ([`stretch_in_plane`]). At small roughness that is how GGX itself
//!   depends on α_x and α_y.

use super::baked::{SIZE, Tables};
use glam::{Vec2, Vec3, Vec4};

/// Least cosine of the view over the mean normal; views below are taken there.
pub const MIN_VIEW_COSINE: f32 = 1.0e-3;
/// Least roughness the tables are read at.
pub const MIN_ALPHA: f32 = 1.0e-3;
const INV_TWO_PI: f32 = 0.159_154_94;

/// A rectangle that radiates evenly, relative to the shaded point, in the tangent frame of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectLight {
    /// Corners in order around the rectangle. The front, which radiates, is where they run counter-clockwise.
    pub corners: [Vec3; 4],
    /// Radiance.
    pub radiance: f32,
    /// Whether the back radiates too.
    pub two_sided: bool,
}

/// Roughness of one lobe: α along `axis` and across it, `axis` in the frame of [`tangent_frame`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// α along `axis`.
    pub major: f32,
    /// α across it.
    pub minor: f32,
    /// Unit vector.
    pub axis: Vec2,
}

/// A light on a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeLight {
    /// How much of the lobe the light fills, 0 to 1.
    pub form_factor: f32,
    /// What the tables say of the lobe: magnitude, Fresnel term, 0, clipped form factor.
    pub terms: Vec4,
}

/// Solid angle below which a rectangle is as flat as it is seen, to .3 %.
const FLAT_ANGLE: f32 = 0.01;

/// atan2(sine, cosine) for sine ≥ 0, not both 0.
fn angle(sine: f32, cosine: f32) -> f32 {
    sine.atan2(cosine)
}

/// What the edge from `a` to `b` adds to the form factor. Both have any length above 0.
fn edge_form_factor(a: Vec3, b: Vec3) -> f32 {
    let normal = a.cross(b);
    let sine = normal.length();
    if sine <= 0.0 || sine.is_nan() {
        return 0.0;
    }
    normal.z / sine * angle(sine, a.dot(b)) * INV_TWO_PI
}

/// Unit vector, without overflow; 0 for 0 and for what is not finite.
fn direction(v: Vec3) -> Vec3 {
    let most = v.abs().max_element();
    if !v.is_finite() || most <= 0.0 {
        return Vec3::ZERO;
    }
    let scaled = v / most;
    scaled / scaled.length()
}

/// The part of an outline above the horizon: what its edges add, and where it goes below and comes up again.
#[derive(Clone, Copy, Default)]
struct CutEdge {
    form_factor: f32,
    down: Vec3,
    up: Vec3,
}

/// Adds the part above the horizon of the edge from `a` to `b`, unit vectors.
fn cut_edge(before: CutEdge, a: Vec3, b: Vec3) -> CutEdge {
    let from_above = a.z >= 0.0;
    let to_above = b.z >= 0.0;
    if !(from_above || to_above) {
        return before;
    }
    let mut sum = before;
    let mut from_point = a;
    let mut to_point = b;
    if from_above != to_above {
        // Both lie on rays through the corners, and so does the point of their connecting line at the horizon.
        let crossing = direction(a * b.z.abs() + b * a.z.abs()) * Vec3::new(1.0, 1.0, 0.0);
        if from_above {
            to_point = crossing;
            sum.down = crossing;
        } else {
            from_point = crossing;
            sum.up = crossing;
        }
    }
    sum.form_factor += edge_form_factor(from_point, to_point);
    sum
}

/// Form factor, 0 to 1, of a plane, convex quadrilateral for a receiver at the origin whose normal is z. Both sides count.
/// Corners that are not finite, or at the origin, make the result 0.
pub fn quad_form_factor(corners: [Vec3; 4]) -> f32 {
    let [a, b, c, d] = corners.map(direction);
    if [a, b, c, d].contains(&Vec3::ZERO) {
        return 0.0;
    }
    let mut sum = CutEdge::default();
    sum = cut_edge(sum, a, b);
    sum = cut_edge(sum, b, c);
    sum = cut_edge(sum, c, d);
    sum = cut_edge(sum, d, a);
    (sum.form_factor + edge_form_factor(sum.down, sum.up)).abs().min(1.0)
}

/// Solid angle of a triangle of unit vectors (Van Oosterom and Strackee 1983), in steradians.
fn triangle_solid_angle(a: Vec3, b: Vec3, c: Vec3) -> f32 {
    let sine = a.dot(b.cross(c)).abs();
    if sine <= 0.0 || sine.is_nan() {
        return 0.0;
    }
    2.0 * angle(sine, 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// Solid angle that a rectangle fills as seen from the origin, in steradians. A small one's is its area as seen from there: triangles would lose
/// its digits.
pub fn rect_solid_angle(light: &RectLight) -> f32 {
    let [a, b, c, d] = light.corners;
    let middle = (a + b + c + d) * 0.25;
    let distance2 = middle.dot(middle).max(1e-20);
    let front = (b - a).cross(d - a);
    let flat_angle = front.dot(middle).abs() / (distance2 * distance2.sqrt());
    if flat_angle < FLAT_ANGLE {
        return flat_angle;
    }
    let [a, b, c, d] = light.corners.map(direction);
    triangle_solid_angle(a, b, c) + triangle_solid_angle(a, c, d)
}

/// Where, in texels, the tables hold a view cosine and roughness.
pub fn table_place(cosine: f32, alpha: f32) -> Vec2 {
    Vec2::new(alpha.max(0.0).sqrt(), (1.0 - cosine).max(0.0).sqrt()) * (SIZE - 1) as f32
}

/// M⁻¹ (a, c, b, d) times a vector.
fn to_cosine(m: Vec4, v: Vec3) -> Vec3 {
    Vec3::new(m.x * v.x + m.z * v.z, v.y, m.y * v.x + m.w * v.z)
}

/// Where the shortest turn from z to `n` (unit) takes x and y.
pub fn tangent_frame(n: Vec3) -> (Vec3, Vec3) {
    let a = 1.0 / (1.0 + n.z.max(-0.9999));
    let b = -n.x * n.y * a;
    (Vec3::new(1.0 - n.x * n.x * a, b, -n.x), Vec3::new(b, 1.0 - n.y * n.y * a, -n.y))
}

/// Inverse, scaled to determinant 1, of a lobe's roughness as a symmetric matrix xx, xy, yy in the plane of incidence, whose
/// first axis is `along` in the tangent frame.
fn stretch_in_plane(lobe: Roughness, along: Vec2) -> Vec3 {
    let mean = (lobe.major * lobe.minor).sqrt();
    let (p, q) = (mean / lobe.major, mean / lobe.minor);
    let c = lobe.axis.dot(along);
    let s = along.perp_dot(lobe.axis);
    Vec3::new(p * c * c + q * s * s, (p - q) * c * s, p * s * s + q * c * c)
}

/// What [`lobe_radiance`] does with each corner: to the plane of incidence, to the cosine, and the stretch.
fn corner_to_cosine(m: Vec4, stretch: Vec3, x: Vec3, y: Vec3, normal: Vec3, corner: Vec3) -> Vec3 {
    let v = to_cosine(m, Vec3::new(x.dot(corner), y.dot(corner), normal.dot(corner)));
    Vec3::new(stretch.x * v.x + stretch.y * v.y, stretch.y * v.x + stretch.z * v.y, v.z)
}

/// What a light and one lobe about the unit `normal` have in common, seen from `view`: how much of the lobe the light fills, and what the
/// tables say of the lobe.
pub fn lobe_light(tables: &Tables, normal: Vec3, roughness: Roughness, view: Vec3, light: &RectLight) -> LobeLight {
    let frame = tangent_frame(normal);
    let across = Vec2::new(frame.0.dot(view), frame.1.dot(view));
    let length = across.length();
    let along = if length > 1.0e-6 { across / length } else { Vec2::X };
    let x = frame.0 * along.x + frame.1 * along.y;
    let y = frame.1 * along.x - frame.0 * along.y;
    let lobe = Roughness {
        major: roughness.major.clamp(MIN_ALPHA, 1.0),
        minor: roughness.minor.clamp(MIN_ALPHA, 1.0),
        axis: roughness.axis,
    };
    let place = table_place(normal.dot(view).max(MIN_VIEW_COSINE), (lobe.major * lobe.minor).sqrt());
    let m = tables.inverse_at(place);
    let terms = tables.terms_at(place);
    let s = stretch_in_plane(lobe, along);
    let form_factor = quad_form_factor(light.corners.map(|corner| corner_to_cosine(m, s, x, y, normal, corner)));
    LobeLight { form_factor, terms }
}

/// Radiance towards `view` of one lobe about the unit `normal`, with reflectance `f0` at normal incidence, for a light of
/// radiance 1.
pub fn lobe_radiance(
    tables: &Tables,
    normal: Vec3,
    roughness: Roughness,
    view: Vec3,
    f0: f32,
    light: &RectLight,
) -> f32 {
    let lobe = lobe_light(tables, normal, roughness, view, light);
    lobe.form_factor * (f0 * lobe.terms.x + (1.0 - f0) * lobe.terms.y)
}

/// Whether the shaded point is in front of the light.
pub fn faces(light: &RectLight) -> bool {
    let [a, b, _, d] = light.corners;
    light.two_sided || (b - a).cross(d - a).dot(a) < 0.0
}

/// Radiance towards `view` of an isotropic surface of overall roughness α, 0 to 1.
pub fn isotropic_radiance(tables: &Tables, normal: Vec3, alpha: f32, view: Vec3, f0: f32, light: &RectLight) -> f32 {
    if !faces(light) {
        return 0.0;
    }
    let lobe = Roughness { major: alpha, minor: alpha, axis: Vec2::X };
    lobe_radiance(tables, normal, lobe, view, f0, light) * light.radiance
}
