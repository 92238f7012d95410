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
//! - Lobe k of all marginals is drawn together, see [`Draws`], and tables are rounded so that they stay normalised, see
//!   [`to_half_with_sum`].
//! - Counts are integers and sums run in one fixed order with portable functions, so a dictionary has the same bytes on
//!   every platform. The work is a few hundredths of a second, so it stays on one thread.

use super::baked::Dictionary;
use super::options::DictionaryOptions;
use crate::error::BakeError;
use crate::progress::Progress;
use multiversion::multiversion;
use rand::Rng;
use rand_pcg::Pcg32;
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

/// Bakes a dictionary, which has no input but its options. One stage of progress, of a step a level.
///
/// # Errors
/// Those of [`DictionaryOptions::validate`].
pub fn bake(options: &DictionaryOptions, progress: &dyn Progress) -> Result<Dictionary, BakeError> {
    options.validate()?;
    progress.begin("levels", u64::from(options.levels));
    let quantiles = MeanQuantiles::new(options);
    let mut bits = vec![0u16; options.tables() as usize * options.entries as usize];
    bake_exact(options, &quantiles, progress, &mut bits);
    // Counts below 2^16 take half the memory of the whole bake.
    if options.levels <= u16::BITS {
        bake_counted::<u16>(options, &quantiles, progress, &mut bits);
    } else {
        bake_counted::<u32>(options, &quantiles, progress, &mut bits);
    }
    progress.end();
    Ok(Dictionary { options: *options, bits })
}

/// Levels up to [`EXACT_LEVEL`]: lobe by lobe.
fn bake_exact(options: &DictionaryOptions, quantiles: &MeanQuantiles, progress: &dyn Progress, bits: &mut [u16]) {
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
        progress.advance(1);
    }
}

/// A whole number that counts lobes.
trait Count: Copy + Default + AddAssign + From<u8> + Into<f64> {}
impl Count for u16 {}
impl Count for u32 {}

/// Levels above [`EXACT_LEVEL`]: counts in sub-bins, and a convolution a level.
fn bake_counted<C: Count>(
    options: &DictionaryOptions,
    quantiles: &MeanQuantiles,
    progress: &dyn Progress,
    bits: &mut [u16],
) {
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
    let mut block = vec![[0u32; BLOCK]; n];
    let mut spread = vec![0f64; kernel.spread_len(entries)];
    let mut lobe = 0;
    for level in EXACT_LEVEL + 1..options.levels {
        while lobe < 1 << level {
            for j in 0..BLOCK {
                quantiles.find_sub_bins(draws.lobe(lobe), j, &mut block);
                lobe += 1;
            }
            for (row, found) in counts.chunks_exact_mut(sub_bins).zip(&block) {
                for sub_bin in found {
                    row[*sub_bin as usize] += C::from(1);
                }
            }
        }
        for i in 0..n {
            kernel.convolve(&counts[i * sub_bins..][..sub_bins], &mut spread, &mut table);
            store(options, level, i, &mut table, bits);
        }
        progress.advance(1);
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
    guide: Box<[(u32, u32); 1 << GUIDE_BITS]>,
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
        let mut guide = Box::new([(0, 0); 1 << GUIDE_BITS]);
        let mut tail = u32::MAX;
        let mut j = 0;
        for (g, entry) in (0u64..).zip(guide.iter_mut()) {
            let (first, next) = (g << (32 - GUIDE_BITS), (g + 1) << (32 - GUIDE_BITS));
            while edges[j + 1] <= first {
                j += 1;
            }
            *entry = (j as u32, (edges[j + 1] - 1) as u32);
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

    /// Sub-bins of one lobe of all marginals, as entry `j` of their blocks. A function of its own, so that nothing it reads is
    /// read anew for each number.
    #[inline(never)]
    fn find_sub_bins(&self, uniform: &[u32], j: usize, block: &mut [[u32; BLOCK]]) {
        for (found, &uniform) in block.iter_mut().zip(uniform) {
            found[j] = self.sub_bin(uniform) as u32;
        }
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
        for (q, taps) in self.taps.chunks_exact(self.per_entry).enumerate() {
            for (s, tap) in taps.iter().enumerate() {
                add_scaled(table, *tap, &spread[s * row + q..][..entries]);
            }
        }
    }
}

/// `table[b] += tap · source[b]`; each product is rounded before it is added, whatever the processor has.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn add_scaled(table: &mut [f64], tap: f64, source: &[f64]) {
    for (sum, value) in table.iter_mut().zip(source) {
        *sum += tap * value;
    }
}

/// First lobe that is drawn in pairs; even.
pub const PAIRED_FROM: u32 = 1024;
const HALF_TURN: u32 = 1 << 31;

/// The random numbers that a dictionary stands for, one lobe after the other: one uniform number a lobe and marginal,
/// stratified across marginals. The bake and the reference share them; each turns them into slopes in its own way.
///
/// Paper: section 4.4 draws lobe means one by one and independently. Deviation: lobe k of all N marginals is one Latin
/// hypercube, a random order of the N strata of [0, 1) with a random place in each. A single marginal still sees
/// independent uniform numbers, so its glints stay; the mean over the dictionary converges far faster.
///
/// From lobe [`PAIRED_FROM`] on, lobes come in pairs half a turn apart (u and u + ½ mod 1). It halves the work where
/// nearly all lobes are, and takes the lowest frequency out of a marginal's deviation from the target. Lobes below it
/// are independent within a marginal: there pairs would be seen as missing glints.
#[derive(Clone, Debug)]
pub struct Draws {
    seed: u64,
    order: Vec<u32>,
    uniform: Vec<u32>,
    drawn: Option<u32>,
}

impl Draws {
    /// Draws for a dictionary of `marginals` marginals, at least 1.
    pub fn new(seed: u64, marginals: u32) -> Draws {
        let n = marginals as usize;
        Draws { seed, order: vec![0; n], uniform: vec![0; n], drawn: None }
    }

    /// Uniform numbers of lobe `lobe`, in units of 2^−32, one a marginal. One generator stream a lobe or pair of lobes,
    /// so any lobe can be drawn alone; asking for the second of a pair after the first costs nothing new.
    pub fn lobe(&mut self, lobe: u32) -> &[u32] {
        if self.drawn == Some(lobe) {
            return &self.uniform;
        }
        if lobe < PAIRED_FROM || lobe.is_multiple_of(2) {
            self.draw(lobe);
        } else {
            if self.drawn != Some(lobe - 1) {
                self.draw(lobe - 1);
            }
            for u in &mut self.uniform {
                *u = u.wrapping_add(HALF_TURN);
            }
        }
        self.drawn = Some(lobe);
        &self.uniform
    }

    fn draw(&mut self, item: u32) {
        let mut rng = Pcg32::new(stream_state(self.seed, item), u64::from(item));
        let order = self.order.as_mut_slice();
        for j in 0..order.len() {
            let r = ((u64::from(rng.next_u32()) * (j as u64 + 1)) >> 32) as usize;
            order[j] = order[r];
            order[r] = j as u32;
        }
        let width = (1u64 << 32) / order.len() as u64;
        for (uniform, &stratum) in self.uniform.iter_mut().zip(&*order) {
            let within = (u64::from(rng.next_u32()) * width) >> 32;
            *uniform = (u64::from(stratum) * width + within) as u32;
        }
    }
}

/// First state of an item's generator. Streams of a linear congruential generator that start from related states stay
/// related, which shows as contrast that grows with the number of lobes, so seed and item are mixed well first.
fn stream_state(seed: u64, item: u32) -> u64 {
    let mut s = seed ^ (u64::from(item) << 32 | u64::from(item));
    for factor in [0x9e37_79b9_7f4a_7c15u64, 0xbb67_ae85_84ca_a73b, 0xa54f_f53a_5f1d_36f1] {
        s = (s ^ (s >> 32)).wrapping_add(factor).wrapping_mul(factor);
    }
    s ^ (s >> 32)
}

/// Largest number of one-unit steps for one table.
const MAX_STEPS: u32 = 64;

/// A sum this near to the wished one, relative to it, is left alone.
const CLOSE_ENOUGH: f64 = 1e-7;

/// Rounds `values` (non-negative, finite, below 65 504) to half floats whose sum is within [`CLOSE_ENOUGH`] of
/// `sum`, or as near to it as single steps in the last place can bring it. The bits go to `out`, which has the same length.
///
/// The paper's tables were normalised before rounding and for other sample places than the sampler uses. Here the sum
/// of the rounded entries is put right last. Each step moves one entry by one unit in its last place, the entry whose
/// step brings the sum nearest to the target, so a few steps of falling size are enough; among equal steps it takes
/// the entry that rounding had moved the other way the most. Zero entries stay zero.
pub fn to_half_with_sum(values: &[f64], sum: f64, out: &mut [u16]) {
    let mut errors = Vec::with_capacity(values.len());
    let mut missing = sum;
    for b in 0..values.len() {
        let (bits, rounded) = nearest_half(values[b]);
        out[b] = bits;
        errors.push(rounded - values[b]);
        missing -= rounded;
    }
    for _ in 0..MAX_STEPS {
        if missing.abs() <= CLOSE_ENOUGH * sum {
            return;
        }
        let up = missing > 0.0;
        let mut best = (missing.abs(), 0.0);
        let mut chosen = None;
        for b in 0..values.len() {
            if out[b] == 0 {
                continue;
            }
            let unit = last_place(if up { out[b] } else { out[b] - 1 });
            let step = if up { unit } else { -unit };
            let left = (missing - step).abs();
            let error = (errors[b] + step).abs() / unit;
            if left < best.0 || (left == best.0 && chosen.is_some() && error < best.1) {
                best = (left, error);
                chosen = Some((b, step));
            }
        }
        let Some((b, step)) = chosen else { return };
        out[b] = if up { out[b] + 1 } else { out[b] - 1 };
        errors[b] += step;
        missing -= step;
    }
}

/// Distance from a positive half float, given by its bits, to the next larger one.
fn last_place(bits: u16) -> f64 {
    let exponent = u64::from(bits >> 10).max(1);
    f64::from_bits((1023 - 25 + exponent) << 52)
}

/// Nearest half float of a non-negative finite number below 65 504, ties to even: its bits and its value. Written out because
/// `half` goes through f32 where the processor can convert f32 but not f64, and rounding twice would give other bytes there.
fn nearest_half(value: f64) -> (u16, f64) {
    let power = (value.to_bits() >> 52) as i64 - 1023;
    let exponent = (power + 15).max(1) as u64;
    let unit = f64::from_bits((1023 - 25 + exponent) << 52);
    let units = (value / unit).round_ties_even();
    // A subnormal has exponent field 0 and up to 1 024 units; a normal one has 1 024 to 2 048, and 2 048 carries.
    let bits = if power + 15 < 1 { units as u64 } else { (exponent << 10) + units as u64 - 1024 };
    (bits as u16, units * unit)
}
