//! Sums of points under a kernel for several directions at once: the inner loop of the filter.
//!
//! Plain loops over fixed-size arrays, compiled for the widest vectors that the processor has. Products and sums stay
//! apart (no fused operations), so the bits do not depend on it.

use super::kernel::Lobe;
use glint_formats::environment::Kernel;
use multiversion::multiversion;

/// Directions that are summed for together.
pub const LANES: usize = 16;
/// Points whose weights are held at a time, and whose sums are taken in f32 before they go to f64.
const CHUNK: usize = 64;

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
    /// x, y, z of the mean direction and the spread, see [`super::tree::Block`].
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
/// The weight is that at the mean of t, plus ½ k_tt Var t with Var t = s² e, e the spread: what a round block's extent
/// adds. That part has the same sign in every block, so without it errors would add up.
pub fn filter_sum(points: &Points, channels: usize, directions: &Directions, lobe: &Lobe, totals: &mut [f64]) {
    let mut weights = [[0.0f32; LANES]; CHUNK];
    let (a, b) = (lobe.a as f32, lobe.b as f32);
    for (places, sums) in points.places.chunks(CHUNK).zip(points.sums.chunks(CHUNK * channels)) {
        let weights = &mut weights[..places.len()];
        match lobe.kernel {
            Kernel::GgxNl => weigh_ggx_nl(places, directions, a, b, weights),
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

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn weigh_ggx_nl(places: &[[f32; 4]], d: &Directions, a: f32, b: f32, weights: &mut [[f32; LANES]]) {
    let bend_all = 6.0 * (b / a) * (b / a);
    for (place, weights) in places.iter().zip(weights) {
        let bend = bend_all * place[3];
        for lane in 0..LANES {
            let h = half_square(place, d, lane);
            let t = h + place[3];
            let p = a / (a + b * t);
            let p = p * p;
            weights[lane] = p * (1.0 + bend * h * p) * (1.0 - t).max(0.0);
        }
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn weigh_ndf(places: &[[f32; 4]], d: &Directions, a: f32, b: f32, weights: &mut [[f32; LANES]]) {
    let bend_all = 6.0 * (b / a) * (b / a);
    let a2 = a * a;
    for (place, weights) in places.iter().zip(weights) {
        let bend = bend_all * place[3];
        for lane in 0..LANES {
            let h = half_square(place, d, lane);
            let t = h + place[3];
            let u = a + b * t;
            let c = (1.0 - t).max(0.0);
            // One division for both factors: 1/u² and masking. √ is above 0 where a is.
            let masked = c + (c * c + a * (1.0 - c * c)).sqrt();
            let inverse = 1.0 / (u * u * masked);
            let p = a2 * masked * inverse;
            weights[lane] = 2.0 * a2 * c * inverse * (1.0 + bend * h * p);
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
