//! A node's exact NDF on a fine grid: micro-normals binned and convolved with the intrinsic lobe.
//!
//! A normal close to the horizon carries a lobe of standard deviation σ_r whose tail would leave the disk of projected normals.
//! The NDF of a single normal n is therefore the Gaussian divided by its mass inside the disk, so that it integrates to one.

use super::hats::add_scaled;
use super::micro_normals::MicroNormals;
use super::windows::Window;
use crate::normal_map::NormalMap;
use glam::DVec2;
use glint_formats::ndf_maps::STEPS_PER_ROUGHNESS;
use multiversion::multiversion;
use std::ops::Range;

/// How far the box reaches beyond the outermost normal, in σ_r: 0.05 % of a lobe's mass lies farther out.
const MARGIN_SIGMAS: f64 = 3.5;
/// Points of the fine grid along one axis at most; a smaller σ_r than they resolve is widened, which the measured error shows.
const MAX_FINE: usize = 768;
/// Micro-normal samples per σ_r along a path through the disk.
const SAMPLES_PER_SIGMA: f64 = 2.5;
/// Samples along an edge of a quarter texel at most.
const MAX_SAMPLES: u32 = 128;

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

/// The micro-normals of an example, dense enough for lobes of standard deviation `sigma`.
pub(super) fn micro_normals(map: &NormalMap, sigma: f64) -> MicroNormals {
    MicroNormals::new(map, sigma / SAMPLES_PER_SIGMA, MAX_SAMPLES)
}

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

impl FineGrid {
    /// Bins the micro-normals under a window (cloud in cell) and convolves with the lobe of standard deviation `sigma`.
    pub fn new(normals: &MicroNormals, window: &Window, sigma: f64, norm: &LobeNorm) -> FineGrid {
        let (lo, hi) = normals.bounds(window);
        let margin = DVec2::splat(MARGIN_SIGMAS * sigma);
        let low = (lo - margin).max(DVec2::splat(-1.0));
        let extent = (hi + margin).min(DVec2::splat(1.0)) - low;
        let unit = sigma / f64::from(STEPS_PER_ROUGHNESS);
        let step = (extent.max_element() / (unit * (MAX_FINE - 3) as f64)).ceil().max(1.0);
        let spacing = step * unit;
        let first = ((low + 1.0) / unit).floor().to_array().map(|v| v as u32);
        let origin = DVec2::new(f64::from(first[0]), f64::from(first[1])) * unit - 1.0;
        let points = |length: f64| (length / spacing).ceil() as usize + 3;
        let (width, height) = (points(extent.x), points(extent.y));

        // The lobes' tails outside the box would come back by the convolution only from points inside it, which is all
        // there is: every micro-normal lies inside.
        let mut bins = vec![0.0f32; width * height];
        let mut total = 0.0;
        normals.for_each_sample(window, |s, weight| {
            let p = (s - origin) / spacing;
            let (i, j) = ((p.x as usize).min(width - 2), (p.y as usize).min(height - 2));
            let (fx, fy) = ((p.x - i as f64) as f32, (p.y - j as f64) as f32);
            let w = (weight * norm.reciprocal_mass(s.length())) as f32;
            total += weight;
            let at = j * width + i;
            bins[at] += w * (1.0 - fx) * (1.0 - fy);
            bins[at + 1] += w * fx * (1.0 - fy);
            bins[at + width] += w * (1.0 - fx) * fy;
            bins[at + width + 1] += w * fx * fy;
        });
        let per_area = (1.0 / (total * spacing * spacing)) as f32;
        bins.iter_mut().for_each(|bin| *bin *= per_area);
        // Cloud in cell widens by spacing² / 6 along each axis; the lobe makes up the rest of σ_r².
        let variance = (sigma * sigma - spacing * spacing / 6.0).max(0.0);
        let density = gaussian_blur(&bins, width, height, variance.sqrt() / spacing);
        FineGrid { first, step: step as u32, origin, spacing, width, height, density }
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
    let taps: Vec<f32> = weights.iter().map(|w| (w / total) as f32).collect();

    let mut rows = vec![0.0f32; input.len()];
    let mut padded = vec![0.0f32; width + 2 * radius];
    for j in 0..height {
        let source = &input[j * width..(j + 1) * width];
        if source.iter().all(|v| *v == 0.0) {
            continue;
        }
        padded[radius..radius + width].copy_from_slice(source);
        let target = &mut rows[j * width..(j + 1) * width];
        for offset in 0..=2 * radius {
            add_scaled(target, &padded[offset..offset + width], taps[offset.abs_diff(radius)]);
        }
    }
    let mut output = vec![0.0f32; input.len()];
    for j in 0..height {
        let target = &mut output[j * width..(j + 1) * width];
        for k in j.saturating_sub(radius)..=(j + radius).min(height - 1) {
            add_scaled(target, &rows[k * width..(k + 1) * width], taps[k.abs_diff(j)]);
        }
    }
    output
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
