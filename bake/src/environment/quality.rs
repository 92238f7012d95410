//! Compares stored texels with sums over the source.
//!
//! Error of a mip: root mean square of the luminance error over all texels, over the mean luminance of the mip; and the
//! largest error of a measured texel as a share of its exact value. Texels are chosen at random, half of them evenly and
//! half by their luminance, and weighted by how likely each was, so that a sun of a few texels is not missed.

use super::baked::Environment;
use super::cube::texel_direction;
use super::eval::Chances;
use super::image::{EnvironmentImage, luminance};
use super::prefilter::{OF_SHARP, SHARP};
use super::reference::{Filtered, filtered, texel_mean};
use crate::progress::Progress;
use crate::rng::{ItemRng, Purpose};
use glint_formats::environment::{EnvironmentParams, MeasuredMip};
use rayon::prelude::*;

/// Images of fewer columns have their pixels divided, so that the reference has not to divide them everywhere.
const FINE_WIDTH: u32 = 256;
/// Lines over a texel of the first mip.
const ROWS: u32 = 512;

/// One texel and what it should hold.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// Face, column, row.
    pub texel: (usize, u32, u32),
    /// As stored.
    pub stored: [f32; 4],
    /// As the reference has it.
    pub exact: Filtered,
    /// Share of the mip that the texel stands for; over all compared texels 1 on average.
    pub weight: f64,
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
    let below = luminance_below(environment, mip);
    let (kernel, alpha) = (environment.params.kernel, environment.params.roughness[mip as usize]);
    (0..count.min(all))
        .into_par_iter()
        .map(|k| {
            let (index, weight) = if all <= count { (k, 1.0) } else { chosen(&below, mip, k) };
            let texel = ((index / (size * size)) as usize, index % size, index / size % size);
            let (face, i, j) = texel;
            let exact = if alpha == 0.0 {
                texel_mean(image, face, i, j, size, ROWS)
            } else {
                filtered(image, kernel, texel_direction(face, i, j, size), alpha)
            };
            Compared { texel, stored: environment.radiance_texel(mip, face, i, j), exact, weight }
        })
        .collect()
}

/// Luminance of all stored texels of a mip up to each, over the whole; evenly rising where there is no light.
fn luminance_below(environment: &Environment, mip: u32) -> Vec<f64> {
    let size = environment.size(mip);
    let mut sum = 0.0;
    let mut below: Vec<f64> = (0..6 * size * size)
        .map(|k| {
            let texel = environment.radiance_texel(mip, (k / (size * size)) as usize, k % size, k / size % size);
            sum += luminance([0, 1, 2].map(|c| f64::from(texel[c])));
            sum
        })
        .collect();
    for (k, value) in below.iter_mut().enumerate() {
        *value = if sum > 0.0 { *value / sum } else { (k + 1) as f64 / f64::from(6 * size * size) };
    }
    below
}

/// A random texel and 1 over how much likelier it was than in an even choice: even numbers choose evenly, odd ones by
/// luminance.
fn chosen(below: &[f64], mip: u32, k: u32) -> (u32, f64) {
    let mut rng = ItemRng::new(u64::from(mip), Purpose::EnvironmentTexels, k);
    let all = below.len();
    let index = if k.is_multiple_of(2) {
        rng.below(all as u32) as usize
    } else {
        let u = rng.unit();
        below.partition_point(|value| *value <= u).min(all - 1)
    };
    let share = below[index] - if index > 0 { below[index - 1] } else { 0.0 };
    (index as u32, 1.0 / (0.5 + 0.5 * share * all as f64))
}

/// Root mean square error over the mean that a mip may have.
pub fn allowed_error(params: &EnvironmentParams, mip: usize) -> f64 {
    params.max_error * if params.roughness[mip] < SHARP { OF_SHARP } else { 1.0 }
}

/// Error of compared texels. `mean` is the mean luminance of the mip.
pub fn error_of(compared: &[Compared], mean: f64) -> MeasuredMip {
    if compared.is_empty() || mean <= 0.0 {
        return MeasuredMip::default();
    }
    let squares: f64 = compared.iter().map(|c| c.weight * c.error().powi(2)).sum();
    let shares = compared.iter().map(|c| c.error().abs() / c.exact.luminance.max(1e-12 * mean));
    MeasuredMip { rmse: (squares / compared.len() as f64).sqrt() / mean, worst: shares.fold(0.0, f64::max) }
}

/// Measures every mip by up to `count` texels and records it.
pub(super) fn measure(image: &EnvironmentImage, count: u32, environment: &mut Environment, progress: &dyn Progress) {
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

/// Variance of [`environment_draw`](super::eval::environment_draw) in luminance over the square of its mean, for facets as `counting`
/// makes them whole.
pub fn relative_variance(chances: &Chances, facets: f32) -> f32 {
    let mean2 = chances.moments[0] * chances.moments[0];
    if !(mean2 > 0.0 && facets > 0.0) {
        return 0.0;
    }
    let part = facets - facets.floor();
    let per_facet = (chances.moments[1] / mean2 - 1.0).max(0.0);
    chances.std_factor * chances.std_factor * per_facet / facets + part * (1.0 - part) / (facets * facets)
}
