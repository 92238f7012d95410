//! A rectangle light on a normal-mapped surface at run time. f32, plain functions, as in WGSL.
//!
//! Paper: Tao et al. 2021, sections 3.1 and 3.5; Heitz et al. 2016 for the LTC. Deviations:
//! - The roughness of the normals comes from the mip chain, see [`super::spread`]. Engines that have no more than the
//!   length of the mean normal take [`alpha_from_deficit`], the exact inverse of the paper's Eq. 4.
//! - Convolution by a symmetric formula ([`convolve_alpha`]).
//! - Normals that vary more along one direction: GGX of roughness p along and q across is taken apart into a few lobes
//!   along the direction, at equal shares of the marginal of √(p² − q²), each of which keeps q. An LTC of one anisotropic
//!   lobe cannot bend around the surface as the reflections of brushed metal do; three can.
//! - A lobe that is still longer along the direction has its cosine stretched, before M takes it to the shape of the
//!   BRDF, by the roughness along and across over their geometric mean ([`stretch_in_plane`]). At small roughness that
//!   is how GGX itself depends on α_x and α_y.

use super::fetch::Surface;
use super::rect::quad_form_factor;
use glam::{Vec2, Vec3, Vec4};

/// Texels along an edge of the LTC tables.
pub const TABLE_SIZE: usize = super::tables::SIZE;
/// Least cosine of the view over the mean normal; views below are taken there.
pub const MIN_VIEW_COSINE: f32 = 1.0e-3;
/// Least roughness the tables are read at.
pub const MIN_ALPHA: f32 = 1.0e-3;
/// Lobes that anisotropic normals are taken apart into.
pub const LOBES: u32 = 3;
/// Most of them.
pub const MAX_LOBES: u32 = 9;
/// Deficit of a lobe of roughness 1.
pub const MAX_DEFICIT: f32 = 1.0 / 3.0;

/// The LTC tables, decoded.
#[derive(Clone, Debug, PartialEq)]
pub struct Tables {
    /// Entries a, c, b, d of M⁻¹.
    pub inverse: Vec<Vec4>,
    /// Magnitude, Fresnel term, 0, clipped form factor.
    pub terms: Vec<Vec4>,
}

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

/// (atanh(β)/β − 1) / β² for β² = 1 − α², with 1 − R = α² times that.
fn deficit_shape(alpha: f32) -> f32 {
    let b2 = (1.0 - alpha) * (1.0 + alpha);
    if b2 < 0.35 {
        let mut sum = 0.0;
        for k in 0..14 {
            sum = sum * b2 + 1.0 / (29 - 2 * k) as f32;
        }
        return sum;
    }
    let b = b2.sqrt();
    (((1.0 + b) / alpha).ln() / b - 1.0) / b2
}

/// Deficit 1 − R of the mean resultant length of GGX normals of roughness α.
pub fn deficit_from_alpha(alpha: f32) -> f32 {
    let alpha = alpha.clamp(0.0, 1.0);
    if alpha > 0.0 { alpha * alpha * deficit_shape(alpha) } else { 0.0 }
}

/// Roughness α of GGX normals whose mean resultant length is 1 − `deficit`; 1 for ⅓ and above.
pub fn alpha_from_deficit(deficit: f32) -> f32 {
    if deficit >= MAX_DEFICIT {
        return 1.0;
    }
    if deficit <= 0.0 || deficit.is_nan() {
        return 0.0;
    }
    // Newton's method on ln(1 − R) over ln α, which is nearly straight.
    let mut alpha = (deficit * 3.0).sqrt();
    for _ in 0..6 {
        let shape = deficit_shape(alpha);
        let b2 = (1.0 - alpha) * (1.0 + alpha);
        // α² times the derivative of the shape by β²; near β = 0 its series.
        let slope = if b2 < 0.02 {
            alpha * alpha * (0.2 + b2 * (0.285_714_3 + b2 / 3.0))
        } else {
            (0.5 - 1.5 * alpha * alpha * shape) / b2
        };
        let rate = 2.0 - 2.0 * slope / shape;
        let error = deficit / (alpha * alpha * shape);
        alpha = (alpha * (error.ln() / rate).exp()).min(1.0);
    }
    alpha
}

/// Roughness of the convolution of lobes of roughness a and b, both 0 to 1; at least the larger, at most 1.
pub fn convolve_alpha(a: f32, b: f32) -> f32 {
    const EXPONENT: f32 = super::convolve::EXPONENT as f32;
    let (small, large) = (a.min(b), a.max(b));
    if small <= 0.0 || small.is_nan() {
        return large.clamp(0.0, 1.0);
    }
    let sum = large * (1.0 + (small / large).powf(EXPONENT)).powf(1.0 / EXPONENT);
    let bend = super::convolve::FIRST as f32 - super::convolve::SECOND as f32 * (a + b);
    (sum * (1.0 - a * b * bend)).clamp(large.min(1.0), 1.0)
}

/// A table at texel coordinates, as linear filtering with clamp to edge reads it.
pub fn table_lookup(table: &[Vec4], x: f32, y: f32) -> Vec4 {
    let last = (TABLE_SIZE - 1) as f32;
    let (x, y) = (x.clamp(0.0, last), y.clamp(0.0, last));
    let (i, j) = ((x as usize).min(TABLE_SIZE - 2), (y as usize).min(TABLE_SIZE - 2));
    let (fx, fy) = (x - i as f32, y - j as f32);
    let at = j * TABLE_SIZE + i;
    let low = table[at].lerp(table[at + 1], fx);
    let high = table[at + TABLE_SIZE].lerp(table[at + TABLE_SIZE + 1], fx);
    low.lerp(high, fy)
}

/// Where, in texels, the tables hold a view cosine and roughness.
pub fn table_place(cosine: f32, alpha: f32) -> Vec2 {
    Vec2::new(alpha.max(0.0).sqrt(), (1.0 - cosine).max(0.0).sqrt()) * (TABLE_SIZE - 1) as f32
}

/// M⁻¹ (a, c, b, d) times a vector.
pub fn to_cosine(m: Vec4, v: Vec3) -> Vec3 {
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
pub fn stretch_in_plane(lobe: Roughness, along: Vec2) -> Vec3 {
    let mean = (lobe.major * lobe.minor).sqrt();
    let (p, q) = (mean / lobe.major, mean / lobe.minor);
    let c = lobe.axis.dot(along);
    let s = along.perp_dot(lobe.axis);
    Vec3::new(p * c * c + q * s * s, (p - q) * c * s, p * s * s + q * c * c)
}

/// Radiance towards `view` of one lobe about the unit `normal`, with reflectance `f0` at normal incidence.
pub fn lobe_radiance(tables: &Tables, normal: Vec3, lobe: Roughness, view: Vec3, f0: f32, light: &RectLight) -> f32 {
    let (t, b) = tangent_frame(normal);
    let across = Vec2::new(t.dot(view), b.dot(view));
    let length = across.length();
    let along = if length > 1.0e-6 { across / length } else { Vec2::X };
    let (x, y) = (t * along.x + b * along.y, b * along.x - t * along.y);
    let lobe =
        Roughness { major: lobe.major.clamp(MIN_ALPHA, 1.0), minor: lobe.minor.clamp(MIN_ALPHA, 1.0), axis: lobe.axis };
    let place = table_place(normal.dot(view).max(MIN_VIEW_COSINE), (lobe.major * lobe.minor).sqrt());
    let m = table_lookup(&tables.inverse, place.x, place.y);
    let terms = table_lookup(&tables.terms, place.x, place.y);
    let s = stretch_in_plane(lobe, along);
    let corners = light.corners.map(|p| {
        let v = to_cosine(m, Vec3::new(x.dot(p), y.dot(p), normal.dot(p)));
        Vec3::new(s.x * v.x + s.y * v.y, s.y * v.x + s.z * v.y, v.z)
    });
    quad_form_factor(corners) * (f0 * terms.x + (1.0 - f0) * terms.y)
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

/// Radiance towards `view` (unit) of what lies under a pixel: base roughness `base_alpha` convolved with the meso roughness
/// of all directions, or, with `lobes` above 0 (at most [`MAX_LOBES`]), with that of each direction.
pub fn surface_radiance(
    tables: &Tables,
    surface: &Surface,
    base_alpha: f32,
    view: Vec3,
    f0: f32,
    light: &RectLight,
    lobes: u32,
) -> f32 {
    if lobes == 0 {
        let alpha = convolve_alpha(base_alpha, surface.alpha);
        return isotropic_radiance(tables, surface.normal, alpha, view, f0, light);
    }
    if !faces(light) {
        return 0.0;
    }
    let lobes = lobes.min(MAX_LOBES);
    let meso = surface.by_direction;
    let spread = (meso.major * meso.major - meso.minor * meso.minor).max(0.0).sqrt();
    let minor = convolve_alpha(base_alpha, meso.minor);
    let major = convolve_alpha(minor, spread / lobes as f32);
    let (t, b) = tangent_frame(surface.normal);
    let along = t * meso.axis.x + b * meso.axis.y;
    let mut sum = 0.0;
    for k in 0..lobes {
        // Share (k + ½) / lobes of the marginal of GGX: x = spread · c / √(1 − c²).
        let c = (2 * k + 1) as f32 / lobes as f32 - 1.0;
        let tilted = surface.normal + along * (spread * c / (1.0 - c * c).sqrt());
        let normal = tilted / tilted.length();
        let (t, b) = tangent_frame(normal);
        let axis = Vec2::new(t.dot(along), b.dot(along));
        let lobe = Roughness { major, minor, axis: axis / axis.length().max(1.0e-6) };
        sum += lobe_radiance(tables, normal, lobe, view, f0, light);
    }
    sum / lobes as f32 * light.radiance
}
