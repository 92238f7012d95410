//! Normals as they come in, before any check: vectors, two channels, or the slopes of a height field.

use glint_formats::Wrap;
use serde::{Deserialize, Serialize};

use crate::error::{BakeError, Result};

/// Vectors shorter than this have no direction. The nearest that 8 bits come to a zero vector, (128, 128, 128), has
/// length 0.0068.
pub const ZERO_LENGTH: f64 = 0.01;

/// Which way the map's second channel points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum GreenAxis {
    /// +Y up, as OpenGL, Vulkan samples, glTF and Blender write it.
    Up,
    /// +Y down, as DirectX and Unreal write it.
    Down,
}

/// How raw normals are to be understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NormalOptions {
    /// What lies beyond the edge.
    pub wrap: Wrap,
    /// Which way the second channel points.
    pub y: GreenAxis,
}

/// Normals as decoded: one vector a texel, row-major, of any length; channels already mapped to −1…1.
#[derive(Clone, Debug, PartialEq)]
pub struct RawNormals {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// `width · height` vectors (x, y, z).
    pub vectors: Vec<[f32; 3]>,
}

impl RawNormals {
    /// Two-channel normals (BC5 style): z = √(1 − x² − y²). Where x² + y² ≥ 1 there is no such z; it is then 0, so that
    /// the texel shows up as `below_horizon` in the report, and as `off_unit` when it is out by more than 1 %.
    ///
    /// # Errors
    /// `BadInput` when `xy` has not `width · height` entries or the map is empty.
    pub fn from_xy(width: u32, height: u32, xy: &[[f32; 2]]) -> Result<RawNormals> {
        check_count(width, height, xy.len())?;
        Ok(RawNormals { width, height, vectors: xy.iter().copied().map(lifted).collect() })
    }

    /// Unit normals of a height field by central differences, +Y up. `scale_texels` is the height, in texels, of the
    /// value 1.0. Beyond the edge a repeating field goes on at the other side; a clamped one ends, so that its edge
    /// texels use the one neighbour that they have.
    ///
    /// # Errors
    /// `BadInput` when `heights` has not `width · height` entries, the map is empty, or a height is NaN or infinite
    /// (named); `BadOption` when the scale is not finite or is 0.
    pub fn from_heights(width: u32, height: u32, heights: &[f32], scale_texels: f32, wrap: Wrap) -> Result<RawNormals> {
        check_count(width, height, heights.len())?;
        if !scale_texels.is_finite() || scale_texels == 0.0 {
            return Err(BakeError::BadOption(format!(
                "the height scale must be a finite number of texels other than 0, found {scale_texels}"
            )));
        }
        let (w, h) = (width as usize, height as usize);
        if let Some(at) = heights.iter().position(|value| !value.is_finite()) {
            return Err(BakeError::BadInput(format!(
                "the height at texel ({}, {}) is {}; every height must be finite",
                at % w,
                at / w,
                heights[at]
            )));
        }
        let mut vectors = Vec::with_capacity(heights.len());
        for j in 0..h {
            let (up, down, rows) = neighbours(j, h, wrap);
            for i in 0..w {
                let (left, right, columns) = neighbours(i, w, wrap);
                let slope = |from: f32, to: f32, steps: f32| (to - from) * scale_texels / steps;
                let du = slope(heights[j * w + left], heights[j * w + right], columns);
                let dv = slope(heights[up * w + i], heights[down * w + i], rows);
                let length = (du * du + dv * dv + 1.0).sqrt();
                vectors.push([-du / length, dv / length, 1.0 / length]);
            }
        }
        Ok(RawNormals { width, height, vectors })
    }

    /// The `width` × `height` texels from (x, y) on.
    ///
    /// # Errors
    /// `BadOption` when the rectangle is empty or leaves the map.
    pub fn crop(&self, x: u32, y: u32, width: u32, height: u32) -> Result<RawNormals> {
        let vectors = crop_rows(&self.vectors, (self.width, self.height), (x, y), (width, height))?;
        Ok(RawNormals { width, height, vectors })
    }
}

/// A vector of two of its components: z = √(1 − x² − y²), 0 where there is no such number.
pub fn lifted([x, y]: [f32; 2]) -> [f32; 3] {
    let rest = 1.0 - x * x - y * y;
    // A NaN must stay one, to be found and named with its texel; f32::max would swallow it.
    [x, y, if rest < 0.0 { 0.0 } else { rest.sqrt() }]
}

/// Indices before and after `i` on an axis of `n` texels, and the distance between them (1 on an axis of one texel,
/// where both are the same and the difference is 0 anyway).
fn neighbours(i: usize, n: usize, wrap: Wrap) -> (usize, usize, f32) {
    match wrap {
        Wrap::Repeat => ((i + n - 1) % n, (i + 1) % n, 2.0),
        Wrap::Clamp => {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(n - 1));
            (before, after, (after - before).max(1) as f32)
        }
    }
}

/// A map has at least one texel and one entry a texel.
pub(super) fn check_count(width: u32, height: u32, entries: usize) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(BakeError::BadInput(format!("the map is empty ({width}×{height}); it needs at least one texel")));
    }
    if width as u64 * height as u64 != entries as u64 {
        return Err(BakeError::BadInput(format!(
            "a {width}×{height} map needs {} texels, found {entries}",
            width as u64 * height as u64
        )));
    }
    Ok(())
}

/// The texels of a rectangle that is `size` large and begins at `from`, row by row, out of an image that is `of` large.
///
/// # Errors
/// `BadOption` when the rectangle is empty or leaves the image.
pub fn crop_rows<T: Copy>(texels: &[T], of: (u32, u32), from: (u32, u32), size: (u32, u32)) -> Result<Vec<T>> {
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
