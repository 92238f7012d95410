//! Roughness α of a set of normals about their mean: the GGX lobe that concentrates as they do.
//!
//! Paper: Tao et al. 2021, section 3.3, takes α from the length of the averaged normal alone ([`super::resultant`]). That
//! is the second moment of the distribution, and GGX has none in slopes: its length is ruled by its tail, that of a real
//! map by its core. The same length belongs to α = .064 of GGX and to .14 of Beckmann. Deviation: what is matched is
//!
//! > C = E[κ² / (κ² + r²)],  r the slope of a normal against the mean,
//!
//! the share of normals near the mean as seen through a blur of width [`KAPPA`], which is what a highlight is made of.
//! It is bounded, so no tail rules it. Both forms below follow from the distribution of r under GGX, whose share within
//! r is r² / (r² + α²), and of one component x, whose density is (1 + x²/α²)^(−3/2) / (2α).

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

/// Roughness α, 0 to 1, of a concentration.
pub fn alpha_of(concentration: f64, of_alpha: fn(f64) -> f64) -> f64 {
    if !(concentration < 1.0) {
        return 0.0;
    }
    if concentration <= of_alpha(1.0) {
        return 1.0;
    }
    // Bisection in ln α, which is monotonic and needs no derivative; 1e-6 is far below what any format stores.
    let (mut low, mut high) = (libm::log(1e-6), 0.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if of_alpha(libm::exp(middle)) > concentration {
            low = middle;
        } else {
            high = middle;
        }
    }
    let alpha = libm::exp(0.5 * (low + high));
    if alpha <= 2e-6 { 0.0 } else { alpha }
}
