//! The surface as an explicit normal map: to look at, and to test against.

use super::baked::Synthesis;
use crate::error::{BakeError, Result};
use crate::normal_map::NormalMap;
use glint_formats::Wrap;
use rayon::prelude::*;

/// The `width` × `height` texels of the surface from (x, y) on, as a map that does not repeat.
///
/// # Errors
/// `BadInput` when `sample` has not the size the surface was made of; `BadOption` for an empty piece.
pub fn assemble(
    surface: &Synthesis,
    sample: &NormalMap,
    (x, y): (i32, i32),
    (width, height): (u32, u32),
) -> Result<NormalMap> {
    let params = &surface.params;
    if (sample.width, sample.height) != (params.sample_width, params.sample_height) {
        return Err(BakeError::BadInput(format!(
            "the surface is made of a sample of {}×{} texels, found one of {}×{}",
            params.sample_width, params.sample_height, sample.width, sample.height
        )));
    }
    if width == 0 || height == 0 || width > i32::MAX as u32 || height > i32::MAX as u32 {
        return Err(BakeError::BadOption(format!("a piece of {width}×{height} texels cannot be assembled")));
    }
    let mut projected = vec![[0.0; 2]; width as usize * height as usize];
    projected.par_chunks_mut(width as usize).enumerate().for_each(|(row, texels)| {
        for (column, texel) in texels.iter_mut().enumerate() {
            let (sx, sy) = surface.source_texel(x.wrapping_add(column as i32), y.wrapping_add(row as i32));
            *texel = sample.projected[sy as usize * sample.width as usize + sx as usize];
        }
    });
    Ok(NormalMap { width, height, wrap: Wrap::Clamp, projected })
}
