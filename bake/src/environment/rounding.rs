//! Rounds filtered texels to what a texture stores, and chooses the factor between stored and true radiance.
//!
//! The paper stores K indicators as half floats or UNorm. Stored separately, rounded numbers do not add up to 1. Here
//! level 0 is not stored: it is what the others leave of 1, so the partition of unity holds exactly in any format, and
//! after any filtering. All that is asked of the others is that they do not exceed 1: where rounding makes them, the
//! largest gives way, by a unit in its last place at a time.
//!
//! A half float is off by 1 in 2048 at the worst. A sun is a few texels of 10⁵ times the mean, so their rounding alone
//! can exceed the error that a sharp roughness may have. How much it is depends on where between two powers of two those few
//! texels fall, so where it matters the factor is chosen for them. The paper stores radiance as it is.

use super::image::{EnvironmentImage, luminance};
use half::f16;

/// Largest stored radiance whose neighbours are still finite half floats.
const MAX_STORED: f64 = 32768.0;
/// Images whose brightest pixel is below this are scaled up, so that half floats keep their digits.
const DIM: f64 = 1.0 / 64.0;
/// Share of the error asked that rounding may take before another factor is looked for. Errors add by squares, so this
/// adds 3 % to it at most.
const UNHEARD: f64 = 0.25;
/// Another factor is taken where it leaves this share of the error of rounding, or less.
const EARNED: f64 = 0.5;
/// Factors that are tried between a power of two and the next; all of them are exact in f32.
const STEPS: u32 = 512;
/// Texels a roughness, its brightest, that factors are tried on. Where more matter, rounding averages out for any factor.
const TRIED: usize = 512;

/// Bits of the half float nearest to a value that is not negative; the largest finite one beyond.
pub fn half_bits(value: f64) -> u16 {
    f16::from_f32((value as f32).min(65504.0)).to_bits()
}

/// Bits of half floats that add up to at most 1. `shares` are not negative.
pub fn indicators(shares: &[f64]) -> Vec<u16> {
    let mut bits: Vec<u16> = shares.iter().map(|share| half_bits(share.min(1.0))).collect();
    while bits.iter().map(|bits| f16::from_bits(*bits).to_f64()).sum::<f64>() > 1.0 {
        // The bits of positive floats are in order, so the largest is the largest number and one less the next smaller one.
        let Some(largest) = bits.iter_mut().max() else { break };
        *largest -= 1;
    }
    bits
}

/// A colour as E5B9G9R9 (Vulkan specification, "Conversion to shared exponent"): 9 bits a channel and one exponent.
pub fn shared_exponent(rgb: [f64; 3]) -> u32 {
    const BIAS: i32 = 15;
    const BITS: i32 = 9;
    let largest_value = 511.0 / 512.0 * 65536.0;
    let rgb = rgb.map(|value| value.clamp(0.0, largest_value));
    let largest = rgb.into_iter().fold(0.0, f64::max);
    let power = if largest > 0.0 { libm::ilogb(largest) } else { -BIAS - 1 };
    let mut exponent = power.max(-BIAS - 1) + 1 + BIAS;
    let unit = |exponent: i32| libm::ldexp(1.0, exponent - BIAS - BITS);
    if (largest / unit(exponent)).round() >= 512.0 {
        exponent += 1;
    }
    let [r, g, b] = rgb.map(|value| (value / unit(exponent)).round() as u32);
    (exponent as u32) << 27 | b << 18 | g << 9 | r
}

/// Texels of one roughness before rounding.
#[derive(Clone, Copy, Debug)]
pub struct Texels<'a> {
    /// Numbers of all texels, R, G and B first.
    pub texels: &'a [f64],
    /// Numbers a texel.
    pub channels: usize,
    /// Root mean square error over the mean that it may have.
    pub max_error: f64,
}

/// Stored radiance times this is radiance: 1, or what brings `image` into the range of half floats, or what makes the
/// brightest texels of `cubes` round well.
pub fn radiance_scale(image: &EnvironmentImage, cubes: &[Texels<'_>]) -> f64 {
    let brightest = image.pixels.iter().flatten().fold(0.0f32, |a, b| a.max(*b));
    let brightest = f64::from(brightest);
    if brightest == 0.0 {
        return 1.0;
    }
    let plain = if (DIM..=MAX_STORED).contains(&brightest) {
        1.0
    } else {
        libm::exp2(libm::ceil(libm::log2(brightest / MAX_STORED)))
    };
    let mean = luminance(image.mean());
    let worst =
        |scale: f64| cubes.iter().map(|cube| rounding_error(cube, scale) / (mean * cube.max_error)).fold(0.0, f64::max);
    if worst(plain) <= UNHEARD {
        return plain;
    }
    let bright: Vec<(Vec<f64>, &Texels<'_>)> = cubes.iter().map(|cube| (brightest_of(cube), cube)).collect();
    // Spread over as many texels as the cube has, so that cubes compare as they do whole.
    let share = |scale: f64| {
        let of = |(texels, cube): &(Vec<f64>, &Texels<'_>)| {
            let few = Texels { texels, channels: 3, max_error: cube.max_error };
            let part = (texels.len() as f64 / 3.0) / (cube.texels.len() / cube.channels) as f64;
            rounding_error(&few, scale) * part.sqrt() / cube.max_error
        };
        bright.iter().map(of).fold(0.0, f64::max)
    };
    let scales = (0..STEPS).map(|k| plain * (1.0 + f64::from(k) / f64::from(STEPS)));
    let best = scales.map(|scale| (scale, share(scale))).min_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|best| best.1 <= EARNED * share(plain)).map_or(plain, |best| best.0)
}

/// R, G and B of the texels that are brightest, in any order.
fn brightest_of(cube: &Texels<'_>) -> Vec<f64> {
    let of = |texel: &[f64]| luminance([texel[0], texel[1], texel[2]]);
    let mut all: Vec<&[f64]> = cube.texels.chunks_exact(cube.channels).collect();
    if all.len() > TRIED {
        all.select_nth_unstable_by(TRIED, |a, b| of(b).total_cmp(&of(a)));
        all.truncate(TRIED);
    }
    all.into_iter().flat_map(|texel| texel[..3].iter().copied()).collect()
}

/// Root mean square error of luminance over the texels that rounding alone makes.
pub fn rounding_error(cube: &Texels<'_>, scale: f64) -> f64 {
    let mut squares = 0.0;
    for texel in cube.texels.chunks_exact(cube.channels) {
        let error = [0, 1, 2].map(|c| f16::from_bits(half_bits(texel[c] / scale)).to_f64() * scale - texel[c]);
        squares += luminance(error).powi(2);
    }
    let count = cube.texels.len() / cube.channels;
    (squares / count.max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::baked::from_shared_exponent;

    #[test]
    fn stored_indicators_never_exceed_one() {
        let mut state = 1u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        for count in [1, 3, 7, 15] {
            for _ in 0..2000 {
                let raw: Vec<f64> = (0..count).map(|_| unit().powi(6)).collect();
                let whole: f64 = raw.iter().sum();
                let shares: Vec<f64> = raw.iter().map(|share| share / whole).collect();
                let read: Vec<f64> = indicators(&shares).iter().map(|bits| f16::from_bits(*bits).to_f64()).collect();
                assert!(read.iter().sum::<f64>() <= 1.0, "{read:?}");
                let largest = shares.iter().copied().fold(0.0, f64::max);
                for (read, share) in read.iter().zip(&shares) {
                    // Half a step by rounding. The largest also takes what all roundings add up to, in whole steps.
                    let half = 0.5 * step(*share);
                    let excess: f64 = shares.iter().map(|share| 0.5 * step(*share)).sum();
                    let given = if *share == largest { excess + 2.0 * half } else { 0.0 };
                    assert!((read - share).abs() <= half + given, "{share} {read}");
                }
            }
        }
    }

    /// Distance of neighbouring half floats at `value`, at most.
    fn step(value: f64) -> f64 {
        (value / 1024.0).max(6e-8)
    }

    #[test]
    fn shared_exponents_keep_nine_bits() {
        for rgb in [[1.0, 0.5, 0.25], [4.7, 0.0, 1e-3], [0.0, 0.0, 13.85], [1023.9, 2.0, 511.5], [0.0; 3]] {
            let read = from_shared_exponent(shared_exponent(rgb)).map(f64::from);
            let largest = rgb.into_iter().fold(0.0, f64::max);
            for c in 0..3 {
                assert!((read[c] - rgb[c]).abs() <= largest / 500.0, "{rgb:?} {read:?}");
            }
        }
    }
}
