//! What radiance is weighted with, and which roughness each mip has.
//!
//! Paper: section 3.4, p ∝ ρ̃(ω_i, ω_r) under N = V = R. With c the cosine between texel and light and t = 1 − c, the
//! half vector has cos² θ_h = 1 − t/2, and GGX becomes D ∝ 1 / (α² + (1 − α²) t/2)². Kernels here are 1 at t = 0 up to
//! the last factor:
//! - `Ndf`, the paper's: F, 4 and n·ω_o are constant, G is Smith's with both directions, whose view part is 1, so the
//!   weight is D · 2c / (c + √(c² + α² (1 − c²)));
//! - `GgxNl`, what engines and Filament's cmgen use: D · c.
//!
//! Roughness of a mip: Filament's mapping, perceptual roughness 1 − √(1 − mip / last), squared. The paper gives none.

use glint_formats::environment::Kernel;
use std::f64::consts::PI;

/// GGX roughness α of each of `mips` mips: 0 first, 1 last.
pub fn roughness_of_mips(mips: u32) -> Vec<f64> {
    let last = f64::from(mips.max(2) - 1);
    (0..mips).map(|mip| (1.0 - (1.0 - f64::from(mip) / last).sqrt()).powi(2)).collect()
}

/// A kernel at one roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Which.
    pub kernel: Kernel,
    /// α².
    pub a: f64,
    /// (1 − α²) / 2, so that D ∝ 1 / (a + b t)².
    pub b: f64,
    /// Integral of [`Lobe::weight`] over the sphere, in steradians.
    pub integral_sr: f64,
}

impl Lobe {
    /// The kernel at roughness α > 0.
    pub fn new(kernel: Kernel, alpha: f64) -> Lobe {
        let a = alpha * alpha;
        let mut lobe = Lobe { kernel, a, b: 0.5 * (1.0 - a), integral_sr: 0.0 };
        // x = ln(1 + (1 + b/a) t) spreads the peak evenly; Simpson's rule is then exact to about 1e-10.
        const STEPS: u32 = 4096;
        let stretch = 1.0 + lobe.b / a;
        let end = libm::log1p(stretch);
        let mut sum = 0.0;
        for k in 0..=STEPS {
            let grown = libm::exp(end * f64::from(k) / f64::from(STEPS));
            let t = ((grown - 1.0) / stretch).min(1.0);
            let simpson = if k == 0 || k == STEPS { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
            sum += simpson * lobe.weight(t) * grown / stretch;
        }
        lobe.integral_sr = 2.0 * PI * sum * end / (3.0 * f64::from(STEPS));
        lobe
    }

    /// Weight at t = 1 − cosine; 0 below the horizon.
    pub fn weight(&self, t: f64) -> f64 {
        let peak = self.a / (self.a + self.b * t);
        let c = 1.0 - t;
        if c <= 0.0 {
            return 0.0;
        }
        peak * peak
            * match self.kernel {
                Kernel::GgxNl => c,
                Kernel::Ndf => 2.0 * c / (c + (c * c + self.a * (1.0 - c * c)).sqrt()),
            }
    }
}
