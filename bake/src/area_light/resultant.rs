//! Mean resultant length of a GGX lobe of normals, and its inverse, both in terms of the deficit 1 − R.
//!
//! Paper: Tao et al. 2021, section 3.3, Eq. 3 to 5. The isotropic LTC of scale α is D_GGX(α) · cosθ, so Eq. 4 has the
//! closed form, with β² = 1 − α²,
//!
//! > R(α) = ∫ cos²θ D(θ) dω = (1 − α² atanh(β)/β) / β²,  and  1 − R = α² (atanh(β)/β − 1) / β².
//!
//! Deviations: the paper fits a rational function to the inverse (Eq. 5); here the closed form is inverted by Newton's
//! method. It works on the deficit 1 − R, which for α = 1e-3 is 7e-6: R itself would keep two digits of α in f32.

/// Deficit of a lobe of roughness 1, R = ⅔: the roughest that the method knows.
pub const MAX_DEFICIT: f64 = 1.0 / 3.0;

/// Terms of the series around β = 0, up to β² = ¼: what is left out is below 1e-17.
const SERIES_TERMS: u32 = 28;

/// (atanh(β)/β − 1) / β² for β² = 1 − α², and its derivative by β².
fn shape(alpha: f64) -> (f64, f64) {
    let b2 = (1.0 - alpha) * (1.0 + alpha);
    if b2 < 0.25 {
        // Σ β^2k / (2k + 3): the closed form cancels here.
        let (mut value, mut slope) = (0.0, 0.0);
        for k in (0..SERIES_TERMS).rev() {
            slope = slope * b2 + value;
            value = value * b2 + 1.0 / f64::from(2 * k + 3);
        }
        return (value, slope);
    }
    let b = b2.sqrt();
    let value = (libm::log((1.0 + b) / alpha) / b - 1.0) / b2;
    (value, (0.5 / (alpha * alpha) - 1.5 * value) / b2)
}

/// Deficit 1 − R of a lobe of roughness α. 0 at α = 0, [`MAX_DEFICIT`] at α = 1 and above.
pub fn deficit_from_alpha(alpha: f64) -> f64 {
    if alpha >= 1.0 {
        return MAX_DEFICIT;
    }
    if alpha > 0.0 { alpha * alpha * shape(alpha).0 } else { 0.0 }
}

/// Roughness α of a lobe of deficit 1 − R: 0 for deficits of 0 and below, 1 for [`MAX_DEFICIT`] and above.
pub fn alpha_from_deficit(deficit: f64) -> f64 {
    if deficit >= MAX_DEFICIT {
        return 1.0;
    }
    if deficit <= 0.0 || deficit.is_nan() {
        return 0.0;
    }
    // ln(1 − R) is nearly straight in ln α, so Newton's method on logarithms ends after a few steps.
    let target = libm::log(deficit);
    let mut log_alpha = 0.5 * (target - libm::log(MAX_DEFICIT));
    for _ in 0..12 {
        let alpha = libm::exp(log_alpha.min(0.0));
        let (value, slope) = shape(alpha);
        let log_deficit = 2.0 * log_alpha.min(0.0) + libm::log(value);
        // d ln(1 − R) / d ln α, with d(β²)/dα = −2α.
        let rate = 2.0 - 2.0 * alpha * alpha * slope / value;
        let step = (target - log_deficit) / rate;
        log_alpha = log_alpha.min(0.0) + step;
        if step.abs() < 1e-15 {
            break;
        }
    }
    libm::exp(log_alpha).min(1.0)
}
