//! Which format a file has: by its first bytes; TGA, which has no magic number, by its footer or extension.

use std::path::Path;

use image::ImageFormat;

use super::error::InputError;
use super::foreign;

/// How OpenEXR files begin.
pub(super) const EXR_MAGIC: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

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
        self.named().0
    }

    /// Its name and the extensions that promise it.
    fn named(self) -> (&'static str, &'static [&'static str]) {
        match self {
            Format::Exr => ("EXR", &["exr"]),
            Format::Raster(raster) => match raster {
                ImageFormat::Png => ("PNG", &["png", "apng"]),
                ImageFormat::Jpeg => ("JPEG", &["jpg", "jpeg", "jfif", "jpe"]),
                ImageFormat::Tiff => ("TIFF", &["tif", "tiff", "btf", "tx"]),
                ImageFormat::WebP => ("WebP", &["webp"]),
                _ => ("TGA", &["tga", "vda", "icb", "vst"]),
            },
        }
    }
}

/// What is read as a map.
const MAPS: &str = "PNG, TGA, JPEG, TIFF, WebP or EXR";
/// What is read as an environment.
const ENVIRONMENTS: &str = "linear radiance as Radiance HDR or OpenEXR";

/// The format of a map.
pub(super) fn detect(path: &Path, bytes: &[u8]) -> Result<Format, InputError> {
    if let Some(format) = recognise(path, bytes) {
        return Ok(format);
    }
    if bytes.starts_with(b"#?") {
        return Err(InputError::unsupported(
            path,
            format!("the file is Radiance HDR, which is read as an environment only; expected a map as {MAPS}"),
        ));
    }
    Err(not_read(path, bytes, MAPS))
}

/// Why a file that is neither Radiance HDR nor OpenEXR is no environment.
pub(super) fn no_environment(path: &Path, bytes: &[u8]) -> InputError {
    match recognise(path, bytes) {
        Some(format) => InputError::unsupported(
            path,
            format!("the file is {}, which has no range for lights; expected {ENVIRONMENTS}", format.named().0),
        ),
        None => not_read(path, bytes, ENVIRONMENTS),
    }
}

/// A note when the name promises another format than the content has.
pub(super) fn extension_note(path: &Path, format: Format) -> Option<String> {
    let (name, extensions) = format.named();
    let found = extension(path);
    // A stream has no name that could promise anything.
    (!found.is_empty() && !extensions.contains(&found.as_str()))
        .then(|| format!("named .{found}, but the content is {name}; read as {name}"))
}

/// The format, when it is one that is read.
fn recognise(path: &Path, bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(EXR_MAGIC) {
        return Some(Format::Exr);
    }
    // The extension comes first for TGA: its first bytes are free and may look like anything short, such as "BM".
    let footer = bytes.ends_with(b"TRUEVISION-XFILE.\0");
    if footer || (extension(path) == "tga" && plausible_tga(bytes)) {
        return Some(Format::Raster(ImageFormat::Tga));
    }
    let raster = match bytes {
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', ..] => ImageFormat::Png,
        [b'I', b'I', b'*' | b'+', 0, ..] | [b'M', b'M', 0, b'*' | b'+', ..] => ImageFormat::Tiff,
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => ImageFormat::WebP,
        // JPEG-LS begins alike, and is told by its frame.
        [0xff, 0xd8, 0xff, ..] => ImageFormat::Jpeg,
        _ => return None,
    };
    Some(Format::Raster(raster))
}

/// A file that is not read: sound and of a known kind, or no image at all.
fn not_read(path: &Path, bytes: &[u8], expected: &str) -> InputError {
    match foreign::kind_of(bytes) {
        Some(kind) => InputError::unsupported(
            path,
            format!("the file is {}, which is not read; expected {expected}: {}", kind.name, kind.advice),
        ),
        None => InputError::bad(
            path,
            format!("the content is no image; expected {expected}, found {}", foreign::beginning(bytes)),
        ),
    }
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
