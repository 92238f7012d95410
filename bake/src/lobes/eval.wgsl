// MIP-mapped position-normal lobes: the distribution of normals (P-NDF) that a footprint sees on a map.
// Tan et al. 2022, "Real-Time Microstructure Rendering with MIP-mapped Normal Map Samples", sections 5.1.2 and 5.2, Eq. 6 and 9.
// Twin of eval.rs, where deviations from the paper are derived. The twin hands lobes on for any normal; here each has the density at
// the normal that is asked for.
//
// Accessors that the including program defines:
//   fn glint_lobes_level(index: u32) -> GlintLobesLevel     level of the section LOUB, 0 the finest
//   fn glint_lobes_words(index: u32) -> vec4u               16 bytes of the section LOBE: a lobe if packed, else half of one
//   fn glint_lobes_lobe(map: GlintLobesMap, level: GlintLobesLevel, index: u32) -> GlintLobe
//                                                           a lobe by its index among all: by lobes::packed or lobes::half,
//                                                           as the pack stores them
//   fn glint_lobes_normals_pair(index: u32) -> vec2u        a texel of the section LONM, row by row, and the one below it as the
//                                                           map is wrapped: stored numbers, sign-extended to 16 bits, x in
//                                                           the lower half

#import footprint
#import erf

const GLINT_LOBES_PI: f32 = 3.14159265;
// 1 / (2 pi).
const GLINT_LOBES_PEAK: f32 = 0.15915494;
// Footprints are taken to be at least this wide, in texels: below it positions have no digits left.
const GLINT_LOBES_LEAST_SIGMA: f32 = 1.0 / 4096.0;
// Squared distance, in standard deviations, beyond which a lobe is nothing.
const GLINT_LOBES_CUT: f32 = 30.0;
const GLINT_LOBES_MAX_CORRELATION: f32 = 0.998;
// Rows, and cells or boxes of a row, that a level is read by at most: more than any sound settings lead to.
const GLINT_LOBES_MOST_STEPS: u32 = 16384u;

const GLINT_LOBES_SNORM16: u32 = 0u;
const GLINT_LOBES_UNORM8: u32 = 1u;
const GLINT_WRAP_REPEAT: u32 = 0u;
const GLINT_WRAP_CLAMP: u32 = 1u;

// Whether densities get back the mass that Gaussians have beyond the rim of the disk of normals. A program of a map of which next to
// nothing lies there may set this to false before it asks; some devices run what is left out, a sum over strips, for every cell.
var<private> glint_lobes_rim: bool = true;

// A map and how its lobes are stored, from the section LOUB.
struct GlintLobesMap {
    // Size in texels.
    width: u32,
    height: u32,
    // GLINT_WRAP_REPEAT or GLINT_WRAP_CLAMP: what filtering sees beyond the map's edge.
    wrap: u32,
    // 1: the nearest texel's normal; 0: bilinear.
    nearest: u32,
    // GLINT_LOBES_SNORM16 or GLINT_LOBES_UNORM8.
    normals: u32,
    lobes_per_cell: u32,
    // 0: a map's own lobes. Else cells larger than this begin at all its multiples, and the last level is the whole surface.
    step_texels: u32,
    // Stored levels.
    levels: u32,
    // Smallest projected normal of a lobe, and their range.
    normal_low: vec2f,
    normal_extent: vec2f,
}

// A level: a grid of square cells.
struct GlintLobesLevel {
    // Edge of a cell in texels.
    cell_texels: u32,
    cells_x: u32,
    cells_y: u32,
    first_lobe: u32,
    // Weight, in texels, that a stored 1.0 stands for.
    weight_scale: f32,
    // |ds/du| per texel that a stored 1.0 stands for.
    jacobian_scale: f32,
    // Smallest standard deviation of positions in texels, and log2 of largest over smallest.
    position_sigma: f32,
    position_log_ratio: f32,
    // Smallest standard deviation of the normals' residual, and log2 of largest over smallest.
    residual_sigma: f32,
    residual_log_ratio: f32,
    // What stored positions are relative to: the cell's edge, cut to the map.
    extent: vec2f,
}

// A footprint by its principal axes, in texels.
struct GlintLobesFrame {
    mean: vec2f,
    // Unit vector along the major axis.
    axis: vec2f,
    major: f32,
    minor: f32,
}

// A footprint and the projected normal at which its density is asked for.
struct GlintLobesQuery {
    frame: GlintLobesFrame,
    // The axes over their standard deviations: what turns an offset into standard deviations. Zero sees every place alike.
    along: vec2f,
    across: vec2f,
    s: vec2f,
    // Intrinsic roughness, a standard deviation of projected normals.
    roughness: f32,
}

struct GlintLobe {
    // In texels; 0 is no lobe.
    weight: f32,
    // Mean position from the cell's corner, in texels.
    position: vec2f,
    // Mean projected normal.
    normal: vec2f,
    // Lower triangular factor F of the covariance of positions F F^T, in texels: xx, yx, yy.
    factor: vec3f,
    // ds/du per texel.
    jacobian: mat2x2f,
    // Residual covariance of normals: xx, xy, yy.
    residual: vec3f,
}

// An ellipse around a footprint, for the ranges of x that it has at some heights.
struct GlintLobesEllipse {
    mean: vec2f,
    // Half its height.
    top: f32,
    // At height y: the middle over y, half the width over sqrt(top^2 - y^2), and where the right end is.
    slope: f32,
    narrow: f32,
    widest: f32,
}

// What a lobe gives to a footprint: a Gaussian over the disk of normals.
struct GlintConditionalLobe {
    // Share of the footprint, to be divided by the sum of all shares.
    share: f32,
    // Share times density at the query's normal, but for the mass that lies inside the disk.
    density: f32,
    // Whether that mass may be less than 1.
    cut: bool,
    mean: vec2f,
    // Covariance: xx, xy, yy.
    covariance: vec3f,
}

// Bilinear patch at a place: projected normal, ds/du, d2s/du dv.
struct GlintLobesPatch {
    normal: vec2f,
    jacobian: mat2x2f,
    twist: vec2f,
}

// Axes of a footprint.
fn glint_lobes_frame(footprint: GlintFootprint) -> GlintLobesFrame {
    let axes = glint_principal(footprint);
    return GlintLobesFrame(
        footprint.mean, axes.axis, max(axes.major, GLINT_LOBES_LEAST_SIGMA), max(axes.minor, GLINT_LOBES_LEAST_SIGMA),
    );
}

// Axes of a footprint, its centre moved by whole periods into the map, where positions have the most digits.
fn glint_lobes_frame_in_map(map: GlintLobesMap, footprint: GlintFootprint) -> GlintLobesFrame {
    let size = vec2f(f32(map.width), f32(map.height));
    let limit = vec2f(1.0e7);
    let place = clamp(footprint.mean, -limit, limit);
    return glint_lobes_frame(
        GlintFootprint(place - floor(place / size) * size, footprint.xx, footprint.xy, footprint.yy),
    );
}

// A query from its parts.
fn glint_lobes_query(frame: GlintLobesFrame, s: vec2f, roughness: f32) -> GlintLobesQuery {
    let across = vec2f(-frame.axis.y, frame.axis.x) / frame.minor;
    return GlintLobesQuery(frame, frame.axis / frame.major, across, s, roughness);
}

fn glint_lobes_variance_y(frame: GlintLobesFrame) -> f32 {
    let a = frame.axis.y * frame.major;
    let b = frame.axis.x * frame.minor;
    return a * a + b * b;
}

// The ellipse of `reach` standard deviations.
fn glint_lobes_ellipse(frame: GlintLobesFrame, reach: f32) -> GlintLobesEllipse {
    let yy = glint_lobes_variance_y(frame);
    let a = frame.axis.x * frame.major;
    let b = frame.axis.y * frame.minor;
    let xx = a * a + b * b;
    let xy = frame.axis.x * frame.axis.y * (frame.major * frame.major - frame.minor * frame.minor);
    let part = 1.0 / yy;
    return GlintLobesEllipse(
        frame.mean, reach * sqrt(yy), xy * part, frame.major * frame.minor * part, reach * xy * inverseSqrt(xx),
    );
}

// Range of x of an ellipse between two heights; x > y if they miss it.
fn glint_lobes_ellipse_span(ellipse: GlintLobesEllipse, low: f32, high: f32) -> vec2f {
    let top = ellipse.top;
    let y0 = max(low - ellipse.mean.y, -top);
    let y1 = min(high - ellipse.mean.y, top);
    // Both sides are extreme where the ellipse is, or at an end of the range.
    let ends = clamp(vec2f(-ellipse.widest, ellipse.widest), vec2f(y0), vec2f(y1));
    let half = ellipse.narrow * sqrt(max(top * top - ends * ends, vec2f(0.0)));
    let span = ellipse.mean.x + ellipse.slope * ends + vec2f(-half.x, half.y);
    return select(vec2f(1.0, 0.0), span, y0 <= y1);
}

// First and last box of a row of boxes of `edge` texels, the row's low edge at `y`, under an ellipse; boxes begin at `origin`.
fn glint_lobes_row(ellipse: GlintLobesEllipse, origin: f32, edge: f32, y: f32) -> vec2i {
    let span = glint_lobes_ellipse_span(ellipse, y, y + edge);
    if !(span.x <= span.y) {
        return vec2i(1, 0);
    }
    let ends = vec2i(floor((span - origin) / edge));
    return vec2i(ends.x, min(ends.y, ends.x + i32(GLINT_LOBES_MOST_STEPS)));
}

// Lower triangular factor F of a covariance F F^T of these standard deviations: xx, yx, yy.
fn glint_lobes_factor(sigmas: vec2f, correlation: f32) -> vec3f {
    let rest = sqrt(max(1.0 - correlation * correlation, 0.0));
    return vec3f(sigmas.x, correlation * sigmas.y, rest * sigmas.y);
}

// Covariance of these standard deviations: xx, xy, yy.
fn glint_lobes_covariance(sigmas: vec2f, correlation: f32) -> vec3f {
    return vec3f(sigmas.x * sigmas.x, correlation * sigmas.x * sigmas.y, sigmas.y * sigmas.y);
}

// Whether a Gaussian may have mass beyond the rim of the disk: five standard deviations from it there is less than 4e-6. A row's sum
// stands for the largest variance.
fn glint_lobes_near_rim(mean: vec2f, covariance: vec3f) -> bool {
    let to_rim = 1.0 - length(mean);
    return glint_lobes_rim
        && !(to_rim > 0.0 && to_rim * to_rim > 25.0 * (max(covariance.x, covariance.z) + abs(covariance.y)));
}

// Mass inside the disk of a Gaussian that is wide or near the rim: a sum over strips across the line from the disk's middle
// through its mean, each strip's chord by its conditional Gaussian.
fn glint_lobes_inside_disk(mean: vec2f, covariance: vec3f) -> f32 {
    const STRIPS: i32 = 12;
    let xx = covariance.x;
    let xy = covariance.y;
    let yy = covariance.z;
    let radius = length(mean);
    var out = vec2f(1.0, 0.0);
    if radius > 0.0 {
        out = mean / radius;
    }
    let along = out.x * out.x * xx + 2.0 * out.x * out.y * xy + out.y * out.y * yy;
    let cross = out.x * out.y * (yy - xx) + (out.x * out.x - out.y * out.y) * xy;
    let rest =
        max(out.y * out.y * xx - 2.0 * out.x * out.y * xy + out.x * out.x * yy - cross * cross / along, 1.0e-12);
    let low = max(radius - 4.5 * sqrt(along), -1.0);
    let step = (1.0 - low) / f32(STRIPS);
    let across = 1.0 / sqrt(2.0 * along);
    let beside = 1.0 / sqrt(2.0 * rest);
    var sum = 0.0;
    var below = glint_erf((low - radius) * across);
    for (var k = 0; k < STRIPS; k++) {
        let x = low + (f32(k) + 0.5) * step;
        let above = glint_erf((x + 0.5 * step - radius) * across);
        let chord = sqrt(max(1.0 - x * x, 0.0));
        let middle = cross / along * (x - radius);
        sum += (above - below) * (glint_erf((chord - middle) * beside) + glint_erf((chord + middle) * beside));
        below = above;
    }
    return max(0.25 * sum, 1.0e-3);
}

// A Gaussian over the disk whose covariance (xx, xy, yy) has at least the eigenvalue `intrinsic`.
fn glint_lobes_conditional_gaussian(
    query: GlintLobesQuery,
    share: f32,
    mean: vec2f,
    covariance: vec3f,
    intrinsic: f32,
) -> GlintConditionalLobe {
    let xx = covariance.x;
    let xy = covariance.y;
    let yy = covariance.z;
    // Rounding may take the determinant of a long thin Gaussian below what it can be.
    let peak = inverseSqrt(max(xx * yy - xy * xy, intrinsic * max(xx, yy)));
    let d = query.s - mean;
    let far = (yy * d.x * d.x - 2.0 * xy * d.x * d.y + xx * d.y * d.y) * peak * peak;
    let near = far <= GLINT_LOBES_CUT;
    let density = select(0.0, share * peak * exp(-0.5 * far) * GLINT_LOBES_PEAK, near);
    return GlintConditionalLobe(share, density, near && glint_lobes_near_rim(mean, covariance), mean, covariance);
}

// What `lobe` gives to a footprint whose centre lies `d` from the lobe's position (Eq. 6).
fn glint_lobes_conditional(query: GlintLobesQuery, lobe: GlintLobe, d: vec2f) -> GlintConditionalLobe {
    // Columns of the factor of positions, in standard deviations of the footprint, and what they are in normals.
    let p = vec2f(
        query.along.x * lobe.factor.x + query.along.y * lobe.factor.y, query.along.y * lobe.factor.z,
    );
    let q = vec2f(
        query.across.x * lobe.factor.x + query.across.y * lobe.factor.y, query.across.y * lobe.factor.z,
    );
    let a = lobe.jacobian[0] * lobe.factor.x + lobe.jacobian[1] * lobe.factor.y;
    let b = lobe.jacobian[1] * lobe.factor.z;
    let w = vec2f(dot(query.along, d), dot(query.across, d));
    // M = I + F^T S^-1 F is I + p p^T + q q^T; det M and adj M are sums of squares and outer products.
    let area = p.x * q.y - p.y * q.x;
    let det = 1.0 + dot(p, p) + dot(q, q) + area * area;
    let root = inverseSqrt(det);
    let part = root * root;
    let across = p * w.y - q * w.x;
    let distance = (dot(w, w) + dot(across, across)) * part;
    let toward = (p * w.x + q * w.y + vec2f(-across.y, across.x) * area) * part;
    let u = b * p.x - a * p.y;
    let v = b * q.x - a * q.y;
    let intrinsic = query.roughness * query.roughness;
    let xx = intrinsic + lobe.residual.x + (a.x * a.x + b.x * b.x + u.x * u.x + v.x * v.x) * part;
    let xy = lobe.residual.y + (a.x * a.y + b.x * b.y + u.x * u.y + v.x * v.y) * part;
    let yy = intrinsic + lobe.residual.z + (a.y * a.y + b.y * b.y + u.y * u.y + v.y * v.y) * part;
    let mean = lobe.normal + a * toward.x + b * toward.y;
    let share = lobe.weight * exp(-0.5 * distance) * root;
    return glint_lobes_conditional_gaussian(query, share, mean, vec3f(xx, xy, yy), intrinsic);
}

// Lobe of a box of the filtered map, `size` texels wide and high: exact moments.
fn glint_lobes_box_lobe(place: GlintLobesPatch, size: vec2f) -> GlintLobe {
    const PER_EDGE: f32 = 0.28867513; // 1 / sqrt 12
    let rest = place.twist * (size.x * size.y / 12.0);
    return GlintLobe(
        size.x * size.y,
        vec2f(0.0),
        place.normal,
        vec3f(size.x * PER_EDGE, 0.0, size.y * PER_EDGE),
        place.jacobian,
        vec3f(rest.x * rest.x, rest.x * rest.y, rest.y * rest.y),
    );
}
