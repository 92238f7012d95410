//! Whole numbers to 1e16 in two f32: a count, and what rounding would take from it.
//!
//! At 1e16 neighbouring f32 are 2³⁰ apart and the standard deviation of a count is up to 5·10⁷, so one f32 cannot show
//! that it varies. The paper (Kneiphof and Klein 2025, section 6) has one. Differences of counts keep what they round off as
//! Dekker's do (1971, "A floating-point technique for extending the available precision"); a compiler must not
//! reassociate them.

use std::ops::Sub;

/// Whole numbers up to here are exact in one f32.
const EXACT: f32 = 16_777_216.0;

/// A whole number `high` + `low`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Count {
    /// The number; rounded, where it is above 2²⁴.
    pub high: f32,
    /// What is missing, which may be negative; 0 up to 2²⁴. Itself off by 2⁻²⁴ of its size, a small part of a standard
    /// deviation.
    pub low: f32,
}

impl Count {
    /// `high` + `low`, both whole, as a count.
    pub fn new(high: f32, low: f32) -> Count {
        let sum = high + low;
        if sum <= EXACT { Count { high: sum, low: 0.0 } } else { Count { high, low } }
    }

    /// The number, rounded to f32: all that a radiance in f32 can use.
    pub fn value(self) -> f32 {
        self.high + self.low
    }
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

impl Sub for Count {
    type Output = Count;

    /// Of a count and a smaller one.
    fn sub(self, other: Count) -> Count {
        let high = self.high - other.high;
        // What rounding took from the line above, exactly, since self.high ≥ other.high.
        let rest = (self.high - high) - other.high;
        Count::new(high, rest + (self.low - other.low))
    }
}
