//! The f64 reference against products, sums and closed forms that share nothing with it.

use glint_bake_core::counting::Count;
use glint_bake_core::counting::quality::{Outcome, SecondWord, compare, outcomes};
use glint_bake_core::counting::reference::ExactBinomial;

/// C(n, k) p^k (1 − p)^(n − k) by adding one trial after another.
fn by_trials(n: usize, p: f64) -> Vec<f64> {
    let mut chances = vec![1.0];
    for _ in 0..n {
        let mut next = vec![0.0; chances.len() + 1];
        for (k, chance) in chances.iter().enumerate() {
            next[k] += chance * (1.0 - p);
            next[k + 1] += chance * p;
        }
        chances = next;
    }
    chances
}

#[test]
fn densities_are_those_of_trial_after_trial() {
    for n in [0usize, 1, 2, 3, 7, 15, 16, 17, 40, 200] {
        for p in [0.0, 1e-6, 0.03, 0.3, 0.5, 0.9, 1.0 - 1e-6, 1.0] {
            let exact = ExactBinomial { trials: n as f64, p, q: 1.0 - p };
            for (k, chance) in by_trials(n, p).into_iter().enumerate() {
                let density = exact.density(k as f64);
                assert!((density - chance).abs() <= 1e-12 * chance + 1e-300, "{n} {p} {k}: {density:e} {chance:e}");
            }
        }
    }
}

#[test]
fn a_fractional_count_is_one_facet_that_may_be_missing() {
    for trials in [0.01, 0.7, 1.5, 2.25, 8.5, 30.9] {
        for p in [1e-3, 0.2, 0.5, 0.95, 1.0] {
            let exact = ExactBinomial { trials, p, q: 1.0 - p };
            let (low, share) = (trials.floor() as usize, trials - trials.floor());
            let (without, with) = (by_trials(low, p), by_trials(low + 1, p));
            let (mut mean, mut square) = (0.0, 0.0);
            for k in 0..=low + 1 {
                let chance = (1.0 - share) * without.get(k).copied().unwrap_or(0.0) + share * with[k];
                assert!((exact.density(k as f64) - chance).abs() < 1e-13);
                mean += k as f64 * chance;
                square += (k * k) as f64 * chance;
            }
            assert!((exact.mean() - mean).abs() < 1e-12 * mean.max(1.0));
            assert!((exact.variance() - (square - mean * mean)).abs() < 1e-11 * square.max(1.0));
        }
    }
}

#[test]
fn densities_of_many_trials_add_up() {
    for (trials, p) in [(1e6, 1e-6), (1e10, 3e-8), (1e16, 1e-16), (1e16, 2e-13), (1e8, 0.3), (1e12, 0.5), (1e15, 0.1)] {
        let exact = ExactBinomial { trials, p, q: 1.0 - p };
        let (mut sum, mut mean, mut square) = (0.0, 0.0, 0.0);
        for (k, chance) in exact.steps() {
            let d = k - exact.mean();
            sum += chance;
            mean += chance * d;
            square += chance * d * d;
        }
        let variance = exact.variance();
        assert!((sum - 1.0).abs() < 1e-6, "{trials:e} {p}: {sum}");
        assert!(mean.abs() < 1e-5 * variance.sqrt(), "{trials:e} {p}: {mean}");
        assert!((square / variance - 1.0).abs() < 1e-5, "{trials:e} {p}: {square} {variance}");
    }
}

#[test]
fn distribution_function_rises_to_one() {
    let exact = ExactBinomial { trials: 12.5, p: 0.3, q: 0.7 };
    assert!((exact.distribution(0.0) - exact.density(0.0)).abs() < 1e-16);
    assert!((exact.distribution(13.0) - 1.0).abs() < 1e-12);
    assert!(exact.distribution(13.0) - exact.distribution(12.0) > 0.0);
}

/// A draw whose distribution is known: gates at 2⁻²⁰ and ¾ of the first word, two halves of the second.
#[test]
fn outcomes_of_a_known_draw() {
    let draw = |[first, second]: [u32; 2]| {
        let hits = if first < 1 << 12 {
            9.0
        } else if first < 3 << 30 {
            if second < 1 << 31 { 5.0 } else { 4.0 }
        } else {
            0.0
        };
        [hits, 10.0 - hits].map(Count::from)
    };
    for second in [SecondWord::Bisected, SecondWord::Shares(8)] {
        let found = outcomes(draw, second);
        let weight = |hits: f64| found.iter().filter(|o| o.hits == hits).map(|o| o.weight).sum::<f64>();
        let rare = 2f64.powi(-20);
        assert!((weight(9.0) - rare).abs() < 1e-15);
        assert!((weight(5.0) - 0.5 * (0.75 - rare)).abs() < 1e-12);
        assert!((weight(4.0) - 0.5 * (0.75 - rare)).abs() < 1e-12);
        assert!((weight(0.0) - 0.25).abs() < 1e-12);
    }
}

/// One trial at p = ½ against a draw that always gives ½ hit: no error of the mean, no variance, and W₁ = ½.
#[test]
fn measures_of_a_known_draw() {
    let exact = ExactBinomial { trials: 1.0, p: 0.5, q: 0.5 };
    let q = compare(&[Outcome { hits: 0.5, misses: 0.75, weight: 1.0 }], &exact);
    assert!(q.mean_error.abs() < 1e-12 && q.relative_mean_error.abs() < 1e-12);
    assert!((q.variance_error + 1.0).abs() < 1e-12);
    assert!((q.wasserstein - 1.0).abs() < 1e-12);
    assert!((q.sum_error - 0.25).abs() < 1e-12);
    let right =
        outcomes(|[_, w]| (if w < 1 << 31 { [1.0, 0.0] } else { [0.0, 1.0] }).map(Count::from), SecondWord::Bisected);
    let q = compare(&right, &exact);
    assert!(q.mean_error == 0.0 && q.variance_error == 0.0 && q.wasserstein == 0.0 && q.sum_error == 0.0);
}
