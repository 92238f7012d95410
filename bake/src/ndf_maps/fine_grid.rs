//! A tile's exact NDF on a fine grid: micro-normals binned and convolved with the intrinsic lobe.
//!
//! A normal close to the horizon carries a lobe of standard deviation σ_r whose tail would leave the disk of projected normals.
//! The NDF of a single normal n is therefore the Gaussian divided by its mass inside the disk, so that it integrates to one.

use super::micro_normals::{self, TexelRect};
use super::spline::add_scaled;
use crate::normal_map::NormalMap;
use glam::DVec2;
use multiversion::multiversion;
use std::ops::Range;

/// Fine grid nodes per σ_r.
const FINE_PER_SIGMA: f64 = 3.0;
/// How far the box reaches beyond the outermost normal, in σ_r: 0.05 % of a lobe's mass lies farther out.
const MARGIN_SIGMAS: f64 = 3.5;
/// Largest fine grid along one axis; a smaller σ_r than this resolves is widened, which the measured error shows.
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

/// A tile's exact density at the nodes of a fine grid.
pub(super) struct FineGrid {
    /// First node.
    pub origin: DVec2,
    /// Distance of nodes.
    pub spacing: f64,
    /// Nodes in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Density at the nodes, row-major.
    pub density: Vec<f32>,
}

impl FineGrid {
    /// Bins the tile's micro-normals (cloud in cell) and convolves with the lobe of standard deviation `sigma`.
    pub fn new(map: &NormalMap, rect: TexelRect, sigma: f64, norm: &LobeNorm) -> FineGrid {
        let (lo, hi) = micro_normals::bounds(map, rect);
        let margin = DVec2::splat(MARGIN_SIGMAS * sigma);
        let origin = (lo - margin).max(DVec2::splat(-1.0));
        let extent = (hi + margin).min(DVec2::splat(1.0)) - origin;
        let spacing = (sigma / FINE_PER_SIGMA).max(extent.max_element() / (MAX_FINE - 2) as f64);
        let nodes = |length: f64| (length / spacing).ceil() as usize + 2;
        let (width, height) = (nodes(extent.x), nodes(extent.y));

        // The lobes' tails outside the box would come back by the convolution only from nodes inside it, which is all
        // there is: every micro-normal lies inside.
        let mut bins = vec![0.0f32; width * height];
        let sample_spacing = spacing.max(sigma) / SAMPLES_PER_SIGMA;
        let per_area = 1.0 / (spacing * spacing);
        micro_normals::for_each_sample(map, rect, sample_spacing, MAX_SAMPLES, |s, weight| {
            let p = (s - origin) / spacing;
            let (i, j) = ((p.x as usize).min(width - 2), (p.y as usize).min(height - 2));
            let (fx, fy) = ((p.x - i as f64) as f32, (p.y - j as f64) as f32);
            let w = (weight * per_area * norm.reciprocal_mass(s.length())) as f32;
            let at = j * width + i;
            bins[at] += w * (1.0 - fx) * (1.0 - fy);
            bins[at + 1] += w * fx * (1.0 - fy);
            bins[at + width] += w * (1.0 - fx) * fy;
            bins[at + width + 1] += w * fx * fy;
        });
        // Cloud in cell widens by spacing² / 6 along each axis; the lobe makes up the rest of σ_r².
        let variance = (sigma * sigma - spacing * spacing / 6.0).max(0.0);
        let density = gaussian_blur(&bins, width, height, variance.sqrt() / spacing);
        FineGrid { origin, spacing, width, height, density }
    }

    /// Columns of row `j` whose nodes lie inside the unit disk; None when there are none.
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

    /// The density at `s`, interpolated bilinearly between fine nodes, zero outside.
    pub fn at(&self, s: DVec2) -> f32 {
        let p = (s - self.origin) / self.spacing;
        let cell = p.floor();
        if cell.x < 0.0 || cell.y < 0.0 || cell.x >= (self.width - 1) as f64 || cell.y >= (self.height - 1) as f64 {
            return 0.0;
        }
        let (i, j) = (cell.x as usize, cell.y as usize);
        let f = (p - cell).as_vec2();
        let row = |j: usize| {
            let at = j * self.width + i;
            self.density[at] * (1.0 - f.x) + self.density[at + 1] * f.x
        };
        row(j) * (1.0 - f.y) + row(j + 1) * f.y
    }
}

/// Convolves with a Gaussian of `sigma` nodes, separably, cut at 4σ and normalised.
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
