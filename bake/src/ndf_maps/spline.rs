//! Quadratic B-splines: what densities are interpolated with, and the least-squares fit to samples.
//!
//! At equal error their texels may lie farther apart than those of bilinear interpolation, for nine reads instead of four.

/// The three splines that reach a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taps {
    /// Index of the first.
    pub first: i32,
    /// Their values; they sum to 1.
    pub weights: [f32; 3],
}

impl Taps {
    /// Splines at `p`, in node distances from node 0.
    pub fn at(p: f32) -> Taps {
        let middle = (p + 0.5).floor();
        let f = p - middle;
        let weights = [0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)];
        Taps { first: middle as i32 - 1, weights }
    }
}

/// The spline at distance `x` ≥ 0 from its centre, in node distances.
fn spline(x: f32) -> f32 {
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
pub struct Fit {
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
        let taps: Vec<f32> = (0..=reach).map(|k| spline(k as f32 / step as f32)).collect();
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
        let count = samples.len() / lanes;
        let nodes = self.nodes();
        let reach = self.taps.len() - 1;
        let mut out = vec![0.0f32; nodes * lanes];
        for k in 0..nodes {
            let centre = k * self.step;
            let (done, rest) = out.split_at_mut(k * lanes);
            let row = &mut rest[..lanes];
            for at in centre.saturating_sub(reach)..=(centre + reach).min(count - 1) {
                add_scaled(row, &samples[at * lanes..(at + 1) * lanes], self.taps[at.abs_diff(centre)]);
            }
            let [reciprocal, first, second] = self.factor[k];
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
                add_scaled(row, &tail[..lanes], -self.factor[k + 1][1]);
            }
            if k + 2 < nodes {
                add_scaled(row, &tail[lanes..2 * lanes], -self.factor[k + 2][2]);
            }
            row.iter_mut().for_each(|v| *v *= self.factor[k][0]);
        }
        out
    }
}

/// target += factor · source, element by element.
pub fn add_scaled(target: &mut [f32], source: &[f32], factor: f32) {
    for (t, s) in target.iter_mut().zip(source) {
        *t += factor * s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taps_sum_to_one_and_meet_at_cell_borders() {
        for k in 0..50 {
            let p = k as f32 * 0.173 - 2.0;
            assert!((Taps::at(p).weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
        let (below, above) = (Taps::at(0.499_999), Taps::at(0.500_001));
        assert!((below.weights[1] - above.weights[0]).abs() < 1e-5);
    }

    #[test]
    fn a_spline_is_fitted_by_itself() {
        for step in 2..=6 {
            let (node, nodes) = (4, 9);
            let samples: Vec<f32> =
                (0..=step * (nodes - 1)).map(|k| spline((k as f32 / step as f32 - node as f32).abs())).collect();
            let fit = Fit::new(samples.len(), step);
            assert_eq!(fit.nodes(), nodes);
            let out = fit.solve(&samples, 1);
            for (k, v) in out.iter().enumerate() {
                let expected = if k == node { 1.0 } else { 0.0 };
                assert!((v - expected).abs() < 1e-4, "step {step}, node {k}: {v}");
            }
        }
    }
}
