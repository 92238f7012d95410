//! The factor between stored and true radiance, and what rounding costs.
//!
//! A half float is off by 1 in 2048 at the worst. A sun is a few texels of 10⁵ times the mean, so their rounding alone
//! can exceed the error that a sharp mip may have. How much it is depends on where between two powers of two those few
//! texels fall, so where it matters the factor is chosen for them. The paper stores radiance as it is.

use super::image::{EnvironmentImage, luminance};
use super::quantise;
use glint_formats::environment::Storage;

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
/// Texels a mip, its brightest, that factors are tried on. Where more matter, rounding averages out for any factor.
const TRIED: usize = 512;

/// One mip before rounding.
#[derive(Clone, Copy, Debug)]
pub struct Mip<'a> {
    /// Numbers of all texels, R, G and B first.
    pub texels: &'a [f64],
    /// Numbers a texel.
    pub channels: usize,
    /// Root mean square error over the mean that it may have.
    pub max_error: f64,
}

/// Stored radiance times this is radiance: 1, or what brings `image` into the range of half floats, or what makes the
/// brightest texels of `mips` round well.
pub fn radiance_scale(image: &EnvironmentImage, mips: &[Mip<'_>], storage: Storage) -> f64 {
    let brightest = image.pixels.iter().flatten().fold(0.0f32, |a, b| a.max(*b));
    let brightest = f64::from(brightest);
    if storage == Storage::F32 || brightest == 0.0 {
        return 1.0;
    }
    let plain = if (DIM..=MAX_STORED).contains(&brightest) {
        1.0
    } else {
        libm::exp2(libm::ceil(libm::log2(brightest / MAX_STORED)))
    };
    let mean = luminance(image.mean());
    let worst = |mips: &[Mip<'_>], scale: f64| {
        mips.iter().map(|mip| rounding_error(mip, scale, storage) / (mean * mip.max_error)).fold(0.0, f64::max)
    };
    if worst(mips, plain) <= UNHEARD {
        return plain;
    }
    let bright: Vec<(Vec<f64>, &Mip<'_>)> = mips.iter().map(|mip| (brightest_of(mip), mip)).collect();
    // Spread over as many texels as the mip has, so that mips compare as they do whole.
    let share = |scale: f64| {
        let of = |(texels, mip): &(Vec<f64>, &Mip<'_>)| {
            let few = Mip { texels, channels: 3, max_error: mip.max_error };
            let spread = (texels.len() as f64 / 3.0) / (mip.texels.len() / mip.channels) as f64;
            rounding_error(&few, scale, storage) * spread.sqrt() / mip.max_error
        };
        bright.iter().map(of).fold(0.0, f64::max)
    };
    let scales = (0..STEPS).map(|k| plain * (1.0 + f64::from(k) / f64::from(STEPS)));
    let best = scales.map(|scale| (scale, share(scale))).min_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|best| best.1 <= EARNED * share(plain)).map_or(plain, |best| best.0)
}

/// R, G and B of the texels that are brightest, in any order.
fn brightest_of(mip: &Mip<'_>) -> Vec<f64> {
    let of = |texel: &[f64]| luminance([texel[0], texel[1], texel[2]]);
    let mut all: Vec<&[f64]> = mip.texels.chunks_exact(mip.channels).collect();
    if all.len() > TRIED {
        all.select_nth_unstable_by(TRIED, |a, b| of(b).total_cmp(&of(a)));
        all.truncate(TRIED);
    }
    all.into_iter().flat_map(|texel| texel[..3].iter().copied()).collect()
}

/// Root mean square error of luminance over a mip's texels that rounding alone makes.
pub fn rounding_error(mip: &Mip<'_>, scale: f64, storage: Storage) -> f64 {
    let mut squares = 0.0;
    for texel in mip.texels.chunks_exact(mip.channels) {
        let error = [0, 1, 2].map(|c| quantise::stored(texel[c] / scale, storage) * scale - texel[c]);
        squares += luminance(error).powi(2);
    }
    let count = mip.texels.len() / mip.channels;
    (squares / count.max(1) as f64).sqrt()
}
