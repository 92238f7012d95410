//! Rounds a table to half floats so that its sum stays what it was asked to be.
//!
//! The paper's tables were normalised before rounding and for other sample places than the sampler uses. Here the sum
//! of the rounded entries is put right last. Each step moves one entry by one unit in its last place, the entry whose
//! step brings the sum nearest to the target, so a few steps of falling size are enough; among equal steps it takes
//! the entry that rounding had moved the other way the most. Zero entries stay zero.
//!
//! The conversion is written out because `half` goes through f32 where the processor can convert f32 but not f64, and
//! rounding twice would give other bytes there.

/// Largest number of one-unit steps for one table.
const MAX_STEPS: u32 = 64;

/// A sum this near to the wished one, relative to it, is left alone.
const CLOSE_ENOUGH: f64 = 1e-7;

/// Rounds `values` (non-negative, finite, below 65 504) to half floats whose sum is within [`CLOSE_ENOUGH`] of
/// `sum`, or as near to it as single steps in the last place can bring it. The bits go to `out`, which has the same length.
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

/// Nearest half float of a non-negative finite number below 65 504, ties to even: its bits and its value.
fn nearest_half(value: f64) -> (u16, f64) {
    let power = (value.to_bits() >> 52) as i64 - 1023;
    let exponent = (power + 15).max(1) as u64;
    let unit = f64::from_bits((1023 - 25 + exponent) << 52);
    let units = (value / unit).round_ties_even();
    // A subnormal has exponent field 0 and up to 1 024 units; a normal one has 1 024 to 2 048, and 2 048 carries.
    let bits = if power + 15 < 1 { units as u64 } else { (exponent << 10) + units as u64 - 1024 };
    (bits as u16, units * unit)
}
