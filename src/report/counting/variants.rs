//! Ways to draw a binomial number that were tried, in f32: the paper's gates and what mends them, and where to switch
//! from the exact walk to which expansion.

use glint_bake_core::counting::eval::{binomial, unit_from_bits, whole_count};
use glint_bake_core::counting::paper::normal_upper_quantile;
use glint_bake_core::counting::pow1m::{one_minus_pow1m, pow1m};
use glint_bake_core::counting::{Count, paper};

/// Hits and misses of n trials with chance p, q = 1 − p, from two words.
pub type Draw = fn(f32, f32, f32, [u32; 2]) -> [Count; 2];

/// One row of the front.
pub struct Variant {
    /// What it is.
    pub name: &'static str,
    /// The draw.
    pub draw: Draw,
    /// Counts are whole and fall monotonously with the second word.
    pub whole: bool,
}

/// The paper's draw first, ours second.
pub fn variants() -> Vec<Variant> {
    let row = |name, draw, whole| Variant { name, draw, whole };
    vec![
        row("paper", |n, p, _, bits| paper::binomial(n, p, bits).map(Count::from), false),
        row("**ours**", binomial, true),
        row("paper's gates, stable powers", gated::<0>, false),
        row("… and the Gaussian moved to the right mean", gated::<1>, false),
        row("two gates a side, conditional mean and variance, moved", gated::<2>, false),
        row("rounded Gaussian alone", switched::<0, 0, false>, true),
        row("walk to 6, then rounded Gaussian", switched::<6, 0, false>, true),
        row("walk to 2, then expansion to first order", switched::<2, 1, false>, true),
        row("walk to 4, then expansion to first order", switched::<4, 1, false>, true),
        row("walk to 6, then expansion to first order", switched::<6, 1, false>, true),
        row("walk to 4, then expansion to second order", switched::<4, 2, false>, true),
        row("walk to 5, then expansion to second order", switched::<5, 2, false>, true),
        row("walk to 6, then expansion to second order", switched::<6, 2, false>, true),
        row("… and both ways computed every time", switched::<6, 2, true>, true),
        row("walk to 8, then expansion to second order", switched::<8, 2, false>, true),
        row("walk to 12, then expansion to second order", switched::<12, 2, false>, true),
    ]
}

/// The walk of `binomial::few_hits` with another number of steps.
fn walk(n: f32, p: f32, q: f32, u: f32, steps: u32) -> f32 {
    let odds = p / q;
    let (mut density, mut more) = (pow1m(p, q, n), one_minus_pow1m(p, q, n));
    let mut k = 0.0f32;
    for _ in 0..steps {
        if u >= more {
            break;
        }
        density *= (n - k) * odds / (k + 1.0);
        more -= density;
        k += 1.0;
    }
    k.min(n)
}

/// Rounded Cornish–Fisher expansion to an order: 0 is the Gaussian, 1 adds skewness and the variance of rounding, 2
/// kurtosis.
fn expansion(n: f32, p: f32, q: f32, u: f32, order: u32) -> f32 {
    let (mean, skew) = (n * p, q - p);
    let variance = mean * q;
    let z = normal_upper_quantile(u);
    let z2 = z * z;
    let hits = match order {
        0 => mean + variance.sqrt() * z,
        1 => mean + ((variance - 1.0 / 12.0).max(0.0).sqrt() * z + skew * (z2 - 1.0) / 6.0),
        _ => {
            let sigma = variance.sqrt();
            let third = (1.0 - 6.0 * p * q) * (z2 - 3.0) / 24.0 - skew * skew * (2.0 * z2 - 5.0) / 36.0;
            mean + (sigma * z + skew * (z2 - 1.0) / 6.0 + z * (third - 1.0 / 24.0) / sigma)
        }
    };
    hits.round_ties_even().clamp(0.0, n)
}

/// Walk where at most `FEW` of the rarer outcome are expected, expansion to `ORDER` beyond; `BOTH` computes both each
/// time, as lanes of a GPU do when their neighbours go the other way.
fn switched<const FEW: u32, const ORDER: u32, const BOTH: bool>(n: f32, p: f32, q: f32, bits: [u32; 2]) -> [Count; 2] {
    let n = whole_count(n, unit_from_bits(bits[0]));
    let swapped = p > q;
    let (rare, common) = if swapped { (q, p) } else { (p, q) };
    let u = unit_from_bits(if swapped { !bits[1] } else { bits[1] });
    let few = n * rare <= FEW as f32;
    // Twenty steps at 6, in proportion to the spread elsewhere.
    let steps = FEW + (5.7 * (FEW as f32).sqrt()).ceil() as u32;
    let hits = if BOTH {
        let walked =
            std::hint::black_box(walk(n, rare.min(FEW as f32 / n), common.max(1.0 - FEW as f32 / n), u, steps));
        let expanded = std::hint::black_box(expansion(n, rare, common, u, ORDER));
        if few { walked } else { expanded }
    } else if few && FEW > 0 {
        walk(n, rare, common, u, steps)
    } else {
        expansion(n, rare, common, u, ORDER)
    };
    (if swapped { [n - hits, hits] } else { [hits, n - hits] }).map(Count::from)
}

/// φ(x).
fn normal_density(x: f32) -> f32 {
    0.398_942_3 * (-0.5 * x * x).exp()
}

/// Φ(x) by Abramowitz and Stegun 7.1.26, absolute error 1.5e-7.
fn normal_distribution(x: f32) -> f32 {
    let h = x.abs() * std::f32::consts::FRAC_1_SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * h);
    let poly = t * (0.254_829_6 + t * (-0.284_496_74 + t * (1.421_413_7 + t * (-1.453_152_1 + t * 1.061_405_4))));
    let tail = 0.5 * poly * (-h * h).exp();
    if x < 0.0 { tail } else { 1.0 - tail }
}

/// Gaussian clamped to [lo, hi], then stretched from one end so that its mean becomes `wanted`.
fn moved_gaussian(mean: f32, sigma: f32, lo: f32, hi: f32, wanted: f32, z: f32) -> f32 {
    let value = (mean + sigma * z).clamp(lo, hi);
    let (a, b) = ((lo - mean) / sigma.max(1e-6), (hi - mean) / sigma.max(1e-6));
    let (below, to_b) = (normal_distribution(a), normal_distribution(b));
    let clamped =
        lo * below + hi * (1.0 - to_b) + mean * (to_b - below) + sigma * (normal_density(a) - normal_density(b));
    let wanted = wanted.clamp(lo, hi);
    if wanted <= clamped {
        lo + (value - lo) * (wanted - lo) / (clamped - lo).max(1e-9)
    } else {
        hi - (hi - value) * (hi - wanted) / (hi - clamped).max(1e-9)
    }
}

/// Gates as in the paper with powers that hold, on the rarer outcome. `KIND` 0: the paper's Gaussian; 1: moved to the
/// mean that E[n] = Np asks for; 2: from N = 4 on, gates for one hit and one miss too, and a Gaussian of the rest's
/// mean and variance, moved.
fn gated<const KIND: u32>(n: f32, p: f32, q: f32, bits: [u32; 2]) -> [Count; 2] {
    gated_counts::<KIND>(n, p, q, bits).map(Count::from)
}

fn gated_counts<const KIND: u32>(n: f32, p: f32, q: f32, bits: [u32; 2]) -> [f32; 2] {
    if n <= 2.0 {
        return paper::binomial(n, p, bits);
    }
    if p > q {
        let [misses, hits] = gated_counts::<KIND>(n, q, p, [!bits[0], !bits[1]]);
        return [hits, misses];
    }
    let gate = unit_from_bits(bits[0]);
    let z = normal_upper_quantile(unit_from_bits(bits[1]));
    let (some, all) = (one_minus_pow1m(p, q, n), pow1m(q, p, n));
    if gate < all {
        return [n, 0.0];
    }
    if gate >= some {
        return [0.0, n];
    }
    let rest = (some - all).max(f32::MIN_POSITIVE);
    let spread = ((n - 2.0) * p * q).sqrt();
    let hits = match KIND {
        0 => (1.0 + (n - 2.0) * p + spread * z).clamp(1.0, n - 1.0),
        2 if n >= 4.0 => {
            let one = n * p * pow1m(p, q, n - 1.0);
            let one_missed = n * q * pow1m(q, p, n - 1.0);
            if gate < all + one_missed {
                return [n - 1.0, 1.0];
            }
            if gate >= some - one {
                return [1.0, n - 1.0];
            }
            let rest = rest - one - one_missed;
            // Less has lost its digits, and is two hits nearly always.
            if rest < 1e-4 {
                return [2.0, n - 2.0];
            }
            let mean = (n * p - one - (n - 1.0) * one_missed - n * all) / rest;
            let square = |x: f32| (x - n * p) * (x - n * p);
            let outside =
                (1.0 - some) * square(0.0) + one * square(1.0) + one_missed * square(n - 1.0) + all * square(n);
            let variance = ((n * p * q - outside) / rest - square(mean)).max(0.0);
            let mean = mean.clamp(2.0, n - 2.0);
            moved_gaussian(mean, variance.sqrt(), 2.0, n - 2.0, mean, z)
        }
        _ => moved_gaussian(1.0 + (n - 2.0) * p, spread, 1.0, n - 1.0, n * (p - all) / rest, z),
    };
    [hits, n - hits]
}
