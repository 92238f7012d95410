//! From a file on disk to a validated environment: Radiance HDR or OpenEXR, linear radiance, equirectangular.
//!
//! Values are taken as they are: an exposure that a Radiance header names is not undone, as in most programs, and noted.

use super::error::InputError;
use super::exr;
use super::format::no_environment;
use super::guard::guarded;
use super::limits::{check_size, digest, from_bake, read};
use super::options::InputOptions;
use glint_bake_core::environment::EnvironmentImage;
use glint_formats::provenance::InputDigest;
use image::codecs::hdr::HdrDecoder;
use image::{ImageDecoder, ImageError};
use std::io::Cursor;
use std::path::Path;

/// An environment with where it came from and what was noticed.
#[derive(Clone, Debug)]
pub struct LoadedEnvironment {
    /// The validated image.
    pub image: EnvironmentImage,
    /// Digest of the bytes that were read.
    pub digest: InputDigest,
    /// What the user should know, one sentence each.
    pub warnings: Vec<String>,
}

/// Loads and validates an equirectangular environment.
///
/// `layer` names the layer of an EXR file to read; when not given, the one of colours is found.
///
/// # Errors
/// [`InputError`]; each kind has its own exit code, and the message names the file, what was expected and found, and
/// what to do. Pixels that are NaN or infinite are named.
pub fn load_environment(path: &Path, layer: Option<&str>, max_memory: u64) -> Result<LoadedEnvironment, InputError> {
    let options = InputOptions { layer: layer.map(str::to_owned), max_memory, ..InputOptions::default() };
    let bytes = read(path, max_memory)?;
    let mut warnings = Vec::new();
    let (width, height, pixels) = guarded(path, || decode(path, &bytes, &options, &mut warnings))?;
    let image = EnvironmentImage::new(width, height, pixels).map_err(|e| from_bake(path, e))?;
    if let Some((x, y)) = image.report.first_negative {
        let count = image.report.negative_pixels;
        warnings.push(format!("{count} pixels are negative, the first of them ({x}, {y}); taken as 0"));
    }
    let digest = digest(path, &bytes, &mut warnings);
    Ok(LoadedEnvironment { image, digest, warnings })
}

/// Pixels of any format.
fn decode(
    path: &Path,
    bytes: &[u8],
    options: &InputOptions,
    warnings: &mut Vec<String>,
) -> Result<(u32, u32, Vec<[f32; 3]>), InputError> {
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        exr::decode_radiance(path, bytes, options, warnings)
    } else if bytes.starts_with(b"#?") {
        options.check_has_layers(path, "Radiance HDR")?;
        decode_hdr(path, bytes, options, warnings)
    } else {
        Err(no_environment(path, bytes))
    }
}

fn decode_hdr(
    path: &Path,
    bytes: &[u8],
    options: &InputOptions,
    notes: &mut Vec<String>,
) -> Result<(u32, u32, Vec<[f32; 3]>), InputError> {
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(|e| from_image(path, e))?;
    let meta = decoder.metadata();
    let size = (u64::from(meta.width), u64::from(meta.height));
    check_size(path, size, 16, options.max_memory)?;
    // Run lengths stand for at most 127 values in two bytes, so a short file cannot hold many pixels.
    if size.0 * size.1 / 128 > bytes.len() as u64 {
        return Err(InputError::bad(
            path,
            "the file is cut off: it ends before the image does; copy or export it again",
        ));
    }
    if let Some(exposure) = meta.exposure.filter(|exposure| *exposure != 1.0) {
        notes.push(format!("the header names an exposure of {exposure}; radiance is taken as it is stored"));
    }
    let mut raw = vec![0; decoder.total_bytes() as usize];
    decoder.read_image(&mut raw).map_err(|e| from_image(path, e))?;
    let value = |b: &[u8]| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]);
    let pixels = raw.chunks_exact(12).map(|p| [value(&p[..4]), value(&p[4..8]), value(&p[8..])]).collect();
    Ok((meta.width, meta.height, pixels))
}

fn from_image(path: &Path, error: ImageError) -> InputError {
    match error {
        ImageError::Unsupported(e) => InputError::unsupported(path, format!("{e}; export it again")),
        ImageError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
            InputError::bad(path, "the file is cut off: it ends before the image does; copy or export it again")
        }
        other => InputError::bad(path, format!("the HDR image is damaged: {other}; copy or export it again")),
    }
}
