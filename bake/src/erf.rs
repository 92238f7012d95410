//! The error function at run time.

/// erf(x) by Abramowitz and Stegun 7.1.26: absolute error 1.5e-7 before rounding, one exponential.
pub fn erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let poly = t * (0.254_829_6 + t * (-0.284_496_74 + t * (1.421_413_7 + t * (-1.453_152_1 + t * 1.061_405_4))));
    (1.0 - poly * (-x * x).exp()).copysign(x)
}

#[cfg(test)]
mod tests {
    #[test]
    fn absolute_error() {
        for k in -600..=600 {
            let x = k as f32 * 0.01;
            assert!((f64::from(super::erf(x)) - libm::erf(f64::from(x))).abs() < 6e-7, "{x}");
        }
    }
}
