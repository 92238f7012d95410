//! Evaluation of NDF maps in f32, as `eval.wgsl` does it: one tile, one lobe, and the sum of a footprint's terms.
//!
//! Xing et al. 2024, section 6.3: the P-NDF is the sum of the NDFs of the tiles under the footprint; below the finest
//! tile, of Gaussian lobes (Eq. 1). Lobes are not stored: position, normal and Jacobian come from the example's normals.

use super::baked::{BakedNdfMaps, Material};
use super::ellipse::REACH;
use crate::erf::erf;
use crate::wrap::{filtered_texels, wrapped};
use glam::{IVec2, Mat2, Vec2};
use glint_formats::ndf_maps::DensityStorage;
use half::f16;

/// Choice between speed and accuracy at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvalSettings {
    /// Largest tile in standard deviations of the footprint's minor axis.
    pub tile_sigmas: f32,
    /// Largest box that is seen as one lobe, in standard deviations of the footprint's minor axis.
    pub lobe_sigmas: f32,
    /// Tiles, lobes or sub-regions in the area of the footprint's ellipse, at most, but for those that sub-regions cut; a footprint that
    /// would need more sees coarser ones.
    pub max_terms: u32,
    /// How often a tile that a sub-region shows only in part is split.
    pub splits: u32,
    /// Pieces lie within this many standard deviations of the footprint's centre; 2 % of its mass is beyond 2.8, 14 % beyond 2.
    pub reach: f32,
    /// Places along a footprint's minor axis where a stochastic surface is seen, each as one tile; 0 for all tiles of all sub-regions.
    pub probes: u32,
}

impl Default for EvalSettings {
    fn default() -> EvalSettings {
        EvalSettings { tile_sigmas: 1.0, lobe_sigmas: 0.75, max_terms: 128, splits: 1, reach: REACH, probes: 0 }
    }
}

/// A tile's share of a footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileTerm {
    /// Index of the tile.
    pub tile: u32,
    /// Palette entry of the example that shows it.
    pub class: u32,
    /// Share of the footprint times |det normal_to_local|.
    pub weight: f32,
}

/// A small box of the example seen as one lobe: its normals fill a parallelogram evenly, convolved with the intrinsic
/// lobe. Unit coordinates are those of the example's disk, turned so that the longer edge lies along x, over σ_r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeTerm {
    /// Surface's disk → example's disk.
    pub to_local: Mat2,
    /// Middle of the parallelogram in the example's disk.
    pub mean: Vec2,
    /// Offsets in the example's disk → unit coordinates.
    pub to_unit: Mat2,
    /// Half the parallelogram's length and height in unit coordinates.
    pub half: Vec2,
    /// Its shear, Δx / Δy.
    pub shear: f32,
    /// Change of the footprint's logarithm from the middle to the end of both edges: where in the box a normal lies says
    /// how much of the footprint it gets.
    pub tilt: Vec2,
    /// Share of the footprint times the Jacobian of both matrices, over the lobe's mass inside the disk.
    pub peak: f32,
}

/// Everything a footprint sees; shares sum to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Terms {
    /// Tiles.
    pub tiles: Vec<TileTerm>,
    /// Lobes.
    pub lobes: Vec<LobeTerm>,
}

impl Terms {
    /// Number of tiles and lobes.
    pub fn len(&self) -> usize {
        self.tiles.len() + self.lobes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Terms of a footprint with the sum of their shares, not yet divided by it.
#[derive(Default)]
pub(super) struct Gathered {
    pub(super) terms: Terms,
    pub(super) share: f32,
}

impl Gathered {
    /// Adds a tile and its share.
    pub(super) fn add(&mut self, term: TileTerm) {
        self.share += term.weight;
        self.terms.tiles.push(term);
    }
}

/// The three splines that reach a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Taps {
    /// Index of the first.
    pub(super) first: i32,
    /// Their values; they sum to 1.
    pub(super) weights: [f32; 3],
}

/// Quadratic B-splines at `p`, in node distances from node 0: those of the nodes ⌊p + ½⌋ − 1 and the next two.
pub(super) fn spline(p: f32) -> Taps {
    let middle = (p + 0.5).floor();
    let f = p - middle;
    let weights = [0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)];
    Taps { first: middle as i32 - 1, weights }
}

/// Row-major matrix of the pack.
pub fn matrix(rows: [f32; 4]) -> Mat2 {
    Mat2::from_cols(Vec2::new(rows[0], rows[2]), Vec2::new(rows[1], rows[3]))
}

impl Material {
    /// P-NDF at the projected normal `s` for the terms of a footprint: density over the disk, 0 outside it.
    pub fn density(&self, terms: &Terms, s: Vec2) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let mut sum = 0.0;
        for term in &terms.tiles {
            let to_local = matrix(self.placement.palette[term.class as usize].normal_to_local);
            sum += term.weight * self.maps.tile_density(term.tile, to_local * s);
        }
        for lobe in &terms.lobes {
            sum += lobe.lobe_density(s);
        }
        sum
    }
}

impl BakedNdfMaps {
    /// Density texels `at`, at + 1 and at + 2, relative to their tile's scale; 0 for those that are not `inside` the tile.
    fn texels(&self, at: i32, inside: [bool; 3]) -> [f32; 3] {
        let texel = |at: usize| match self.params.storage {
            DensityStorage::SqrtU8 => {
                let root = self.density[at] as f32 / 255.0;
                root * root
            }
            DensityStorage::F16 => f16::from_le_bytes([self.density[2 * at], self.density[2 * at + 1]]).to_f32(),
            DensityStorage::PaperF32 => {
                let b = &self.density[4 * at..4 * at + 4];
                f32::from_le_bytes([b[0], b[1], b[2], b[3]])
            }
        };
        let mut values = [0.0; 3];
        for k in 0..3 {
            if inside[k] {
                values[k] = texel((at + k as i32) as usize);
            }
        }
        values
    }

    /// Weighted sum of those of the three density texels from `at` on that lie `inside` the tile.
    fn row(&self, at: i32, weights: [f32; 3], inside: [bool; 3]) -> f32 {
        let v = self.texels(at, inside);
        weights[0] * v[0] + weights[1] * v[1] + weights[2] * v[2]
    }

    /// Density of one tile at the example's projected normal `s`: quadratic splines over decoded texels (bilinear for
    /// the paper's storage), 0 outside the box.
    pub fn tile_density(&self, tile: u32, s: Vec2) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let record = &self.tiles[tile as usize];
        let size = [record.width() as i32, record.height() as i32];
        let p = (s - Vec2::from(record.origin)) * Vec2::from(record.inv_spacing);
        if !record.holds(s) {
            return 0.0;
        }
        let bilinear = self.params.storage == DensityStorage::PaperF32;
        let [across, down] = [p.x, p.y].map(|p| {
            if !bilinear {
                return spline(p);
            }
            let cell = p.floor();
            Taps { first: cell as i32, weights: [1.0 - (p - cell), p - cell, 0.0] }
        });
        let inside = [0, 1, 2].map(|a| (0..size[0]).contains(&(across.first + a)));
        let start = record.first as i32 + down.first * size[0] + across.first;
        let mut sum = 0.0;
        for b in 0..3 {
            if (0..size[1]).contains(&(down.first + b)) {
                sum += down.weights[b as usize] * self.row(start + b * size[0], across.weights, inside);
            }
        }
        record.scale * sum
    }

    /// Projected normal of texel (i, j), wrapped or clamped.
    fn normal(&self, i: i32, j: i32) -> Vec2 {
        let (w, h) = (self.params.width as i32, self.params.height as i32);
        let (i, j) = (wrapped(i, w, self.params.wrap), wrapped(j, h, self.params.wrap));
        let [x, y] = self.normals[(j * w + i) as usize];
        Vec2::new(x as f32 / 32767.0, y as f32 / 32767.0)
    }

    /// Bilinear projected normal and Jacobian ∂s/∂u at `u` (example texels); the example repeats as a whole.
    pub fn normal_and_jacobian(&self, u: Vec2) -> (Vec2, Mat2) {
        let size = Vec2::new(self.params.width as f32, self.params.height as f32);
        let (IVec2 { x: i, y: j }, f) = filtered_texels(u - (u / size).floor() * size);
        let (s00, s10) = (self.normal(i, j), self.normal(i + 1, j));
        let (s01, s11) = (self.normal(i, j + 1), self.normal(i + 1, j + 1));
        let top = s00 + (s10 - s00) * f.x;
        let bottom = s01 + (s11 - s01) * f.x;
        let du = (s10 - s00) * (1.0 - f.y) + (s11 - s01) * f.y;
        (top + (bottom - top) * f.y, Mat2::from_cols(du, bottom - top))
    }
}

/// Φ(x).
fn normal_cdf(x: f32) -> f32 {
    0.5 * (1.0 + erf(x * std::f32::consts::FRAC_1_SQRT_2))
}

/// A box of half width `half` and area 1, convolved with the unit Gaussian, at `x`.
fn smoothed_box(x: f32, half: f32) -> f32 {
    // Below this width a box is a Gaussian to 1e-4, and the difference of two error functions loses digits.
    if half < 0.05 {
        return (-0.5 * x * x).exp() / (2.0 * std::f32::consts::PI).sqrt();
    }
    (normal_cdf(x + half) - normal_cdf(x - half)) / (2.0 * half)
}

/// Where in a box of half width `half` (as −1 … 1) a point most likely comes from that was seen at `x` after a unit
/// Gaussian: the posterior mean of Gaussians of the same variances.
fn place_in_box(x: f32, half: f32) -> f32 {
    (x * half / (half * half + 3.0)).clamp(-1.0, 1.0)
}

/// Mean of exp(t · x) over x in −1 … 1: sinh(t) / t, by its series where that has all digits.
fn mean_exp(t: f32) -> f32 {
    let q = t * t;
    if q < 1.0 { 1.0 + q / 6.0 * (1.0 + q / 20.0 * (1.0 + q / 42.0)) } else { t.sinh() / t }
}

/// Mass on the disk's side of the rim next to `s`, as if that were straight.
fn inside_rim(s: Vec2, a: Vec2, b: Vec2, sigma: f32) -> f32 {
    let radius = s.length();
    let outward = if radius > 0.0 { s / radius } else { Vec2::X };
    let variance = sigma * sigma + (outward.dot(a).powi(2) + outward.dot(b).powi(2)) / 12.0;
    normal_cdf((1.0 - radius) / variance.sqrt())
}

/// Mass inside the disk of a lobe around `s` whose longer edge is `long`: the mean over pieces of that edge, each as
/// across a straight rim.
fn inside_disk(s: Vec2, long: Vec2, short: Vec2, sigma: f32) -> f32 {
    const PIECES: i32 = 4;
    if s.length() + 0.5 * (long.length() + short.length()) + 5.0 * sigma < 1.0 {
        return 1.0;
    }
    let piece = long / PIECES as f32;
    let mut sum = 0.0;
    for k in 0..PIECES {
        sum += inside_rim(s + piece * (k as f32 + 0.5 - 0.5 * PIECES as f32), piece, short, sigma);
    }
    (sum / PIECES as f32).max(1e-3)
}

/// Largest tilt: a footprint that needs more is far thinner than its boxes, and all of it lies at their ends.
const MAX_TILT: Vec2 = Vec2::splat(20.0);

impl LobeTerm {
    /// Lobe of a box of edge `edge` (example texels) around an example point of projected normal `s` and Jacobian
    /// `jacobian`, with the intrinsic roughness `sigma`, seen through the palette's `normal_to_local`. The box has
    /// `weight` of the footprint, whose logarithm has the gradient `gradient` there (per example texel).
    ///
    /// What would leave the disk is put back: across a rim that is straight at the scale of a quarter of the box,
    /// Φ(distance / σ) of the mass stays inside.
    pub fn new(
        (s, jacobian): (Vec2, Mat2),
        edge: f32,
        sigma: f32,
        normal_to_local: Mat2,
        weight: f32,
        gradient: Vec2,
    ) -> LobeTerm {
        let (a, b) = (jacobian.x_axis * edge, jacobian.y_axis * edge);
        let (long, short, tilt) = if a.length_squared() >= b.length_squared() {
            (a, b, gradient * (0.5 * edge))
        } else {
            (b, a, Vec2::new(gradient.y, gradient.x) * (0.5 * edge))
        };
        let length = long.length();
        let along = if length > 0.0 { long / length } else { Vec2::X };
        let height = along.perp_dot(short);
        // Edges that are nearly parallel have no height to shear over; their spread is the longer edge's.
        let shear = if height.abs() > 1e-3 * length { along.dot(short) / height } else { 0.0 };
        let turn = Mat2::from_cols(Vec2::new(along.x, -along.y), Vec2::new(along.y, along.x));
        let half = Vec2::new(0.5 * length, 0.5 * height.abs()) / sigma;
        let tilt = Vec2::new(tilt.x, tilt.y.copysign(tilt.y * height)).clamp(-MAX_TILT, MAX_TILT);
        // The places in the box that `density` infers spread less than the box where the lobe blurs it.
        let inferred = tilt * half / (half * half + 3.0).map(f32::sqrt);
        let normalised = inside_disk(s, long, short, sigma) * mean_exp(inferred.x) * mean_exp(inferred.y);
        LobeTerm {
            to_local: normal_to_local,
            mean: s,
            to_unit: turn * (1.0 / sigma),
            half,
            shear,
            tilt,
            peak: weight * normal_to_local.determinant().abs() / (sigma * sigma * normalised),
        }
    }

    /// Density at the projected normal `s` of the surface.
    pub fn lobe_density(&self, s: Vec2) -> f32 {
        /// Beyond this many standard deviations the lobe is nothing.
        const CUT: f32 = 5.0;
        let x = self.to_unit * (self.to_local * s - self.mean);
        if x.y.abs() > self.half.y + CUT {
            return 0.0;
        }
        let along = x.x - self.shear * x.y.clamp(-self.half.y, self.half.y);
        if along.abs() > self.half.x + CUT {
            return 0.0;
        }
        let tilt = self.tilt.x * place_in_box(along, self.half.x) + self.tilt.y * place_in_box(x.y, self.half.y);
        self.peak * tilt.exp() * smoothed_box(along, self.half.x) * smoothed_box(x.y, self.half.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taps_sum_to_one_and_meet_at_cell_borders() {
        for k in 0..50 {
            let p = k as f32 * 0.173 - 2.0;
            assert!((spline(p).weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
        let (below, above) = (spline(0.499_999), spline(0.500_001));
        assert!((below.weights[1] - above.weights[0]).abs() < 1e-5);
    }
}
