//! Heights in any float or grey form: one channel, or colours that are grey in truth.

use super::colour;
use crate::input::error::InputError;
use crate::input::options::InputOptions;
use crate::input::pixels::{Stored, Values};
use std::path::Path;

/// Difference between colours of a grey image: JPEG rounds each channel on its own, so allow two 8-bit steps.
const GREY: f32 = 2.25 / 255.0;

/// The heights; the value 1.0 is the scale high.
pub(super) fn heights(
    path: &Path,
    width: u32,
    values: Values,
    stored: &Stored,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<f32>, InputError> {
    let transfer = colour::transfer_of_heights(stored, options, notes);
    if stored.bits.is_some_and(|bits| bits <= 8) {
        notes.push(
            "8-bit heights: slopes come in steps of the scale / 510, which shows as terraces; prefer 16 bits".into(),
        );
    }
    if let Some(codec) = stored.lossy {
        notes.push(format!("{codec} is lossy: its errors of a few steps become slopes; prefer PNG, TIFF or EXR"));
    }
    let mut heights = grey(path, width, values, stored, notes)?;
    heights.iter_mut().for_each(|height| *height = transfer.decode(*height));
    note_range(&heights, stored, notes);
    Ok(heights)
}

fn grey(
    path: &Path,
    width: u32,
    values: Values,
    stored: &Stored,
    notes: &mut Vec<String>,
) -> Result<Vec<f32>, InputError> {
    match values {
        Values::Grey(heights) => return Ok(heights),
        Values::GreyAlpha(pairs) => return Ok(pairs.into_iter().map(|[grey, _]| grey).collect()),
        Values::Rgb(_) | Values::Rgba(_) | Values::Rgb8(_) | Values::Rgba8(_) => {}
    }
    // Floats may be of any size, and their roundings with them. A NaN is named with its texel later.
    let size = |a: f32| if stored.bits.is_none() { a.abs().max(1.0) } else { 1.0 };
    let differ = |a: f32, b: f32| (a - b).abs() > GREY * size(a);
    if let Some(at) = values.texels().position(|c| differ(c[0], c[1]) || differ(c[1], c[2])) {
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
    Ok(values.texels().map(|c| c[1]).collect())
}

/// Floats are not bound to 0…1, which the scale alone does not tell.
fn note_range(heights: &[f32], stored: &Stored, notes: &mut Vec<String>) {
    let finite = || heights.iter().copied().filter(|height| height.is_finite());
    let (least, most) = (finite().fold(f32::INFINITY, f32::min), finite().fold(f32::NEG_INFINITY, f32::max));
    if stored.bits.is_none() && (least < 0.0 || most > 1.0) {
        notes.push(format!("heights range from {least} to {most}; used as they are, 1.0 being the scale high"));
    }
}
