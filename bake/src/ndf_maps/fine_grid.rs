//! A node's exact NDF on a fine grid: the bins of the parts under its window, convolved with the intrinsic lobe.

use super::normal_bins::{NormalBins, Parts};
use super::windows::{AxisWeights, Window};
use glam::DVec2;
use glint_formats::ndf_maps::STEPS_PER_ROUGHNESS;
use multiversion::multiversion;
use std::ops::Range;

/// How far the box reaches beyond the outermost normal, in σ_r: 0.05 % of a lobe's mass lies farther out.
const MARGIN_SIGMAS: f64 = 3.5;
/// Points of the fine grid along one axis at most; a smaller σ_r than they resolve is widened, which the measured error shows.
const MAX_FINE: usize = 768;

/// A node's exact density at the points of a fine grid.
pub(super) struct FineGrid {
    /// Steps of the node records from s = (−1, −1) to the first point.
    pub first: [u32; 2],
    /// Steps between points.
    pub step: u32,
    /// First point.
    pub origin: DVec2,
    /// Distance of points.
    pub spacing: f64,
    /// Points in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Density at the points, row-major.
    pub density: Vec<f32>,
}

/// Where a node's fine grid lies, and what the parts of the map weigh in it.
pub(super) struct Plan {
    weights: [AxisWeights; 2],
    /// Steps of the node records between points, a power of two, so that few lattices serve all nodes.
    pub step: u32,
    /// First point, in points from s = (−1, −1).
    first: [u32; 2],
    width: usize,
    height: usize,
}

/// Distance of the steps that node records count in.
pub(super) fn step_length(roughness: f64) -> f64 {
    roughness / f64::from(STEPS_PER_ROUGHNESS)
}

impl Plan {
    /// That of the node with `window`; `roughness` is the lobes' standard deviation.
    pub fn new(parts: &Parts, window: &Window, roughness: f64) -> Plan {
        let weights = parts.weights(window);
        let (lo, hi) = parts.bounds(&weights);
        let margin = DVec2::splat(MARGIN_SIGMAS * roughness);
        let low = (lo - margin).max(DVec2::splat(-1.0)) + 1.0;
        let high = (hi + margin).min(DVec2::splat(1.0)) + 1.0;
        let unit = step_length(roughness);
        let steps = ((high - low).max_element() / (unit * (MAX_FINE - 3) as f64)).ceil().max(1.0) as u32;
        let step = steps.next_power_of_two();
        let spacing = f64::from(step) * unit;
        let first = (low / spacing).floor();
        let points = |axis: usize| ((high[axis] / spacing).ceil() - first[axis]) as usize + 2;
        Plan { weights, step, first: first.to_array().map(|v| v as u32), width: points(0), height: points(1) }
    }
}

impl FineGrid {
    /// Adds up `bins`, which are on the plan's lattice, and convolves with the lobe of standard deviation `sigma`.
    pub fn new(plan: &Plan, bins: &NormalBins, sigma: f64) -> FineGrid {
        let spacing = f64::from(plan.step) * step_length(sigma);
        let (width, height) = (plan.width, plan.height);
        // The lobes' tails outside the box would come back by the convolution only from points inside it, which is all
        // there is: every micro-normal lies inside.
        let mut density = vec![0.0f32; width * height];
        let total = bins.add_to(&plan.weights, plan.first, width, &mut density);
        let per_area = (1.0 / (total * spacing * spacing)) as f32;
        density.iter_mut().for_each(|bin| *bin *= per_area);
        // Cloud in cell widens by spacing² / 6 along each axis; the lobe makes up the rest of σ_r².
        let variance = (sigma * sigma - spacing * spacing / 6.0).max(0.0);
        let density = gaussian_blur(&density, width, height, variance.sqrt() / spacing);
        let origin = DVec2::new(f64::from(plan.first[0]), f64::from(plan.first[1])) * spacing - 1.0;
        let first = plan.first.map(|v| v * plan.step);
        FineGrid { first, step: plan.step, origin, spacing, width, height, density }
    }

    /// The columns and rows that hold all but `part` of the density beyond each side, and what lies beyond them as a part of all.
    pub fn core(&self, part: f64) -> ([Range<usize>; 2], f64) {
        let columns: Vec<f64> = (0..self.width)
            .map(|i| (0..self.height).map(|j| f64::from(self.density[j * self.width + i])).sum())
            .collect();
        let rows: Vec<f64> =
            self.density.chunks_exact(self.width).map(|row| row.iter().map(|v| f64::from(*v)).sum()).collect();
        let total: f64 = rows.iter().sum();
        let range = |sums: &[f64]| {
            let skipped = |sums: &mut dyn Iterator<Item = &f64>| {
                let mut left = part * total;
                sums.take_while(|sum| {
                    left -= **sum;
                    left >= 0.0
                })
                .count()
            };
            let first = skipped(&mut sums.iter()).min(sums.len() - 2);
            let last = skipped(&mut sums.iter().rev()).min(sums.len() - 2 - first);
            first..sums.len() - last
        };
        let core = [range(&columns), range(&rows)];
        let kept: f64 = core[1]
            .clone()
            .map(|j| self.density[j * self.width..][core[0].clone()].iter().map(|v| f64::from(*v)).sum::<f64>())
            .sum();
        (core, 1.0 - kept / total.max(f64::MIN_POSITIVE))
    }

    /// Mean, and covariance xx, xy, yy, of the density within the disk.
    pub fn moments(&self) -> ([f64; 2], [f64; 3]) {
        // About the middle, for digits.
        let middle = self.origin + 0.5 * self.spacing * DVec2::new(self.width as f64, self.height as f64);
        let mut sums = [0.0; 6];
        for j in 0..self.height {
            let y = self.origin.y + j as f64 * self.spacing - middle.y;
            for i in self.columns_inside(j).unwrap_or_default() {
                let x = self.origin.x + i as f64 * self.spacing - middle.x;
                let density = f64::from(self.density[j * self.width + i]);
                for (sum, part) in sums.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
                    *sum += density * part;
                }
            }
        }
        let [mass, x, y, xx, xy, yy] = sums;
        let [x, y, xx, xy, yy] = [x, y, xx, xy, yy].map(|sum| sum / mass.max(f64::MIN_POSITIVE));
        ([middle.x + x, middle.y + y], [xx - x * x, xy - x * y, yy - y * y])
    }

    /// Columns of row `j` whose points lie inside the unit disk; None when there are none.
    pub fn columns_inside(&self, j: usize) -> Option<Range<usize>> {
        let y = self.origin.y + j as f64 * self.spacing;
        let half = (1.0 - y * y).max(0.0).sqrt();
        let first = ((-half - self.origin.x) / self.spacing).ceil().max(0.0) as usize;
        let last = ((half - self.origin.x) / self.spacing).floor();
        if y.abs() > 1.0 || last < first as f64 || first >= self.width {
            return None;
        }
        Some(first..(last as usize + 1).min(self.width))
    }
}

/// Convolves with a Gaussian of `sigma` points, separably, cut at 4σ and normalised.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn gaussian_blur(input: &[f32], width: usize, height: usize, sigma: f64) -> Vec<f32> {
    let radius = (4.0 * sigma).ceil() as usize;
    if radius == 0 {
        return input.to_vec();
    }
    let weights: Vec<f64> = (0..=radius).map(|k| libm::exp(-0.5 * (k as f64 / sigma).powi(2))).collect();
    let total = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    let taps: Vec<f32> = (0..=2 * radius).map(|k| (weights[k.abs_diff(radius)] / total) as f32).collect();

    let mut rows = vec![0.0f32; input.len()];
    let mut padded = vec![0.0f32; width + 2 * radius];
    for (source, target) in input.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        if source.iter().all(|v| *v == 0.0) {
            continue;
        }
        padded[radius..radius + width].copy_from_slice(source);
        weighted_sum(&padded, 1, &taps, target);
    }
    let mut output = vec![0.0f32; input.len()];
    for (j, target) in output.chunks_exact_mut(width).enumerate() {
        let first = j.saturating_sub(radius);
        let end = (j + radius).min(height - 1) + 1;
        weighted_sum(&rows[first * width..], width, &taps[first + radius - j..end + radius - j], target);
    }
    output
}

/// target[i] = Σ_k taps[k] · source[i + k · stride], some neighbours at a time, whose sums stay in registers. Inlined, so that it has
/// the vectors of its caller.
#[inline(always)]
fn weighted_sum(source: &[f32], stride: usize, taps: &[f32], target: &mut [f32]) {
    const LANES: usize = 16;
    if target.len() < LANES {
        for (i, out) in target.iter_mut().enumerate() {
            *out = taps.iter().enumerate().map(|(k, tap)| tap * source[i + k * stride]).sum();
        }
        return;
    }
    // The last ones overlap those before.
    let last = target.len() - LANES;
    for at in (0..last).step_by(LANES).chain([last]) {
        let mut sums = [0.0f32; LANES];
        for (k, tap) in taps.iter().enumerate() {
            let lanes: &[f32; LANES] =
                source[at + k * stride..].first_chunk().expect("rows reach as far as the target");
            for lane in 0..LANES {
                sums[lane] += tap * lanes[lane];
            }
        }
        target[at..at + LANES].copy_from_slice(&sums);
    }
}
