//! What stored values mean: which of them are a normal or a height, on which scale and by which curve.
//!
//! Each question has a file: is a texel painted at all (`coverage`), which channels hold the normal (`channels`), are values
//! encoded colours (`colour`), 0…1 or −1…1 (`scale`), in tangent space (`space`), what did a lossy codec do (`noise`), and
//! what does a height map hold (`heights`). What is taken is noted; what is ambiguous is refused, with the flags that say it.

mod channels;
mod colour;
mod coverage;
mod heights;
mod lengths;
mod noise;
mod scale;
mod space;

use super::error::InputError;
use super::limits::from_bake;
use super::options::InputOptions;
use super::pixels::{Pixels, Stored, Values};
use coverage::Coverage;
use glint_bake_core::normal_map::{RawNormals, lifted};
use scale::Scale;
use std::path::Path;

/// Pixels as raw normals; heights are turned into normals.
pub(super) fn raw_normals(
    path: &Path,
    pixels: Pixels,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<RawNormals, InputError> {
    let Pixels { width, height, values, stored } = pixels;
    if let Some(scale) = options.height {
        let heights = heights::heights(path, width, values, &stored, options, notes)?;
        return RawNormals::from_heights(width, height, &heights, scale, options.wrap).map_err(|e| from_bake(path, e));
    }
    let vectors = vectors(path, values, &stored, options, notes)?;
    Ok(RawNormals { width, height, vectors })
}

/// One vector a texel.
fn vectors(
    path: &Path,
    values: Values,
    stored: &Stored,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<[f32; 3]>, InputError> {
    let two = options.channels.and_then(|channels| channels.two());
    channels::check_there(path, &values, options.channels)?;
    let scale = Scale::of(&values, stored, notes);
    let coverage = Coverage::of(&values, stored, scale, two);
    if options.channels.is_none() {
        channels::refuse_two(path, &values, stored, scale, &coverage)?;
    }
    coverage.check(path, notes)?;
    coverage.note_alpha(&values, two, notes);
    let painted = || values.texels().filter(|texel| !coverage.is_unpainted(texel));
    let transfer = colour::transfer(path, painted, stored, scale, two.is_some(), options, notes)?;
    let colour = |v: f32| scale.signed(transfer.decode(v));

    let vector = |texel: [f32; 4]| {
        if coverage.is_unpainted(&texel) {
            return [0.0, 0.0, 1.0];
        }
        let [r, g, b, a] = texel;
        match two {
            None => [r, g, b].map(colour),
            Some(columns) => {
                // Alpha is linear whatever the colours are.
                let signed = [colour(r), colour(g), colour(b), scale.signed(a)];
                lifted(columns.map(|column| signed[column]))
            }
        }
    };
    let vectors: Vec<[f32; 3]> = values.texels().map(vector).collect();
    let measured = || {
        let painted = |(texel, vector): ([f32; 4], &[f32; 3])| (!coverage.is_unpainted(&texel)).then_some(*vector);
        values.texels().zip(&vectors).filter_map(painted)
    };
    if options.channels.is_none() {
        space::refuse_other_spaces(path, measured())?;
    }
    if let Some(codec) = stored.lossy {
        notes.push(noise::note(codec, two.is_some(), measured()));
    }
    Ok(vectors)
}
