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
