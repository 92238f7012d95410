//! Vectors in, [`NormalMap`] out: what is mended, what is counted, what is refused.
//!
//! Mended and counted: lengths other than 1 (artists' maps are off on 40–100 % of their texels), a few zero lengths
//! (flat then), normals at or below the horizon (pushed just above it). Refused: NaN and infinities, too many zero
//! lengths, a map most of which lies below the horizon.

use super::map::NormalMap;
use super::raw::{GreenAxis, NormalOptions, RawNormals, ZERO_LENGTH, check_count};
use super::report::{Lengths, NormalReport};
use crate::error::{BakeError, Result};

/// Largest |s| of a projected normal: just inside the disk, so that z = √(1 − |s|²) stays away from 0.
pub const HORIZON: f64 = 1.0 - 1e-4;

/// Share of zero-length vectors above which a map is refused.
pub const MAX_ZERO_LENGTH: f64 = 0.01;

/// Share of texels with z ≤ 0 above which a map is refused.
pub const MAX_BELOW_HORIZON: f64 = 0.5;

impl NormalMap {
    /// Validates raw normals and measures them. Afterwards every projected normal is finite and at most [`HORIZON`]
    /// long, and +Y is up.
    ///
    /// # Errors
    /// `BadInput` for: an empty map or a wrong number of texels; NaN or infinity (the first such texel is named); more
    /// than [`MAX_ZERO_LENGTH`] of vectors without direction; more than [`MAX_BELOW_HORIZON`] with z ≤ 0.
    pub fn from_vectors(raw: &RawNormals, options: &NormalOptions) -> Result<(NormalMap, NormalReport)> {
        check_count(raw.width, raw.height, raw.vectors.len())?;
        let y_sign = match options.y {
            GreenAxis::Up => 1.0,
            GreenAxis::Down => -1.0,
        };
        let mut lengths = Lengths::new();
        let mut projected = Vec::with_capacity(raw.vectors.len());
        for (at, vector) in raw.vectors.iter().enumerate() {
            if !vector.iter().all(|c| c.is_finite()) {
                return Err(not_finite(at % raw.width as usize, at / raw.width as usize, vector));
            }
            let [x, y, z] = vector.map(|c| c as f64);
            let length = (x * x + y * y + z * z).sqrt();
            lengths.add(length, z);
            projected.push(project(x, y * y_sign, z, length));
        }
        refuse_if_no_normal_map(&lengths)?;
        let map = NormalMap { width: raw.width, height: raw.height, wrap: options.wrap, projected };
        let report = NormalReport::measure(&map, &lengths);
        Ok((map, report))
    }

    /// [`RawNormals::from_xy`], validated.
    ///
    /// # Errors
    /// As [`NormalMap::from_vectors`].
    pub fn from_xy(
        width: u32,
        height: u32,
        xy: &[[f32; 2]],
        options: &NormalOptions,
    ) -> Result<(NormalMap, NormalReport)> {
        NormalMap::from_vectors(&RawNormals::from_xy(width, height, xy)?, options)
    }

    /// [`RawNormals::from_heights`], validated; the green axis does not come into it.
    ///
    /// # Errors
    /// As [`RawNormals::from_heights`].
    pub fn from_heights(
        width: u32,
        height: u32,
        heights: &[f32],
        scale_texels: f32,
        wrap: glint_formats::Wrap,
    ) -> Result<(NormalMap, NormalReport)> {
        let raw = RawNormals::from_heights(width, height, heights, scale_texels, wrap)?;
        NormalMap::from_vectors(&raw, &NormalOptions { wrap, y: GreenAxis::Up })
    }
}

/// The projected unit normal, at most [`HORIZON`] long; flat where there is no direction.
fn project(x: f64, y: f64, z: f64, length: f64) -> [f32; 2] {
    let radius = x.hypot(y);
    if length < ZERO_LENGTH || radius == 0.0 {
        return [0.0, 0.0];
    }
    let sine = if z > 0.0 { (radius / length).min(HORIZON) } else { HORIZON };
    [(x / radius * sine) as f32, (y / radius * sine) as f32]
}

fn not_finite(x: usize, y: usize, vector: &[f32; 3]) -> BakeError {
    BakeError::BadInput(format!(
        "texel ({x}, {y}) holds ({}, {}, {}); every channel must be finite, so repair or repaint that texel",
        vector[0], vector[1], vector[2]
    ))
}

fn refuse_if_no_normal_map(lengths: &Lengths) -> Result<()> {
    let share = |count: u64| count as f64 / lengths.texels as f64;
    if share(lengths.zero) > MAX_ZERO_LENGTH {
        return Err(BakeError::BadInput(format!(
            "this is not a normal map: {} of {} texels are the zero vector (mid-grey), at most {:.0} % may be; \
             if these are heights, read them as a height map",
            lengths.zero,
            lengths.texels,
            MAX_ZERO_LENGTH * 100.0
        )));
    }
    if share(lengths.below_horizon) > MAX_BELOW_HORIZON {
        return Err(BakeError::BadInput(format!(
            "this is not a normal map: {} of {} texels have z ≤ 0 (black, or turned away from the surface), at most \
             {:.0} % may; expected tangent-space normals with z in the blue channel",
            lengths.below_horizon,
            lengths.texels,
            MAX_BELOW_HORIZON * 100.0
        )));
    }
    Ok(())
}
