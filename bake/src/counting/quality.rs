//! The distribution that a draw of two random words really has, by going through the words instead of drawing them.
//!
//! A draw is a step function of its words. Steps in the first word are found by bisection, so gates as rare as 2⁻³² are
//! weighed exactly; the second word is either bisected as well (counts that are whole and few) or sampled at
//! the middles of equal shares. Mean, variance and Wasserstein distance of the very f32 code follow without the
//! noise of random draws.

use super::eval::Count;
use super::reference::ExactBinomial;

/// One outcome of a draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Hits n.
    pub hits: f64,
    /// Misses n̄.
    pub misses: f64,
    /// Probability.
    pub weight: f64,
}

/// How the second word is gone through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SecondWord {
    /// By bisection: hits fall monotonously with the word, in whole steps.
    Bisected,
    /// At the middles of this many equal shares.
    Shares(u32),
}

impl From<f32> for Count {
    fn from(whole: f32) -> Count {
        Count { high: whole, low: 0.0 }
    }
}

impl From<Count> for f64 {
    fn from(count: Count) -> f64 {
        f64::from(count.high) + f64::from(count.low)
    }
}

/// Words and how many of them up to the next change of `value`, over all 2³² words; `value` must not return to what it
/// left.
fn constant_runs(value: &impl Fn(u32) -> [f64; 2]) -> Vec<([f64; 2], u64)> {
    let mut runs = Vec::new();
    let (mut start, end) = (0u64, 1u64 << 32);
    let last = value(u32::MAX);
    while start < end {
        let here = value(start as u32);
        if here == last {
            runs.push((here, end - start));
            break;
        }
        let (mut same, mut other) = (start, end - 1);
        while other - same > 1 {
            let middle = (same + other) / 2;
            if value(middle as u32) == here { same = middle } else { other = middle }
        }
        runs.push((here, other - start));
        start = other;
    }
    runs
}

/// All outcomes of `draw`, whose hits must not grow with the first word.
pub fn outcomes(draw: impl Fn([u32; 2]) -> [Count; 2], second: SecondWord) -> Vec<Outcome> {
    let draw = |bits| draw(bits).map(f64::from);
    let whole = (1u64 << 32) as f64;
    let mut all = Vec::new();
    let mut start = 0u64;
    for (_, words) in constant_runs(&|word| draw([word, 1 << 31])) {
        let first = (start + words / 2) as u32;
        start += words;
        let mut push = |[hits, misses]: [f64; 2], share: f64| {
            let weight = share * words as f64 / whole;
            all.push(Outcome { hits, misses, weight });
        };
        match second {
            SecondWord::Bisected => {
                for (value, count) in constant_runs(&|word| draw([first, word])) {
                    push(value, count as f64 / whole);
                }
            }
            SecondWord::Shares(shares) => {
                for i in 0..shares {
                    let word = (f64::from(i) + 0.5) / f64::from(shares) * whole;
                    push(draw([first, word as u32]), 1.0 / f64::from(shares));
                }
            }
        }
    }
    all
}

/// What a draw is measured by, on the rarer of its two outcomes: of N = 1e16 trials, f64 holds 3 misses but not N − 3
/// hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountingQuality {
    /// (mean − exact mean) / σ with the exact σ of the rarer count.
    pub mean_error: f64,
    /// mean / exact mean − 1.
    pub relative_mean_error: f64,
    /// Variance over the exact one, less 1.
    pub variance_error: f64,
    /// Wasserstein distance W₁ over σ.
    pub wasserstein: f64,
    /// (mean of n + n̄ − N) / N.
    pub sum_error: f64,
}

/// Holds the outcomes of a draw against the exact distribution.
pub fn compare(outcomes: &[Outcome], exact: &ExactBinomial) -> CountingQuality {
    let exchanged = exact.p > exact.q;
    let rarer = |o: &Outcome| if exchanged { o.misses } else { o.hits };
    let exact = if exchanged { exact.exchanged() } else { *exact };
    let (mean, sigma) = (exact.mean(), exact.variance().sqrt());
    let (mut shift, mut square, mut sum) = (0.0, 0.0, 0.0);
    for o in outcomes {
        shift += o.weight * (rarer(o) - mean);
        square += o.weight * (rarer(o) - mean) * (rarer(o) - mean);
        sum += o.weight * (o.hits + o.misses - exact.trials);
    }
    CountingQuality {
        mean_error: shift / sigma,
        relative_mean_error: shift / mean,
        variance_error: (square - shift * shift) / exact.variance() - 1.0,
        wasserstein: wasserstein(outcomes.iter().map(|o| (rarer(o), o.weight)).collect(), &exact) / sigma,
        sum_error: sum / exact.trials,
    }
}

/// W₁ = ∫ |F − G| of two distribution functions; `changes` starts as the values of one with their probabilities.
fn wasserstein(mut changes: Vec<(f64, f64)>, exact: &ExactBinomial) -> f64 {
    changes.extend(exact.steps().into_iter().map(|(k, density)| (k, -density)));
    changes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut difference, mut distance) = (0.0f64, 0.0);
    for pair in changes.windows(2) {
        difference += pair[0].1;
        distance += difference.abs() * (pair[1].0 - pair[0].0);
    }
    distance
}
