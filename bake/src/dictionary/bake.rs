//! Bakes the multi-scale marginals: level l is the mean of the first 2^l even lobes of a marginal.
//!
//! Paper: section 4.3 and 4.4, tables of section 7.3. What is the same: lobe means by importance sampling of the target,
//! each level keeps the lobes of the level below. What deviates:
//! - Means are drawn from a narrower Gaussian than the target, by the lobe's own variance and that of the sampler's
//!   tent, and only inside the domain. What the GPU reads converges to the target, not to a blurred one, and no lobe is
//!   lost beyond the end of the table.
//! - Up to 2^[`EXACT_LEVEL`] lobes are added one by one, exactly, at the bin centres. Above, lobes are counted in
//!   sub-bins of at most a sixth of a lobe's standard deviation, and each level is one convolution of the counts. The
//!   authors sum every lobe of every level anew.
//! - Counts are integers and sums run in one fixed order with portable functions, so a dictionary has the same bytes on
//!   every platform. The work is a few hundredths of a second, so it stays on one thread.

use super::draws::Draws;
use super::options::DictionaryOptions;
use super::round::to_half_with_sum;
use super::tables::Dictionary;
use crate::error::Result;
use std::ops::AddAssign;

/// Last level whose lobes are summed one by one.
const EXACT_LEVEL: u32 = 8;
/// Sub-bins a standard deviation of a lobe, at least.
const SUB_BINS_PER_STD: f64 = 6.0;
/// Lobes whose sub-bins are found before they are counted, so that counting stays within one marginal's row for a
/// while; divides 2^(EXACT_LEVEL + 1).
const BLOCK: usize = 32;
/// A lobe ends at this many standard deviations (what is beyond is 2e-9 of it).
const LOBE_REACH: f64 = 6.0;

/// Bakes a dictionary.
///
/// # Errors
/// Those of [`DictionaryOptions::validate`].
pub fn bake(options: &DictionaryOptions) -> Result<Dictionary> {
    options.validate()?;
    let quantiles = MeanQuantiles::new(options);
    let mut bits = vec![0u16; options.tables() as usize * options.entries as usize];
    bake_exact(options, &quantiles, &mut bits);
    // Counts below 2^16 take half the memory of the whole bake.
    if options.levels <= u16::BITS {
        bake_counted::<u16>(options, &quantiles, &mut bits);
    } else {
        bake_counted::<u32>(options, &quantiles, &mut bits);
    }
    Ok(Dictionary { options: *options, bits })
}

/// Levels up to [`EXACT_LEVEL`]: lobe by lobe.
fn bake_exact(options: &DictionaryOptions, quantiles: &MeanQuantiles, bits: &mut [u16]) {
    let n = options.marginals as usize;
    let entries = options.entries as usize;
    let mut draws = Draws::new(options.seed, options.marginals);
    let mut table = vec![0f64; entries];
    let mut sums = vec![0f64; n * entries];
    let mut lobe = 0;
    for level in 0..options.levels.min(EXACT_LEVEL + 1) {
        while lobe < 1 << level {
            let uniform = draws.lobe(lobe);
            for i in 0..n {
                add_lobe(options, quantiles.mean(uniform[i]), &mut sums[i * entries..][..entries]);
            }
            lobe += 1;
        }
        for i in 0..n {
            table.copy_from_slice(&sums[i * entries..][..entries]);
            store(options, level, i, &mut table, bits);
        }
    }
}

/// A whole number that counts lobes.
trait Count: Copy + Default + AddAssign + From<u8> + Into<f64> {}
impl Count for u16 {}
impl Count for u32 {}

/// Levels above [`EXACT_LEVEL`]: counts in sub-bins, and a convolution a level.
fn bake_counted<C: Count>(options: &DictionaryOptions, quantiles: &MeanQuantiles, bits: &mut [u16]) {
    if options.levels <= EXACT_LEVEL + 1 {
        return;
    }
    let n = options.marginals as usize;
    let entries = options.entries as usize;
    let kernel = Kernel::new(options, quantiles.sub_bins_per_entry);
    let sub_bins = quantiles.sub_bins();
    let mut draws = Draws::new(options.seed, options.marginals);
    let mut table = vec![0f64; entries];
    let mut counts = vec![C::default(); n * sub_bins];
    let mut block = vec![0u32; n * BLOCK];
    let mut spread = vec![0f64; kernel.spread_len(entries)];
    let mut lobe = 0;
    for level in EXACT_LEVEL + 1..options.levels {
        while lobe < 1 << level {
            for j in 0..BLOCK {
                let uniform = draws.lobe(lobe);
                for i in 0..n {
                    block[i * BLOCK + j] = quantiles.sub_bin(uniform[i]) as u32;
                }
                lobe += 1;
            }
            for i in 0..n {
                let row = &mut counts[i * sub_bins..][..sub_bins];
                for sub_bin in &block[i * BLOCK..][..BLOCK] {
                    row[*sub_bin as usize] += C::from(1);
                }
            }
        }
        for i in 0..n {
            kernel.convolve(&counts[i * sub_bins..][..sub_bins], &mut spread, &mut table);
            store(options, level, i, &mut table, bits);
        }
    }
}

/// Scales `table` so that linear filtering integrates it to ½ over the half line, and stores it rounded.
fn store(options: &DictionaryOptions, level: u32, marginal: usize, table: &mut [f64], bits: &mut [u16]) {
    let wished = 0.5 / options.spacing();
    let mut sum = 0.0;
    for value in table.iter() {
        sum += value;
    }
    for value in table.iter_mut() {
        *value *= wished / sum;
    }
    let row = level as usize * options.marginals as usize + marginal;
    to_half_with_sum(table, wished, &mut bits[row * table.len()..][..table.len()]);
}

/// Adds exp(−(x − mean)² / 2σ²) and its mirror image at the bin centres x of the positive half line. Two exponentials,
/// then a recurrence: the ratio of neighbouring samples of a Gaussian shrinks by a constant factor.
fn add_lobe(options: &DictionaryOptions, mean: f64, sums: &mut [f64]) {
    let h = options.spacing();
    let inv_var = 1.0 / (options.lobe_std * options.lobe_std);
    let reach = LOBE_REACH * options.lobe_std;
    let nearest = (mean / h).floor();
    let offset = (nearest + 0.5) * h - mean;
    let peak = libm::exp(-0.5 * offset * offset * inv_var);
    let shrink = libm::exp(-h * h * inv_var);
    let ratio_up = libm::exp(-(offset * h + 0.5 * h * h) * inv_var);

    let mut value = peak;
    let mut ratio = ratio_up;
    let mut bin = nearest as i64;
    let last = ((mean + reach) / h).floor() as i64;
    while bin <= last {
        add_even(sums, bin, value);
        value *= ratio;
        ratio *= shrink;
        bin += 1;
    }
    ratio = shrink / ratio_up;
    value = peak * ratio;
    bin = nearest as i64 - 1;
    let first = ((mean - reach) / h).floor() as i64;
    while bin >= first {
        ratio *= shrink;
        add_even(sums, bin, value);
        value *= ratio;
        bin -= 1;
    }
}

/// Bins left of zero are those of the mirror image; bins beyond the domain are cut.
fn add_even(sums: &mut [f64], bin: i64, value: f64) {
    let folded = if bin < 0 { -1 - bin } else { bin } as usize;
    if folded < sums.len() {
        sums[folded] += value;
    }
}

/// The distribution of lobe means on the positive half line, as thresholds of a 32-bit uniform number at sub-bin edges.
struct MeanQuantiles {
    sub_bins_per_entry: usize,
    sub_bin_width: f64,
    /// CDF at the lower edge of each sub-bin, and 1 at the end, in units of 2^−32.
    edges: Vec<u64>,
    /// d(mean) / d(uniform) at the same edges, per unit of 2^−32.
    slopes: Vec<f64>,
    /// For the leading bits of a uniform number: the sub-bin of the smallest such number, and the last number in it.
    guide: Vec<(u32, u32)>,
    /// First uniform number whose leading bits span more than two sub-bins.
    tail: u32,
}

const GUIDE_BITS: u32 = 12;

impl MeanQuantiles {
    fn new(options: &DictionaryOptions) -> MeanQuantiles {
        let per_entry = (SUB_BINS_PER_STD * options.spacing() / options.lobe_std).ceil() as usize;
        let sub_bins = per_entry * options.entries as usize;
        let width = options.domain() / sub_bins as f64;
        let mean_std = options.mean_variance().sqrt();
        let inside = libm::erf(options.domain() / (mean_std * std::f64::consts::SQRT_2));
        let peak = 2.0 / ((2.0 * std::f64::consts::PI).sqrt() * mean_std * inside);
        let mut edges = Vec::with_capacity(sub_bins + 1);
        let mut slopes = Vec::with_capacity(sub_bins + 1);
        for j in 0..=sub_bins {
            let z = j as f64 * width / mean_std;
            let cdf = libm::erf(z * std::f64::consts::FRAC_1_SQRT_2) / inside;
            let density = peak * libm::exp(-0.5 * z * z);
            edges.push((cdf * 4_294_967_296.0).round() as u64);
            slopes.push(1.0 / (density * 4_294_967_296.0));
        }
        let mut guide = Vec::with_capacity(1 << GUIDE_BITS);
        let mut tail = u32::MAX;
        let mut j = 0;
        for g in 0..1u64 << GUIDE_BITS {
            let (first, next) = (g << (32 - GUIDE_BITS), (g + 1) << (32 - GUIDE_BITS));
            while edges[j + 1] <= first {
                j += 1;
            }
            guide.push((j as u32, (edges[j + 1] - 1) as u32));
            if j + 2 < edges.len() && edges[j + 2] < next {
                tail = tail.min(first as u32);
            }
        }
        MeanQuantiles { sub_bins_per_entry: per_entry, sub_bin_width: width, edges, slopes, guide, tail }
    }

    fn sub_bins(&self) -> usize {
        self.edges.len() - 1
    }

    fn sub_bin(&self, uniform: u32) -> usize {
        let (first, last_below) = self.guide[(uniform >> (32 - GUIDE_BITS)) as usize];
        let mut j = first as usize + usize::from(uniform > last_below);
        if uniform >= self.tail {
            while self.edges[j + 1] <= u64::from(uniform) {
                j += 1;
            }
        }
        j
    }

    /// Lobe mean of a uniform number: the inverse of the CDF, as the cubic through two edges with its slopes there.
    fn mean(&self, uniform: u32) -> f64 {
        let j = self.sub_bin(uniform);
        let gap = (self.edges[j + 1] - self.edges[j]) as f64;
        if gap == 0.0 {
            return (j as f64 + 0.5) * self.sub_bin_width;
        }
        let t = ((f64::from(uniform) - self.edges[j] as f64) / gap).clamp(0.0, 1.0);
        let w = self.sub_bin_width;
        let (a, b) = (self.slopes[j] * gap, self.slopes[j + 1] * gap);
        let s = 1.0 - t;
        j as f64 * w + t * t * (3.0 - 2.0 * t) * w + t * s * (s * a - t * b)
    }
}

/// Samples of one lobe on the sub-bin grid, and the convolution with it.
struct Kernel {
    per_entry: usize,
    /// Whole bins that the kernel reaches to each side.
    pad: usize,
    /// Tap q · per_entry + s weighs sub-bin s of the bin q − pad away.
    taps: Vec<f64>,
}

impl Kernel {
    fn new(options: &DictionaryOptions, per_entry: usize) -> Kernel {
        let pad = (LOBE_REACH * options.lobe_std / options.spacing() + 0.5).ceil() as usize;
        let width = options.spacing() / per_entry as f64;
        let centre = (pad as f64 + 0.5) * options.spacing();
        let mut taps = Vec::with_capacity((2 * pad + 1) * per_entry);
        for t in 0..(2 * pad + 1) * per_entry {
            let z = ((t as f64 + 0.5) * width - centre) / options.lobe_std;
            taps.push(libm::exp(-0.5 * z * z));
        }
        Kernel { per_entry, pad, taps }
    }

    /// Length of the scratch that [`Kernel::convolve`] needs.
    fn spread_len(&self, entries: usize) -> usize {
        self.per_entry * (entries + 2 * self.pad)
    }

    /// `table[b]` becomes the sum over lobes and mirror images at bin centre b. `spread` holds the counts sorted by
    /// place within the bin, so that the inner loop runs over neighbouring memory.
    fn convolve<C: Count>(&self, counts: &[C], spread: &mut [f64], table: &mut [f64]) {
        let entries = table.len();
        let row = entries + 2 * self.pad;
        for s in 0..self.per_entry {
            for p in 0..row {
                let sub = (p as i64 - self.pad as i64) * self.per_entry as i64 + s as i64;
                let folded = if sub < 0 { -1 - sub } else { sub } as usize;
                spread[s * row + p] = if folded < counts.len() { counts[folded].into() } else { 0.0 };
            }
        }
        table.fill(0.0);
        for q in 0..2 * self.pad + 1 {
            for s in 0..self.per_entry {
                let tap = self.taps[q * self.per_entry + s];
                let source = &spread[s * row + q..][..entries];
                for b in 0..entries {
                    table[b] += tap * source[b];
                }
            }
        }
    }
}
