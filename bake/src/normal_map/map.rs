//! Projected normals on a grid of texels: look-up, bilinear interpolation, parts.

use super::raw::crop_rows;
use crate::error::Result;
use glam::{DMat2, DVec2};
use glint_formats::Wrap;

/// Projected normals s = (n_x, n_y) on a grid of texels, +X right and +Y up in the tangent plane; texel (i, j) has its
/// centre at (i + ½, j + ½), u right and v down.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// What lies beyond the edge.
    pub wrap: Wrap,
    /// Row-major, `width · height` entries, each of length at most 1.
    pub projected: Vec<[f32; 2]>,
}

impl NormalMap {
    /// Projected normal of texel (i, j); indices beyond the edge wrap or clamp.
    pub fn texel(&self, i: i64, j: i64) -> DVec2 {
        let (i, j) = match self.wrap {
            Wrap::Repeat => (i.rem_euclid(self.width as i64), j.rem_euclid(self.height as i64)),
            Wrap::Clamp => (i.clamp(0, self.width as i64 - 1), j.clamp(0, self.height as i64 - 1)),
        };
        let [x, y] = self.projected[j as usize * self.width as usize + i as usize];
        DVec2::new(x as f64, y as f64)
    }

    /// Bilinear projected normal at `u` (texels), and its Jacobian ∂s/∂u (columns ∂s/∂u_x, ∂s/∂u_y).
    pub fn bilinear(&self, u: DVec2) -> (DVec2, DMat2) {
        let p = u - 0.5;
        let cell = p.floor();
        let f = p - cell;
        let (i, j) = (cell.x as i64, cell.y as i64);
        let (s00, s10) = (self.texel(i, j), self.texel(i + 1, j));
        let (s01, s11) = (self.texel(i, j + 1), self.texel(i + 1, j + 1));
        let top = s00.lerp(s10, f.x);
        let bottom = s01.lerp(s11, f.x);
        let du = (s10 - s00).lerp(s11 - s01, f.y);
        (top.lerp(bottom, f.y), DMat2::from_cols(du, bottom - top))
    }

    /// The `width` × `height` texels from (x, y) on, as a map of its own with its own `wrap`.
    ///
    /// # Errors
    /// `BadOption` when the rectangle is empty or leaves the map.
    pub fn crop(&self, x: u32, y: u32, width: u32, height: u32, wrap: Wrap) -> Result<NormalMap> {
        let projected = crop_rows(&self.projected, (self.width, self.height), (x, y), (width, height))?;
        Ok(NormalMap { width, height, wrap, projected })
    }
}
