//! The unit disk of projected normals: how much of a lobe lies inside it.
//!
//! A normal close to the horizon carries a lobe of standard deviation σ_r whose tail would leave the disk. The NDF of a
//! single normal n is therefore the Gaussian divided by its mass inside the disk, so that it integrates to one.

/// Reciprocal mass inside the unit disk of an isotropic Gaussian at distance r from the centre, tabulated over r.
#[derive(Clone, Debug)]
pub struct LobeNorm {
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

/// Integral over the unit disk of a grid of quadratic-spline coefficients (zero outside the grid), texel (0, 0) at
/// `origin`. Whole cells around nodes are exact; cells on the rim are summed over 16² points.
pub fn spline_integral(values: &[f32], width: usize, height: usize, origin: [f64; 2], spacing: [f64; 2]) -> f64 {
    let texel = |i: i64, j: i64| {
        if i < 0 || j < 0 || i >= width as i64 || j >= height as i64 {
            0.0
        } else {
            values[j as usize * width + i as usize] as f64
        }
    };
    let far = |axis: usize, n: usize| {
        let reach = 1.5 * spacing[axis];
        (origin[axis] - reach).abs().max((origin[axis] + spacing[axis] * (n - 1) as f64 + reach).abs())
    };
    if far(0, width).hypot(far(1, height)) <= 1.0 {
        return values.iter().map(|v| *v as f64).sum::<f64>() * spacing[0] * spacing[1];
    }
    let mut total = 0.0;
    for j in -1..=height as i64 {
        for i in -1..=width as i64 {
            let middle = [origin[0] + spacing[0] * i as f64, origin[1] + spacing[1] * j as f64];
            total += cell_mean(|a, b| texel(i + a, j + b), middle, spacing);
        }
    }
    total * spacing[0] * spacing[1]
}

/// Mean of the spline surface times the disk's indicator over the cell around a node; `texel(a, b)` gives the
/// coefficients around it.
fn cell_mean(texel: impl Fn(i64, i64) -> f64, middle: [f64; 2], spacing: [f64; 2]) -> f64 {
    let (x, y) = (middle[0].abs(), middle[1].abs());
    let (hx, hy) = (0.5 * spacing[0], 0.5 * spacing[1]);
    if (x - hx).max(0.0).hypot((y - hy).max(0.0)) >= 1.0 {
        return 0.0;
    }
    let sum = |wx: [f64; 3], wy: [f64; 3]| {
        let row = |b: usize| (0..3).map(|a| wx[a] * texel(a as i64 - 1, b as i64 - 1)).sum::<f64>();
        wy[0] * row(0) + wy[1] * row(1) + wy[2] * row(2)
    };
    if (x + hx).hypot(y + hy) <= 1.0 {
        const WHOLE: [f64; 3] = [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0];
        return sum(WHOLE, WHOLE);
    }
    const SUB: usize = 16;
    let mut total = 0.0;
    for b in 0..SUB {
        let fy = (b as f64 + 0.5) / SUB as f64 - 0.5;
        for a in 0..SUB {
            let fx = (a as f64 + 0.5) / SUB as f64 - 0.5;
            if (middle[0] + fx * spacing[0]).hypot(middle[1] + fy * spacing[1]) <= 1.0 {
                let weights = |f: f64| [0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)];
                total += sum(weights(fx), weights(fy));
            }
        }
    }
    total / (SUB * SUB) as f64
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

    #[test]
    fn a_constant_grid_integrates_to_the_disk_s_area() {
        let n = 41;
        let values = vec![1.0f32; n * n];
        let integral = spline_integral(&values, n, n, [-1.0, -1.0], [0.05, 0.05]);
        assert!((integral - std::f64::consts::PI).abs() < 1e-3, "{integral}");
    }
}
