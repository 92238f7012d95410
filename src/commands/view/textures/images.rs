//! Images by their bytes, as textures: with their own mips where they have them, and with plain ones.

use super::ktx2_file::{self, is_ktx2};
use super::mips::{as_they_are, averaged};
use crate::exit::{Exit, Failure};
use crate::gltf::fault::Fault;
use crate::input::{Texels, picture_of};
use crate::reading::{self, ReadError};
use glint_view::methods::textures::MipImage;
use std::path::Path;
use std::rc::Rc;

/// An image with both kinds of mips; the same where it has none of its own.
#[derive(Clone, Debug)]
pub struct Image {
    pub image: Rc<MipImage>,
    pub plain: Rc<MipImage>,
}

impl Image {
    /// Of levels, the finest first.
    pub fn of_levels(size: (u32, u32), levels: &[Texels], srgb: bool) -> Image {
        let plain = Rc::new(averaged(size, &levels[0], srgb));
        let image = if levels.len() > 1 { Rc::new(as_they_are(size, levels, srgb)) } else { Rc::clone(&plain) };
        Image { image, plain }
    }
}

/// The bytes of a file of at most `limit` bytes.
///
/// # Errors
/// Why it can't be read.
pub fn bytes_of(path: &Path, limit: u64) -> Result<Vec<u8>, Failure> {
    reading::read(path, limit).map_err(|error| match error {
        ReadError::Io(error) => Failure::io(path, "cannot be read", &error),
        ReadError::TooLarge(_) => {
            let what = format!("{}: has more than {limit} bytes, the limit; raise --max-memory", path.display());
            Failure::new(Exit::LimitExceeded, what)
        }
    })
}

/// The image in these bytes; `label` is what messages call it, of the file at `path`. `srgb` says that it holds encoded colours.
///
/// # Errors
/// Bytes that are no image, damaged, of a kind that is not read, or too many.
pub fn image_of(path: &Path, label: &str, bytes: &[u8], srgb: bool, limit: u64) -> Result<Image, Failure> {
    if is_ktx2(bytes) {
        let mips = ktx2_file::read(bytes, limit).map_err(|fault: Fault| fault.of(label).at(path))?;
        return Ok(Image::of_levels(mips.size, &mips.levels, srgb));
    }
    let picture = picture_of(Path::new(label), bytes, limit).map_err(|error| {
        let failure = Failure::from(error);
        Failure::new(failure.exit, format!("{}: {}", path.display(), failure.message))
    })?;
    Ok(Image::of_levels((picture.width, picture.height), &[picture.texels], srgb))
}
