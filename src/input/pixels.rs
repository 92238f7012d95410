//! Decoded pixels: grey heights 0…1, or colours as vectors −1…1.

use std::path::Path;

use super::error::InputError;

/// Decoded pixels, row-major from the top left.
pub(super) struct Pixels {
    pub width: u32,
    pub height: u32,
    pub values: Values,
}

/// What the pixels hold.
pub(super) enum Values {
    /// One channel, as stored: 0…1, or any float.
    Grey(Vec<f32>),
    /// Red, green, blue as −1…1.
    Colour(Vec<[f32; 3]>),
}

/// UNORM 0…1 → −1…1, as a shader does it.
pub(super) fn signed(unorm: f32) -> f32 {
    2.0 * unorm - 1.0
}

/// Brings float colours to −1…1. A file that stores −1…1 has negative x or y, or else (all but flat) has them near 0 on
/// average, where 0…1 has them near ½.
pub(super) fn sign_floats(colours: &mut [[f32; 3]], notes: &mut Vec<String>) {
    let n = colours.len() as f64;
    let negative = colours.iter().filter(|c| c[0].min(c[1]) < -0.01).count() as f64 / n;
    let mean = colours.iter().map(|c| (c[0] as f64 + c[1] as f64) / 2.0).sum::<f64>() / n;
    if negative > 0.001 || mean < 0.25 {
        notes.push("float values are −1…1; used as they are".into());
        return;
    }
    notes.push("float values are 0…1; decoded as 2v − 1".into());
    for colour in colours {
        *colour = colour.map(signed);
    }
}

/// The heights in a colour image that is grey in truth.
pub(super) fn grey_of(
    path: &Path,
    width: u32,
    colours: &[[f32; 3]],
    notes: &mut Vec<String>,
) -> Result<Vec<f32>, InputError> {
    // JPEG rounds each channel on its own, so allow two 8-bit steps.
    let same = |a: f32, b: f32| (a - b).abs() <= 4.5 / 255.0;
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
    Ok(colours.iter().map(|c| 0.5 * (c[1] + 1.0)).collect())
}
