//! Projected normals on a grid of texels: look-up, bilinear interpolation, parts.

use super::raw::crop_rows;
use crate::error::Result;
use crate::wrap::wrapped_far;
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
        self.stored(wrapped_far(i, self.width as i64, self.wrap), wrapped_far(j, self.height as i64, self.wrap))
    }

    /// Projected normal of texel (i, j) within the map.
    fn stored(&self, i: i64, j: i64) -> DVec2 {
        let [x, y] = self.projected[j as usize * self.width as usize + i as usize];
        DVec2::new(x as f64, y as f64)
    }

    /// Bilinear projected normal at `u` (texels), and its Jacobian ∂s/∂u (columns ∂s/∂u_x, ∂s/∂u_y).
    pub fn bilinear(&self, u: DVec2) -> (DVec2, DMat2) {
        let p = u - 0.5;
        let cell = p.floor();
        let f = p - cell;
        // Each column and row is wrapped once for the two texels that lie in it.
        let around = |first: f64, size: u32| [0, 1].map(|k| wrapped_far(first as i64 + k, size as i64, self.wrap));
        let ([left, right], [upper, lower]) = (around(cell.x, self.width), around(cell.y, self.height));
        let (s00, s10) = (self.stored(left, upper), self.stored(right, upper));
        let (s01, s11) = (self.stored(left, lower), self.stored(right, lower));
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
