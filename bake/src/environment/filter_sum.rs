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

/// Σ weight · sums over points: `channels` × [`LANES`] numbers, channel by channel, into `totals`.
pub fn filter_sum(points: &Points, channels: usize, directions: &Directions, lobe: &Lobe, totals: &mut [f64]) {
    totals.fill(0.0);
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

/// t and (a / (a + b t))² of a point for one direction.
#[inline(always)]
fn peak(place: &[f32; 4], d: &Directions, lane: usize, a: f32, b: f32) -> (f32, f32) {
    let (x, y, z) = (d.x[lane] - place[0], d.y[lane] - place[1], d.z[lane] - place[2]);
    let t = place[3] + 0.5 * (x * x + y * y + z * z);
    let p = a / (a + b * t);
    (t, p * p)
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn weigh_ggx_nl(places: &[[f32; 4]], d: &Directions, a: f32, b: f32, weights: &mut [[f32; LANES]]) {
    for (place, weights) in places.iter().zip(weights) {
        for lane in 0..LANES {
            let (t, p) = peak(place, d, lane, a, b);
            weights[lane] = p * (1.0 - t).max(0.0);
        }
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn weigh_ndf(places: &[[f32; 4]], d: &Directions, a: f32, b: f32, weights: &mut [[f32; LANES]]) {
    for (place, weights) in places.iter().zip(weights) {
        for lane in 0..LANES {
            let (t, p) = peak(place, d, lane, a, b);
            let c = (1.0 - t).max(0.0);
            // The tiny number keeps 0 / 0 away at a = 0 on the horizon.
            weights[lane] = p * 2.0 * c / (c + (c * c + a * (1.0 - c * c)).sqrt() + 1e-30);
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
