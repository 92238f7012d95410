//! What a lobe keeps inside the disk.
//!
//! A normal close to the horizon carries a lobe of standard deviation σ_r whose tail would leave the disk of projected normals.
//! The NDF of a single normal n is therefore the Gaussian divided by its mass inside the disk, so that it integrates to one.

/// Reciprocal mass inside the unit disk of an isotropic Gaussian at distance r from the centre, tabulated over r.
#[derive(Clone, Debug)]
pub(super) struct LobeNorm {
    first_radius: f64,
    step: f64,
    table: Vec<f64>,
}

const ENTRIES: usize = 256;
/// Lobes whose centre is farther than this many standard deviations from the edge lose less than 1e-9 of their mass.
const REACH: f64 = 6.0;

impl LobeNorm {
    /// Table for lobes of standard deviation `sigma` (> 0).
    pub fn new(sigma: f64) -> LobeNorm {
        let first_radius = (1.0 - REACH * sigma).max(0.0);
        let step = (1.0 - first_radius) / (ENTRIES - 1) as f64;
        let table = (0..ENTRIES).map(|k| 1.0 / mass_in_disk(first_radius + step * k as f64, sigma)).collect();
        LobeNorm { first_radius, step, table }
    }

    /// 1 / mass at distance `radius` (0 … 1) from the centre of the disk.
    pub fn reciprocal_mass(&self, radius: f64) -> f64 {
        if radius <= self.first_radius && self.first_radius > 0.0 {
            return 1.0;
        }
        let p = ((radius.min(1.0) - self.first_radius) / self.step).max(0.0);
        let k = (p as usize).min(ENTRIES - 2);
        let f = p - k as f64;
        self.table[k] * (1.0 - f) + self.table[k + 1] * f
    }
}

/// Mass inside the unit disk of an isotropic Gaussian centred at (radius, 0): the chord at x carries
/// erf(√(1−x²) / (σ√2)) of the Gaussian's slice, integrated over x by Simpson's rule in x = sin t (smooth at the rim).
fn mass_in_disk(radius: f64, sigma: f64) -> f64 {
    const PANELS: usize = 512;
    let lo = libm::asin((radius - 8.0 * sigma).max(-1.0));
    let hi = libm::asin((radius + 8.0 * sigma).min(1.0));
    let h = (hi - lo) / PANELS as f64;
    let slice = |t: f64| {
        let (x, half_chord) = (libm::sin(t), libm::cos(t));
        let z = (x - radius) / sigma;
        let density = libm::exp(-0.5 * z * z) / (sigma * (2.0 * std::f64::consts::PI).sqrt());
        density * libm::erf(half_chord / (sigma * std::f64::consts::SQRT_2)) * half_chord
    };
    let mut sum = slice(lo) + slice(hi);
    for k in 1..PANELS {
        sum += slice(lo + h * k as f64) * if k % 2 == 1 { 4.0 } else { 2.0 };
    }
    sum * h / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_is_whole_inside_and_about_half_at_the_rim() {
        let norm = LobeNorm::new(0.01);
        assert_eq!(norm.reciprocal_mass(0.5), 1.0);
        // A straight edge would leave exactly half; the rim's curvature takes a little more.
        let at_rim = norm.reciprocal_mass(1.0);
        assert!(at_rim > 2.0 && at_rim < 2.02, "{at_rim}");
    }

    #[test]
    fn a_lobe_at_the_centre_has_the_rayleigh_mass() {
        for sigma in [0.3, 1.0] {
            let exact = 1.0 - libm::exp(-0.5 / (sigma * sigma));
            let got = 1.0 / LobeNorm::new(sigma).reciprocal_mass(0.0);
            assert!((got - exact).abs() < 1e-9, "{sigma}: {got} {exact}");
        }
    }
}
