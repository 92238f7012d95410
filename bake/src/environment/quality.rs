//! Compares stored texels with sums over the source.
//!
//! Error of a mip: root mean square of the luminance error over randomly chosen texels, over the mean luminance of the
//! mip; and the largest error of a texel as a share of its exact value.

use super::cube::texel_direction;
use super::image::{EnvironmentImage, luminance};
use super::reference::{Filtered, filtered, texel_mean};
use super::tables::Environment;
use crate::progress::Progress;
use crate::rng::ItemRng;
use glint_formats::environment::MeasuredMip;
use rayon::prelude::*;

/// Purpose of the random numbers that choose texels.
const PURPOSE: u32 = 30;
/// Images of fewer columns have their pixels divided, so that the reference has not to divide them everywhere.
const FINE_WIDTH: u32 = 256;
/// Points a side of a texel of the first mip.
const SAMPLES: u32 = 256;

/// One texel and what it should hold.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// Face, column, row.
    pub texel: (usize, u32, u32),
    /// As stored.
    pub stored: [f32; 4],
    /// As the reference has it.
    pub exact: Filtered,
}

impl Compared {
    /// Error of luminance.
    pub fn error(&self) -> f64 {
        luminance([0, 1, 2].map(|c| f64::from(self.stored[c]))) - self.exact.luminance
    }
}

/// Compares up to `count` texels of a mip, all of them where there are no more.
pub fn compare(image: &EnvironmentImage, environment: &Environment, mip: u32, count: u32) -> Vec<Compared> {
    let fine;
    let image = match FINE_WIDTH.div_ceil(image.width) {
        0 | 1 => image,
        parts => {
            fine = image.divided(parts);
            &fine
        }
    };
    let size = environment.size(mip);
    let all = 6 * size * size;
    let (kernel, alpha) = (environment.params.kernel, environment.params.roughness[mip as usize]);
    (0..count.min(all))
        .into_par_iter()
        .map(|k| {
            let index = if all <= count { k } else { ItemRng::new(u64::from(mip), PURPOSE, k).below(all) };
            let texel = ((index / (size * size)) as usize, index % size, index / size % size);
            let (face, i, j) = texel;
            let exact = if alpha == 0.0 {
                texel_mean(image, face, i, j, size, SAMPLES)
            } else {
                filtered(image, kernel, texel_direction(face, i, j, size), alpha)
            };
            Compared { texel, stored: environment.radiance_texel(mip, face, i, j), exact }
        })
        .collect()
}

/// Error of compared texels. `mean` is the mean luminance of the mip.
pub fn error_of(compared: &[Compared], mean: f64) -> MeasuredMip {
    if compared.is_empty() || mean <= 0.0 {
        return MeasuredMip::default();
    }
    let squares: f64 = compared.iter().map(|c| c.error().powi(2)).sum();
    let shares = compared.iter().map(|c| c.error().abs() / c.exact.luminance.max(1e-12 * mean));
    MeasuredMip { rmse: (squares / compared.len() as f64).sqrt() / mean, worst: shares.fold(0.0, f64::max) }
}

/// Measures every mip by up to `count` texels and records it.
pub fn measure(image: &EnvironmentImage, count: u32, environment: &mut Environment, progress: &dyn Progress) {
    let mips = environment.params.mips();
    environment.params.measured.texels = count;
    if count == 0 {
        return;
    }
    progress.begin("measure", u64::from(mips));
    // Filters keep the mean over the sphere up to the horizon's part, so one mean serves all mips.
    let mean = luminance(environment.params.mean_radiance);
    for mip in 0..mips {
        let compared = compare(image, environment, mip, count);
        environment.params.measured.mips.push(error_of(&compared, mean));
        progress.advance(1);
    }
    progress.end();
}
