//! The micro-normals of small square parts of a map, binned once on a lattice that all nodes share, so that a node sums the bins of the
//! parts under its window.
//!
//! Bilinear interpolation makes the map a patchwork of bilinear cells between texel centres. A part lies in one cell, so its normals are
//! a bilinear patch whose extremes are its four corners. Over a part the window counts as what it is in its middle; what the part's own
//! extent adds to the variance is taken off the window ([`Window::of_parts`]).

use super::lobe_norm::LobeNorm;
use super::windows::{AxisWeights, Window};
use crate::normal_map::NormalMap;
use glam::DVec2;
use rayon::prelude::*;

/// Parts of an edge of a window's standard deviation over this count by what the window is in their middle, to half a per cent of E₁.
const EDGES_PER_SIGMA: f64 = 5.5;
/// Parts along a texel at least, as bilinear cells end in its middle, and at most.
const PER_TEXEL: (u32, u32) = (2, 8);
/// Samples of the normals per σ_r along a path through the disk.
const SAMPLES_PER_SIGMA: f64 = 2.5;
/// Samples along an edge of a part at most.
const MAX_SAMPLES: f64 = 128.0;

/// Parts along a texel that serve windows like `window`.
pub(super) fn parts_per_texel(window: &Window) -> u32 {
    let wanted = (EDGES_PER_SIGMA / window.least_sigma()).ceil().min(f64::from(PER_TEXEL.1)) as u32;
    wanted.next_power_of_two().max(PER_TEXEL.0)
}

/// The parts of a map: the projected normals of their corners (00, 10, 01, 11).
pub(super) struct Parts {
    /// Parts along an edge of a texel.
    pub per_texel: u32,
    /// Parts along both axes.
    size: [u32; 2],
    corners: Vec<[DVec2; 4]>,
}

impl Parts {
    pub fn new(map: &NormalMap, per_texel: u32) -> Parts {
        let size = [map.width * per_texel, map.height * per_texel];
        let edge = f64::from(per_texel).recip();
        let normal = |x: u32, y: u32| map.bilinear(DVec2::new(f64::from(x), f64::from(y)) * edge).0;
        let part = |x: u32, y: u32| [normal(x, y), normal(x + 1, y), normal(x, y + 1), normal(x + 1, y + 1)];
        let corners = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| part(x, y))).collect();
        Parts { per_texel, size, corners }
    }

    /// What each column and row of parts weighs under a window; a part weighs the product.
    pub fn weights(&self, window: &Window) -> [AxisWeights; 2] {
        let window = window.of_parts(f64::from(self.per_texel).recip());
        [0, 1].map(|axis| window.along(axis, self.size[axis], self.per_texel))
    }

    /// Bounds (min, max) of the projected normals of the parts that weigh something.
    pub fn bounds(&self, weights: &[AxisWeights; 2]) -> (DVec2, DVec2) {
        let mut lo = DVec2::splat(f64::INFINITY);
        let mut hi = DVec2::splat(f64::NEG_INFINITY);
        for_each_part(weights, |x, y, _| {
            for corner in self.corners[(y * self.size[0] + x) as usize] {
                lo = lo.min(corner);
                hi = hi.max(corner);
            }
        });
        (lo, hi)
    }
}

/// Calls `visit(x, y, weight)` for the parts that weigh something.
fn for_each_part(weights: &[AxisWeights; 2], mut visit: impl FnMut(u32, u32, f64)) {
    for (y, wy) in &weights[1].0 {
        for (x, wx) in &weights[0].0 {
            let weight = wx * wy;
            if weight > Window::LEAST {
                visit(*x, *y, weight);
            }
        }
    }
}

/// One row of a part's bins that are not zero.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Lattice point of the first.
    at: [u16; 2],
    count: u16,
}

/// The bins of a row of parts.
#[derive(Default)]
struct PartRow {
    /// Where each part's runs and values begin, and where those of the last end.
    begins: Vec<[u32; 2]>,
    runs: Vec<Run>,
    values: Vec<f32>,
}

/// The bins of all parts on one lattice: point (i, j) at s = (−1, −1) + spacing · (i, j).
pub(super) struct NormalBins {
    rows: Vec<PartRow>,
}

impl NormalBins {
    /// Bins the normals (cloud in cell) of parts, each of mass 1 times the reciprocal of its lobes' mass in the disk.
    pub fn new(parts: &Parts, spacing: f64, roughness: f64, norm: &LobeNorm) -> NormalBins {
        let rows = parts.corners.par_chunks_exact(parts.size[0] as usize).map(|corners| {
            let mut row = PartRow { begins: vec![[0; 2]], ..PartRow::default() };
            let mut box_ = Vec::new();
            for corners in corners {
                row.add(corners, spacing, roughness / SAMPLES_PER_SIGMA, norm, &mut box_);
            }
            row
        });
        NormalBins { rows: rows.collect() }
    }

    /// Adds all parts by their weights to `bins`, rows of `width` whose first point is `first` of the lattice; gives the sum of
    /// the weights.
    pub fn add_to(&self, weights: &[AxisWeights; 2], first: [u32; 2], width: usize, bins: &mut [f32]) -> f64 {
        let mut total = 0.0;
        for_each_part(weights, |x, y, weight| {
            total += weight;
            let row = &self.rows[y as usize];
            let [[run, value], [runs, _]] = [row.begins[x as usize], row.begins[x as usize + 1]];
            let mut values = &row.values[value as usize..];
            for run in &row.runs[run as usize..runs as usize] {
                let [i, j] = [0, 1].map(|axis| (u32::from(run.at[axis]) - first[axis]) as usize);
                let (own, rest) = values.split_at(run.count as usize);
                values = rest;
                for (bin, value) in bins[j * width + i..].iter_mut().zip(own) {
                    *bin += weight as f32 * value;
                }
            }
        });
        total
    }
}

impl PartRow {
    /// Adds one part's bins; samples along its edges are at most `distance` apart in the disk. `cells` is room to work in.
    fn add(&mut self, corners: &[DVec2; 4], spacing: f64, distance: f64, norm: &LobeNorm, cells: &mut Vec<f32>) {
        let [s00, s10, s01, s11] = *corners;
        let lattice = |s: DVec2| (s + 1.0) / spacing;
        let low = lattice(s00.min(s10).min(s01).min(s11)).max(DVec2::ZERO).floor();
        let high = lattice(s00.max(s10).max(s01).max(s11)).floor() + 1.0;
        let [width, height] = (high - low).to_array().map(|v| v as usize + 1);
        cells.clear();
        cells.resize(width * height, 0.0f32);
        let steps = |a: f64, b: f64| (a.max(b) / distance).ceil().clamp(1.0, MAX_SAMPLES);
        let nu = steps(s00.distance(s10), s01.distance(s11));
        let nv = steps(s00.distance(s01), s10.distance(s11));
        for j in 0..nv as u32 {
            let v = (f64::from(j) + 0.5) / nv;
            let left = s00.lerp(s01, v);
            let step = (s10.lerp(s11, v) - left) / nu;
            for i in 0..nu as u32 {
                let s = left + step * (f64::from(i) + 0.5);
                let p = lattice(s) - low;
                let (i, j) = ((p.x.max(0.0) as usize).min(width - 2), (p.y.max(0.0) as usize).min(height - 2));
                let (fx, fy) = ((p.x - i as f64) as f32, (p.y - j as f64) as f32);
                let w = (norm.reciprocal_mass(s.length()) / (nu * nv)) as f32;
                let at = j * width + i;
                cells[at] += w * (1.0 - fx) * (1.0 - fy);
                cells[at + 1] += w * fx * (1.0 - fy);
                cells[at + width] += w * (1.0 - fx) * fy;
                cells[at + width + 1] += w * fx * fy;
            }
        }
        for (j, row) in cells.chunks_exact(width).enumerate() {
            let Some(begin) = row.iter().position(|v| *v != 0.0) else { continue };
            let end = row.iter().rposition(|v| *v != 0.0).map_or(begin, |last| last + 1);
            let at = [low.x as usize + begin, low.y as usize + j].map(|v| v as u16);
            self.runs.push(Run { at, count: (end - begin) as u16 });
            self.values.extend_from_slice(&row[begin..end]);
        }
        self.begins.push([self.runs.len() as u32, self.values.len() as u32]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::windows::levels;
    use super::*;
    use glint_formats::Wrap;

    /// An example whose normals run over a good part of the disk.
    fn map() -> NormalMap {
        let projected = (0..20).map(|k| [0.03 * k as f32 - 0.3, 0.01 * (k * k % 7) as f32]).collect();
        NormalMap { width: 5, height: 4, wrap: Wrap::Repeat, projected }
    }

    /// Total and mean of the normals in bins under a window.
    fn mean(window: &Window) -> (f64, DVec2) {
        const SPACING: f64 = 0.01;
        let parts = Parts::new(&map(), parts_per_texel(window));
        let bins = NormalBins::new(&parts, SPACING, 0.02, &LobeNorm::new(0.02));
        let mut values = vec![0.0; 201 * 201];
        let weights = parts.weights(window);
        let total = bins.add_to(&weights, [0, 0], 201, &mut values);
        let at = |k: usize| DVec2::new((k % 201) as f64, (k / 201) as f64) * SPACING - 1.0;
        let mass: f64 = values.iter().map(|v| f64::from(*v)).sum();
        (mass / total, values.iter().enumerate().map(|(k, v)| at(k) * f64::from(*v)).sum::<DVec2>() / mass)
    }

    #[test]
    fn the_whole_example_s_mean_is_that_of_its_texels() {
        let levels = levels(5, 4, 0.7);
        let (mass, mean) = mean(&Window::new(5, 4, levels.last().unwrap(), 100.0, 0));
        let texels = map().projected.iter().map(|s| DVec2::new(s[0] as f64, s[1] as f64)).sum::<DVec2>() / 20.0;
        assert!((mass - 1.0).abs() < 1e-5, "{mass}");
        assert!((mean - texels).length() < 1e-5, "{mean} {texels}");
    }

    #[test]
    fn a_window_s_mean_is_that_of_an_integral() {
        let (map, levels) = (map(), levels(5, 4, 0.7));
        let window = Window::new(5, 4, &levels[0], 0.49, 7);
        let (mut total, mut expected) = (0.0, DVec2::ZERO);
        const N: i32 = 64;
        for k in 0..(16 * N) * (16 * N) {
            let d = (DVec2::new((k % (16 * N)) as f64, (k / (16 * N)) as f64) + 0.5) / f64::from(N) - 8.0;
            let weight = window.weight(d);
            if weight > 0.0 {
                total += weight;
                expected += map.bilinear((window.centre + d).rem_euclid(DVec2::new(5.0, 4.0))).0 * weight;
            }
        }
        let (_, mean) = mean(&window);
        assert!((mean - expected / total).length() < 2e-4, "{mean} {}", expected / total);
    }
}
