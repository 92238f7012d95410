//! OpenEXR: the channels of one layer of one part, as normals, as heights, or as linear radiance.
//!
//! The library reads headers and decompresses blocks. Which layer is meant, what the attributes change, and whether the
//! sizes that a file claims are possible, is decided here, before anything is allocated for them.

mod attributes;
mod blocks;
mod choice;
mod dwa;
mod fault;
mod header;
mod layers;
mod names;
#[cfg(test)]
mod tests;

use super::error::InputError;
use super::limits::check_size;
use super::options::{AlphaUse, InputOptions};
use super::pixels::{Pixels, Stored, Values};
use attributes::Subject;
use choice::{Choice, Need, Set, choose};
use header::File;
use std::path::Path;

/// The column of a texel that alpha is in.
const ALPHA: usize = 3;

/// Decodes the normals or, with `options.height`, the heights of an EXR file.
pub(super) fn decode(
    path: &Path,
    bytes: &[u8],
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<Pixels, InputError> {
    let need = match (options.height, options.channels.unwrap_or_default().two()) {
        (Some(_), _) => Need::Height,
        (None, None) if options.alpha == AlphaUse::default() => Need::Normals,
        (None, None) => Need::NormalsAndAlpha,
        (None, Some([x, y])) if x.max(y) < ALPHA => Need::TwoChannels,
        (None, Some(_)) => Need::WithAlpha,
    };
    let chosen = chosen(path, bytes, need, options, notes)?;
    attributes::check(path, &chosen.file, chosen.choice.part, Subject::Map(options.wrap), notes)?;
    let values = match chosen.choice.channels {
        Set::One(height) => {
            Values::Grey(chosen.read(path, height, options)?.into_iter().map(|[height]| height).collect())
        }
        Set::Two(xy) => Values::Rgb(chosen.read(path, xy, options)?.into_iter().map(|[x, y]| [x, y, 0.0]).collect()),
        Set::Three(xyz) => Values::Rgb(chosen.read(path, xyz, options)?),
        Set::Four(rgba) => Values::Rgba(chosen.read(path, rgba, options)?),
    };
    let stored = Stored { lossy: chosen.file.lossy(chosen.choice.part), ..Stored::default() };
    Ok(Pixels { width: chosen.size.0, height: chosen.size.1, values, stored })
}

/// Decodes an EXR file as linear RGB radiance with the primaries of Rec. 709; one channel is grey.
pub(super) fn decode_radiance(
    path: &Path,
    bytes: &[u8],
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<(u32, u32, Vec<[f32; 3]>), InputError> {
    let chosen = chosen(path, bytes, Need::Radiance, options, notes)?;
    let to_rec_709 = attributes::check(path, &chosen.file, chosen.choice.part, Subject::Environment, notes)?;
    let mut pixels = match chosen.choice.channels {
        Set::One([grey]) | Set::Two([grey, _]) => chosen.read(path, [grey; 3], options)?,
        Set::Three(rgb) | Set::Four([rgb @ .., _]) => chosen.read(path, rgb, options)?,
    };
    if let Some(matrix) = to_rec_709 {
        for pixel in pixels.iter_mut().filter(|pixel| pixel.iter().all(|value| value.is_finite())) {
            *pixel = (matrix * glam::DVec3::from(pixel.map(f64::from))).as_vec3().into();
        }
    }
    Ok((chosen.size.0, chosen.size.1, pixels))
}

/// A file and what is read of it.
struct Chosen<'a> {
    file: File<'a>,
    choice: Choice,
    size: (u32, u32),
}

/// Looks at all headers and chooses a layer, whose size must be within the limits.
fn chosen<'a>(
    path: &Path,
    bytes: &'a [u8],
    need: Need,
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<Chosen<'a>, InputError> {
    let file = File::open(bytes).map_err(|fault| fault.of(path))?;
    let choice = choose(&file.meta, need, options.layer.as_deref(), notes).map_err(|fault| fault.of(path))?;
    let size = file.meta.headers[choice.part].layer_size;
    check_size(path, (size.0 as u64, size.1 as u64), 0, options.max_memory)?;
    Ok(Chosen { size: (size.0 as u32, size.1 as u32), file, choice })
}

impl Chosen<'_> {
    fn read<const N: usize>(
        &self,
        path: &Path,
        channels: [usize; N],
        options: &InputOptions,
    ) -> Result<Vec<[f32; N]>, InputError> {
        blocks::read(path, &self.file, self.choice.part, channels, options.max_memory)
    }
}
