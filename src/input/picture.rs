//! Images of any meaning, as textures have them: four channels a texel, as stored.

use super::error::InputError;
use super::guard::guarded;
use super::normal_map::decode;
use super::options::InputOptions;
use super::pixels::{Pixels, Values, unorm8};
use std::path::Path;

/// Texels, row by row; grey is all three colours, and alpha is 1 where there is none.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 8 bits a channel.
    Bytes(Vec<[u8; 4]>),
    /// More than that, 0 to 1.
    Floats(Vec<[f32; 4]>),
}

impl Texels {
    /// A texel by number, 0 to 1.
    pub fn texel(&self, at: usize) -> [f32; 4] {
        match self {
            Texels::Bytes(texels) => texels[at].map(unorm8),
            Texels::Floats(texels) => texels[at],
        }
    }
}

/// An image.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// All of them.
    pub texels: Texels,
}

/// The image in these bytes; `path` is what messages call them.
///
/// # Errors
/// [`InputError`]: bytes that are no image, or larger than the limit.
pub fn picture_of(path: &Path, bytes: &[u8], max_memory: u64) -> Result<Picture, InputError> {
    let options = InputOptions { max_memory, ..InputOptions::default() };
    let (Pixels { width, height, values, stored }, _) = guarded(path, || decode(path, bytes, &options))?;
    let texels = match values {
        Values::Rgb8(texels) => Texels::Bytes(texels.into_iter().map(|[r, g, b]| [r, g, b, 255]).collect()),
        Values::Rgba8(texels) => Texels::Bytes(texels),
        // Grey of few bits has been widened to floats.
        values if stored.bits.is_some_and(|bits| bits <= 8) => {
            Texels::Bytes(values.texels().map(|texel| texel.map(|value| (value * 255.0).round() as u8)).collect())
        }
        values => Texels::Floats(values.texels().collect()),
    };
    Ok(Picture { width, height, texels })
}
