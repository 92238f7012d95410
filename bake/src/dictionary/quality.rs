//! How good a dictionary is: normalisation, distance to the target, glint contrast. f64, from the half floats that ship.
//!
//! A table is measured as the sampler reads it: linear filtering between bin centres, clamp to edge, zero beyond the
//! domain. Distances are over the whole line, of the even distribution: L1 = ∫|P − T|, KS = sup|F_P − F_T|; what the
//! target has beyond the domain counts.

use super::baked::Dictionary;
use super::eval::{MAX_ANISOTROPY, PIXEL_RADIUS2, widened};
use super::options::{DOMAIN_STDS, DictionaryOptions};
use glint_formats::dictionary::MeasuredError;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Sub-intervals of a bin in quadrature; even, so that none straddles a bin centre.
const STEPS: usize = 16;

/// One level of a dictionary against its target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelQuality {
    /// Largest |∫P − 1| over marginals.
    pub normalisation: f64,
    /// L1 to the target: mean over marginals.
    pub l1_mean: f64,
    /// L1 to the target: worst marginal.
    pub l1_worst: f64,
    /// KS to the target: mean over marginals.
    pub ks_mean: f64,
    /// KS to the target: worst marginal.
    pub ks_worst: f64,
    /// L1 of the mean over marginals to the target.
    pub l1_of_mean: f64,
    /// KS of the mean over marginals to the target.
    pub ks_of_mean: f64,
    /// Standard deviation over marginals, root mean square over slopes, as a share of the root mean square density.
    pub contrast: f64,
    /// The same standard deviation, as a ratio to that of independent lobe means (closed form).
    pub contrast_ratio: f64,
}

/// The number that a pack records.
pub fn measure(dictionary: &Dictionary) -> MeasuredError {
    let options = &dictionary.options;
    let mut normalisation: f64 = 0.0;
    for level in 0..options.levels {
        for marginal in 0..options.marginals {
            let integral = integral_linear(&dictionary.entries(level, marginal), options.spacing());
            normalisation = normalisation.max((2.0 * integral - 1.0).abs());
        }
    }
    let target = TargetSamples::new(options);
    let mut ks = 0.0;
    for marginal in 0..options.marginals {
        ks += target.distances(&dictionary.entries(options.levels - 1, marginal)).1;
    }
    MeasuredError {
        normalisation,
        mean_l1_first_level: target.distances(&mean_table(dictionary, 0)).0,
        ks_last_level: ks / f64::from(options.marginals),
    }
}

/// Measures one level in full.
pub fn measure_level(dictionary: &Dictionary, level: u32) -> LevelQuality {
    let options = &dictionary.options;
    let n = f64::from(options.marginals);
    let mean = mean_table(dictionary, level);
    let target = TargetSamples::new(options);
    let (l1_of_mean, ks_of_mean) = target.distances(&mean);
    let mut quality = LevelQuality {
        normalisation: 0.0,
        l1_mean: 0.0,
        l1_worst: 0.0,
        ks_mean: 0.0,
        ks_worst: 0.0,
        l1_of_mean,
        ks_of_mean,
        contrast: 0.0,
        contrast_ratio: 0.0,
    };
    let mut variance = vec![0.0; mean.len()];
    for marginal in 0..options.marginals {
        let table = dictionary.entries(level, marginal);
        let (l1, ks) = target.distances(&table);
        let integral = integral_linear(&table, options.spacing());
        quality.normalisation = quality.normalisation.max((2.0 * integral - 1.0).abs());
        quality.l1_mean += l1 / n;
        quality.l1_worst = quality.l1_worst.max(l1);
        quality.ks_mean += ks / n;
        quality.ks_worst = quality.ks_worst.max(ks);
        for b in 0..table.len() {
            variance[b] += (table[b] - mean[b]).powi(2) / (n - 1.0).max(1.0);
        }
    }
    let (mut measured, mut independent, mut power) = (0.0, 0.0, 0.0);
    for b in 0..mean.len() {
        let x = (b as f64 + 0.5) * options.spacing();
        measured += variance[b];
        independent += independent_variance(options, level, x);
        power += target_density(options, x).powi(2);
    }
    quality.contrast = (measured / power).sqrt();
    quality.contrast_ratio = (measured / independent).sqrt();
    quality
}

/// Density of the target marginal on the whole line.
pub fn target_density(options: &DictionaryOptions, x: f64) -> f64 {
    let z = x / options.target_std();
    libm::exp(-0.5 * z * z) / (options.target_std() * (2.0 * PI).sqrt())
}

/// KS distance that the end of the domain leaves: half of the target's share beyond it.
pub fn domain_floor() -> f64 {
    0.5 * libm::erfc(DOMAIN_STDS * FRAC_1_SQRT_2)
}

/// Mean over marginals of one level's tables.
pub fn mean_table(dictionary: &Dictionary, level: u32) -> Vec<f64> {
    let n = dictionary.options.marginals;
    let mut mean = vec![0.0; dictionary.options.entries as usize];
    for marginal in 0..n {
        let table = dictionary.entries(level, marginal);
        for b in 0..mean.len() {
            mean[b] += table[b] / f64::from(n);
        }
    }
    mean
}

/// ∫₀^domain of a table as the sampler reads it: two half bins at constant value and trapezoids between.
pub fn integral_linear(table: &[f64], spacing: f64) -> f64 {
    let mut integral = 0.5 * spacing * (table[0] + table[table.len() - 1]);
    for b in 1..table.len() {
        integral += 0.5 * spacing * (table[b - 1] + table[b]);
    }
    integral
}

/// A table at slope x ≥ 0 as the sampler reads it.
pub fn read_linear(table: &[f64], spacing: f64, x: f64) -> f64 {
    let last = table.len() - 1;
    let t = (x / spacing - 0.5).clamp(0.0, last as f64);
    // Not negative, so that the integer below it is what a cast leaves.
    let low = (t as usize).min(last);
    let high = (low + 1).min(last);
    table[low] + (table[high] - table[low]) * (t - low as f64)
}

/// The target at the quadrature points, so that many tables can be compared with it.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetSamples {
    spacing: f64,
    /// Density at the middle of each sub-interval.
    density: Vec<f64>,
    /// Share of the positive half line up to the end of each sub-interval.
    share: Vec<f64>,
}

impl TargetSamples {
    /// The target of a dictionary with these options.
    pub fn new(options: &DictionaryOptions) -> TargetSamples {
        let step = options.spacing() / STEPS as f64;
        let (mut density, mut share) = (Vec::new(), Vec::new());
        for k in 0..options.entries as usize * STEPS {
            density.push(target_density(options, (k as f64 + 0.5) * step));
            share.push(0.5 * libm::erf((k as f64 + 1.0) * step / options.target_std() * FRAC_1_SQRT_2));
        }
        TargetSamples { spacing: options.spacing(), density, share }
    }

    /// L1 and KS distance of a table to the target, over the whole line.
    pub fn distances(&self, table: &[f64]) -> (f64, f64) {
        let step = self.spacing / STEPS as f64;
        let (mut l1, mut integral, mut ks) = (0.0, 0.0, 0.0f64);
        for k in 0..self.density.len() {
            let value = read_linear(table, self.spacing, (k as f64 + 0.5) * step);
            l1 += 2.0 * step * (value - self.density[k]).abs();
            integral += step * value;
            ks = ks.max((integral - self.share[k]).abs());
        }
        (l1 + 2.0 * domain_floor(), ks)
    }
}

/// Variance of a marginal's density at x if its 2^level lobe means were independent: that of one even lobe,
/// E[g²] − E[g]², over their number. Each expectation is an integral over products of Gaussians, in closed form.
fn independent_variance(options: &DictionaryOptions, level: u32, x: f64) -> f64 {
    let s2 = options.lobe_std.powi(2);
    let m2 = options.mean_variance();
    let gauss = |v: f64| libm::exp(-0.5 * x * x / v) / (2.0 * PI * v).sqrt();
    let same = gauss(m2 + 0.5 * s2) / (2.0 * PI.sqrt() * options.lobe_std);
    let mirrored = libm::exp(-x * x / s2) / (2.0 * PI * s2) / (1.0 + 2.0 * m2 / s2).sqrt();
    let mean = gauss(m2 + s2);
    (0.5 * same + 0.5 * mirrored - mean * mean) / f64::from(1u32 << level)
}

/// Bound on the cells of one query, both levels together: area plus perimeter of the largest ellipse of each level.
pub fn max_cells(max_anisotropy: f32) -> u32 {
    let ratio = max_anisotropy.clamp(1.0, MAX_ANISOTROPY);
    let mut bound = 0.0;
    for minor in [1.0f32, 0.5] {
        let minor2 = PIXEL_RADIUS2 * minor * minor;
        let short = widened(minor2).sqrt();
        let long = widened(minor2 * ratio * ratio).sqrt();
        bound += std::f32::consts::PI * (short + 0.75) * (long + 0.75);
    }
    bound.ceil() as u32
}
