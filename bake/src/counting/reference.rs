//! The binomial distribution in f64 from its definition, for any real number of trials ≥ 0.
//!
//! N facets lie in a footprint: ⌊N⌋ of them and one more with probability λ = N − ⌊N⌋. Each reflects with chance p. So
//! P_N(k) = (1 − λ) C(⌊N⌋, k) p^k q^(⌊N⌋ − k) + λ C(⌊N⌋ + 1, k) p^k q^(⌊N⌋ + 1 − k), mean Np, variance
//! Npq + λ(1 − λ)p². Below N = 2 this is the paper's own definition (Kneiphof and Klein 2025, figure 4). For N to 1e16 the binomial
//! coefficients are written by what factorials exceed Stirling's formula by, so that large logarithms never cancel.

use libm::{exp, lgamma, log, log1p, sqrt};
use std::f64::consts::PI;

/// Distribution of the hits of `trials` facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactBinomial {
    /// N ≥ 0.
    pub trials: f64,
    /// Chance of a hit, 0 to 1.
    pub p: f64,
    /// 1 − p, given by itself where p is near 1.
    pub q: f64,
}

/// ln(n!) less Stirling's (n + ½) ln n − n + ½ ln 2π, for whole n ≥ 1.
fn stirling_excess(n: f64) -> f64 {
    if n < 16.0 {
        return lgamma(n + 1.0) - (n + 0.5) * log(n) + n - 0.5 * log(2.0 * PI);
    }
    let square = n * n;
    (1.0 / 12.0 - (1.0 / 360.0 - (1.0 / 1260.0 - 1.0 / (1680.0 * square)) / square) / square) / n
}

/// x ln(x / m) − x + m for x, m > 0, without cancellation where x is near m.
fn deviance(x: f64, m: f64) -> f64 {
    let v = (x - m) / (x + m);
    if v.abs() > 0.1 {
        return x * log(x / m) - x + m;
    }
    // ln(x/m) = 2 (v + v³/3 + v⁵/5 + …)
    let (mut power, mut sum) = (v * v * v, 0.0);
    for term in 1..12 {
        sum += power / (2 * term + 1) as f64;
        power *= v * v;
    }
    (x - m) * v + 2.0 * x * sum
}

/// P(k hits of n whole trials).
fn whole_density(n: f64, p: f64, q: f64, k: f64) -> f64 {
    if k < 0.0 || k > n || (p == 0.0 && k > 0.0) || (q == 0.0 && k < n) {
        return 0.0;
    }
    let log_power = |x: f64, complement: f64, n: f64| {
        if n == 0.0 {
            0.0
        } else if complement < 0.5 {
            n * log1p(-complement)
        } else {
            n * log(x)
        }
    };
    if k == 0.0 {
        return exp(log_power(q, p, n));
    }
    if k == n {
        return exp(log_power(p, q, n));
    }
    let excess = stirling_excess(n) - stirling_excess(k) - stirling_excess(n - k);
    let exponent = excess - deviance(k, n * p) - deviance(n - k, n * q);
    exp(exponent) * sqrt(n / (2.0 * PI * k * (n - k)))
}

impl ExactBinomial {
    /// The distribution that f32 arguments mean: the smaller of `p` and `q` is exact, the other its complement.
    pub fn of_f32(trials: f32, p: f32, q: f32) -> ExactBinomial {
        let (p, q) = (f64::from(p), f64::from(q));
        let (p, q) = if p <= q { (p, 1.0 - p) } else { (1.0 - q, q) };
        ExactBinomial { trials: f64::from(trials), p, q }
    }

    /// λ = N − ⌊N⌋.
    fn fraction(&self) -> f64 {
        self.trials - self.trials.floor()
    }

    /// P(k hits), k whole.
    pub fn density(&self, k: f64) -> f64 {
        let (floor, fraction) = (self.trials.floor(), self.fraction());
        let low = whole_density(floor, self.p, self.q, k);
        if fraction == 0.0 {
            return low;
        }
        (1.0 - fraction) * low + fraction * whole_density(floor + 1.0, self.p, self.q, k)
    }

    /// P(at most k hits), by adding up.
    pub fn distribution(&self, k: f64) -> f64 {
        let mut sum = 0.0;
        let mut i = 0.0;
        while i <= k {
            sum += self.density(i);
            i += 1.0;
        }
        sum
    }

    /// The same trials with hits and misses exchanged.
    pub fn exchanged(&self) -> ExactBinomial {
        ExactBinomial { p: self.q, q: self.p, ..*self }
    }

    /// E = Np.
    pub fn mean(&self) -> f64 {
        self.trials * self.p
    }

    /// Npq + λ(1 − λ)p².
    pub fn variance(&self) -> f64 {
        let fraction = self.fraction();
        self.trials * self.p * self.q + fraction * (1.0 - fraction) * self.p * self.p
    }

    /// Counts in ascending order with their probabilities, over 12 standard deviations and more either side of the
    /// mean.
    ///
    /// Where the standard deviation is above 512, one count stands for the few around it (a 512th of it). The mean is
    /// at most 2⁵², so that counts are told apart; exchange p and q if it is not.
    pub fn steps(&self) -> Vec<(f64, f64)> {
        let sigma = sqrt(self.variance());
        let stride = (sigma / 512.0).floor().max(1.0);
        let reach = 12.0 * sigma + 40.0;
        let first = (self.mean() - reach).floor().max(0.0);
        let last = (self.mean() + reach).ceil().min(self.trials.ceil());
        let count = ((last - first) / stride).floor() as u64;
        let at = |i| first + i as f64 * stride;
        (0..=count).map(|i| (at(i), self.density(at(i)) * stride)).collect()
    }
}
