//! A bilinear patch of normals under a footprint in closed form.
//!
//! What a map is between four texel centres is such a patch. `docs/methods/ndf-maps.md`, *A patch under a footprint*, derives the
//! density.

use super::ellipse::Ellipse;
use crate::erf::erf;
use glam::{Vec2, Vec3};

/// Density at `s` of a patch of edge 1 under a footprint, whose centre is seen from corner 00: the integral over the patch of the
/// footprint times the lobes, of standard deviation `sigma`, of its normals. One that is twisted is divided in squares.
pub(crate) fn patch_density(corners: [Vec2; 4], e: &Ellipse, sigma: f32, s: Vec2) -> f32 {
    if !square_reaches(corners, sigma, s) {
        return 0.0;
    }
    let [s00, s10, s01, s11] = corners;
    let twist = (s11 - s10 - s01 + s00).length();
    let parts = (twist / (TWIST * sigma)).sqrt().ceil().clamp(1.0, MOST_PARTS);
    let at = |x: f32, y: f32| bilinear(corners, Vec2::new(x, y) / parts);
    let mut sum = 0.0;
    let mut square = Vec2::ZERO;
    while square.y < parts {
        let Vec2 { x, y } = square;
        let corners = [at(x, y), at(x + 1.0, y), at(x, y + 1.0), at(x + 1.0, y + 1.0)];
        if square_reaches(corners, sigma, s) {
            let mean = e.mean * parts - square;
            let seen = Ellipse { mean, axis: e.axis, major: e.major * parts, minor: e.minor * parts };
            sum += square_density(corners, &seen, sigma, s);
        }
        square = if x + 1.0 < parts { Vec2::new(x + 1.0, y) } else { Vec2::new(0.0, y + 1.0) };
    }
    sum
}

/// Bilinear between four corners (00, 10, 01, 11).
pub(crate) fn bilinear([s00, s10, s01, s11]: [Vec2; 4], at: Vec2) -> Vec2 {
    s00.lerp(s10, at.x).lerp(s01.lerp(s11, at.x), at.y)
}

/// Squares of a patch depart from a parallelogram by no more than this many σ_r at a corner.
const TWIST: f32 = 2.0;
/// Squares along an edge of a patch at most.
const MOST_PARTS: f32 = 4.0;

/// Whether lobes of normals between four corners reach `s`.
fn square_reaches([s00, s10, s01, s11]: [Vec2; 4], sigma: f32, s: Vec2) -> bool {
    let low = s00.min(s10).min(s01.min(s11)) - CUT * sigma;
    let high = s00.max(s10).max(s01.max(s11)) + CUT * sigma;
    s.cmpgt(low).all() && s.cmplt(high).all()
}

/// Density at `s` of a square of edge 1 whose corners have these normals, under a footprint whose centre is seen from corner 00.
///
/// Where normals are n + J d, the density is a Gaussian in s and what it says of d another one (docs/methods/ndf-maps.md, *A patch
/// under a footprint*), of which the part in the square counts. The square is taken as linear around the likeliest d.
fn square_density([s00, s10, s01, s11]: [Vec2; 4], e: &Ellipse, sigma: f32, s: Vec2) -> f32 {
    let side = e.axis.perp();
    let mut at = e.mean.clamp(Vec2::ZERO, Vec2::ONE);
    let mut seen = Seen::default();
    for _ in 0..STEPS {
        let du = (s10 - s00) * (1.0 - at.y) + (s11 - s01) * at.y;
        let dv = (s01 - s00) * (1.0 - at.x) + (s11 - s10) * at.x;
        let normal = s00 + (s10 - s00) * at.x + dv * at.y;
        let a = (du * e.axis.x + dv * e.axis.y) * e.major;
        let b = (du * side.x + dv * side.y) * e.minor;
        let mean = normal + du * (e.mean.x - at.x) + dv * (e.mean.y - at.y);
        seen = self::seen(s - mean, a, b, sigma);
        seen.place = e.mean + e.axis * (seen.place.x * e.major) + side * (seen.place.y * e.minor);
        at = seen.place.clamp(Vec2::ZERO, Vec2::ONE);
    }
    // Along the square's axes: what is uncertain of the place.
    let along = Vec2::new(e.axis.x * e.major, side.x * e.minor);
    let down = Vec2::new(e.axis.y * e.major, side.y * e.minor);
    let (xx, xy, yy) = (seen.covariance(along, along), seen.covariance(along, down), seen.covariance(down, down));
    // The places within the square, along x, are about those of a product with a Gaussian of the square's mean and variance; the part
    // along y is that of the places there.
    let slope = xy / xx.max(LEAST_VARIANCE);
    let within = 1.0 / (1.0 / xx.max(LEAST_VARIANCE) + 12.0);
    let moved = (0.5 - seen.place.x) * 12.0 * within;
    let part = inside(seen.place.x, xx) * inside(seen.place.y + slope * moved, yy - slope * (xy - slope * within));
    let dv = (s01 - s00) * (1.0 - at.x) + (s11 - s10) * at.x;
    let normal = s00 + (s10 - s00) * at.x + dv * at.y;
    let density = (-0.5 * seen.far).exp() / (std::f32::consts::TAU * seen.determinant.sqrt());
    density * part / inside_disk(normal, sigma)
}

/// Mass of the lobe of a normal inside the disk, whose rim is taken as straight.
pub(crate) fn inside_disk(normal: Vec2, sigma: f32) -> f32 {
    let clear = (1.0 - CUT * sigma).max(0.0);
    if normal.length_squared() < clear * clear {
        return 1.0;
    }
    normal_cdf((1.0 - normal.length()) / sigma).max(1e-3)
}

/// Beyond this many standard deviations the lobe of a normal is nothing.
pub(crate) const CUT: f32 = 4.5;
/// Steps towards the likeliest place.
const STEPS: u32 = 2;

/// Variance of a place, in edges of a square, below which it is a point.
const LEAST_VARIANCE: f32 = 1e-12;

/// Part from 0 to 1 of a Gaussian around `place`.
fn inside(place: f32, variance: f32) -> f32 {
    let inverse = 1.0 / variance.max(LEAST_VARIANCE).sqrt();
    normal_cdf((1.0 - place) * inverse) - normal_cdf(-place * inverse)
}

/// What a projected normal says of the place it comes from, in standard deviations of the footprint along its axes: prior variance 1.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Squared distance of the normal, in standard deviations of what the footprint sees.
    far: f32,
    /// Determinant of the covariance of what the footprint sees.
    determinant: f32,
    /// Mean of the place.
    place: Vec2,
    /// Its covariance: xx, xy, yy.
    own: Vec3,
}

/// Of a normal `d` from the footprint's middle, where normals move by `a` and `b` a standard deviation, seen through a lobe of `sigma`.
fn seen(d: Vec2, a: Vec2, b: Vec2, sigma: f32) -> Seen {
    let sigma2 = sigma * sigma;
    let (aa, ab, bb) = (a.length_squared(), a.dot(b), b.length_squared());
    let (a_d, b_d, crossed) = (a.perp_dot(d), b.perp_dot(d), a.perp_dot(b));
    // The covariance C = σ² + a aᵀ + b bᵀ of normals: det C and dᵀ (adj C) d are sums of squares, so that no digits cancel.
    let determinant = sigma2 * (sigma2 + aa + bb) + crossed * crossed;
    let part = 1.0 / determinant;
    Seen {
        far: (sigma2 * d.length_squared() + a_d * a_d + b_d * b_d) * part,
        determinant,
        place: Vec2::new(sigma2 * a.dot(d) - crossed * b_d, sigma2 * b.dot(d) + crossed * a_d) * part,
        // (1 + (a b)ᵀ(a b)/σ²)⁻¹, whose determinant is det/σ⁴.
        own: Vec3::new(sigma2 + bb, -ab, sigma2 + aa) * (sigma2 * part),
    }
}

impl Seen {
    /// Covariance of the place along two axes, vectors in standard deviations.
    fn covariance(&self, a: Vec2, b: Vec2) -> f32 {
        a.x * b.x * self.own.x + (a.x * b.y + a.y * b.x) * self.own.y + a.y * b.y * self.own.z
    }
}

/// Φ(x).
pub(crate) fn normal_cdf(x: f32) -> f32 {
    0.5 * (1.0 + erf(x * std::f32::consts::FRAC_1_SQRT_2))
}
