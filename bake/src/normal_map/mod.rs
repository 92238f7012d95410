//! A validated normal map: projected normals in the unit disk, bilinear look-up, wrap.
//!
//! `raw` turns colours, two channels or heights into vectors; `validate` turns vectors into a [`NormalMap`];
//! `report` and `convention` measure what came in.
//!
//! The green axis: row 0 of an image is its top and v grows downwards, while tangent space has +Y up. So y = −v, and
//! over a height field h(u, v) the normal is proportional to (−∂h/∂u, **+**∂h/∂v, 1): the upper side of a bump is
//! bright green. A map with [`GreenAxis::Down`] (DirectX) stores −n_y instead; it is negated once, on the way in.

mod convention;
mod raw;
mod report;
mod validate;

#[cfg(test)]
mod tests;

pub use raw::{GreenAxis, NormalOptions, RawNormals};
pub use report::{NormalReport, SEAM_RATIO, SeamRatio};
pub use validate::{HORIZON, MAX_BELOW_HORIZON, MAX_ZERO_LENGTH, ZERO_LENGTH};

use glam::{DMat2, DVec2};
use glint_formats::Wrap;

use crate::error::{BakeError, Result};

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

/// The texels of a rectangle, row by row.
fn crop_rows<T: Copy>(texels: &[T], of: (u32, u32), from: (u32, u32), size: (u32, u32)) -> Result<Vec<T>> {
    let inside = |start: u32, length: u32, whole: u32| length > 0 && start as u64 + length as u64 <= whole as u64;
    if !inside(from.0, size.0, of.0) || !inside(from.1, size.1, of.1) {
        return Err(BakeError::BadOption(format!(
            "a crop of {}×{} at ({}, {}) must have at least one texel and lie inside the {}×{} map",
            size.0, size.1, from.0, from.1, of.0, of.1
        )));
    }
    let mut out = Vec::with_capacity(size.0 as usize * size.1 as usize);
    for row in from.1..from.1 + size.1 {
        let start = row as usize * of.0 as usize + from.0 as usize;
        out.extend_from_slice(&texels[start..start + size.0 as usize]);
    }
    Ok(out)
}
