//! Radiance levels: the K values that a facet may reflect.
//!
//! Paper: section 5, Eq. 18 and 19. A pixel of luminance L between two levels is shared between them by linear
//! interpolation, so that the mean is exact for any levels. The second moment is over-estimated by
//! (L − L_j)(L_{j+1} − L) a pixel, so glints vary too much. Deviations:
//! - [`optimal`] chooses levels by an exact dynamic programme over a histogram of log radiance. Each pixel counts by the
//!   mean over directions and roughnesses of kernel / ⟨L²⟩, so the sum is the mean relative error of the second moment.
//! - [`log_uniform`] is the paper's Eq. 18. Where all radiance is equal, or none, its logarithms say nothing; levels are
//!   then spread evenly below the brightest pixel.
//! - The darkest level is 0, as in the paper, and also stands for facets that reflect from below the horizon.

use super::image::EnvironmentImage;
use super::kernel::Lobe;
use glam::DVec3;
use glint_formats::environment::{Kernel, MAX_LEVELS};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Bins of the histogram.
const BINS: usize = 1024;
/// Ratio of the brightest radiance to the darkest that has a bin of its own.
const RANGE: f64 = 1e9;
/// Directions that glints are seen in.
const DIRECTIONS: usize = 96;
/// Roughnesses of facets.
pub const ROUGHNESSES: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
/// Rows of the blocks of pixels whose weight is taken together, at most.
const BLOCK_ROWS: u32 = 128;

/// `count` directions spread evenly over the sphere (a Fibonacci lattice), turned by `turn`, 0 to 1.
pub fn even_directions(count: usize, turn: f64) -> Vec<DVec3> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    (0..count)
        .map(|k| {
            let height = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
            super::image::direction(2.0 * PI * (k as f64 * GOLDEN + turn), height)
        })
        .collect()
}

/// How much of what reflects in glints has which radiance, over bins of log radiance.
pub struct RadianceHistogram {
    /// Largest luminance of each bin that is not empty, rising.
    tops: Vec<f64>,
    /// Weight, weight · L and weight · L² of all bins up to each.
    below: Vec<[f64; 3]>,
}

impl RadianceHistogram {
    /// Gathers an image under a kernel.
    pub fn new(image: &EnvironmentImage, kernel: Kernel) -> RadianceHistogram {
        let brightest = image.max_luminance();
        let mut bins = vec![[0.0; 4]; BINS];
        if brightest > 0.0 {
            let weights = Weights::new(image, kernel);
            let per_bin = BINS as f64 / libm::log(RANGE);
            for y in 0..image.height {
                for x in 0..image.width {
                    let l = image.luminance((y * image.width + x) as usize);
                    let depth = (libm::log(brightest / l.max(brightest / RANGE)) * per_bin) as usize;
                    let bin = &mut bins[BINS - 1 - depth.min(BINS - 1)];
                    let weight = weights.of(x, y) * image.solid_angle_sr(y);
                    *bin = [bin[0] + weight, bin[1] + weight * l, bin[2] + weight * l * l, bin[3].max(l)];
                }
            }
        }
        let (mut tops, mut below) = (Vec::new(), Vec::new());
        let mut sum = [0.0; 3];
        for bin in bins {
            (0..3).for_each(|k| sum[k] += bin[k]);
            if bin[3] > 0.0 {
                tops.push(bin[3]);
                below.push(sum);
            }
        }
        RadianceHistogram { tops, below }
    }

    /// Over-estimate of the second moment between levels at tops `i` (or 0) and `j`, relative to the whole.
    fn excess(&self, i: Option<usize>, j: usize) -> f64 {
        let (low, from) = i.map_or((0.0, [0.0; 3]), |i| (self.tops[i], self.below[i]));
        let high = self.tops[j];
        let [w, wl, wll] = [0, 1, 2].map(|k| self.below[j][k] - from[k]);
        ((low + high) * wl - low * high * w - wll).max(0.0)
    }

    /// Mean relative over-estimate of the second moment with these levels, of which the last is the brightest.
    pub fn error(&self, levels: &[f64]) -> f64 {
        let mut error = 0.0;
        let mut j = 0;
        let mut from = [0.0; 3];
        for pair in levels.windows(2) {
            let mut to = from;
            while j < self.tops.len() && self.tops[j] <= pair[1] {
                to = self.below[j];
                j += 1;
            }
            let [w, wl, wll] = [0, 1, 2].map(|k| to[k] - from[k]);
            error += ((pair[0] + pair[1]) * wl - pair[0] * pair[1] * w - wll).max(0.0);
            from = to;
        }
        error
    }

    /// The best levels for every count from 2 to `most`: levels and their error.
    pub fn optimal(&self, most: usize) -> Vec<(Vec<f64>, f64)> {
        let n = self.tops.len();
        if n == 0 {
            return (2..=most).map(|count| (spread_below(1.0, count), 0.0)).collect();
        }
        // best[j] is the least excess of all bins up to j with the top of j as a level, with so many levels above 0.
        let mut best: Vec<f64> = (0..n).map(|j| self.excess(None, j)).collect();
        let mut previous: Vec<Vec<Option<usize>>> = vec![vec![None; n]];
        let mut all = Vec::new();
        for count in 2..=most {
            let error = best[n - 1];
            let mut levels = vec![self.tops[n - 1]];
            let (mut at, mut row) = (n - 1, previous.len() - 1);
            while let Some(before) = previous[row][at] {
                levels.push(self.tops[before]);
                at = before;
                row = row.saturating_sub(1);
            }
            levels.push(0.0);
            levels.reverse();
            all.push((filled(levels, count), error));
            let (next, from): (Vec<f64>, Vec<Option<usize>>) = (0..n)
                .into_par_iter()
                .map(|j| {
                    let mut least = (best[j], previous[previous.len() - 1][j]);
                    for i in 0..j {
                        let sum = best[i] + self.excess(Some(i), j);
                        if sum < least.0 {
                            least = (sum, Some(i));
                        }
                    }
                    least
                })
                .unzip();
            best = next;
            previous.push(from);
        }
        all
    }
}

/// The best `count` levels (2 or more) and their mean relative error of the second moment.
pub fn optimal(histogram: &RadianceHistogram, count: usize) -> (Vec<f64>, f64) {
    histogram.optimal(count).pop().unwrap_or_else(|| (spread_below(1.0, 2), 0.0))
}

/// The fewest levels whose error is `most_error` or less; [`MAX_LEVELS`] when no count is enough.
pub fn fewest(histogram: &RadianceHistogram, most_error: f64) -> (Vec<f64>, f64) {
    let mut all = histogram.optimal(MAX_LEVELS);
    let first = all.iter().position(|(_, error)| *error <= most_error).unwrap_or(all.len() - 1);
    all.swap_remove(first)
}

/// The paper's `count` levels (2 or more): Eq. 18, radiance below `floor` taken as `floor`.
pub fn log_uniform(image: &EnvironmentImage, count: usize, floor: f64) -> Vec<f64> {
    let brightest = image.max_luminance();
    let darkest = (0..image.pixels.len()).map(|i| image.luminance(i)).fold(f64::INFINITY, f64::min).max(floor);
    if brightest <= darkest || count == 2 {
        return spread_below(if brightest > 0.0 { brightest } else { 1.0 }, count);
    }
    let (low, high) = (libm::log(darkest), libm::log(brightest));
    let mut levels = vec![0.0];
    levels.extend((2..count).map(|k| {
        let part = (k - 1) as f64 / (count - 1) as f64;
        libm::exp(low + (high - low) * part)
    }));
    levels.push(brightest);
    levels
}

/// Levels evenly from 0 to `top`.
fn spread_below(top: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| top * k as f64 / (count - 1) as f64).collect()
}

/// Levels where there are fewer radiances than levels: the widest gaps are halved until there are enough.
fn filled(mut levels: Vec<f64>, count: usize) -> Vec<f64> {
    while levels.len() < count {
        let widest = (1..levels.len())
            .max_by(|&a, &b| (levels[a] - levels[a - 1]).total_cmp(&(levels[b] - levels[b - 1])))
            .unwrap_or(1);
        levels.insert(widest, 0.5 * (levels[widest - 1] + levels[widest]));
    }
    levels
}

/// Shares of luminance `l` in levels 1, 2, …; what is left of 1 is level 0's (Eq. 19).
pub fn shares(levels: &[f64], l: f64, out: &mut [f32]) {
    out.fill(0.0);
    let above = levels.partition_point(|level| *level < l).clamp(1, levels.len() - 1);
    let upper = ((l - levels[above - 1]) / (levels[above] - levels[above - 1])).clamp(0.0, 1.0);
    out[above - 1] = upper as f32;
    if above > 1 {
        out[above - 2] = (1.0 - upper) as f32;
    }
}

/// Mean over directions and roughnesses of kernel / ⟨L²⟩, a block of pixels at a time.
struct Weights {
    block: u32,
    columns: u32,
    weights: Vec<f64>,
}

impl Weights {
    fn new(image: &EnvironmentImage, kernel: Kernel) -> Weights {
        let block = image.height.div_ceil(BLOCK_ROWS);
        let (columns, rows) = (image.width.div_ceil(block), image.height.div_ceil(block));
        let mut squares = Vec::new();
        for j in 0..rows {
            for i in 0..columns {
                let (mut whole, mut sum, mut mean) = (0.0, 0.0, DVec3::ZERO);
                for y in j * block..((j + 1) * block).min(image.height) {
                    let sine = 0.5 * (image.sine(f64::from(y)) + image.sine(f64::from(y + 1)));
                    let angle = image.solid_angle_sr(y);
                    for x in i * block..((i + 1) * block).min(image.width) {
                        let l = image.luminance((y * image.width + x) as usize);
                        let lambda = super::image::longitude(f64::from(x) + 0.5, image.width);
                        mean += super::image::direction(lambda, sine) * angle;
                        whole += angle;
                        sum += l * l * angle;
                    }
                }
                squares.push((mean.normalize(), whole, sum));
            }
        }
        let views: Vec<(DVec3, f64)> =
            even_directions(DIRECTIONS, 0.0).into_iter().flat_map(|d| ROUGHNESSES.map(|alpha| (d, alpha))).collect();
        // A fixed number of parts, added in order, so that the sum does not depend on threads.
        let parts: Vec<Vec<f64>> = views
            .par_chunks(ROUGHNESSES.len() * 12)
            .map(|views| {
                let mut weights = vec![0.0; squares.len()];
                let mut kernels = vec![0.0; squares.len()];
                for (d, alpha) in views {
                    let lobe = Lobe::new(kernel, *alpha);
                    let (mut whole, mut second) = (0.0, 0.0);
                    for (k, (place, angle, square)) in squares.iter().enumerate() {
                        kernels[k] = lobe.weight((1.0 - place.dot(*d)).max(0.0));
                        whole += kernels[k] * angle;
                        second += kernels[k] * square;
                    }
                    // A hemisphere without light has no glints.
                    if second > 0.0 && whole > 0.0 {
                        for k in 0..squares.len() {
                            weights[k] += kernels[k] / second;
                        }
                    }
                }
                weights
            })
            .collect();
        let mut weights = vec![0.0; squares.len()];
        for part in parts {
            (0..weights.len()).for_each(|k| weights[k] += part[k] / views.len() as f64);
        }
        Weights { block, columns, weights }
    }

    /// Weight of a pixel, a steradian.
    fn of(&self, x: u32, y: u32) -> f64 {
        self.weights[(y / self.block * self.columns + x / self.block) as usize]
    }
}
