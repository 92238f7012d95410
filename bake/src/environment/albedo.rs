//! Directional albedo E_ρ, visible reflecting area E_D and mean square ⟨ρ²⟩ of GGX, over view angle and roughness.
//!
//! Paper: Eq. 11 and 21. All are integrals over half vectors h with dω_i = 4 (h·ω_o) dh:
//!
//! - E_D = ∫ D(h) [n·ω_i > 0] dh. A facet at θ_h reflects to above the horizon for azimuths with
//!   cos φ > (cos θ_o / (2 cos θ_h) − cos θ_h cos θ_o) / (sin θ_h sin θ_o), so the integral over azimuth is an arc.
//! - E_ρ = ∫ F G₂ (h·ω_o) / (n·ω_o) D(h) dh over the same facets, G₂ Smith's height-correlated. Schlick's Fresnel factor
//!   F₀ + (1 − F₀)(1 − h·ω_o)⁵ splits it into F₀ R + G.
//! - ⟨ρ²⟩ = D_H ∫ (F G₂ (h·ω_o) / (n·ω_o))² D(h) dh, the mean square of what a facet adds under even light, where E_ρ is the mean. The
//!   paper has none: it takes all E_D/D_H facets that reflect as equally bright. As many equally bright facets as have both
//!   moments are the share (E_ρ)²/⟨ρ²⟩ of all, at most E_D/D_H by Cauchy and Schwarz.
//!
//! Facets are integrated over x = ln(1 + tan² θ_h/α²), in which GGX's tails are even. Up to θ_h = (π/2 − θ_o)/2 all
//! azimuths are visible, beyond (π/2 + θ_o)/2 none; between, the arc has square-root ends, which a cosine smooths.

use std::f64::consts::{FRAC_PI_2, PI};

/// Weights and nodes on (−1, 1) of Gauss quadrature with 16 points, the positive half.
const GAUSS16: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_87),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_78),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_89),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_095),
];

/// Calls `f` with every node and weight of Gauss quadrature over a range.
fn gauss(low: f64, high: f64, mut f: impl FnMut(f64, f64)) {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    for (node, weight) in GAUSS16 {
        f(middle - half * node, half * weight);
        f(middle + half * node, half * weight);
    }
}

/// Whole facet area of unit surface, D_H = 1 + α² atanh(β)/β, β = √(1 − α²).
pub fn facet_area(alpha: f64) -> f64 {
    1.0 + alpha * alpha * atanh_over(alpha)
}

/// Facet area that reflects to above the horizon at normal incidence, where θ_h < π/4.
pub fn reflecting_area_at_normal(alpha: f64) -> f64 {
    let a = alpha * alpha;
    let beta = (1.0 - a).max(0.0).sqrt();
    let c = std::f64::consts::FRAC_1_SQRT_2;
    let tilted = if beta < 1e-4 { c * (1.0 + beta * beta * c * c / 3.0) } else { libm::atanh(beta * c) / beta };
    facet_area(alpha) - a * (c / (1.0 - beta * beta * c * c) + tilted)
}

fn atanh_over(alpha: f64) -> f64 {
    let beta = (1.0 - alpha * alpha).max(0.0).sqrt();
    if beta < 1e-4 {
        1.0 + beta * beta / 3.0
    } else {
        // atanh(β) = ln((1 + β)/α), which keeps its digits at small α.
        libm::log((1.0 + beta) / alpha) / beta
    }
}

/// What an entry of the table has of areas: albedo is F₀ · `scale` + `bias`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Areas {
    /// Factor of F₀.
    pub scale: f64,
    /// Albedo at F₀ = 0.
    pub bias: f64,
    /// Visible reflecting area E_D.
    pub reflecting: f64,
    /// Whole facet area D_H.
    pub whole: f64,
    /// ⟨ρ²⟩ = F₀² · first + 2 F₀ · second + third.
    pub squares: [f64; 3],
}

impl Areas {
    /// ⟨ρ²⟩/(E_ρ)² of the part of F₀, of both parts crossed, and of the part that is there at F₀ = 0. With x = F₀ `scale` / (F₀ `scale` +
    /// `bias`) that of both together is first · x² + 2 · second · x (1 − x) + third · (1 − x)².
    pub fn dispersion(&self) -> [f64; 3] {
        let [scale, crossed, bias] = self.squares;
        [scale / (self.scale * self.scale), crossed / (self.scale * self.bias), bias / (self.bias * self.bias)]
    }
}

/// The areas at one view cosine and roughness, both above 0.
pub fn areas(cos_o: f64, alpha: f64) -> Areas {
    let a = alpha * alpha;
    let sin_o = (1.0 - cos_o * cos_o).max(0.0).sqrt();
    let whole = facet_area(alpha);
    let mut sum = Areas { whole, ..Areas::default() };
    let mut add = |x: f64, weight: f64| {
        let grown = libm::exp(x);
        let tangent2 = a * (grown - 1.0);
        let cos_h = 1.0 / (1.0 + tangent2).sqrt();
        let sin_h = tangent2.sqrt() * cos_h;
        // D sin θ_h dθ_h = dx / (2π grown cos θ_h).
        let facets = weight / (2.0 * PI * grown * cos_h);
        let arc = visible_arc(cos_o, sin_o, cos_h, sin_h);
        sum.reflecting += 2.0 * arc * facets;
        gauss(0.0, arc, |phi, weight| {
            let oh = sin_h * sin_o * libm::cos(phi) + cos_h * cos_o;
            let cos_i = 2.0 * oh * cos_h - cos_o;
            if cos_i > 0.0 && oh > 0.0 {
                let part = 2.0 * weight * facets;
                let schlick = (1.0 - oh).max(0.0).powi(5);
                let facet = masking(cos_o, cos_i, a) * oh / cos_o;
                let [scale, bias] = [1.0 - schlick, schlick].map(|fresnel| facet * fresnel);
                sum.scale += part * scale;
                sum.bias += part * bias;
                for (sum, square) in sum.squares.iter_mut().zip([scale * scale, scale * bias, bias * bias]) {
                    *sum += whole * part * square;
                }
            }
        });
    };
    let x_of = |theta: f64| libm::log1p(libm::tan(theta).powi(2) / a);
    let theta_o = libm::acos(cos_o);
    let [first, last] = [FRAC_PI_2 - theta_o, FRAC_PI_2 + theta_o].map(|twice| x_of(0.5 * twice));
    gauss(0.0, 0.5 * first, &mut add);
    gauss(0.5 * first, first, &mut add);
    gauss(0.0, PI, |psi, weight| {
        let half = 0.5 * (last - first);
        add(first + half * (1.0 - libm::cos(psi)), weight * half * libm::sin(psi));
    });
    sum
}

/// Largest azimuth, 0 to π, at which a facet reflects to above the horizon.
fn visible_arc(cos_o: f64, sin_o: f64, cos_h: f64, sin_h: f64) -> f64 {
    let needed = 0.5 * cos_o / cos_h - cos_h * cos_o;
    let reach = sin_h * sin_o;
    if reach <= needed.abs() {
        return if needed > 0.0 { 0.0 } else { PI };
    }
    FRAC_PI_2 - libm::asin(needed / reach)
}

/// Smith's height-correlated masking and shadowing.
pub(super) fn masking(cos_o: f64, cos_i: f64, a: f64) -> f64 {
    let term = |c: f64| (a + (1.0 - a) * c * c).sqrt();
    2.0 * cos_o * cos_i / (cos_o * term(cos_i) + cos_i * term(cos_o))
}
