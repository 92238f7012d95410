// A footprint as an ellipse. Twin of ellipse.rs. No accessors; lengths are texels.

#import footprint

// Least standard deviation: below it positions have no digits left.
const GLINT_WINDOWS_LEAST_TEXELS: f32 = 0.0001220703125;

// A Gaussian by its principal axes.
struct GlintWindowsEllipse {
    mean: vec2f,
    // Unit vector.
    axis: vec2f,
    major: f32,
    minor: f32,
}

// A matrix by rows, m00 m01 m10 m11, times a vector.
fn glint_windows_apply(m: vec4f, v: vec2f) -> vec2f {
    return vec2f(m.x * v.x + m.y * v.y, m.z * v.x + m.w * v.y);
}

fn glint_windows_determinant(m: vec4f) -> f32 {
    return m.x * m.w - m.y * m.z;
}

// A footprint with its centre at the origin. A point is one of the least size.
fn glint_windows_ellipse(footprint: GlintFootprint) -> GlintWindowsEllipse {
    let principal = glint_principal(footprint);
    let least = GLINT_WINDOWS_LEAST_TEXELS;
    return GlintWindowsEllipse(
        vec2f(0.0), principal.axis, clamp(principal.major, least, 1.0e9), clamp(principal.minor, least, 1.0e9),
    );
}

// The ellipse in coordinates x' = m x + offset. The minor axis follows from the area, which keeps its digits.
fn glint_windows_transformed(e: GlintWindowsEllipse, m: vec4f, offset: vec2f) -> GlintWindowsEllipse {
    let p = glint_windows_apply(m, e.axis) * e.major;
    let q = glint_windows_apply(m, vec2f(-e.axis.y, e.axis.x)) * e.minor;
    let half_gap = vec2f(0.5 * (p.x * p.x + q.x * q.x - p.y * p.y - q.y * q.y), p.x * p.y + q.x * q.y);
    let h = sqrt(half_gap.x * half_gap.x + half_gap.y * half_gap.y);
    let major = sqrt(0.5 * (dot(p, p) + dot(q, q)) + h);
    let minor = abs(glint_windows_determinant(m) * e.major * e.minor) / major;
    return GlintWindowsEllipse(glint_windows_apply(m, e.mean) + offset, glint_half_angle(half_gap), major, minor);
}

// With a minor axis that the major one is at most `max_ratio` times.
fn glint_windows_shortened(e: GlintWindowsEllipse, max_ratio: f32) -> GlintWindowsEllipse {
    return GlintWindowsEllipse(e.mean, e.axis, e.major, max(e.minor, e.major / max_ratio));
}

// The ellipse whose semi-axes are `reach` standard deviations and `margin`, as one of standard deviations.
fn glint_windows_within(e: GlintWindowsEllipse, reach: f32, margin: f32) -> GlintWindowsEllipse {
    return GlintWindowsEllipse(e.mean, e.axis, reach * e.major + margin, reach * e.minor + margin);
}

// Half the height of the ellipse of one standard deviation.
fn glint_windows_half_height(e: GlintWindowsEllipse) -> f32 {
    let y = e.axis.y * e.major;
    let x = e.axis.x * e.minor;
    return sqrt(y * y + x * x);
}

// The range of x at height y of the ellipse of one standard deviation; empty where it does not reach.
fn glint_windows_span_x(e: GlintWindowsEllipse, y: f32) -> vec2f {
    let p = 1.0 / (e.major * e.major);
    let q = 1.0 / (e.minor * e.minor);
    let a = e.axis.x * e.axis.x * p + e.axis.y * e.axis.y * q;
    let b = e.axis.x * e.axis.y * (p - q);
    let dy = y - e.mean.y;
    let inner = a - dy * dy * p * q;
    if !(inner >= 0.0) {
        return vec2f(1.0e30, -1.0e30);
    }
    let half = sqrt(inner) / a;
    let middle = e.mean.x - b / a * dy;
    return vec2f(middle - half, middle + half);
}
