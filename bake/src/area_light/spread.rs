//! Roughness α of a set of normals about their mean: the GGX lobe that concentrates as they do.
//!
//! Paper: Tao et al. 2021, section 3.3, takes α from the length of the averaged normal alone ([`alpha_from_deficit`]). That
//! is the second moment of the distribution, and GGX has none in slopes: its length is ruled by its tail, that of a real
//! map by its core. The same length belongs to α = .064 of GGX and to .14 of Beckmann. Deviation: what is matched is
//!
//! > C = E[κ² / (κ² + r²)],  r the slope of a normal against the mean,
//!
//! the share of normals near the mean as seen through a blur of width [`KAPPA`], which is what a highlight is made of.
//! It is bounded, so no tail rules it. Both forms below follow from the distribution of r under GGX, whose share within
//! r is r² / (r² + α²), and of one component x, whose density is (1 + x²/α²)^(−3/2) / (2α).
//!
//! Beside it stand, in f64, what engines need that have no such roughness: the mean resultant length of a lobe and its inverse,
//! both in terms of the deficit 1 − R, and the convolution of two lobes.
//!
//! Paper: section 3.3, Eq. 3 to 5. The isotropic LTC of scale α is D_GGX(α) · cosθ, so Eq. 4 has the closed form, with
//! β² = 1 − α²,
//!
//! > R(α) = ∫ cos²θ D(θ) dω = (1 − α² atanh(β)/β) / β²,  and  1 − R = α² (atanh(β)/β − 1) / β².
//!
//! Deviations: the paper fits a rational function to the inverse (Eq. 5); here the closed form is inverted by Newton's
//! method. It works on the deficit 1 − R, which for α = 1e-3 is 7e-6: R itself would keep two digits of α in f32.
//!
//! Section 3.5, Eq. 6 and 7, fits a polynomial to the convolution over all of the square at once; it is not symmetric, not exact
//! when one roughness is 0, and off by up to 13 %. Deviation: a power sum, which is both, times a correction for the curvature
//! of the sphere, fitted to spherical convolutions in f64.

/// Width κ of the blur, in slope: about that of a base lobe under a light of ten degrees. From 0.1 to 0.2 results differ
/// little; narrower prefers peaks that no light resolves, wider the tails.
pub const KAPPA: f64 = 0.12;

/// Concentration E[κ²/(κ²+r²)] of GGX: with q = α²/κ², 1/(1−q) + q ln q / (1−q)².
pub fn concentration(alpha: f64) -> f64 {
    let q = alpha * alpha / (KAPPA * KAPPA);
    if q <= 0.0 {
        return 1.0;
    }
    let p = 1.0 - q;
    if p.abs() < 0.05 {
        // Σ pᵏ / ((k+1)(k+2)).
        return (0..12).rev().fold(0.0, |sum, k| sum * p + 1.0 / (f64::from(k + 1) * f64::from(k + 2)));
    }
    1.0 / p + q * libm::log(q) / (p * p)
}

/// Concentration E[κ²/(κ²+x²)] of one component of GGX: ∫₀¹ (1 − s²) / (1 − (1 − q) s²) ds.
pub fn axis_concentration(alpha: f64) -> f64 {
    let p = 1.0 - alpha * alpha / (KAPPA * KAPPA);
    if p.abs() < 0.05 {
        // Σ pᵏ · 2 / ((2k+1)(2k+3)).
        return (0..12).rev().fold(0.0, |sum, k| sum * p + 2.0 / (f64::from(2 * k + 1) * f64::from(2 * k + 3)));
    }
    if p >= 1.0 {
        return 1.0;
    }
    let root = p.abs().sqrt();
    let arc = if p > 0.0 { libm::atanh(root) } else { libm::atan(root) };
    1.0 / p + (1.0 - 1.0 / p) * arc / root
}

/// Power of the code that textures hold, see [`code_of`].
pub const CODE_POWER: f64 = 1.4;

/// What textures hold for a roughness: t / (1 + t) with t = (α/κ)^1.4, 0 to 0.952. It follows 1 − C within 0.02, and C is
/// a mean over normals; so a linear look-up between texels finds the roughness of both together. Its inverse is one power,
/// and it is 0, with all digits of a half float, where normals agree.
pub fn code_of(alpha: f64) -> f64 {
    let t = libm::pow(alpha / KAPPA, CODE_POWER);
    t / (1.0 + t)
}

/// The inverse of a concentration, by table: one is needed for every texel.
pub struct AlphaOf {
    /// Concentrations of α = exp(−`STEP` · k), rising.
    concentrations: Vec<f64>,
}

/// Distance of the table's entries in ln α; between them α is off by 1e-6 of itself at most.
const STEP: f64 = 1.0 / 512.0;
/// Least roughness of the table, e^−12 or 6e-6, is far below what any format stores.
const ENTRIES: usize = 12 * 512 + 1;

impl AlphaOf {
    /// The inverse of `of_alpha`, which falls with α.
    pub fn new(of_alpha: fn(f64) -> f64) -> AlphaOf {
        AlphaOf { concentrations: (0..ENTRIES).map(|k| of_alpha(libm::exp(-STEP * k as f64))).collect() }
    }

    /// Roughness α, 0 to 1, of a concentration.
    pub fn get(&self, concentration: f64) -> f64 {
        let k = self.concentrations.partition_point(|&found| found < concentration);
        if k == 0 {
            return 1.0;
        }
        if k == ENTRIES {
            return 0.0;
        }
        let (low, high) = (self.concentrations[k - 1], self.concentrations[k]);
        let t = (concentration - low) / (high - low);
        libm::exp(-STEP * ((k - 1) as f64 + t))
    }
}

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

/// Exponent of the power sum.
pub const EXPONENT: f64 = 1.3021;
/// Correction 1 − `FIRST` ab + `SECOND` ab (a + b).
pub const FIRST: f64 = 0.3355;
/// The other number of that correction.
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
