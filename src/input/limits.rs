//! What is refused before it is decoded, for every kind of file.

use super::error::InputError;
use crate::reading::{self, ReadError};
use glint_bake_core::error::BakeError;
use glint_formats::provenance::InputDigest;
use std::path::Path;

/// Most texels a side, the size that every GPU class we bake for can hold.
pub const MAX_SIDE: u32 = 16_384;

/// The bytes of a file or a pipe, when they fit. They are read once.
pub(super) fn read(path: &Path, max_memory: u64) -> Result<Vec<u8>, InputError> {
    let bytes = reading::read(path, max_memory).map_err(|error| match error {
        ReadError::Io(source) => InputError::Io { path: path.to_owned(), source },
        ReadError::TooLarge(found) => {
            let found = found.map_or("more".to_owned(), |found| format!("{found} bytes"));
            InputError::limit(
                path,
                format!("expected a file of at most {max_memory} bytes, found {found}; raise --max-memory"),
            )
        }
    })?;
    if bytes.is_empty() {
        return Err(InputError::bad(path, "the file is empty (0 bytes); expected an image"));
    }
    Ok(bytes)
}

/// Digest of a file's bytes under the name that packs record; a note when that is another name than the file's.
pub(super) fn digest(path: &Path, bytes: &[u8], notes: &mut Vec<String>) -> InputDigest {
    let (name, note) = reading::recorded_name(path);
    notes.extend(note);
    InputDigest::of(&name, bytes)
}

/// Refuses a size before anything is allocated for it. `decoder_bytes_per_texel` is what the decoder itself holds.
pub(super) fn check_size(
    path: &Path,
    (width, height): (u64, u64),
    decoder_bytes_per_texel: u64,
    max_memory: u64,
) -> Result<(), InputError> {
    if width == 0 || height == 0 {
        return Err(InputError::bad(path, format!("the image is {width}×{height}; expected at least 1×1 texels")));
    }
    if width.max(height) > MAX_SIDE as u64 {
        return Err(InputError::limit(
            path,
            format!(
                "the image is {width}×{height}; at most {MAX_SIDE} texels a side: scale it down or cut it into tiles"
            ),
        ));
    }
    // Four floats a texel while decoding, two floats in the finished map.
    let needed = width * height * (decoder_bytes_per_texel + 16 + 8);
    if needed > max_memory {
        return Err(InputError::limit(
            path,
            format!(
                "the image is {width}×{height} and needs {needed} bytes to load, the limit is {max_memory}; raise \
                 --max-memory or scale it down"
            ),
        ));
    }
    Ok(())
}

/// What a bake says of a file's content.
pub(super) fn from_bake(path: &Path, error: BakeError) -> InputError {
    match error {
        BakeError::LimitExceeded(what) => InputError::limit(path, what),
        BakeError::BadOption(what) | BakeError::BadInput(what) => InputError::bad(path, what),
    }
}
