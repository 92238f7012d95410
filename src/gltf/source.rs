//! Bytes of images and files of a glTF file (specification, section 2.8): inside it, or in its folder. Nothing else is read: a file
//! of a stranger must not reach other files, or the network.

use super::document::{Document, missing};
use super::fault::Fault;
use super::uri::file_of;
use crate::reading::{self, ReadError};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;
use std::path::Path;

/// Where a file's bytes come from.
pub struct Source<'a> {
    pub document: &'a Document,
    /// The binary chunk of a GLB.
    pub binary: Option<&'a [u8]>,
    /// Folder of the file.
    pub folder: &'a Path,
    /// Most bytes of one image or buffer.
    pub limit: u64,
}

impl Source<'_> {
    /// The bytes of an image.
    ///
    /// # Errors
    /// What is wrong with it, or with the file that it lies in.
    pub fn image(&self, index: usize) -> Result<Vec<u8>, Fault> {
        let image = self.document.image(index)?;
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), None) => self.fetch(uri),
            (None, Some(view)) => self.view(view),
            _ => Err(Fault::bad("it has no bytes, or two places for them; export it anew")),
        };
        bytes.map_err(|fault| fault.of(&format!("image {index}")))
    }

    fn view(&self, index: usize) -> Result<Vec<u8>, Fault> {
        let views = &self.document.buffer_views;
        let view = views.get(index).ok_or_else(|| missing("buffer view", index, views.len()))?;
        let buffer = self.buffer(view.buffer)?;
        let end = view.byte_offset.checked_add(view.byte_length).and_then(|end| usize::try_from(end).ok());
        let bytes = end.and_then(|end| buffer.get(usize::try_from(view.byte_offset).ok()?..end));
        bytes.map(<[u8]>::to_vec).ok_or_else(|| {
            let (at, length, there) = (view.byte_offset, view.byte_length, buffer.len());
            Fault::bad(format!(
                "buffer view {index} has {length} bytes from byte {at} on, its buffer has {there}; export it anew"
            ))
        })
    }

    /// The bytes of a buffer.
    ///
    /// # Errors
    /// What is wrong with it, or with the file that it lies in.
    pub fn buffer(&self, index: usize) -> Result<Cow<'_, [u8]>, Fault> {
        let buffers = &self.document.buffers;
        let buffer = buffers.get(index).ok_or_else(|| missing("buffer", index, buffers.len()))?;
        let bytes: Result<Cow<'_, [u8]>, Fault> = match (&buffer.uri, self.binary) {
            (Some(uri), _) => self.fetch(uri).map(Cow::Owned),
            (None, Some(binary)) if index == 0 => Ok(Cow::Borrowed(binary)),
            _ => Err(Fault::bad("it has no bytes in the file; export it anew")),
        };
        let bytes = bytes.map_err(|fault| fault.of(&format!("buffer {index}")))?;
        if (bytes.len() as u64) < buffer.byte_length {
            let (found, expected) = (bytes.len(), buffer.byte_length);
            let what = format!("buffer {index} has {found} bytes where {expected} are declared; export it anew");
            return Err(Fault::bad(what));
        }
        let length = buffer.byte_length as usize;
        Ok(match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..length]),
            Cow::Owned(mut bytes) => {
                bytes.truncate(length);
                Cow::Owned(bytes)
            }
        })
    }

    fn fetch(&self, uri: &str) -> Result<Vec<u8>, Fault> {
        if let Some(data) = uri.strip_prefix("data:") {
            let text = data.split_once(";base64,").map(|(_, text)| text);
            return decoded(text.ok_or_else(|| Fault::bad("its data URI is not base64; export it as a file"))?);
        }
        let path = self.folder.join(file_of(uri)?);
        // A pipe or a device may never end.
        let meta = std::fs::metadata(&path).and_then(|meta| reading::check_regular(&meta));
        meta.map_err(|error| Fault::io(&path, &error))?;
        reading::read(&path, self.limit).map_err(|error| match error {
            ReadError::Io(error) => Fault::io(&path, &error),
            ReadError::TooLarge(_) => Fault::limit(format!(
                "{} has more than {} bytes, the limit; raise --max-memory",
                path.display(),
                self.limit
            )),
        })
    }
}

/// Bytes of a text in base64; padding may be left out.
fn decoded(text: &str) -> Result<Vec<u8>, Fault> {
    let config = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    GeneralPurpose::new(&STANDARD, config)
        .decode(text)
        .map_err(|error| Fault::bad(format!("its data URI is not base64: {error}; export it anew")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn padding_may_be_left_out() {
        assert_eq!(decoded("AAE=").unwrap(), decoded("AAE").unwrap());
        assert!(decoded("A*").is_err());
    }
}
