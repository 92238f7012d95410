// A rectangle light on one GGX lobe: linearly transformed cosines.
// Heitz et al. 2016, "Real-Time Polygonal-Light Shading with Linearly Transformed Cosines"; Tao et al. 2021, section 3.1.
// Twin of rect.rs, where deviations are derived: edges are cut at the horizon one by one,
// the angle of an edge is exact, and a lobe that is longer along one direction has its cosine stretched.
//
// Vectors are relative to the shaded point, in the tangent frame of the surface. Radiance and reflectance are linear RGB.
//
// Accessors that the including program defines:
//   fn glint_ltc_inverse(place: vec2f) -> vec4f   section ALLI (a, c, b, d of the inverse matrix) at texel coordinates `place`,
//                                                 0 to 63, linear filtering: texel i's centre is at i
//   fn glint_ltc_terms(place: vec2f) -> vec4f     section ALLT (magnitude, Fresnel term, 0, clipped sphere), read alike

// Texels along an edge of the tables.
const GLINT_LTC_SIZE: f32 = 64.0;
// Least cosine of the view over the mean normal; views below are taken there.
const GLINT_LTC_MIN_VIEW_COSINE: f32 = 1.0e-3;
// Least roughness the tables are read at.
const GLINT_LTC_MIN_ALPHA: f32 = 1.0e-3;
// Solid angle below which a rectangle is as flat as it is seen, to .3 %.
const GLINT_LTC_FLAT_ANGLE: f32 = 0.01;
const GLINT_LTC_INV_TWO_PI: f32 = 0.15915494;
const GLINT_LTC_MAX_FLOAT: f32 = 3.4028234e38;

// A rectangle that radiates evenly.
struct GlintRectLight {
    // Corners in order around the rectangle. The front, which radiates, is where they run counter-clockwise.
    corner_0: vec3f,
    corner_1: vec3f,
    corner_2: vec3f,
    corner_3: vec3f,
    radiance: vec3f,
    // 1 where the back radiates too.
    two_sided: u32,
}

// Roughness of one lobe: alpha along `axis` and across it, `axis` in the frame of glint_tangent_frame.
struct GlintRoughness {
    major: f32,
    minor: f32,
    // Unit vector.
    axis: vec2f,
}

// A light on a lobe.
struct GlintLobeLight {
    // How much of the lobe the light fills, 0 to 1.
    form_factor: f32,
    // What the tables say of the lobe, see glint_ltc_terms.
    terms: vec4f,
}

// Two unit vectors across a third.
struct GlintTangentFrame {
    x: vec3f,
    y: vec3f,
}

// atan2(sine, cosine) for sine >= 0, not both 0: the odd minimax polynomial of atan on 0 to 1, relative error below 2e-7.
fn glint_angle(sine: f32, cosine: f32) -> f32 {
    let c = abs(cosine);
    let t = min(sine, c) / max(sine, c);
    let s = t * t;
    let atan = t * (0.999999985 + s * (-0.333330733 + s * (0.199926193 + s * (-0.142036439 + s * (0.106409316
        + s * (-0.0750428943 + s * (0.0426914587 + s * (-0.0160685916 + s * 0.00284988026))))))));
    let steep = select(atan, 1.5707964 - atan, sine > c);
    return select(steep, 3.1415927 - steep, cosine < 0.0);
}

// What the edge from `a` to `b` adds to the form factor. Both have any length above 0.
fn glint_edge_form_factor(a: vec3f, b: vec3f) -> f32 {
    let normal = cross(a, b);
    let sine = length(normal);
    if !(sine > 0.0) {
        return 0.0;
    }
    return normal.z / sine * glint_angle(sine, dot(a, b)) * GLINT_LTC_INV_TWO_PI;
}

// Unit vector, without overflow; 0 for 0 and for what is not finite.
fn glint_direction(v: vec3f) -> vec3f {
    let size = abs(v);
    let most = max(max(size.x, size.y), size.z);
    if !(most > 0.0 && all(size <= vec3f(GLINT_LTC_MAX_FLOAT))) {
        return vec3f(0.0);
    }
    let scaled = v / most;
    return scaled / length(scaled);
}

// The part of an outline above the horizon: what its edges add, and where it goes below and comes up again.
struct GlintCutEdge {
    form_factor: f32,
    down: vec3f,
    up: vec3f,
}

// Adds the part above the horizon of the edge from `a` to `b`, unit vectors.
fn glint_cut_edge(before: GlintCutEdge, a: vec3f, b: vec3f) -> GlintCutEdge {
    let from_above = a.z >= 0.0;
    let to_above = b.z >= 0.0;
    if !(from_above || to_above) {
        return before;
    }
    var sum = before;
    var from_point = a;
    var to_point = b;
    if from_above != to_above {
        // Both lie on rays through the corners, and so does the point of their connecting line at the horizon.
        let crossing = glint_direction(a * abs(b.z) + b * abs(a.z)) * vec3f(1.0, 1.0, 0.0);
        if from_above {
            to_point = crossing;
            sum.down = crossing;
        } else {
            from_point = crossing;
            sum.up = crossing;
        }
    }
    sum.form_factor += glint_edge_form_factor(from_point, to_point);
    return sum;
}

// Form factor, 0 to 1, of a plane, convex quadrilateral for a receiver at the origin whose normal is z. Both sides count.
// Corners that are not finite, or at the origin, make the result 0.
fn glint_quad_form_factor(corner_0: vec3f, corner_1: vec3f, corner_2: vec3f, corner_3: vec3f) -> f32 {
    let a = glint_direction(corner_0);
    let b = glint_direction(corner_1);
    let c = glint_direction(corner_2);
    let d = glint_direction(corner_3);
    let none = vec3f(0.0);
    if all(a == none) || all(b == none) || all(c == none) || all(d == none) {
        return 0.0;
    }
    var sum = GlintCutEdge(0.0, none, none);
    sum = glint_cut_edge(sum, a, b);
    sum = glint_cut_edge(sum, b, c);
    sum = glint_cut_edge(sum, c, d);
    sum = glint_cut_edge(sum, d, a);
    return min(abs(sum.form_factor + glint_edge_form_factor(sum.down, sum.up)), 1.0);
}

// Solid angle of a triangle of unit vectors (Van Oosterom and Strackee 1983), in steradians.
fn glint_triangle_solid_angle(a: vec3f, b: vec3f, c: vec3f) -> f32 {
    let sine = abs(dot(a, cross(b, c)));
    if !(sine > 0.0) {
        return 0.0;
    }
    return 2.0 * glint_angle(sine, 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
}

// Solid angle that a rectangle fills as seen from the origin, in steradians. A small one's is its area as seen from there: triangles would lose
// its digits.
fn glint_rect_solid_angle(light: GlintRectLight) -> f32 {
    let middle = (light.corner_0 + light.corner_1 + light.corner_2 + light.corner_3) * 0.25;
    let distance2 = max(dot(middle, middle), 1.0e-20);
    let front = cross(light.corner_1 - light.corner_0, light.corner_3 - light.corner_0);
    let flat_angle = abs(dot(front, middle)) / (distance2 * sqrt(distance2));
    if flat_angle < GLINT_LTC_FLAT_ANGLE {
        return flat_angle;
    }
    let a = glint_direction(light.corner_0);
    let b = glint_direction(light.corner_1);
    let c = glint_direction(light.corner_2);
    let d = glint_direction(light.corner_3);
    return glint_triangle_solid_angle(a, b, c) + glint_triangle_solid_angle(a, c, d);
}

// Where, in texels, the tables hold a view cosine and roughness.
fn glint_table_place(cosine: f32, alpha: f32) -> vec2f {
    return vec2f(sqrt(max(alpha, 0.0)), sqrt(max(1.0 - cosine, 0.0))) * (GLINT_LTC_SIZE - 1.0);
}

// The inverse matrix (a, c, b, d) times a vector.
fn glint_to_cosine(m: vec4f, v: vec3f) -> vec3f {
    return vec3f(m.x * v.x + m.z * v.z, v.y, m.y * v.x + m.w * v.z);
}

// Where the shortest turn from z to `n` (unit) takes x and y.
fn glint_tangent_frame(n: vec3f) -> GlintTangentFrame {
    let a = 1.0 / (1.0 + max(n.z, -0.9999));
    let b = -n.x * n.y * a;
    return GlintTangentFrame(vec3f(1.0 - n.x * n.x * a, b, -n.x), vec3f(b, 1.0 - n.y * n.y * a, -n.y));
}

// Inverse, scaled to determinant 1, of a lobe's roughness as a symmetric matrix xx, xy, yy in the plane of incidence, whose
// first axis is `along` in the tangent frame.
fn glint_stretch_in_plane(lobe: GlintRoughness, along: vec2f) -> vec3f {
    let mean = sqrt(lobe.major * lobe.minor);
    let p = mean / lobe.major;
    let q = mean / lobe.minor;
    let c = dot(lobe.axis, along);
    let s = along.x * lobe.axis.y - along.y * lobe.axis.x;
    return vec3f(p * c * c + q * s * s, (p - q) * c * s, p * s * s + q * c * c);
}

// What glint_lobe_radiance does with each corner: to the plane of incidence, to the cosine, and the stretch.
fn glint_corner_to_cosine(m: vec4f, stretch: vec3f, x: vec3f, y: vec3f, normal: vec3f, corner: vec3f) -> vec3f {
    let v = glint_to_cosine(m, vec3f(dot(x, corner), dot(y, corner), dot(normal, corner)));
    return vec3f(stretch.x * v.x + stretch.y * v.y, stretch.y * v.x + stretch.z * v.y, v.z);
}

// What a light and one lobe about the unit `normal` have in common, seen from `view`.
fn glint_lobe_light(normal: vec3f, roughness: GlintRoughness, view: vec3f, light: GlintRectLight) -> GlintLobeLight {
    let frame = glint_tangent_frame(normal);
    let across = vec2f(dot(frame.x, view), dot(frame.y, view));
    let size = length(across);
    var along = vec2f(1.0, 0.0);
    if size > 1.0e-6 {
        along = across / size;
    }
    let x = frame.x * along.x + frame.y * along.y;
    let y = frame.y * along.x - frame.x * along.y;
    let lobe = GlintRoughness(
        clamp(roughness.major, GLINT_LTC_MIN_ALPHA, 1.0), clamp(roughness.minor, GLINT_LTC_MIN_ALPHA, 1.0), roughness.axis,
    );
    let place = glint_table_place(max(dot(normal, view), GLINT_LTC_MIN_VIEW_COSINE), sqrt(lobe.major * lobe.minor));
    let m = glint_ltc_inverse(place);
    let terms = glint_ltc_terms(place);
    let s = glint_stretch_in_plane(lobe, along);
    let form_factor = glint_quad_form_factor(
        glint_corner_to_cosine(m, s, x, y, normal, light.corner_0),
        glint_corner_to_cosine(m, s, x, y, normal, light.corner_1),
        glint_corner_to_cosine(m, s, x, y, normal, light.corner_2),
        glint_corner_to_cosine(m, s, x, y, normal, light.corner_3),
    );
    return GlintLobeLight(form_factor, terms);
}

// Radiance towards `view` of one lobe about the unit `normal`, with reflectance `f0` at normal incidence, for a light of
// radiance 1.
fn glint_lobe_radiance(normal: vec3f, roughness: GlintRoughness, view: vec3f, f0: vec3f, light: GlintRectLight) -> vec3f {
    let lobe = glint_lobe_light(normal, roughness, view, light);
    return lobe.form_factor * (f0 * lobe.terms.x + (vec3f(1.0) - f0) * lobe.terms.y);
}

// Whether the shaded point is in front of the light.
fn glint_faces(light: GlintRectLight) -> bool {
    let across = cross(light.corner_1 - light.corner_0, light.corner_3 - light.corner_0);
    return light.two_sided != 0u || dot(across, light.corner_0) < 0.0;
}

// Radiance towards `view` of an isotropic surface of overall roughness alpha, 0 to 1.
fn glint_isotropic_radiance(normal: vec3f, alpha: f32, view: vec3f, f0: vec3f, light: GlintRectLight) -> vec3f {
    if !glint_faces(light) {
        return vec3f(0.0);
    }
    let lobe = GlintRoughness(alpha, alpha, vec2f(1.0, 0.0));
    return glint_lobe_radiance(normal, lobe, view, f0, light) * light.radiance;
}
