//! The least exact elementary functions that WGSL allows, for tests and reports.
//!
//! WGSL, section "Accuracy of Concrete Floating Point Expressions", f32: log is off by at most 2⁻²¹ between ½ and 2 and
//! by 3 units in the last place elsewhere, exp by 3 + 2|x| units, division by 2.5 units.

use super::pow1m::Elementary;

/// Elementary functions that are off by all that WGSL allows, in a fixed direction each: 1 up, −1 down, 0 exact.
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
