//! Hats, which roots of densities are interpolated with: the least-squares fit to samples, and the integral of the square over the
//! disk.

use multiversion::multiversion;

/// Least-squares fit along one axis with hats `step` ≥ 1 samples apart, each 1 at its node and 0 at its neighbours.
///
/// Both the samples' projections and the normal equations (a matrix with one diagonal on either side, factored by
/// Cholesky) are the same for every line, so lines are treated `lanes` at a time: element k of lane l lies at
/// k · lanes + l. Samples beyond the last one count as zero.
pub(super) struct Fit {
    step: usize,
    taps: Vec<f32>,
    /// Lower factor: diagonal's reciprocal, subdiagonal.
    factor: Vec<[f32; 2]>,
}

impl Fit {
    /// Fit of `samples` samples; gives [`Fit::nodes`] coefficients.
    pub fn new(samples: usize, step: usize) -> Fit {
        let nodes = (samples - 1).div_ceil(step) + 1;
        let taps: Vec<f32> = (0..step).map(|k| 1.0 - k as f32 / step as f32).collect();
        let own = taps[0] * taps[0] + 2.0 * taps[1..].iter().map(|v| v * v).sum::<f32>();
        let next: f32 = (1..step).map(|k| taps[k] * taps[step - k]).sum();
        let mut factor: Vec<[f32; 2]> = Vec::with_capacity(nodes);
        for k in 0..nodes {
            let below = if k >= 1 { next * factor[k - 1][0] } else { 0.0 };
            factor.push([1.0 / (own - below * below).sqrt(), below]);
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
        let [reciprocal, below] = fit.factor[k];
        if k >= 1 {
            add_scaled(row, &done[(k - 1) * lanes..], -below);
        }
        row.iter_mut().for_each(|v| *v *= reciprocal);
    }
    for k in (0..nodes).rev() {
        let (head, tail) = out.split_at_mut((k + 1) * lanes);
        let row = &mut head[k * lanes..];
        if k + 1 < nodes {
            add_scaled(row, &tail[..lanes], -fit.factor[k + 1][1]);
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

/// Integral over the unit disk of the square of a grid of roots, bilinear between texels and zero outside the grid; texel (0, 0) at
/// `origin`. Whole cells are exact (docs/methods/ndf-maps.md, *Roots*); those on the rim are summed over 16² points.
pub(super) fn square_integral(roots: &[f32], width: usize, height: usize, origin: [f64; 2], spacing: [f64; 2]) -> f64 {
    let far = |axis: usize, count: usize| {
        let [low, high] = [-1.0, count as f64].map(|k| (origin[axis] + spacing[axis] * k).abs());
        low.max(high)
    };
    if far(0, width).powi(2) + far(1, height).powi(2) <= 1.0 {
        return whole_square_integral(roots, width) * spacing[0] * spacing[1];
    }
    let texel = |i: i64, j: i64| {
        let inside = i >= 0 && j >= 0 && i < width as i64 && j < height as i64;
        if inside { f64::from(roots[j as usize * width + i as usize]) } else { 0.0 }
    };
    let mut total = 0.0;
    for j in -1..height as i64 {
        for i in -1..width as i64 {
            let corner = [origin[0] + spacing[0] * i as f64, origin[1] + spacing[1] * j as f64];
            total += cell_mean([texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1)], corner, spacing);
        }
    }
    total * spacing[0] * spacing[1]
}

/// The integral over the plane, in cells: hats overlap their own kind by 2/3 and their neighbours by 1/6 along each axis.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn whole_square_integral(roots: &[f32], width: usize) -> f64 {
    let mut total = 0.0;
    let mut before: Option<&[f32]> = None;
    for row in roots.chunks_exact(width) {
        total += row_overlap(row, row) * (2.0 / 3.0);
        // It counts from both sides.
        total += before.map_or(0.0, |before| row_overlap(row, before) * (1.0 / 3.0));
        before = Some(row);
    }
    total
}

/// Overlap of two rows as if they were one, in cells; inlined, so that it has the vectors of its caller.
#[inline(always)]
fn row_overlap(a: &[f32], b: &[f32]) -> f64 {
    let last = a.len() - 1;
    dot(a, b) * (2.0 / 3.0) + (dot(&a[1..], &b[..last]) + dot(&a[..last], &b[1..])) * (1.0 / 6.0)
}

/// Σ a·b in eight lanes; inlined, so that it has the vectors of its caller.
#[inline(always)]
fn dot(a: &[f32], b: &[f32]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0f64; LANES];
    let (a8, b8) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a8.remainder().iter().zip(b8.remainder()).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum();
    for (a, b) in a8.zip(b8) {
        for k in 0..LANES {
            sums[k] += f64::from(a[k]) * f64::from(b[k]);
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Mean over a cell of the squared bilinear root times the disk's indicator; `corner` is that of the first root.
fn cell_mean([a, b, c, d]: [f64; 4], corner: [f64; 2], spacing: [f64; 2]) -> f64 {
    let far = |axis: usize| corner[axis].abs().max((corner[axis] + spacing[axis]).abs());
    if far(0) * far(0) + far(1) * far(1) <= 1.0 {
        let top = (a * a + a * b + b * b) / 3.0;
        let bottom = (c * c + c * d + d * d) / 3.0;
        let both = (2.0 * (a * c + b * d) + a * d + b * c) / 6.0;
        return (top + both + bottom) / 3.0;
    }
    const SUB: usize = 16;
    let mut total = 0.0;
    for k in 0..SUB {
        let fy = (k as f64 + 0.5) / SUB as f64;
        for l in 0..SUB {
            let fx = (l as f64 + 0.5) / SUB as f64;
            let [x, y] = [corner[0] + fx * spacing[0], corner[1] + fy * spacing[1]];
            if x * x + y * y <= 1.0 {
                let top = a + (b - a) * fx;
                let root = top + (c + (d - c) * fx - top) * fy;
                total += root * root;
            }
        }
    }
    total / (SUB * SUB) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hat_is_fitted_by_itself() {
        for step in 1..=6 {
            let (node, nodes) = (4, 9);
            let hat = |k: usize| (1.0 - (k as f32 / step as f32 - node as f32).abs()).max(0.0);
            let samples: Vec<f32> = (0..=step * (nodes - 1)).map(hat).collect();
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
        let roots = vec![1.0f32; n * n];
        let integral = square_integral(&roots, n, n, [-1.0, -1.0], [0.05, 0.05]);
        assert!((integral - std::f64::consts::PI).abs() < 1e-3, "{integral}");
    }

    #[test]
    fn a_grid_within_the_disk_is_the_sum_of_its_cells() {
        let (width, height) = (7, 5);
        let roots: Vec<f32> = (0..width * height).map(|k| (k * k % 13) as f32 / 13.0).collect();
        let texel = |i: i64, j: i64| {
            let inside = i >= 0 && j >= 0 && i < width as i64 && j < height as i64;
            if inside { f64::from(roots[j as usize * width + i as usize]) } else { 0.0 }
        };
        let cell =
            |i, j| cell_mean([texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1)], [0.0; 2], [0.01; 2]);
        let cells: f64 =
            (-1..height as i64).flat_map(|j| (-1..width as i64).map(move |i| (i, j))).map(|(i, j)| cell(i, j)).sum();
        let whole = whole_square_integral(&roots, width);
        assert!((whole - cells).abs() < 1e-12 * cells, "{whole} {cells}");
    }

    #[test]
    fn the_square_of_a_cell_is_integrated_exactly() {
        let roots = [0.3f32, 1.0, 0.2, 0.7];
        let n = 400;
        let mut sum = 0.0;
        for k in 0..n * n {
            let (x, y) = (((k % n) as f64 + 0.5) / n as f64, ((k / n) as f64 + 0.5) / n as f64);
            let r = (0.3 * (1.0 - x) + x) * (1.0 - y) + (0.2 * (1.0 - x) + 0.7 * x) * y;
            sum += r * r;
        }
        let mean = cell_mean(roots.map(f64::from), [0.0, 0.0], [0.1, 0.1]);
        assert!((mean - sum / (n * n) as f64).abs() < 1e-5, "{mean}");
    }
}
