//! Binomial numbers from one random word, f32, as in WGSL: two bounded ways, no table, no memory.
//!
//! Paper: Kneiphof and Klein 2025, section 6, algorithm 1 and figure 4. Deviations:
//! - The paper decides n = 0 and n = N by a first uniform number and draws everything between from a clamped Gaussian
//!   by a second. The Gaussian's conditional mean is not that of the distribution: the mean of n exceeds Np by up to a
//!   third. Here n is the inverse of the distribution function at one uniform number. Where the rarer outcome is
//!   expected at most [`FEW`] times, its distribution is walked from 0 up and n is exact. Beyond, n is the
//!   Cornish–Fisher expansion (1938) of that inverse around the Gaussian, with skewness, kurtosis and the correction
//!   for whole numbers (Giles 2016, "Algorithm 955", has such a form for Poisson numbers), rounded to a whole number.
//!   Its mean is Np term by term.
//! - Both ends are treated alike: the rarer of the two outcomes is the one that is counted.
//! - For a fractional N the paper mixes the distributions of ⌊N⌋ and ⌈N⌉ below 2, where n + n̄ is not N, and uses N as
//!   it is above, where counts are fractional. Here the mixture is the definition for all N: N facets are ⌊N⌋ facets
//!   and one more with probability N − ⌊N⌋. n + n̄ is that whole number; it is N where N is whole, as all f32 from 2²³
//!   on are.
//! - Counts above 2²⁴ come with what rounding to f32 takes from them ([`Count`]), so that their variance holds to 1e16.

use super::count::Count;
use super::normal::{Uniform, normal_upper_fraction, unit_from_bits};
use super::pow1m::{MOST_HALVINGS, halved, halvings};

/// Largest expected count of the rarer outcome that is drawn exactly.
pub const FEW: f32 = 6.0;

/// From here on every f32 is a whole number.
const WHOLE: f32 = 8_388_608.0;

/// Steps of the walk: more hits happen in 1.5 of 10⁶ draws when [`FEW`] are expected, and count as this many.
pub const WALK_STEPS: u32 = 20;

/// A whole number with mean `n`: ⌊n⌋, or ⌊n⌋ + 1 where the uniform number `word` is below n − ⌊n⌋. Negative `n` counts as 0.
pub fn whole_count(n: f32, word: f32) -> f32 {
    let n = n.max(0.0);
    let floor = n.floor();
    if word < n - floor { floor + 1.0 } else { floor }
}

/// Hits k with P(hits > k) ≤ u of n trials with p ≤ ½, q = 1 − p and np at most a few; exact up to [`WALK_STEPS`].
///
/// Both P(hits = k) and P(hits > k) − u are walked times k!, so that no step divides; 20! is far from the largest f32.
pub fn few_hits(n: f32, p: f32, q: f32, u: f32) -> f32 {
    // q is 0 besides p where nothing is drawn.
    let odds = p / q.max(0.5);
    let [mut density, lost] = halved((n * halvings(p)).min(MOST_HALVINGS));
    let mut excess = lost - u;
    let mut k = 0.0;
    for _ in 0..WALK_STEPS {
        if excess <= 0.0 {
            break;
        }
        density *= (n - k) * odds;
        k += 1.0;
        excess = excess * k - density;
    }
    // Rounding may leave a rest of excess past the last trial.
    k.min(n)
}

/// What rounding took from a · b = `product`: both factors are split into halves whose products are exact.
fn product_rest(a: f32, b: f32, product: f32) -> f32 {
    let high = |x: f32| f32::from_bits(x.to_bits() & 0xffff_f000);
    let (a_high, b_high) = (high(a), high(b));
    let (a_low, b_low) = (a - a_high, b - b_high);
    ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
}

/// Hits k with P(hits > k) ≈ u of n trials with p ≤ ½, q = 1 − p and np more than [`FEW`].
///
/// With z the normal quantile, σ² = npq, γ = q − p:
/// np + σz + γ(z² − 1)/6 + z [(1 − 6pq)(z² − 3)/24 − γ²(2z² − 5)/36 − 1/24] / σ, to the nearest whole number.
pub fn many_hits(n: Count, p: f32, q: f32, u: Uniform) -> Count {
    let mean = n.high * p;
    // From np = 4e8 on, the rounding of np alone would show as a bias in ten million draws.
    let rest = product_rest(n.high, p, mean) + n.low * p;
    let sigma = ((mean + rest) * q).sqrt();
    let [over, under] = normal_upper_fraction(u);
    // z / σ: one division for both.
    let slope = over / (under * sigma);
    let z = slope * sigma;
    let z2 = z * z;
    // (1 − 6pq)(z² − 3)/24 − γ²(2z² − 5)/36 − 1/24 times 72, with γ² = 1 − 4pq.
    let third = p * q * (14.0 - 2.0 * z2) - (z2 + 2.0);
    let spread = sigma * z + (q - p) * (z2 - 1.0) * (1.0 / 6.0) + slope * third * (1.0 / 72.0);
    if mean < WHOLE {
        return Count::from((mean + (rest + spread)).round_ties_even().clamp(0.0, n.value()));
    }
    // The mean is a whole number here, hundreds of σ from 0 and n; added to it in f32, the spread would be lost.
    Count::new(mean, (rest + spread).round_ties_even())
}

/// Hits and misses of `n` trials with hit chance `p`, from one uniform number; they add up to `n`. The hits are many where the number is
/// small, the misses where its rest is.
///
/// `n` ≥ 0 is at most 1e16, `p` and `q` = 1 − p are from 0 to 1 (to 1e-16); where both are 0, all hit. For equal `u` the hits grow with
/// `p`, and exchanging p with q and u with its rest exchanges the result.
pub fn whole_binomial(n: Count, p: f32, q: f32, u: Uniform) -> [Count; 2] {
    let swapped = p >= q;
    let (rare, common) = if swapped { (q, p) } else { (p, q) };
    let u = if swapped { u.exchanged() } else { u };
    let few = n.value() * rare <= FEW;
    let hits = if few { few_hits(n.value(), rare, common, u.number).into() } else { many_hits(n, rare, common, u) };
    if swapped { [n - hits, hits] } else { [hits, n - hits] }
}

/// Hits and misses of any number `n` ≥ 0 of trials, from two random words: the first makes `n` whole ([`whole_count`]),
/// the second draws ([`whole_binomial`]).
///
/// Hits have mean np and variance npq + λ(1 − λ)p², λ = n − ⌊n⌋; they and the misses add up to the whole number.
pub fn binomial(n: f32, p: f32, q: f32, bits: [u32; 2]) -> [Count; 2] {
    let n = whole_count(n, unit_from_bits(bits[0]));
    whole_binomial(n.into(), p, q, Uniform::from_bits(bits[1]))
}
