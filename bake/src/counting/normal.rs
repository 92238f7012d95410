//! Uniform and normal numbers from random words, f32, as in WGSL.
//!
//! The paper (algorithm 1, line 18) asks for the inverse of the normal distribution function and leaves its
//! computation open. The form x · P(w), w = −log(4u(1 − u)), is that of Giles 2010, "Approximating the erfinv
//! function". Here P is one quotient of polynomials, fitted to uniforms of 32 bits, and the logarithm, to the base 2, is the
//! polynomial that powers take: a shader that computes both finds them for the price of one.

use super::pow1m::{digits, halvings};

/// Uniform number in (0, 1) of 32 random bits; small ones keep a resolution of 2⁻³².
pub fn unit_from_bits(bits: u32) -> f32 {
    // Words near the top round to 1, whose logarithm below would be infinite.
    ((bits as f32 + 0.5) * (1.0 / 4_294_967_296.0)).min(1.0 - f32::EPSILON / 2.0)
}

/// A uniform number in (0, 1) and 1 less it, each with all of its digits where it is small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uniform {
    /// The number.
    pub number: f32,
    /// 1 less it.
    pub rest: f32,
}

/// Words are taken as at least this, half a step of 32 random bits.
const LEAST_WORD: f32 = 0.5 / 4_294_967_296.0;

impl Uniform {
    /// Of 32 random bits; `!bits` exchange the number and its rest.
    pub fn from_bits(bits: u32) -> Uniform {
        Uniform { number: unit_from_bits(bits), rest: unit_from_bits(!bits) }
    }

    /// The number that is large where `rest`, from above 0 to 1, is small.
    pub fn from_rest(rest: f32) -> Uniform {
        Uniform { number: (1.0 - rest).max(LEAST_WORD), rest }
    }

    /// 1 less the number.
    pub fn exchanged(self) -> Uniform {
        Uniform { number: self.rest, rest: self.number }
    }
}

/// Numerator and positive denominator of z with P(Z > z) = u for a standard normal Z. z is off by at most 3e-5 for u from 2⁻³³
/// to ½, and antisymmetric around ½.
pub fn normal_upper_fraction(u: Uniform) -> [f32; 2] {
    let [whole, rest] = digits(4.0 * u.number * u.rest);
    let y = whole + halvings(rest);
    let y2 = y * y;
    // Terms by pairs, which is a shorter chain of operations.
    let over = (1.253_207_3 + y * 0.282_916_72) + y2 * ((0.035_295_784 + y * 2.842_739e-3) - y2 * 2.691_667_4e-5);
    let under = (1.0 + y * 0.043_911_94) + y2 * ((0.014_345_539 + y * 6.409_245_5e-5) - y2 * 1.822_928_8e-6);
    [(1.0 - 2.0 * u.number) * over, under]
}

/// z itself for 0 < u < 1, see [`normal_upper_fraction`].
pub fn normal_upper_quantile(u: f32) -> f32 {
    let [over, under] = normal_upper_fraction(Uniform { number: u, rest: 1.0 - u });
    over / under
}
