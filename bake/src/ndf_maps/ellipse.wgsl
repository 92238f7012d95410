// A footprint as an ellipse, and the pieces under it: cells of a grid, places of tiles on the repeating example. Twin of ellipse.rs.
// No accessors; lengths are texels.

#import footprint

// In estimates of how many there are, pieces lie within this many standard deviations of the footprint's centre.
const GLINT_NDF_REACH: f32 = 2.8;
// Finest boxes: below this edge positions have no digits left.
const GLINT_NDF_FINEST_TEXELS: f32 = 0.000244140625;
// Rows or columns of one loop, at most; settings bound them far below that where footprints are numbers.
const GLINT_NDF_MAX_STEPS: i32 = 8192;

// A Gaussian by its principal axes.
struct GlintNdfEllipse {
    mean: vec2f,
    // Unit vector.
    axis: vec2f,
    major: f32,
    minor: f32,
    // Pieces lie within this many standard deviations of the mean.
    reach: f32,
}

// A matrix by rows, m00 m01 m10 m11, times a vector.
fn glint_ndf_apply(m: vec4f, v: vec2f) -> vec2f {
    return vec2f(m.x * v.x + m.y * v.y, m.z * v.x + m.w * v.y);
}

fn glint_ndf_determinant(m: vec4f) -> f32 {
    return m.x * m.w - m.y * m.z;
}

fn glint_ndf_inverse(m: vec4f) -> vec4f {
    return vec4f(m.w, -m.y, -m.z, m.x) * (1.0 / glint_ndf_determinant(m));
}

// A footprint with its centre at the origin. A point is a footprint of the finest box's size.
fn glint_ndf_ellipse(footprint: GlintFootprint, reach: f32) -> GlintNdfEllipse {
    let principal = glint_principal(footprint);
    let least = 0.5 * GLINT_NDF_FINEST_TEXELS;
    return GlintNdfEllipse(
        vec2f(0.0), principal.axis, clamp(principal.major, least, 1.0e9), clamp(principal.minor, least, 1.0e9), reach,
    );
}

// The ellipse in coordinates x' = m x + offset. The minor axis follows from the area, which keeps its digits.
fn glint_ndf_transformed(e: GlintNdfEllipse, m: vec4f, offset: vec2f) -> GlintNdfEllipse {
    let p = glint_ndf_apply(m, e.axis) * e.major;
    let q = glint_ndf_apply(m, vec2f(-e.axis.y, e.axis.x)) * e.minor;
    let half_gap = vec2f(0.5 * (p.x * p.x + q.x * q.x - p.y * p.y - q.y * q.y), p.x * p.y + q.x * q.y);
    let h = sqrt(half_gap.x * half_gap.x + half_gap.y * half_gap.y);
    let major = sqrt(0.5 * (dot(p, p) + dot(q, q)) + h);
    let minor = abs(glint_ndf_determinant(m) * e.major * e.minor) / major;
    return GlintNdfEllipse(glint_ndf_apply(m, e.mean) + offset, glint_half_angle(half_gap), major, minor, e.reach);
}

// Widened by a box of edge `edge`.
fn glint_ndf_widened(e: GlintNdfEllipse, edge: f32) -> GlintNdfEllipse {
    let extra = edge * edge / 12.0;
    return GlintNdfEllipse(e.mean, e.axis, sqrt(e.major * e.major + extra), sqrt(e.minor * e.minor + extra), e.reach);
}

// Pieces of `edge` in the box around the ellipse that is widened by them.
fn glint_ndf_pieces(e: GlintNdfEllipse, edge: f32) -> f32 {
    let widened = glint_ndf_widened(e, edge);
    return (2.0 * GLINT_NDF_REACH * widened.minor / edge) * (2.0 * GLINT_NDF_REACH * widened.major / edge);
}

// Density at x, 1 / texel^2.
fn glint_ndf_gaussian(e: GlintNdfEllipse, x: vec2f) -> f32 {
    let d = x - e.mean;
    let along = dot(d, e.axis) / e.major;
    let across = (d.x * e.axis.y - d.y * e.axis.x) / e.minor;
    return exp(-0.5 * (along * along + across * across)) / (6.2831853 * e.minor * e.major);
}

// That of the ellipse widened by a box of edge `edge`.
fn glint_ndf_widened_gaussian(e: GlintNdfEllipse, edge: f32, x: vec2f) -> f32 {
    let d = x - e.mean;
    let along = dot(d, e.axis);
    let across = d.x * e.axis.y - d.y * e.axis.x;
    let extra = edge * edge / 12.0;
    let p = 1.0 / (e.major * e.major + extra);
    let q = 1.0 / (e.minor * e.minor + extra);
    return exp(-0.5 * (along * along * p + across * across * q)) * sqrt(p * q) * 0.15915494;
}

// Gradient of the density's logarithm at x.
fn glint_ndf_log_gradient(e: GlintNdfEllipse, x: vec2f) -> vec2f {
    let d = x - e.mean;
    let across = vec2f(-e.axis.y, e.axis.x);
    return e.axis * (-dot(d, e.axis) / (e.major * e.major)) + across * (-dot(d, across) / (e.minor * e.minor));
}

// Half the height of the ellipse of its reach.
fn glint_ndf_reach_y(e: GlintNdfEllipse) -> f32 {
    let y = e.axis.y * e.major;
    let x = e.axis.x * e.minor;
    return e.reach * sqrt(y * y + x * x);
}

// The ellipse's range of x at height y; an empty one where it does not reach.
fn glint_ndf_span_x(e: GlintNdfEllipse, y: f32) -> vec2f {
    let p = 1.0 / (e.major * e.major);
    let q = 1.0 / (e.minor * e.minor);
    let a = e.axis.x * e.axis.x * p + e.axis.y * e.axis.y * q;
    let b = e.axis.x * e.axis.y * (p - q);
    let dy = y - e.mean.y;
    let inner = e.reach * e.reach * a - dy * dy * p * q;
    if !(inner >= 0.0) {
        return vec2f(1.0e30, -1.0e30);
    }
    let half = sqrt(inner) / a;
    let middle = e.mean.x - b / a * dy;
    return vec2f(middle - half, middle + half);
}

// First cell, of a grid of `edge` with a corner at `origin`, whose centre is not below x.
fn glint_ndf_cell_from(origin: f32, edge: f32, x: f32) -> i32 {
    return i32(ceil(clamp((x - origin) / edge - 0.5, -1.0e9, 1.0e9)));
}

// First and one past the last cell of an axis with centres from `low` to `high`.
fn glint_ndf_cells(origin: f32, edge: f32, low: f32, high: f32) -> vec2i {
    let first = glint_ndf_cell_from(origin, edge, low);
    return vec2i(first, min(glint_ndf_cell_from(origin, edge, high), first + GLINT_NDF_MAX_STEPS));
}

fn glint_ndf_cell_centre(origin: f32, edge: f32, index: i32) -> f32 {
    return origin + (f32(index) + 0.5) * edge;
}

// A tile's place on one axis of the repeating example.
struct GlintNdfSlot {
    // Where the example's period begins.
    period: f32,
    // Index of the tile.
    index: u32,
}

// The slot that holds x, of `count` tiles of `edge` repeated every `length`.
fn glint_ndf_slot_at(x: f32, count: u32, length: f32, edge: f32) -> GlintNdfSlot {
    let period = floor(x / length) * length;
    return GlintNdfSlot(period, min(u32(max((x - period) / edge, 0.0)), count - 1u));
}

fn glint_ndf_next_slot(slot: GlintNdfSlot, count: u32, length: f32) -> GlintNdfSlot {
    if slot.index + 1u == count {
        return GlintNdfSlot(slot.period + length, 0u);
    }
    return GlintNdfSlot(slot.period, slot.index + 1u);
}
