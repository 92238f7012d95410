//! One channel of a picture as numbers, 0 to 1.

use super::error::InputError;
use super::options::Crop;
use super::pixels::{Pixels, Values};
use std::path::Path;

/// Difference between colours of a grey image: JPEG rounds each channel on its own, so allow two 8-bit steps.
const GREY: f32 = 2.25 / 255.0;

/// Alpha of a picture that holds something else in its colours; `flag` is what asks for it.
///
/// # Errors
/// A picture without alpha, a value that is not 0 to 1.
pub(super) fn alpha_of(
    path: &Path,
    Pixels { width, height, values, .. }: &Pixels,
    flag: &str,
    crop: Option<Crop>,
) -> Result<Vec<f32>, InputError> {
    let numbers = one_channel(path, *width, values, Some(3), flag)?;
    Ok(checked(path, "alpha of texel", numbers, (*width, *height), crop)?.0)
}

/// The part of a map that is used, and its size; `what` is what messages call a value.
///
/// # Errors
/// A part that is not inside, a value that is not 0 to 1, whose texel is named.
pub(super) fn checked(
    path: &Path,
    what: &str,
    mut numbers: Vec<f32>,
    mut size: (u32, u32),
    crop: Option<Crop>,
) -> Result<(Vec<f32>, (u32, u32)), InputError> {
    let mut from = (0, 0);
    if let Some(crop) = crop {
        numbers = cropped(path, numbers, size, crop)?;
        (size, from) = ((crop.w, crop.h), (crop.x, crop.y));
    }
    if let Some(at) = numbers.iter().position(|value| !(0.0..=1.0).contains(value)) {
        let (x, y) = (at as u32 % size.0 + from.0, at as u32 / size.0 + from.1);
        return Err(InputError::bad(path, format!("{what} ({x}, {y}) is {}; expected 0 to 1", numbers[at])));
    }
    Ok((numbers, size))
}

/// A column of red, green, blue, alpha; without one the image has to be grey. `flag` is what chooses it, for messages.
///
/// # Errors
/// Colours without a column, a column that is not there.
pub(super) fn one_channel(
    path: &Path,
    width: u32,
    values: &Values,
    channel: Option<usize>,
    flag: &str,
) -> Result<Vec<f32>, InputError> {
    match channel {
        Some(3) if !values.has_alpha() => {
            Err(InputError::bad(path, format!("{flag} asks for alpha, and the image has none")))
        }
        Some(channel) => Ok(values.texels().map(|texel| texel[channel]).collect()),
        None => {
            let differ = |a: f32, b: f32| (a - b).abs() > GREY;
            match values.texels().position(|c| differ(c[0], c[1]) || differ(c[1], c[2])) {
                None => Ok(values.texels().map(|texel| texel[1]).collect()),
                Some(at) => Err(InputError::bad(
                    path,
                    format!(
                        "expected a grey image, found colours at texel ({}, {}); say which channel to use with {flag} r, g, b or a",
                        at % width as usize,
                        at / width as usize
                    ),
                )),
            }
        }
    }
}

fn cropped(path: &Path, values: Vec<f32>, (width, height): (u32, u32), crop: Crop) -> Result<Vec<f32>, InputError> {
    let inside = |from: u32, count: u32, whole: u32| u64::from(from) + u64::from(count) <= u64::from(whole);
    if !inside(crop.x, crop.w, width) || !inside(crop.y, crop.h, height) {
        return Err(InputError::bad(
            path,
            format!(
                "the crop of {}×{} at ({}, {}) leaves the {width}×{height} map; with --crop all maps have the normal map's size",
                crop.w, crop.h, crop.x, crop.y
            ),
        ));
    }
    let rows = values.chunks_exact(width as usize).skip(crop.y as usize).take(crop.h as usize);
    Ok(rows.flat_map(|row| row[crop.x as usize..(crop.x + crop.w) as usize].iter().copied()).collect())
}
