//! (1 − p)^N and its complement in f32, for N from 0 to 1e16 and p from 0 to 1.
//!
//! Paper: Kneiphof and Klein 2025, section 6, Eq. 24 and 25. Deviation: the paper replaces (1 − p)^N by
//! (1 − cp)^(N/c), which is off by 8e-5. Here it is exp(−N · L) with L = −log(1 − p) from p itself where p ≤ ½,
//! L = 2 atanh(p / (2 − p)), and from q = 1 − p where p > ½. Both are given by the caller, so that neither end loses
//! digits and p^N is `pow1m(q, p, n)`. A shader's log may be off by 2⁻²¹ between ½ and 2; it is never asked there.
//!
//! Draws take powers of 2 instead ([`halved`](super::eval::halved)); these forms are what a draw could rest on with the functions
//! that a device has, and the report holds them against the paper's.

/// The elementary functions that WGSL leaves to the device, so that tests can put its worst case in their place.
pub trait Elementary {
    /// Natural logarithm of x > 0.
    fn log(&self, x: f32) -> f32;
    /// Exponential.
    fn exp(&self, x: f32) -> f32;
    /// a / b.
    fn divide(&self, a: f32, b: f32) -> f32;
}

/// The elementary functions of this processor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Native;

impl Elementary for Native {
    fn log(&self, x: f32) -> f32 {
        x.ln()
    }

    fn exp(&self, x: f32) -> f32 {
        x.exp()
    }

    fn divide(&self, a: f32, b: f32) -> f32 {
        a / b
    }
}

/// Elementary functions that are off by all that WGSL allows, in a fixed direction each: 1 up, −1 down, 0 exact.
///
/// WGSL, section "Accuracy of Concrete Floating Point Expressions", f32: log is off by at most 2⁻²¹ between ½ and 2 and
/// by 3 units in the last place elsewhere, exp by 3 + 2|x| units, division by 2.5 units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastExact {
    /// Direction of log's error.
    pub log: f64,
    /// Direction of exp's error.
    pub exp: f64,
    /// Direction of division's error.
    pub divide: f64,
}

impl LeastExact {
    /// All combinations of directions.
    pub fn all() -> Vec<LeastExact> {
        let directions = [-1.0, 0.0, 1.0];
        let mut all = Vec::new();
        for log in directions {
            for exp in directions {
                for divide in directions {
                    all.push(LeastExact { log, exp, divide });
                }
            }
        }
        all
    }
}

/// Distance of neighbouring f32 around x.
fn unit_in_last_place(x: f64) -> f64 {
    let exponent = libm::floor(libm::log2(x.abs().max(f64::from(f32::MIN_POSITIVE))));
    libm::exp2(exponent - 23.0)
}

impl Elementary for LeastExact {
    fn log(&self, x: f32) -> f32 {
        let exact = libm::log(f64::from(x));
        let error = if (0.5..=2.0).contains(&x) { libm::exp2(-21.0) } else { 3.0 * unit_in_last_place(exact) };
        (exact + self.log * error) as f32
    }

    fn exp(&self, x: f32) -> f32 {
        let exact = libm::exp(f64::from(x));
        let error = (3.0 + 2.0 * f64::from(x.abs())) * unit_in_last_place(exact);
        (exact + self.exp * error) as f32
    }

    fn divide(&self, a: f32, b: f32) -> f32 {
        let exact = f64::from(a) / f64::from(b);
        (exact + self.divide * 2.5 * unit_in_last_place(exact)) as f32
    }
}

/// Smallest normal f32: a logarithm of less would be left to the device.
const LEAST: f32 = f32::MIN_POSITIVE;

/// Largest exponent whose exponential a device need not flush to zero.
const LARGEST_EXPONENT: f32 = 87.0;

/// −log(1 − p) to a few units in the last place; at most 88. `p` and `q` = 1 − p are from 0 to 1.
fn negative_log1m(math: &impl Elementary, p: f32, q: f32) -> f32 {
    if p > 0.5 {
        return -math.log(q.max(LEAST));
    }
    let s = math.divide(p, 1.0 + q);
    let t = s * s;
    // 2 atanh(s), s ≤ ⅓: the first term left out is below 2e-9 of the sum.
    let series = 1.0 / 9.0 + t * (1.0 / 11.0 + t * (1.0 / 13.0 + t * (1.0 / 15.0)));
    2.0 * s * (1.0 + t * (1.0 / 3.0 + t * (1.0 / 5.0 + t * (1.0 / 7.0 + t * series))))
}

/// (1 − p)^n with the given elementary functions; see [`pow1m()`].
pub fn pow1m_with(math: &impl Elementary, p: f32, q: f32, n: f32) -> f32 {
    math.exp(-(n * negative_log1m(math, p, q)).min(LARGEST_EXPONENT))
}

/// (1 − p)^n, off by at most 5e-7 even with the least exact log, exp and division that WGSL allows.
///
/// `p` and `q` = 1 − p are from 0 to 1, `n` ≥ 0. p^n is `pow1m(q, p, n)`. 0^0 is 1.
pub fn pow1m(p: f32, q: f32, n: f32) -> f32 {
    pow1m_with(&Native, p, q, n)
}

/// 1 − (1 − p)^n with the given elementary functions; see [`one_minus_pow1m()`].
pub fn one_minus_pow1m_with(math: &impl Elementary, p: f32, q: f32, n: f32) -> f32 {
    one_minus_exp(math, (n * negative_log1m(math, p, q)).min(LARGEST_EXPONENT))
}

/// 1 − exp(−x) for x ≥ 0, with a small *relative* error where it is small.
pub fn one_minus_exp(math: &impl Elementary, x: f32) -> f32 {
    if x >= 0.5 {
        return 1.0 - math.exp(-x);
    }
    // 1 − exp(−x) by its series, which keeps the digits of small x.
    let series = 1.0 / 24.0 - x * (1.0 / 120.0 - x * (1.0 / 720.0 - x * (1.0 / 5040.0)));
    x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x * series)))
}

/// 1 − (1 − p)^n, the chance of at least one hit, with a small *relative* error where it is small.
///
/// Arguments as of [`pow1m()`].
pub fn one_minus_pow1m(p: f32, q: f32, n: f32) -> f32 {
    one_minus_pow1m_with(&Native, p, q, n)
}
