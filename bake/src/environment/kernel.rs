//! What radiance is weighted with.
//!
//! Paper: section 3.4, p ∝ ρ̃(ω_i, ω_r) under N = V = R. With c the cosine between texel and light and t = 1 − c, the
//! half vector has cos² θ_h = 1 − t/2, and GGX becomes D ∝ 1 / (α² + (1 − α²) t/2)². Kernels here are 1 at t = 0 up to
//! the last factor:
//! - `Ndf`, the paper's: F, 4 and n·ω_o are constant, G is Smith's with both directions, whose view part is 1, so the
//!   weight is D · 2c / (c + √(c² + α² (1 − c²)));
//! - `GgxNl`, what engines and Filament's cmgen use: D · c;
//! - `GgxSoft`, the same with a smooth end: c becomes s(c), a parabola from −τ to τ. A sun at the horizon of a rough lobe is a kink of the
//!   other kernels, which texels an eighth of a radian wide cannot follow.
//!
//! [`filter_sum`] sums points under a kernel for several directions at once: the inner loop of the filter. Plain loops over fixed-size
//! arrays, compiled for the widest vectors that the processor has. Products and sums stay apart (no fused operations), so the bits
//! do not depend on it.

use glint_formats::environment::{Kernel, SOFT_TOE};
use multiversion::multiversion;
use std::f64::consts::PI;

/// Directions that are summed for together.
pub const LANES: usize = 16;
/// Points whose weights are held at a time, and whose sums are taken in f32 before they go to f64.
const CHUNK: usize = 64;

/// A kernel at one roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Which.
    pub kernel: Kernel,
    /// α².
    pub a: f64,
    /// (1 − α²) / 2, so that D ∝ 1 / (a + b t)².
    pub b: f64,
    /// Integral of [`Lobe::weight`] over the sphere, in steradians.
    pub integral_sr: f64,
}

impl Lobe {
    /// The kernel at roughness α > 0, its integral left at 0.
    pub fn shape(kernel: Kernel, alpha: f64) -> Lobe {
        let a = alpha * alpha;
        Lobe { kernel, a, b: 0.5 * (1.0 - a), integral_sr: 0.0 }
    }

    /// The kernel at roughness α > 0.
    pub fn new(kernel: Kernel, alpha: f64) -> Lobe {
        let mut lobe = Lobe::shape(kernel, alpha);
        // x = ln(1 + (1 + b/a) t) spreads the peak evenly; Simpson's rule is then exact to about 1e-10.
        const STEPS: u32 = 4096;
        let stretch = 1.0 + lobe.b / lobe.a;
        let reach = reach(kernel);
        let end = libm::log1p(stretch * reach);
        let mut sum = 0.0;
        for k in 0..=STEPS {
            let grown = libm::exp(end * f64::from(k) / f64::from(STEPS));
            let t = ((grown - 1.0) / stretch).min(reach);
            let simpson = if k == 0 || k == STEPS { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
            sum += simpson * lobe.weight(t) * grown / stretch;
        }
        lobe.integral_sr = 2.0 * PI * sum * end / (3.0 * f64::from(STEPS));
        lobe
    }

    /// Weight at t = 1 − cosine; 0 below the horizon.
    pub fn weight(&self, t: f64) -> f64 {
        let peak = self.a / (self.a + self.b * t);
        let c = 1.0 - t;
        if t >= reach(self.kernel) {
            return 0.0;
        }
        peak * peak
            * match self.kernel {
                Kernel::GgxNl => c,
                Kernel::GgxSoft => soft_cosine(c),
                Kernel::Ndf => 2.0 * c / (c + (c * c + self.a * (1.0 - c * c)).sqrt()),
            }
    }
}

/// Largest t = 1 − cosine at which a kernel has any weight.
pub fn reach(kernel: Kernel) -> f64 {
    match kernel {
        Kernel::Ndf | Kernel::GgxNl => 1.0,
        Kernel::GgxSoft => 1.0 + SOFT_TOE,
    }
}

/// A cosine that ends as a parabola.
pub fn soft_cosine(c: f64) -> f64 {
    let toe = (c + SOFT_TOE).clamp(0.0, 2.0 * SOFT_TOE);
    toe * toe / (4.0 * SOFT_TOE) + (c - SOFT_TOE).max(0.0)
}

/// Directions of unit length, one a lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Directions {
    /// x of each.
    pub x: [f32; LANES],
    /// y of each.
    pub y: [f32; LANES],
    /// z of each.
    pub z: [f32; LANES],
}

/// Points to be summed.
#[derive(Clone, Debug, Default)]
pub struct Points {
    /// x, y, z of the mean direction and half the variance, as a block of the tree has them.
    pub places: Vec<[f32; 4]>,
    /// `channels` numbers a point.
    pub sums: Vec<f32>,
}

impl Points {
    /// Forgets all points, keeps the memory.
    pub fn clear(&mut self) {
        self.places.clear();
        self.sums.clear();
    }
}

/// Adds Σ weight · sums over points to `totals`: `channels` × [`LANES`] numbers, channel by channel.
///
/// The weight is that at the mean of t, plus ½ k_tt Var t with Var t = s² (1 − s²/4) e, e half the variance: what a round block's extent
/// adds. That part has the same sign in every block, so without it errors would add up. The same for the soft end of a cosine.
pub fn filter_sum(points: &Points, channels: usize, directions: &Directions, lobe: &Lobe, totals: &mut [f64]) {
    let mut weights = [[0.0f32; LANES]; CHUNK];
    let (a, b) = (lobe.a as f32, lobe.b as f32);
    for (places, sums) in points.places.chunks(CHUNK).zip(points.sums.chunks(CHUNK * channels)) {
        let weights = &mut weights[..places.len()];
        match lobe.kernel {
            Kernel::GgxNl => weigh_ggx_nl(places, directions, a, b, weights),
            Kernel::GgxSoft => weigh_ggx_soft(places, directions, a, b, weights),
            Kernel::Ndf => weigh_ndf(places, directions, a, b, weights),
        }
        accumulate(weights, sums, channels, totals);
    }
}

/// ½ s² of a point for one direction.
#[inline(always)]
fn half_square(place: &[f32; 4], d: &Directions, lane: usize) -> f32 {
    let (x, y, z) = (d.x[lane] - place[0], d.y[lane] - place[1], d.z[lane] - place[2]);
    0.5 * (x * x + y * y + z * z)
}

/// Var t over twice e, of ½ s²: t changes with the sine of the angle, sin² = s² (1 − s²/4).
#[inline(always)]
fn spread(half_square: f32) -> f32 {
    half_square * (1.0 - 0.5 * half_square)
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn weigh_ggx_nl(places: &[[f32; 4]], d: &Directions, a: f32, b: f32, weights: &mut [[f32; LANES]]) {
    let (bend_all, slope_all) = (6.0 * (b / a) * (b / a), 4.0 * (b / a));
    for (place, weights) in places.iter().zip(weights) {
        let (bend, slope) = (bend_all * place[3], slope_all * place[3]);
        for lane in 0..LANES {
            let h = half_square(place, d, lane);
            let t = h + place[3];
            let q = a / (a + b * t);
            let p = q * q;
            let c = (1.0 - t).max(0.0);
            // Both factors fall with t, so half of what their slopes make, 2 k_t c_t, times Var t is added too.
            let crossed = if c > 0.0 { slope * spread(h) * q } else { 0.0 };
            weights[lane] = p * ((1.0 + bend * spread(h) * p) * c + crossed);
        }
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn weigh_ggx_soft(places: &[[f32; 4]], d: &Directions, a: f32, b: f32, weights: &mut [[f32; LANES]]) {
    const TOE: f32 = SOFT_TOE as f32;
    let (bend_all, slope_all) = (6.0 * (b / a) * (b / a), 4.0 * (b / a));
    for (place, weights) in places.iter().zip(weights) {
        let (bend, slope) = (bend_all * place[3], slope_all * place[3]);
        for lane in 0..LANES {
            let h = half_square(place, d, lane);
            let t = h + place[3];
            let q = a / (a + b * t);
            let p = q * q;
            let c = 1.0 - t;
            let toe = (c + TOE).clamp(0.0, 2.0 * TOE);
            let soft = toe * toe * (0.25 / TOE) + (c - TOE).max(0.0);
            // As above, and half the parabola's second derivative times Var t.
            let crossed = slope * spread(h) * q * toe * (0.5 / TOE);
            let curved = if c.abs() < TOE { 0.5 / TOE * spread(h) * place[3] } else { 0.0 };
            weights[lane] = p * ((1.0 + bend * spread(h) * p) * soft + crossed + curved);
        }
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn weigh_ndf(places: &[[f32; 4]], d: &Directions, a: f32, b: f32, weights: &mut [[f32; LANES]]) {
    let (bend_all, slope_all) = (6.0 * (b / a) * (b / a), 4.0 * b);
    let a2 = a * a;
    for (place, weights) in places.iter().zip(weights) {
        let (bend, slope) = (bend_all * place[3], slope_all * place[3]);
        for lane in 0..LANES {
            let h = half_square(place, d, lane);
            let t = h + place[3];
            let u = a + b * t;
            let c = (1.0 - t).max(0.0);
            // One division for both factors: 1/u² and masking. √ is above 0 where a is.
            let masked = c + (c * c + a * (1.0 - c * c)).sqrt();
            let inverse = 1.0 / (u * u * masked);
            let p = a2 * masked * inverse;
            // As above; the derivative of 2 c / masked by the cosine is 2 a / (T masked²).
            let steep = if c > 0.0 { a / ((masked - c) * masked) } else { 0.0 };
            let crossed = slope * spread(h) * u * inverse * masked * steep;
            weights[lane] = 2.0 * a2 * inverse * (c * (1.0 + bend * spread(h) * p) + crossed);
        }
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn accumulate(weights: &[[f32; LANES]], sums: &[f32], channels: usize, totals: &mut [f64]) {
    for first in (0..channels).step_by(4) {
        let mut part = [[0.0f32; LANES]; 4];
        for (weights, sums) in weights.iter().zip(sums.chunks_exact(channels)) {
            for c in 0..4 {
                for lane in 0..LANES {
                    part[c][lane] += sums[first + c] * weights[lane];
                }
            }
        }
        for c in 0..4 {
            for lane in 0..LANES {
                totals[(first + c) * LANES + lane] += f64::from(part[c][lane]);
            }
        }
    }
}
