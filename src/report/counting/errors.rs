//! Errors of a draw over the grid of places that the report goes through.

use super::variants::Variant;
use glint_bake_core::counting::eval::FEW;
use glint_bake_core::counting::quality::{CountingQuality, SecondWord, compare, outcomes};
use glint_bake_core::counting::reference::ExactBinomial;

/// Trials of the grid.
pub const TRIALS: [f32; 24] = [
    0.01, 0.3, 0.9, 1.0, 1.5, 2.0, 2.5, 3.0, 5.0, 8.0, 8.5, 11.0, 13.0, 16.0, 64.0, 300.0, 1e3, 1e4, 1e6, 1e8, 1e10,
    1e12, 1e14, 1e16,
];

/// (p, q) of the grid for n trials: fixed ones and fixed expected counts, each also exchanged; expected counts from
/// 1e-7.
pub fn chances(n: f32) -> Vec<(f32, f32)> {
    let mut rare = vec![1e-16, 1e-12, 1e-9, 1e-7, 1e-5, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5];
    for count in
        [1e-6, 1e-3, 0.1, 0.5, 1.0, 1.45, 2.0, 2.1, 3.0, 4.1, 5.1, 0.99 * FEW, 1.01 * FEW, 8.1, 12.1, 20.0, 100.0]
    {
        rare.push(count / n);
    }
    rare.retain(|p| *p <= 0.5 && n * p >= 1e-7);
    rare.into_iter().flat_map(|p| [(p, 1.0 - p), (1.0 - p, p)]).collect()
}

/// Errors of a draw at one place.
pub fn measure_draw(variant: &Variant, n: f32, p: f32, q: f32) -> (CountingQuality, ExactBinomial) {
    let exact = ExactBinomial::of_f32(n, p, q);
    let bisected = variant.whole && exact.variance() < 4e4;
    let second = if bisected { SecondWord::Bisected } else { SecondWord::Shares(1 << 14) };
    (compare(&outcomes(|bits| (variant.draw)(n, p, q, bits), second), &exact), exact)
}

/// Worst figures over places.
#[derive(Clone, Copy, Default)]
pub struct Worst {
    pub mean: f64,
    pub relative_mean: f64,
    pub variance: f64,
    pub core_variance: f64,
    pub wasserstein: f64,
}

impl Worst {
    pub fn add(&mut self, found: &CountingQuality, exact: &ExactBinomial) {
        let worse = |old: f64, new: f64| if new.abs() > old.abs() { new } else { old };
        let expected = exact.trials * exact.p.min(exact.q);
        self.mean = worse(self.mean, found.mean_error);
        if expected >= 0.01 {
            self.relative_mean = worse(self.relative_mean, found.relative_mean_error);
            self.variance = worse(self.variance, found.variance_error);
        }
        if exact.trials >= 8.0 && expected >= 0.5 {
            self.core_variance = worse(self.core_variance, found.variance_error);
        }
        self.wasserstein = worse(self.wasserstein, found.wasserstein);
    }

    /// Its cells in a table with the columns of [`WORST_COLUMNS`].
    pub fn cells(&self) -> String {
        format!(
            "{:+.1e} | {:+.2} % | {:+.2} % | {:+.2} % | {:.4}",
            self.mean,
            100.0 * self.relative_mean,
            100.0 * self.variance,
            100.0 * self.core_variance,
            self.wasserstein
        )
    }
}

/// Columns of the worst figures.
pub const WORST_COLUMNS: &str = "mean, σ | mean, relative | variance | variance, core | W₁/σ";
