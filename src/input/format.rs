//! Which format a file has: by its first bytes; TGA, which has no magic number, by its footer or extension.

use std::path::Path;

use image::ImageFormat;

use super::error::InputError;

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// OpenEXR.
    Exr,
    /// PNG, JPEG, TGA, TIFF or WebP.
    Raster(ImageFormat),
}

impl Format {
    /// What it is called.
    pub fn name(self) -> &'static str {
        self.name_and_extensions().0
    }

    fn name_and_extensions(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Format::Exr => ("EXR", &["exr"]),
            Format::Raster(raster) => match raster {
                ImageFormat::Png => ("PNG", &["png"]),
                ImageFormat::Jpeg => ("JPEG", &["jpg", "jpeg", "jfif"]),
                ImageFormat::Tiff => ("TIFF", &["tif", "tiff"]),
                ImageFormat::WebP => ("WebP", &["webp"]),
                _ => ("TGA", &["tga", "vda", "icb", "vst"]),
            },
        }
    }
}

/// Formats that are recognised only to be refused with a better message.
const NOT_READ: [(&[u8], &str); 8] = [
    (b"\xabKTX 20\xbb\r\n\x1a\n", "KTX2"),
    (b"\xabKTX 11\xbb\r\n\x1a\n", "KTX"),
    (b"DDS ", "DDS"),
    (b"#?RADIANCE", "Radiance HDR"),
    (b"GIF8", "GIF"),
    (b"BM", "BMP"),
    (b"8BPS", "Photoshop"),
    (b"RIFX", "big-endian RIFF"),
];

const READ: &str = "PNG, TGA, JPEG, TIFF, WebP or EXR";

/// The format of a file.
pub(super) fn detect(path: &Path, bytes: &[u8]) -> Result<Format, InputError> {
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return Ok(Format::Exr);
    }
    // The extension comes first for TGA: its first bytes are free and may look like anything short, such as "BM".
    let footer = bytes.ends_with(b"TRUEVISION-XFILE.\0");
    if footer || (extension(path) == "tga" && plausible_tga(bytes)) {
        return Ok(Format::Raster(ImageFormat::Tga));
    }
    if let Some((_, name)) = NOT_READ.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Err(InputError::unsupported(
            path,
            format!("the file is {name}, which is not read; expected {READ}: convert it without changing its values"),
        ));
    }
    match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Tiff | ImageFormat::WebP)) => {
            Ok(Format::Raster(format))
        }
        Ok(other) => Err(InputError::unsupported(
            path,
            format!(
                "the file is {other:?}, which is not read; expected {READ}: convert it without changing its values"
            ),
        )),
        Err(_) => Err(InputError::bad(
            path,
            format!("the content is no image; expected {READ}, found bytes starting with {}", first_bytes(bytes)),
        )),
    }
}

/// A note when the name promises another format than the content has.
pub(super) fn extension_note(path: &Path, format: Format) -> Option<String> {
    let (name, extensions) = format.name_and_extensions();
    let found = extension(path);
    (!extensions.contains(&found.as_str()))
        .then(|| format!("named .{found}, but the content is {name}; read as {name}"))
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Whether a header can be one of TGA: known colour map and image types, a known depth.
fn plausible_tga(bytes: &[u8]) -> bool {
    bytes.len() > 18
        && bytes[1] <= 1
        && matches!(bytes[2], 1 | 2 | 3 | 9 | 10 | 11)
        && matches!(bytes[16], 8 | 15 | 16 | 24 | 32)
}

/// The start of a file, as far as it is printable.
fn first_bytes(bytes: &[u8]) -> String {
    format!("\"{}\"", bytes[..bytes.len().min(12)].escape_ascii())
}
