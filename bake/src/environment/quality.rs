//! Compares stored texels with sums over the source.
//!
//! Error of a roughness: root mean square of the luminance error over all texels, over the mean luminance of the source; and the
//! largest error of a measured texel as a share of its exact value. Texels are chosen at random, half of them evenly and
//! half by their luminance, and weighted by how likely each was, so that a sun of a few texels is not missed.

use super::baked::Environment;
use super::cube::texel_direction;
use super::eval::Chances;
use super::image::{EnvironmentImage, luminance};
use super::prefilter::OF_SHARP;
use super::reads;
use super::reference::{Filtered, filtered, texel_mean, with_small_pixels};
use crate::progress::Progress;
use crate::rng::{ItemRng, Purpose};
use glint_formats::environment::{EnvironmentParams, Kernel, MeasuredTexels, SHARP};
use rayon::prelude::*;

/// Lines over a texel of the mirror.
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
    /// Share of the texels that it stands for; over all compared texels 1 on average.
    pub weight: f64,
}

impl Compared {
    /// Error of luminance.
    pub fn error(&self) -> f64 {
        luminance([0, 1, 2].map(|c| f64::from(self.stored[c]))) - self.exact.luminance
    }
}

/// Compares up to `count` texels of roughness `index`, 0 for the mirror; all of them where there are no more.
pub fn compare(image: &EnvironmentImage, environment: &Environment, index: u32, count: u32) -> Vec<Compared> {
    let params = &environment.params;
    let cube = Cube { kernel: params.kernel, alpha: params.roughness[index as usize], size: params.size(index) };
    compare_cube(image, &cube, index, count, |face, i, j| environment.radiance_texel(index, face, i, j))
}

/// What the texels of a cube should be.
#[derive(Clone, Copy, Debug)]
pub struct Cube {
    /// Filter.
    pub kernel: Kernel,
    /// GGX roughness α; 0 for means over texels.
    pub alpha: f64,
    /// Edge of a face in texels.
    pub size: u32,
}

/// Compares up to `count` texels of a cube, which `texel` gives by face, column and row. Their choice follows `seed`.
pub fn compare_cube(
    image: &EnvironmentImage,
    cube: &Cube,
    seed: u32,
    count: u32,
    texel: impl Fn(usize, u32, u32) -> [f32; 4] + Sync,
) -> Vec<Compared> {
    let image = &*with_small_pixels(image);
    let Cube { kernel, alpha, size } = *cube;
    let all = 6 * size * size;
    let place = |k: u32| ((k / (size * size)) as usize, k % size, k / size % size);
    let below = luminance_below(all, |k| {
        let (face, i, j) = place(k);
        texel(face, i, j)
    });
    (0..count.min(all))
        .into_par_iter()
        .map(|k| {
            let (at, weight) = if all <= count { (k, 1.0) } else { chosen(&below, seed, k) };
            let (face, i, j) = place(at);
            let exact = if alpha == 0.0 {
                texel_mean(image, face, i, j, size, ROWS)
            } else {
                filtered(image, kernel, texel_direction(face, i, j, size), alpha)
            };
            Compared { texel: (face, i, j), stored: texel(face, i, j), exact, weight }
        })
        .collect()
}

/// Luminance of all texels up to each, over the whole; evenly rising where there is no light.
fn luminance_below(all: u32, texel: impl Fn(u32) -> [f32; 4]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut below: Vec<f64> = (0..all)
        .map(|k| {
            let texel = texel(k);
            sum += luminance([0, 1, 2].map(|c| f64::from(texel[c])));
            sum
        })
        .collect();
    for (k, value) in below.iter_mut().enumerate() {
        *value = if sum > 0.0 { *value / sum } else { (k + 1) as f64 / f64::from(all) };
    }
    below
}

/// A random texel and 1 over how much likelier it was than in an even choice: even numbers choose evenly, odd ones by
/// luminance.
fn chosen(below: &[f64], seed: u32, k: u32) -> (u32, f64) {
    let mut rng = ItemRng::new(u64::from(seed), Purpose::EnvironmentTexels, k);
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

/// Root mean square error over the mean that the texels of a roughness may have.
pub fn allowed_error(params: &EnvironmentParams, index: usize) -> f64 {
    params.filter_error * if params.roughness[index] < SHARP { OF_SHARP } else { 1.0 }
}

/// Error of compared texels. `mean` is the mean luminance of the source.
pub fn error_of(compared: &[Compared], mean: f64) -> MeasuredTexels {
    if compared.is_empty() || mean <= 0.0 {
        return MeasuredTexels::default();
    }
    let squares: f64 = compared.iter().map(|c| c.weight * c.error().powi(2)).sum();
    let shares = compared.iter().map(|c| c.error().abs() / c.exact.luminance.max(1e-12 * mean));
    MeasuredTexels { rmse: (squares / compared.len() as f64).sqrt() / mean, worst: shares.fold(0.0, f64::max) }
}

/// Seed of the look-ups that a bake measures.
const READS_SEED: u64 = 0;
/// Look-ups for each texel that is measured of every roughness.
const READS_PER_TEXEL: u32 = 16;

/// Measures `count` look-ups and a sixteenth as many texels of every roughness, and records their errors.
pub(super) fn measure(image: &EnvironmentImage, count: u32, environment: &mut Environment, progress: &dyn Progress) {
    if count == 0 {
        return;
    }
    let texels = count.div_ceil(READS_PER_TEXEL);
    let roughnesses = environment.params.roughness.len() as u32;
    environment.params.measured.texels_measured = texels;
    progress.begin("measure", u64::from(roughnesses) + 1);
    // Filters keep the mean over the sphere up to the horizon's part, so one mean serves all roughnesses.
    let mean = luminance(environment.params.mean_radiance);
    for index in 0..roughnesses {
        let compared = compare(image, environment, index, texels);
        environment.params.measured.texels.push(error_of(&compared, mean));
        progress.advance(1);
    }
    let reads = reads::random(image, environment, (reads::LEAST_ALPHA, 1.0), READS_SEED, count);
    environment.params.measured.reads = reads::errors_of(environment, &reads).to_vec();
    progress.advance(1);
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
