//! Binomial and multinomial counts from random words, f32, as in WGSL: two bounded ways, no table, no memory.
//!
//! Paper: Kneiphof and Klein 2025, section 6, algorithm 1 and figure 4. Twin: `eval.wgsl`, which draws four nodes at a time. Deviations:
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
//! - At 1e16 neighbouring f32 are 2³⁰ apart and the standard deviation of a count is up to 5·10⁷, so one f32, as the paper has
//!   it, cannot show that it varies. Counts above 2²⁴ come with what rounding to f32 takes from them ([`Count`]), so that their
//!   variance holds to 1e16. Differences of counts keep what they round off as Dekker's do (1971, "A floating-point technique
//!   for extending the available precision"); a compiler must not reassociate them.
//! - In the tree of binomial draws ("Sampling Multinomial Distributions") the number of facets is made whole once, at the root;
//!   every count below is whole, and they add up to it. In the paper inner counts are fractional, and where less than two
//!   facets reach a node the sum is lost. Both branch probabilities are quotients of sums of weights, never 1 − p, so that a
//!   rare level keeps its digits on either side.
//!
//! The paper (algorithm 1, line 18) asks for the inverse of the normal distribution function and leaves its computation open. The
//! form x · P(w), w = −log(4u(1 − u)), is that of Giles 2010, "Approximating the erfinv function". Here P is one quotient of
//! polynomials, fitted to uniforms of 32 bits, and the logarithm, to the base 2, is the polynomial that powers take: a shader
//! that computes both finds them for the price of one. Powers (1 − p)^N are taken by powers of 2, where the exponent of an f32
//! does half of the work: [`halvings`] and [`halved`] are polynomials for p ≤ ½ alone, without a function that WGSL leaves to
//! the device.

/// Most levels of one draw.
pub const MAX_LEVELS: usize = 16;
/// Largest expected count of the rarer outcome that is drawn exactly.
pub const FEW: f32 = 6.0;
/// From here on every f32 is a whole number.
const WHOLE: f32 = 8_388_608.0;
/// Whole numbers up to here are exact in one f32.
const EXACT_COUNT: f32 = 16_777_216.0;
/// Steps of the walk: more hits happen in 1.5 of 10⁶ draws when [`FEW`] are expected, and count as this many.
const WALK_STEPS: u32 = 20;
/// Most halvings whose power is a normal number.
const MOST_HALVINGS: f32 = 125.0;
/// Words are taken as at least this, half a step of 32 random bits.
const LEAST_WORD: f32 = 0.5 / 4_294_967_296.0;
/// Nodes that are lighter are taken as this heavy, which they fill in part: one over the weight must be a number.
const LEAST_WEIGHT: f32 = 1e-37;

/// A whole number to 1e16, `high` + `low`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Count {
    /// The number; rounded, where it is above 2²⁴.
    pub high: f32,
    /// What is missing, which may be negative; 0 up to 2²⁴. Itself off by 2⁻²⁴ of its size, a small part of a standard
    /// deviation.
    pub low: f32,
}

/// A walk along numbers of hits, up to the first of which more hits are not as likely as the uniform number says.
///
/// Both chances are times the factorial of the steps, so that no step divides; 20! is far from the largest f32.
#[derive(Clone, Copy, Debug)]
struct Walk {
    /// Chance of as many hits as steps.
    density: f32,
    /// Chance of more hits, less the uniform number.
    excess: f32,
    /// Hits so far.
    hits: f32,
}

/// Uniform number in (0, 1) of 32 random bits; small ones keep a resolution of 2⁻³².
pub fn unit_from_bits(bits: u32) -> f32 {
    // Words near the top round to 1, whose logarithm below would be infinite.
    ((bits as f32 + 0.5) * (1.0 / 4_294_967_296.0)).min(1.0 - f32::EPSILON / 2.0)
}

/// −log₂(1 − p) for p ≤ ½, to 4e-7 of itself: how often one trial halves the chance of no hit.
///
/// Terms go by pairs, which is a short chain of operations.
pub fn halvings(p: f32) -> f32 {
    // Powers of less would be subnormal numbers, which take a processor long and add nothing.
    let least = p.max(1e-9);
    let p2 = least * least;
    let high = (0.054_848_81 + p * 1.133_136_9) - p2 * (1.560_332_5 - p * 1.709_495);
    p * ((1.442_694_8 + p * 0.721_400_2) + p2 * ((0.478_776_57 + p * 0.392_774_4) + p2 * high))
}

/// Digits of x > 0: how often 1 is halved to less than 2x (less than 0 where it is doubled), and 1 − x times 2 to the power of that, which
/// is at most ½. −log₂ x is the first and the [`halvings`] of the second.
pub(super) fn digits(x: f32) -> [f32; 2] {
    let number = x.to_bits();
    let mantissa = f32::from_bits((number & 0x007f_ffff) | 0x3f00_0000);
    [126.0 - (number >> 23) as f32, 1.0 - mantissa]
}

/// Numerator and positive denominator of z with P(Z > z) = u for a standard normal Z, with y = −log₂(4u(1 − u)). z is off by at most
/// 3e-5 for u from 2⁻³³ to ½, and antisymmetric around ½.
pub(super) fn normal_upper_fraction(u: f32, y: f32) -> [f32; 2] {
    let y2 = y * y;
    // Terms by pairs, which is a shorter chain of operations.
    let over = (1.253_207_3 + y * 0.282_916_72) + y2 * ((0.035_295_784 + y * 2.842_739e-3) - y2 * 2.691_667_4e-5);
    let under = (1.0 + y * 0.043_911_94) + y2 * ((0.014_345_539 + y * 6.409_245_5e-5) - y2 * 1.822_928_8e-6);
    [(1.0 - 2.0 * u) * over, under]
}

/// 2^−y and 1 − 2^−y for y from 0 to 126, both to 6e-7 of themselves.
pub fn halved(y: f32) -> [f32; 2] {
    let whole = y.floor();
    let f = y - whole;
    let f2 = f * f;
    let scale = f32::from_bits(((127 - whole as i32) as u32) << 23);
    let series = (0.693_146_9 - f * 0.240_213_82) + f2 * ((0.055_404_34 - f * 9.337_599e-3) + f2 * 1.000_355_1e-3);
    let lost = f * scale * series;
    [scale - lost, (1.0 - scale) + lost]
}

/// `high` + `low`, both whole, as a count.
fn count_sum(high: f32, low: f32) -> Count {
    let sum = high + low;
    if sum <= EXACT_COUNT { Count { high: sum, low: 0.0 } } else { Count { high, low } }
}

/// A count, rounded to f32: all that a radiance in f32 can use.
pub fn count_value(count: Count) -> f32 {
    count.high + count.low
}

/// A count less a smaller one.
fn count_difference(a: Count, b: Count) -> Count {
    let high = a.high - b.high;
    // What rounding took from the line before, exactly, since a.high ≥ b.high.
    let rest = (a.high - high) - b.high;
    count_sum(high, rest + (a.low - b.low))
}

/// A whole number with mean `n`: ⌊n⌋, or ⌊n⌋ + 1 where the uniform number `word` is below n − ⌊n⌋. Negative `n` counts as 0.
pub fn whole_count(n: f32, word: f32) -> f32 {
    let positive = n.max(0.0);
    let whole = positive.floor();
    if word < positive - whole { whole + 1.0 } else { whole }
}

/// A walk's step from k to k + 1, with `left` = n − k.
fn walk_step(walk: Walk, left: f32, odds: f32, k: f32) -> Walk {
    let hits = walk.hits + if walk.excess > 0.0 { 1.0 } else { 0.0 };
    let density = walk.density * (left * odds);
    Walk { density, excess: walk.excess * (k + 1.0) - density, hits }
}

/// Hits k with P(hits > k) ≤ u of n trials with p ≤ ½, q = 1 − p, (1 − p)^n = 2^−y and np at most a few; exact up to [`WALK_STEPS`].
fn few_hits(n: f32, p: f32, q: f32, u: f32, y: f32) -> f32 {
    // q is 0 besides p where nothing is drawn.
    let odds = p / q.max(0.5);
    let [left, lost] = halved(y.min(MOST_HALVINGS));
    let mut walk = Walk { density: left, excess: lost - u, hits: 0.0 };
    let mut k = 0.0;
    for _ in 0..WALK_STEPS {
        if walk.excess <= 0.0 {
            break;
        }
        walk = walk_step(walk, n - k, odds, k);
        k += 1.0;
    }
    // Rounding may leave a rest of excess past the last trial.
    walk.hits.min(n)
}

/// What rounding took from a · b = `product`: both factors are split into halves whose products are exact.
fn product_rest(a: f32, b: f32, product: f32) -> f32 {
    let high = |x: f32| f32::from_bits(x.to_bits() & 0xffff_f000);
    let (a_high, b_high) = (high(a), high(b));
    let (a_low, b_low) = (a - a_high, b - b_high);
    ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
}

/// Hits k with P(hits > k) ≈ u of n trials with p ≤ ½, q = 1 − p, y = −log₂(4u(1 − u)) and np more than [`FEW`].
///
/// With z the normal quantile, σ² = npq, γ = q − p:
/// np + σz + γ(z² − 1)/6 + z [(1 − 6pq)(z² − 3)/24 − γ²(2z² − 5)/36 − 1/24] / σ, to the nearest whole number.
fn many_hits(n: Count, p: f32, q: f32, u: f32, y: f32) -> Count {
    let mean = n.high * p;
    // From np = 4e8 on, the rounding of np alone would show as a bias in ten million draws.
    let rest = product_rest(n.high, p, mean) + n.low * p;
    let sigma = ((mean + rest) * q).sqrt();
    let [over, under] = normal_upper_fraction(u, y);
    // z / σ: one division for both.
    let slope = over / (under * sigma);
    let z = slope * sigma;
    let z2 = z * z;
    // (1 − 6pq)(z² − 3)/24 − γ²(2z² − 5)/36 − 1/24 times 72, with γ² = 1 − 4pq.
    let third = p * q * (14.0 - 2.0 * z2) - (z2 + 2.0);
    let shift = sigma * z + (q - p) * (z2 - 1.0) * (1.0 / 6.0) + slope * third * (1.0 / 72.0);
    if mean < WHOLE {
        let small = (mean + (rest + shift)).round_ties_even().clamp(0.0, count_value(n));
        return Count { high: small, low: 0.0 };
    }
    // The mean is a whole number here, hundreds of σ from 0 and n; added to it in f32, the shift would be lost.
    count_sum(mean, (rest + shift).round_ties_even())
}

/// Hits and misses of `n` trials with hit chance `p`, from one uniform number `u` and `v` = 1 − u, each with all of its digits where it
/// is small; they add up to `n`. The hits are many where u is small, the misses where v is.
///
/// `n` ≥ 0 is at most 1e16, `p` and `q` = 1 − p are from 0 to 1 (to 1e-16); where both are 0, all hit. For equal `u` the hits grow with
/// `p`, and exchanging p with q and u with v exchanges the result.
pub fn whole_binomial(n: Count, p: f32, q: f32, u: f32, v: f32) -> [Count; 2] {
    let swapped = p >= q;
    let (rare, frequent) = if swapped { (q, p) } else { (p, q) };
    let word = if swapped { v } else { u };
    let value = count_value(n);
    let hits = if value * rare <= FEW {
        let walked = few_hits(value, rare, frequent, word, value * halvings(rare));
        Count { high: walked, low: 0.0 }
    } else {
        let [whole, rest] = digits(4.0 * u * v);
        many_hits(n, rare, frequent, word, whole + halvings(rest))
    };
    let misses = count_difference(n, hits);
    if swapped { [misses, hits] } else { [hits, misses] }
}

/// Hits and misses of any number `n` ≥ 0 of trials, from two random words: the first makes `n` whole ([`whole_count`]),
/// the second draws ([`whole_binomial`]).
///
/// Hits have mean np and variance npq + λ(1 − λ)p², λ = n − ⌊n⌋; they and the misses add up to the whole number.
pub fn binomial(n: f32, p: f32, q: f32, bits: [u32; 2]) -> [Count; 2] {
    let whole = Count { high: whole_count(n, unit_from_bits(bits[0])), low: 0.0 };
    whole_binomial(whole, p, q, unit_from_bits(bits[1]), unit_from_bits(!bits[1]))
}

/// A node of the tree: how many of `n` go left and right, with chances in proportion to the weights; many go right where `word`, a
/// uniform number above 0 and at most 1, is small.
fn split(n: Count, left: f32, right: f32, word: f32) -> [Count; 2] {
    // A node without weight has chances of 0, of which all go left.
    let share = 1.0 / (left + right).max(LEAST_WEIGHT);
    // A word of 1 has a logarithm, too.
    let u = (1.0 - word).max(LEAST_WORD);
    whole_binomial(n, left * share, right * share, u, word)
}

/// Leaves of the tree that holds `levels` levels: the next power of two, at most [`MAX_LEVELS`].
///
/// This is also how many random words [`multinomial`] reads.
pub fn tree_leaves(levels: usize) -> usize {
    levels.clamp(1, MAX_LEVELS).next_power_of_two()
}

/// How many of `n` ≥ 0 facets fall to each level, with chances in proportion to `weights`.
///
/// The first `levels` (1 to 16) weights count; they are finite, ≥ 0, and need not add up to 1. A level of weight 0 gets
/// no facet; if all are 0, level 0 gets them. `words` are uniform numbers above 0 and at most 1: word 0
/// makes `n` whole and is small where there is one facet more, words 1 to [`tree_leaves`] − 1 draw and are small where the right branch
/// gets more: node i has the children 2i and 2i + 1. Whole counts come back that add up to a whole number with mean `n` (`n`
/// itself where it is whole). Chances are quotients of f32 sums of weights: they are off by about 1e-7 of themselves,
/// which is a shift of the mean that exceeds the standard deviation of counts above 1e14.
pub fn multinomial(
    n: f32,
    weights: &[f32; MAX_LEVELS],
    levels: usize,
    words: &[f32; MAX_LEVELS],
) -> [Count; MAX_LEVELS] {
    let leaves = tree_leaves(levels);
    let mut weight = [0.0f32; 2 * MAX_LEVELS];
    for i in 0..levels.min(MAX_LEVELS) {
        weight[leaves + i] = weights[i].max(0.0);
    }
    for node in (1..leaves).rev() {
        weight[node] = weight[2 * node] + weight[2 * node + 1];
    }
    let mut count = [Count::default(); 2 * MAX_LEVELS];
    count[1] = Count { high: whole_count(n, words[0]), low: 0.0 };
    for node in 1..leaves {
        [count[2 * node], count[2 * node + 1]] =
            split(count[node], weight[2 * node], weight[2 * node + 1], words[node]);
    }
    let mut counts = [Count::default(); MAX_LEVELS];
    counts[..leaves].copy_from_slice(&count[leaves..2 * leaves]);
    counts
}
