//! (1 − p)^N and its complement in f32, for N from 0 to 1e16 and p from 0 to 1.
//!
//! Paper: Kneiphof and Klein 2025, section 6, Eq. 24 and 25. Deviation: the paper replaces (1 − p)^N by
//! (1 − cp)^(N/c), which is off by 8e-5. Here it is exp(−N · L) with L = −log(1 − p) from p itself where p ≤ ½,
//! L = 2 atanh(p / (2 − p)), and from q = 1 − p where p > ½. Both are given by the caller, so that neither end loses
//! digits and p^N is `pow1m(q, p, n)`. A shader's log may be off by 2⁻²¹ between ½ and 2; it is never asked there.
//!
//! Draws themselves take them by powers of 2, where the exponent of an f32 does half of the work: [`halvings`] and [`halved`]
//! are polynomials for p ≤ ½ alone, without a function that WGSL leaves to the device.

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
pub fn digits(x: f32) -> [f32; 2] {
    let bits = x.to_bits();
    let mantissa = f32::from_bits((bits & 0x007f_ffff) | 0x3f00_0000);
    [126.0 - (bits >> 23) as f32, 1.0 - mantissa]
}

/// Most halvings whose power is a normal number.
pub const MOST_HALVINGS: f32 = 125.0;

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

/// 1 − (1 − p)^n, the chance of at least one hit, with a small *relative* error where it is small.
///
/// Arguments as of [`pow1m()`].
pub fn one_minus_pow1m(p: f32, q: f32, n: f32) -> f32 {
    one_minus_pow1m_with(&Native, p, q, n)
}
