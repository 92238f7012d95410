//! The footprints that error is measured over, the same for every method.

use crate::footprint::Footprint;
use crate::rng::{ItemRng, Purpose};
use glam::DVec2;

/// Standard deviations of footprints along their minor axis, in texels.
pub const SIGMAS_TEXELS: [f64; 7] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// Ratios of major to minor axis.
pub const ANISOTROPIES: [f64; 2] = [1.0, 4.0];
/// Random footprints of a size that a report measures.
pub const FOOTPRINTS: u32 = 64;

/// `count` seeded random footprints of one size on a surface of `extent` texels: any place, any direction.
pub fn footprints(sigma_texels: f64, anisotropy: f64, extent: DVec2, count: u32, seed: u64) -> Vec<Footprint> {
    (0..count)
        .map(|k| {
            let mut rng = ItemRng::new(seed, Purpose::MeasuredFootprints, k);
            let mean = DVec2::new(rng.unit(), rng.unit()) * extent;
            Footprint::new(mean, sigma_texels, anisotropy, rng.unit() * std::f64::consts::PI)
        })
        .collect()
}
