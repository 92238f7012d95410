//! Evaluation of packed NDF maps, f32, as a shader would do it: one tile, one lobe, and the sum of a footprint's terms.
//!
//! Xing et al. 2024, section 6.3: the P-NDF is the sum of the NDFs of the tiles under the footprint; below the finest
//! tile, of Gaussian lobes (Eq. 1). Lobes are not stored: position, normal and Jacobian come from the example's normals.

use super::bake::BakedNdfMaps;
use super::placement::BakedPlacement;
use glam::{Mat2, Vec2};
use glint_formats::ndf_maps::{DensityStorage, TransformRecord, Wrap};
use half::f16;

/// A material as a renderer holds it: one example's maps and how they cover the surface.
#[derive(Clone, Debug)]
pub struct Material {
    /// NDF maps of the example.
    pub maps: BakedNdfMaps,
    /// Placement on the surface.
    pub placement: BakedPlacement,
}

/// A tile's share of a footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileTerm {
    /// Index of the tile.
    pub tile: u32,
    /// Palette entry of the example that shows it.
    pub class: u32,
    /// Share of the footprint.
    pub weight: f32,
}

/// A Gaussian lobe in the surface's projected-normal disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeTerm {
    /// Mean projected normal.
    pub mean: Vec2,
    /// Inverse covariance: xx, xy, yy.
    pub inverse: [f32; 3],
    /// Share of the footprint times the lobe's density at its mean.
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
            let TransformRecord { normal_to_local, .. } = self.placement.palette[term.class as usize];
            let to_local = matrix(normal_to_local);
            sum += term.weight * to_local.determinant().abs() * self.maps.tile_density(term.tile, to_local * s);
        }
        for lobe in &terms.lobes {
            let d = s - lobe.mean;
            let [xx, xy, yy] = lobe.inverse;
            sum += lobe.peak * (-0.5 * (xx * d.x * d.x + 2.0 * xy * d.x * d.y + yy * d.y * d.y)).exp();
        }
        sum
    }
}

impl BakedNdfMaps {
    /// Density of one tile at the example's projected normal `s`: bilinear between decoded texels, 0 outside the box.
    pub fn tile_density(&self, tile: u32, s: Vec2) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let record = &self.tiles[tile as usize];
        let (width, height) = (record.width() as i32, record.height() as i32);
        let p = (s - Vec2::from(record.origin)) * Vec2::from(record.inv_spacing);
        let cell = p.floor();
        let f = p - cell;
        let (i, j) = (cell.x as i32, cell.y as i32);
        if i < -1 || j < -1 || i >= width || j >= height {
            return 0.0;
        }
        let texel = |i: i32, j: i32| {
            if i < 0 || j < 0 || i >= width || j >= height {
                return 0.0;
            }
            self.texel(record.texel_offset as usize + (j * width + i) as usize)
        };
        let top = texel(i, j) * (1.0 - f.x) + texel(i + 1, j) * f.x;
        let bottom = texel(i, j + 1) * (1.0 - f.x) + texel(i + 1, j + 1) * f.x;
        record.scale * (top * (1.0 - f.y) + bottom * f.y)
    }

    /// Decoded density texel, relative to its tile's scale.
    fn texel(&self, at: usize) -> f32 {
        match self.params.storage {
            DensityStorage::SqrtU8 => {
                let root = self.density[at] as f32 / 255.0;
                root * root
            }
            DensityStorage::F16 => f16::from_le_bytes([self.density[2 * at], self.density[2 * at + 1]]).to_f32(),
            DensityStorage::PaperF32 => {
                let b = &self.density[4 * at..4 * at + 4];
                f32::from_le_bytes([b[0], b[1], b[2], b[3]])
            }
        }
    }

    /// Projected normal of texel (i, j), wrapped or clamped.
    fn normal(&self, i: i32, j: i32) -> Vec2 {
        let (w, h) = (self.params.width as i32, self.params.height as i32);
        let (i, j) = match self.params.wrap {
            Wrap::Repeat => (i.rem_euclid(w), j.rem_euclid(h)),
            Wrap::Clamp => (i.clamp(0, w - 1), j.clamp(0, h - 1)),
        };
        let [x, y] = self.normals[(j * w + i) as usize];
        Vec2::new(x as f32 / 32767.0, y as f32 / 32767.0)
    }

    /// Bilinear projected normal and Jacobian ∂s/∂u at `u` (example texels); the example repeats as a whole.
    pub fn normal_and_jacobian(&self, u: Vec2) -> (Vec2, Mat2) {
        let size = Vec2::new(self.params.width as f32, self.params.height as f32);
        let p = u - (u / size).floor() * size - 0.5;
        let cell = p.floor();
        let f = p - cell;
        let (i, j) = (cell.x as i32, cell.y as i32);
        let (s00, s10) = (self.normal(i, j), self.normal(i + 1, j));
        let (s01, s11) = (self.normal(i, j + 1), self.normal(i + 1, j + 1));
        let top = s00 + (s10 - s00) * f.x;
        let bottom = s01 + (s11 - s01) * f.x;
        let du = (s10 - s00) * (1.0 - f.y) + (s11 - s01) * f.y;
        (top + (bottom - top) * f.y, Mat2::from_cols(du, bottom - top))
    }
}

impl LobeTerm {
    /// Lobe of a sub-footprint: `mean` and `covariance` in the surface's disk, `weight` its share of the footprint.
    ///
    /// What would leave the disk is put back: across a rim that is straight at the lobe's scale, Φ(distance / σ) of the
    /// mass stays inside.
    pub fn new(mean: Vec2, covariance: Mat2, weight: f32) -> LobeTerm {
        let determinant = covariance.determinant().max(1e-20);
        let (xx, xy, yy) = (covariance.x_axis.x, covariance.x_axis.y, covariance.y_axis.y);
        let radius = mean.length();
        let outward = if radius > 0.0 { mean / radius } else { Vec2::X };
        let sigma = outward.dot(covariance * outward).max(1e-20).sqrt();
        let inside = 0.5 * (1.0 + libm::erff((1.0 - radius) / (sigma * std::f32::consts::SQRT_2)));
        let peak = weight / (2.0 * std::f32::consts::PI * determinant.sqrt() * inside.max(1e-3));
        LobeTerm { mean, inverse: [yy / determinant, -xy / determinant, xx / determinant], peak }
    }
}
