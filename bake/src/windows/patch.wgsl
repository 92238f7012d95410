// A bilinear patch of normals under a footprint in closed form. Twin of patch.rs. No accessors.

#import erf
#import windows::ellipse

// Squares of a patch depart from a parallelogram by no more than this many intrinsic roughnesses at a corner.
const GLINT_WINDOWS_TWIST: f32 = 2.0;
// Squares along an edge of a patch at most.
const GLINT_WINDOWS_MOST_PARTS: f32 = 4.0;
// Variance of a place, in edges of a square, below which it is a point.
const GLINT_WINDOWS_LEAST_VARIANCE: f32 = 1.0e-12;
// Steps towards the likeliest place.
const GLINT_WINDOWS_STEPS: i32 = 2;
// Beyond this many standard deviations the lobe of a normal is nothing.
const GLINT_WINDOWS_CUT: f32 = 4.5;

// What a projected normal says of the place it comes from, in standard deviations of the footprint along its axes: prior variance 1.
struct GlintWindowsSeen {
    // Squared distance of the normal, in standard deviations of what the footprint sees.
    far: f32,
    // Determinant of the covariance of what the footprint sees.
    determinant: f32,
    // Mean of the place.
    place: vec2f,
    // Its covariance: xx, xy, yy.
    own: vec3f,
}

// Density at `s` of a patch of edge 1 under a footprint, whose centre is seen from corner 00: the integral over the patch of the
// footprint times the lobes, of standard deviation `sigma`, of its normals. One that is twisted is divided in squares.
fn glint_windows_patch_density(
    s00: vec2f,
    s10: vec2f,
    s01: vec2f,
    s11: vec2f,
    e: GlintWindowsEllipse,
    sigma: f32,
    s: vec2f,
) -> f32 {
    if !glint_windows_square_reaches(s00, s10, s01, s11, sigma, s) {
        return 0.0;
    }
    let bend = s11 - s10 - s01 + s00;
    let twist = sqrt(dot(bend, bend));
    let parts = clamp(ceil(sqrt(twist / (GLINT_WINDOWS_TWIST * sigma))), 1.0, GLINT_WINDOWS_MOST_PARTS);
    var sum = 0.0;
    var square = vec2f(0.0);
    for (var visit = 0; visit < 16; visit++) {
        let a = glint_windows_bilinear(s00, s10, s01, s11, square / parts);
        let b = glint_windows_bilinear(s00, s10, s01, s11, (square + vec2f(1.0, 0.0)) / parts);
        let c = glint_windows_bilinear(s00, s10, s01, s11, (square + vec2f(0.0, 1.0)) / parts);
        let d = glint_windows_bilinear(s00, s10, s01, s11, (square + vec2f(1.0, 1.0)) / parts);
        if glint_windows_square_reaches(a, b, c, d, sigma, s) {
            let seen = GlintWindowsEllipse(e.mean * parts - square, e.axis, e.major * parts, e.minor * parts);
            sum += glint_windows_square_density(a, b, c, d, seen, sigma, s);
        }
        square = select(vec2f(0.0, square.y + 1.0), vec2f(square.x + 1.0, square.y), square.x + 1.0 < parts);
        if square.y >= parts {
            break;
        }
    }
    return sum;
}

// Bilinear between four corners (00, 10, 01, 11).
fn glint_windows_bilinear(s00: vec2f, s10: vec2f, s01: vec2f, s11: vec2f, at: vec2f) -> vec2f {
    return mix(mix(s00, s10, at.x), mix(s01, s11, at.x), at.y);
}

// Whether lobes of normals between four corners reach `s`.
fn glint_windows_square_reaches(s00: vec2f, s10: vec2f, s01: vec2f, s11: vec2f, sigma: f32, s: vec2f) -> bool {
    let cut = GLINT_WINDOWS_CUT * sigma;
    let low = min(min(s00, s10), min(s01, s11)) - cut;
    let high = max(max(s00, s10), max(s01, s11)) + cut;
    return all(s > low) && all(s < high);
}

// Density at `s` of a square of edge 1 whose corners have these normals, under a footprint whose centre is seen from corner 00. The
// square is taken as linear around the likeliest place.
fn glint_windows_square_density(
    s00: vec2f,
    s10: vec2f,
    s01: vec2f,
    s11: vec2f,
    e: GlintWindowsEllipse,
    sigma: f32,
    s: vec2f,
) -> f32 {
    let side = vec2f(-e.axis.y, e.axis.x);
    var at = clamp(e.mean, vec2f(0.0), vec2f(1.0));
    var seen: GlintWindowsSeen;
    for (var k = 0; k < GLINT_WINDOWS_STEPS; k++) {
        let du = (s10 - s00) * (1.0 - at.y) + (s11 - s01) * at.y;
        let dv = (s01 - s00) * (1.0 - at.x) + (s11 - s10) * at.x;
        let normal = s00 + (s10 - s00) * at.x + dv * at.y;
        let a = (du * e.axis.x + dv * e.axis.y) * e.major;
        let b = (du * side.x + dv * side.y) * e.minor;
        let mean = normal + du * (e.mean.x - at.x) + dv * (e.mean.y - at.y);
        seen = glint_windows_seen(s - mean, a, b, sigma);
        seen.place = e.mean + e.axis * (seen.place.x * e.major) + side * (seen.place.y * e.minor);
        at = clamp(seen.place, vec2f(0.0), vec2f(1.0));
    }
    // Along the square's axes: what is uncertain of the place.
    let along = vec2f(e.axis.x * e.major, side.x * e.minor);
    let down = vec2f(e.axis.y * e.major, side.y * e.minor);
    let xx = glint_windows_covariance(seen, along, along);
    let xy = glint_windows_covariance(seen, along, down);
    let yy = glint_windows_covariance(seen, down, down);
    // The places within the square, along x, are about those of a product with a Gaussian of the square's mean and variance; the part
    // along y is that of the places there.
    let slope = xy / max(xx, GLINT_WINDOWS_LEAST_VARIANCE);
    let within = 1.0 / (1.0 / max(xx, GLINT_WINDOWS_LEAST_VARIANCE) + 12.0);
    let moved = (0.5 - seen.place.x) * 12.0 * within;
    let part = glint_windows_inside(seen.place.x, xx)
        * glint_windows_inside(seen.place.y + slope * moved, yy - slope * (xy - slope * within));
    let dv = (s01 - s00) * (1.0 - at.x) + (s11 - s10) * at.x;
    let normal = s00 + (s10 - s00) * at.x + dv * at.y;
    let density = exp(-0.5 * seen.far) * inverseSqrt(seen.determinant) * 0.15915494;
    return density * part / glint_windows_inside_disk(normal, sigma);
}

// Mass of the lobe of a normal inside the disk, whose rim is taken as straight.
fn glint_windows_inside_disk(normal: vec2f, sigma: f32) -> f32 {
    let clear = max(1.0 - GLINT_WINDOWS_CUT * sigma, 0.0);
    let square = dot(normal, normal);
    if square < clear * clear {
        return 1.0;
    }
    return max(glint_windows_normal_cdf((1.0 - sqrt(square)) / sigma), 1.0e-3);
}

// Part from 0 to 1 of a Gaussian around `place`.
fn glint_windows_inside(place: f32, variance: f32) -> f32 {
    let inverse = inverseSqrt(max(variance, GLINT_WINDOWS_LEAST_VARIANCE));
    return glint_windows_normal_cdf((1.0 - place) * inverse) - glint_windows_normal_cdf(-place * inverse);
}

// Of a normal `d` from the footprint's middle, where normals move by `a` and `b` a standard deviation, seen through a lobe of `sigma`.
fn glint_windows_seen(d: vec2f, a: vec2f, b: vec2f, sigma: f32) -> GlintWindowsSeen {
    let sigma2 = sigma * sigma;
    let aa = dot(a, a);
    let ab = dot(a, b);
    let bb = dot(b, b);
    let a_d = a.x * d.y - a.y * d.x;
    let b_d = b.x * d.y - b.y * d.x;
    let crossed = a.x * b.y - a.y * b.x;
    // The covariance C = sigma^2 + a a^T + b b^T of normals: det C and d^T (adj C) d are sums of squares, so that no digits cancel.
    let determinant = sigma2 * (sigma2 + aa + bb) + crossed * crossed;
    let part = 1.0 / determinant;
    return GlintWindowsSeen(
        (sigma2 * dot(d, d) + a_d * a_d + b_d * b_d) * part,
        determinant,
        vec2f(sigma2 * dot(a, d) - crossed * b_d, sigma2 * dot(b, d) + crossed * a_d) * part,
        vec3f(sigma2 + bb, -ab, sigma2 + aa) * (sigma2 * part),
    );
}

// Covariance of the place along two axes, vectors in standard deviations.
fn glint_windows_covariance(seen: GlintWindowsSeen, a: vec2f, b: vec2f) -> f32 {
    return a.x * b.x * seen.own.x + (a.x * b.y + a.y * b.x) * seen.own.y + a.y * b.y * seen.own.z;
}

fn glint_windows_normal_cdf(x: f32) -> f32 {
    return 0.5 * (1.0 + glint_erf(x * 0.70710678));
}
