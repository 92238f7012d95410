//! Roughness of the convolution of two GGX lobes of normals.
//!
//! Paper: Tao et al. 2021, section 3.5, Eq. 6 and 7. The paper fits a polynomial to all of the square at once; it is not
//! symmetric, not exact when one roughness is 0, and off by up to 13 %. Deviation: a power sum, which is both, times a
//! correction for the curvature of the sphere, fitted to spherical convolutions in f64.

/// Exponent of the power sum.
pub const EXPONENT: f64 = 1.3021;
/// Correction 1 − `FIRST` ab + `SECOND` ab (a + b).
pub const FIRST: f64 = 0.3355;
/// See [`FIRST`].
pub const SECOND: f64 = 0.0255;

/// Roughness of the convolution of lobes of roughness a and b, both 0 to 1; at least the larger, at most 1. Symmetric; a
/// for b = 0.
pub fn convolve_alpha(a: f64, b: f64) -> f64 {
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    if small <= 0.0 || small.is_nan() {
        return large.clamp(0.0, 1.0);
    }
    let sum = large * libm::pow(1.0 + libm::pow(small / large, EXPONENT), 1.0 / EXPONENT);
    (sum * (1.0 - a * b * (FIRST - SECOND * (a + b)))).clamp(large.min(1.0), 1.0)
}
