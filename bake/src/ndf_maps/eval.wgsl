// Evaluation of NDF maps: the density of one node as it is stored, and of one patch of the map. Xing et al. 2024, "A Tiny Example Based Procedural
// Model for Real-Time Glinty Appearance Rendering", section 5 and Eq. 1. Twin of eval.rs. The CPU lists the nodes and patches of a
// footprint and then sums; shaders take the sum on the way, in the same order.
//
// Accessors that the including program defines; `layer` is that of the material, which is 0 in programs of one:
//   fn glint_ndf_record(layer: u32, at: u32) -> vec4u                  record `at` of section NMUB, see GlintNdfMaterial
//   fn glint_ndf_node(layer: u32, at: u32) -> vec4u                    element of the table NMND
//   fn glint_ndf_roots(layer: u32, at: vec2f) -> vec4f                 four texels of NMDE: textureGather at the corner that they share,
//                                                                      from 0 to 1; w and z are the upper ones from left to right, x and
//                                                                      y the lower ones
//   fn glint_ndf_normal_texel(layer: u32, at: vec2u) -> vec4u          texel of NMNO
//   fn glint_ndf_noise_texel(layer: u32, at: vec2u) -> vec4u           texel of PLNO; any value for tiled materials
//   fn glint_ndf_class_texel(layer: u32, at: vec2u, mip: u32) -> vec4u texel of PLCL; any value for tiled materials

#import erf
#import ndf_maps::ellipse

// Squares of a patch depart from a parallelogram by no more than this many intrinsic roughnesses at a corner.
const GLINT_NDF_TWIST: f32 = 2.0;
// Squares along an edge of a patch at most.
const GLINT_NDF_MOST_PARTS: f32 = 4.0;
// Variance of a place, in edges of a square, below which it is a point.
const GLINT_NDF_LEAST_VARIANCE: f32 = 1.0e-12;
// Steps towards the likeliest place.
const GLINT_NDF_STEPS: i32 = 2;

// One material: the first 64 bytes of section NMUB. Records are the rest of that section, four u32 each; the levels come first, one
// record a level: nodes_x, nodes_y, first_node, 0.
struct GlintNdfMaterial {
    // Example, in texels.
    size: vec2u,
    // 0.
    unused: u32,
    levels: u32,
    // Standard deviation of the lobe of a normal, in the projected-normal disk.
    intrinsic_roughness: f32,
    // Steps a unit of the disk; nodes count in them.
    steps: f32,
    // Variance of the finest windows, texels^2; each level has twice that of the one before.
    finest_variance: f32,
    palette: u32,
    // Cells of the stochastic placement along an axis, a power of two; 0 means tiled.
    cells: u32,
    // Edge of a cell in surface texels.
    cell_texels: f32,
    // First record of: the palette, two an entry: position_to_local, normal_to_local, each a matrix by rows.
    palette_records: u32,
    // The reach mask, see glint_ndf_reaches.
    reach_records: u32,
    // 1 over width and height of the atlas.
    inv_atlas: vec2f,
    // 0 in the pack. A program of several materials tells its accessors by this which of them is meant.
    layer: u32,
    // Example texels a surface texel, by area, under the transform of the palette that has most.
    most_texels: f32,
}

// Choice between speed and accuracy at run time.
struct GlintNdfSettings {
    // A footprint's major axis in minor ones at most; longer ones are seen as wide as that.
    max_ratio: f32,
    // Patches of the map lie within this many standard deviations of the footprint's centre: 4 % of its mass is beyond 2.5, 3e-4 beyond 4.
    reach: f32,
}

// What a part of a footprint shows.
struct GlintNdfSum {
    // Its density, times the part.
    density: f32,
    // Nodes and patches visited.
    terms: f32,
}

// Density of one node at the example's projected normal `s`: the square of roots that are bilinear between texels, 0 outside the table
// and outside the disk.
fn glint_ndf_node_density(material: GlintNdfMaterial, node: u32, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    let record = glint_ndf_node(material.layer, node);
    let away = (s + 1.0) * material.steps - vec2f(f32(record.x & 0xffffu), f32(record.x >> 16u));
    let p = away / vec2f(f32((record.z >> 16u) & 0xffu), f32(record.z >> 24u));
    let size = vec2f(f32(record.z & 0xffu), f32((record.z >> 8u) & 0xffu));
    if !(all(p > vec2f(-1.0)) && all(p < size)) {
        return 0.0;
    }
    let cell = floor(p);
    let f = p - cell;
    let corner = vec2f(f32(record.y & 0xffffu), f32(record.y >> 16u)) + cell;
    let roots = glint_ndf_roots(material.layer, (corner + 1.0) * material.inv_atlas);
    let top = roots.w + (roots.z - roots.w) * f.x;
    let bottom = roots.x + (roots.y - roots.x) * f.x;
    let root = top + (bottom - top) * f.y;
    return bitcast<f32>(record.w) * root * root;
}

// What a projected normal says of the place it comes from, in standard deviations of the footprint along its axes: prior variance 1.
struct GlintNdfSeen {
    // Density of the normal.
    density: f32,
    // Mean of the place.
    place: vec2f,
    // Its covariance: xx, xy, yy.
    own: vec3f,
}

// Density at the example's projected normal `s` of a patch under a footprint, whose centre lies in texels from corner 00: the integral
// over the patch of the footprint times the lobes of its normals. One that is twisted is divided in squares. `texel` is that of NMNO.
fn glint_ndf_patch_density(material: GlintNdfMaterial, texel: vec4u, e: GlintNdfEllipse, s: vec2f) -> f32 {
    let s00 = unpack2x16snorm(texel.x);
    let s10 = unpack2x16snorm(texel.y);
    let s01 = unpack2x16snorm(texel.z);
    let s11 = unpack2x16snorm(texel.w);
    let sigma = material.intrinsic_roughness;
    if dot(s, s) > 1.0 || !glint_ndf_square_reaches(s00, s10, s01, s11, sigma, s) {
        return 0.0;
    }
    let bend = s11 - s10 - s01 + s00;
    let twist = sqrt(dot(bend, bend));
    let parts = clamp(ceil(sqrt(twist / (GLINT_NDF_TWIST * sigma))), 1.0, GLINT_NDF_MOST_PARTS);
    var sum = 0.0;
    var square = vec2f(0.0);
    for (var visit = 0; visit < 16; visit++) {
        let a = glint_ndf_bilinear(s00, s10, s01, s11, square / parts);
        let b = glint_ndf_bilinear(s00, s10, s01, s11, (square + vec2f(1.0, 0.0)) / parts);
        let c = glint_ndf_bilinear(s00, s10, s01, s11, (square + vec2f(0.0, 1.0)) / parts);
        let d = glint_ndf_bilinear(s00, s10, s01, s11, (square + vec2f(1.0, 1.0)) / parts);
        if glint_ndf_square_reaches(a, b, c, d, sigma, s) {
            let seen = GlintNdfEllipse(e.mean * parts - square, e.axis, e.major * parts, e.minor * parts);
            sum += glint_ndf_square_density(a, b, c, d, seen, sigma, s);
        }
        square = select(vec2f(0.0, square.y + 1.0), vec2f(square.x + 1.0, square.y), square.x + 1.0 < parts);
        if square.y >= parts {
            break;
        }
    }
    return sum;
}

// Bilinear between four corners (00, 10, 01, 11).
fn glint_ndf_bilinear(s00: vec2f, s10: vec2f, s01: vec2f, s11: vec2f, at: vec2f) -> vec2f {
    return mix(mix(s00, s10, at.x), mix(s01, s11, at.x), at.y);
}

// Whether lobes of normals between four corners reach `s`.
fn glint_ndf_square_reaches(s00: vec2f, s10: vec2f, s01: vec2f, s11: vec2f, sigma: f32, s: vec2f) -> bool {
    // Beyond this many standard deviations a lobe is nothing.
    let cut = 4.5;
    let low = min(min(s00, s10), min(s01, s11)) - cut * sigma;
    let high = max(max(s00, s10), max(s01, s11)) + cut * sigma;
    return all(s > low) && all(s < high);
}

// Density at `s` of a square of edge 1 whose corners have these normals, under a footprint whose centre is seen from corner 00. The
// square is taken as linear around the likeliest place.
fn glint_ndf_square_density(
    s00: vec2f,
    s10: vec2f,
    s01: vec2f,
    s11: vec2f,
    e: GlintNdfEllipse,
    sigma: f32,
    s: vec2f,
) -> f32 {
    let side = vec2f(-e.axis.y, e.axis.x);
    var at = clamp(e.mean, vec2f(0.0), vec2f(1.0));
    var seen: GlintNdfSeen;
    for (var k = 0; k < GLINT_NDF_STEPS; k++) {
        let du = (s10 - s00) * (1.0 - at.y) + (s11 - s01) * at.y;
        let dv = (s01 - s00) * (1.0 - at.x) + (s11 - s10) * at.x;
        let normal = s00 + (s10 - s00) * at.x + dv * at.y;
        let a = (du * e.axis.x + dv * e.axis.y) * e.major;
        let b = (du * side.x + dv * side.y) * e.minor;
        let mean = normal + du * (e.mean.x - at.x) + dv * (e.mean.y - at.y);
        seen = glint_ndf_seen(s - mean, a, b, sigma);
        seen.place = e.mean + e.axis * (seen.place.x * e.major) + side * (seen.place.y * e.minor);
        at = clamp(seen.place, vec2f(0.0), vec2f(1.0));
    }
    // Along the square's axes: what is uncertain of the place.
    let along = vec2f(e.axis.x * e.major, side.x * e.minor);
    let down = vec2f(e.axis.y * e.major, side.y * e.minor);
    let xx = glint_ndf_covariance(seen, along, along);
    let xy = glint_ndf_covariance(seen, along, down);
    let yy = glint_ndf_covariance(seen, down, down);
    // The places within the square, along x, are about those of a product with a Gaussian of the square's mean and variance; the part
    // along y is that of the places there.
    let slope = xy / max(xx, GLINT_NDF_LEAST_VARIANCE);
    let within = 1.0 / (1.0 / max(xx, GLINT_NDF_LEAST_VARIANCE) + 12.0);
    let moved = (0.5 - seen.place.x) * 12.0 * within;
    let part = glint_ndf_inside(seen.place.x, xx)
        * glint_ndf_inside(seen.place.y + slope * moved, yy - slope * (xy - slope * within));
    let dv = (s01 - s00) * (1.0 - at.x) + (s11 - s10) * at.x;
    let normal = s00 + (s10 - s00) * at.x + dv * at.y;
    let mass = max(glint_ndf_normal_cdf((1.0 - sqrt(dot(normal, normal))) / sigma), 1.0e-3);
    return seen.density * part / mass;
}

// Part from 0 to 1 of a Gaussian around `place`.
fn glint_ndf_inside(place: f32, variance: f32) -> f32 {
    let inverse = 1.0 / sqrt(max(variance, GLINT_NDF_LEAST_VARIANCE));
    return glint_ndf_normal_cdf((1.0 - place) * inverse) - glint_ndf_normal_cdf(-place * inverse);
}

// Of a normal `d` from the footprint's middle, where normals move by `a` and `b` a standard deviation, seen through a lobe of `sigma`.
fn glint_ndf_seen(d: vec2f, a: vec2f, b: vec2f, sigma: f32) -> GlintNdfSeen {
    let sigma2 = sigma * sigma;
    let aa = dot(a, a);
    let ab = dot(a, b);
    let bb = dot(b, b);
    let crossed = a.x * b.y - a.y * b.x;
    // Determinants as sums of squares, so that no digits cancel.
    let det = sigma2 * (sigma2 + aa + bb) + crossed * crossed;
    let xx = sigma2 + a.x * a.x + b.x * b.x;
    let xy = a.x * a.y + b.x * b.y;
    let yy = sigma2 + a.y * a.y + b.y * b.y;
    let w = vec2f(yy * d.x - xy * d.y, xx * d.y - xy * d.x) / det;
    return GlintNdfSeen(
        exp(-0.5 * dot(d, w)) / (6.2831853 * sqrt(det)),
        vec2f(dot(a, w), dot(b, w)),
        vec3f(sigma2 + bb, -ab, sigma2 + aa) * (sigma2 / det),
    );
}

// Covariance of the place along two axes, vectors in standard deviations.
fn glint_ndf_covariance(seen: GlintNdfSeen, a: vec2f, b: vec2f) -> f32 {
    return a.x * b.x * seen.own.x + (a.x * b.y + a.y * b.x) * seen.own.y + a.y * b.y * seen.own.z;
}

fn glint_ndf_normal_cdf(x: f32) -> f32 {
    return 0.5 * (1.0 + glint_erf(x * 0.70710678));
}
