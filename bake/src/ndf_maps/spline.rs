//! Quadratic B-splines, which densities are interpolated with: the least-squares fit to samples, and the integral over the disk.
//!
//! At equal error their texels may lie farther apart than those of bilinear interpolation, for nine reads instead of four.

use multiversion::multiversion;

/// The spline at distance `x` ≥ 0 from its centre, in node distances.
fn spline_at(x: f32) -> f32 {
    if x < 0.5 {
        0.75 - x * x
    } else if x < 1.5 {
        0.5 * (1.5 - x) * (1.5 - x)
    } else {
        0.0
    }
}

/// Least-squares fit along one axis with splines `step` ≥ 1 samples apart.
///
/// Both the samples' projections and the normal equations (a matrix with two diagonals on either side, factored by
/// Cholesky) are the same for every line, so lines are treated `lanes` at a time: element k of lane l lies at
/// k · lanes + l. Samples beyond the last one count as zero.
pub(super) struct Fit {
    step: usize,
    taps: Vec<f32>,
    /// Lower factor: diagonal's reciprocal, first and second subdiagonal.
    factor: Vec<[f32; 3]>,
}

impl Fit {
    /// Fit of `samples` samples; gives [`Fit::nodes`] coefficients.
    pub fn new(samples: usize, step: usize) -> Fit {
        let nodes = (samples - 1).div_ceil(step) + 1;
        let reach = (3 * step - 1) / 2;
        let taps: Vec<f32> = (0..=reach).map(|k| spline_at(k as f32 / step as f32)).collect();
        let product = |distance: i64| {
            let mut sum = 0.0f32;
            for k in -(reach as i64)..=reach as i64 {
                let other = (k - distance * step as i64).unsigned_abs() as usize;
                if other <= reach {
                    sum += taps[k.unsigned_abs() as usize] * taps[other];
                }
            }
            sum
        };
        let (own, next, second_next) = (product(0), product(1), product(2));
        let mut factor: Vec<[f32; 3]> = Vec::with_capacity(nodes);
        for k in 0..nodes {
            let second = if k >= 2 { second_next * factor[k - 2][0] } else { 0.0 };
            let shared = if k >= 2 { second * factor[k - 1][1] } else { 0.0 };
            let first = if k >= 1 { (next - shared) * factor[k - 1][0] } else { 0.0 };
            factor.push([1.0 / (own - first * first - second * second).sqrt(), first, second]);
        }
        Fit { step, taps, factor }
    }

    /// Number of coefficients.
    pub fn nodes(&self) -> usize {
        self.factor.len()
    }

    /// Fits all lanes.
    pub fn solve(&self, samples: &[f32], lanes: usize) -> Vec<f32> {
        solve(self, samples, lanes)
    }
}

#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn solve(fit: &Fit, samples: &[f32], lanes: usize) -> Vec<f32> {
    let count = samples.len() / lanes;
    let nodes = fit.nodes();
    let reach = fit.taps.len() - 1;
    let mut out = vec![0.0f32; nodes * lanes];
    for k in 0..nodes {
        let centre = k * fit.step;
        let (done, rest) = out.split_at_mut(k * lanes);
        let row = &mut rest[..lanes];
        for at in centre.saturating_sub(reach)..=(centre + reach).min(count - 1) {
            add_scaled(row, &samples[at * lanes..(at + 1) * lanes], fit.taps[at.abs_diff(centre)]);
        }
        let [reciprocal, first, second] = fit.factor[k];
        if k >= 1 {
            add_scaled(row, &done[(k - 1) * lanes..], -first);
        }
        if k >= 2 {
            add_scaled(row, &done[(k - 2) * lanes..(k - 1) * lanes], -second);
        }
        row.iter_mut().for_each(|v| *v *= reciprocal);
    }
    for k in (0..nodes).rev() {
        let (head, tail) = out.split_at_mut((k + 1) * lanes);
        let row = &mut head[k * lanes..];
        if k + 1 < nodes {
            add_scaled(row, &tail[..lanes], -fit.factor[k + 1][1]);
        }
        if k + 2 < nodes {
            add_scaled(row, &tail[lanes..2 * lanes], -fit.factor[k + 2][2]);
        }
        row.iter_mut().for_each(|v| *v *= fit.factor[k][0]);
    }
    out
}

/// target += factor · source, element by element; inlined, so that it has the vectors of its caller.
#[inline(always)]
pub(super) fn add_scaled(target: &mut [f32], source: &[f32], factor: f32) {
    for (t, s) in target.iter_mut().zip(source) {
        *t += factor * s;
    }
}

/// Integral over the unit disk of a grid of quadratic-spline coefficients (zero outside the grid), texel (0, 0) at
/// `origin`. Whole cells around nodes are exact; cells on the rim are summed over 16² points.
pub(super) fn spline_integral(values: &[f32], width: usize, height: usize, origin: [f64; 2], spacing: [f64; 2]) -> f64 {
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
    fn a_spline_is_fitted_by_itself() {
        for step in 2..=6 {
            let (node, nodes) = (4, 9);
            let samples: Vec<f32> =
                (0..=step * (nodes - 1)).map(|k| spline_at((k as f32 / step as f32 - node as f32).abs())).collect();
            let fit = Fit::new(samples.len(), step);
            assert_eq!(fit.nodes(), nodes);
            let out = fit.solve(&samples, 1);
            for (k, v) in out.iter().enumerate() {
                let expected = if k == node { 1.0 } else { 0.0 };
                assert!((v - expected).abs() < 1e-4, "step {step}, node {k}: {v}");
            }
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
