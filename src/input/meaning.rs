//! What stored values mean: which of them are a normal or a height, and on which scale.

use super::error::InputError;
use super::limits::from_bake;
use super::options::{Channels, InputOptions};
use super::pixels::{Pixels, Stored, Values};
use glint_bake_core::normal_map::RawNormals;
use std::path::Path;

/// Pixels as raw normals; heights are turned into normals.
pub(super) fn raw_normals(
    path: &Path,
    pixels: Pixels,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<RawNormals, InputError> {
    let Pixels { width, height, values, stored } = pixels;
    stored.tag.clone().check(path, options, notes)?;
    if let Some(scale) = options.height {
        let heights = heights(path, width, values, &stored, notes)?;
        return RawNormals::from_heights(width, height, &heights, scale, options.wrap).map_err(|e| from_bake(path, e));
    }
    let mut vectors = vectors(path, values, notes)?;
    sign(&mut vectors, &stored, notes);
    match options.channels {
        Channels::Xyz => Ok(RawNormals { width, height, vectors }),
        Channels::Xy => {
            let xy: Vec<[f32; 2]> = vectors.iter().map(|v| [v[0], v[1]]).collect();
            RawNormals::from_xy(width, height, &xy).map_err(|e| from_bake(path, e))
        }
    }
}

/// The three colour channels; alpha is dropped.
fn vectors(path: &Path, values: Values, notes: &mut Vec<String>) -> Result<Vec<[f32; 3]>, InputError> {
    match values {
        Values::Rgb(colours) => Ok(colours),
        Values::Rgba(colours) => {
            if colours.iter().any(|c| c[3] != 1.0) {
                notes.push("the alpha channel holds data (often roughness or height); ignored".into());
            }
            Ok(colours.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
        }
        Values::Grey(_) => Err(InputError::bad(
            path,
            "the image has one channel (grey); expected a normal map in red, green, blue. For a height map give \
             --height SCALE, the height in texels of white",
        )),
    }
}

/// Brings stored values to −1…1: whole numbers as a shader does it; floats by which of both ranges they have. A file that
/// stores −1…1 has negative x or y, or else (all but flat) has them near 0 on average, where 0…1 has them near ½.
fn sign(vectors: &mut [[f32; 3]], stored: &Stored, notes: &mut Vec<String>) {
    if stored.bits.is_none() {
        let n = vectors.len() as f64;
        let negative = vectors.iter().filter(|c| c[0].min(c[1]) < -0.01).count() as f64 / n;
        let mean = vectors.iter().map(|c| (c[0] as f64 + c[1] as f64) / 2.0).sum::<f64>() / n;
        if negative > 0.001 || mean < 0.25 {
            notes.push("float values are −1…1; used as they are".into());
            return;
        }
        notes.push("float values are 0…1; decoded as 2v − 1".into());
    }
    for vector in vectors {
        *vector = vector.map(|unorm| 2.0 * unorm - 1.0);
    }
}

/// The heights in a grey image, or in a colour image that is grey in truth.
fn heights(
    path: &Path,
    width: u32,
    values: Values,
    stored: &Stored,
    notes: &mut Vec<String>,
) -> Result<Vec<f32>, InputError> {
    if stored.bits.is_some_and(|bits| bits <= 8) {
        notes.push(
            "8-bit heights: slopes come in steps of the scale / 510, which shows as terraces; prefer 16 bits".into(),
        );
    }
    let colours: Vec<[f32; 3]> = match values {
        Values::Grey(heights) => return Ok(heights),
        Values::Rgb(colours) => colours,
        Values::Rgba(colours) => colours.into_iter().map(|[r, g, b, _]| [r, g, b]).collect(),
    };
    // JPEG rounds each channel on its own, so allow two 8-bit steps.
    let same = |a: f32, b: f32| (a - b).abs() <= 2.25 / 255.0;
    if let Some(at) = colours.iter().position(|c| !same(c[0], c[1]) || !same(c[1], c[2])) {
        return Err(InputError::bad(
            path,
            format!(
                "the image is coloured (texel ({}, {})), but --height expects a grey height map; leave --height out for \
                 a normal map",
                at % width as usize,
                at / width as usize
            ),
        ));
    }
    notes.push("a colour image of grey heights; the green channel is used".into());
    Ok(colours.iter().map(|c| c[1]).collect())
}
