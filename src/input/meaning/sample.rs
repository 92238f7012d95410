//! Texels that speak for a whole map.
//!
//! What a map means is a matter of medians and shares. Of 65,536 texels, one out of each run of as many neighbours, at a place
//! that is random but always the same, a share is off by 0.2 % of the map at most (one standard deviation; 0.4 % of the painted
//! part where that is a quarter of the map). So where these texels leave no doubt, with a margin of seven deviations at least,
//! the others are not asked; where they do, all are. Exact numbers that a message gives are counted over all.

use crate::input::pixels::Values;
use glint_bake_core::hash::mix_bits;

/// Texels that are looked at; a map of no more than these is its own sample.
const TEXELS: usize = 65_536;

/// Painted texels that are enough to go by.
const ENOUGH: usize = TEXELS / 4;

/// Painted texels of all parts of a map, in order; all of them where they are few.
pub(super) fn sample(values: &Values, is_painted: impl Fn(&[f32; 4]) -> bool) -> Vec<[f32; 4]> {
    let all = values.len();
    let place = |run: usize| {
        let (first, next) = (run * all / TEXELS, (run + 1) * all / TEXELS);
        first + ((mix_bits(run as u32) as u64 * (next - first) as u64) >> 32) as usize
    };
    if all > TEXELS {
        let chosen: Vec<_> = (0..TEXELS).map(|run| values.texel(place(run))).filter(&is_painted).collect();
        if chosen.len() >= ENOUGH {
            return chosen;
        }
    }
    values.texels().filter(is_painted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_all_of_a_small_map_and_even_over_a_large_one() {
        let ramp = |texels: usize| Values::Grey((0..texels).map(|at| at as f32).collect());
        assert_eq!(sample(&ramp(TEXELS), |_| true).len(), TEXELS);
        // Of 1,000 painted texels among a million all are taken.
        assert_eq!(sample(&ramp(1_000_000), |texel| texel[0] % 1000.0 == 7.0).len(), 1000);
        for texels in [TEXELS + 1, 300 * 1000, 1 << 22] {
            let chosen: Vec<usize> = sample(&ramp(texels), |_| true).iter().map(|texel| texel[0] as usize).collect();
            assert_eq!(chosen.len(), TEXELS);
            for (run, at) in chosen.iter().enumerate() {
                assert_eq!((at * TEXELS + TEXELS - 1) / texels, run, "{texels}: {at} is not of run {run}");
            }
        }
    }

    #[test]
    fn shares_of_rows_columns_and_squares_are_those_of_the_map() {
        let (width, height) = (1024, 2048);
        type Pattern = fn(usize, usize) -> bool;
        let patterns: [(&str, Pattern); 4] = [
            ("every 32nd column", |x, _| x % 32 == 0),
            ("every 64th row", |_, y| y % 64 == 0),
            ("a square in the middle", |x, y| x.abs_diff(512) < 128 && y.abs_diff(1024) < 128),
            ("squares of 8", |x, y| (x / 8 + y / 8) % 2 == 0),
        ];
        for (name, pattern) in patterns {
            let marked: Vec<f32> = (0..width * height).map(|at| f32::from(pattern(at % width, at / width))).collect();
            let share = |texels: &[f32]| texels.iter().sum::<f32>() / texels.len() as f32;
            let truth = share(&marked);
            let found =
                share(&sample(&Values::Grey(marked), |_| true).iter().map(|texel| texel[0]).collect::<Vec<_>>());
            println!("{name}: {truth:.4}, found {found:.4}");
            assert!((found - truth).abs() < 0.006, "{name}: {truth}, found {found}");
        }
    }
}
