//! From a file on disk to a validated environment: Radiance HDR or OpenEXR, linear radiance, equirectangular.

use super::error::InputError;
use super::exr;
use super::format::{EXR_MAGIC, no_environment};
use super::guard::guarded;
use super::limits::{digest, from_bake, read};
use super::options::InputOptions;
use super::radiance;
use glint_bake_core::environment::EnvironmentImage;
use glint_formats::provenance::InputDigest;
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
pub(super) fn decode(
    path: &Path,
    bytes: &[u8],
    options: &InputOptions,
    warnings: &mut Vec<String>,
) -> Result<(u32, u32, Vec<[f32; 3]>), InputError> {
    if bytes.starts_with(EXR_MAGIC) {
        exr::decode_radiance(path, bytes, options, warnings)
    } else if bytes.starts_with(radiance::MAGIC) {
        options.check_has_layers(path, "Radiance HDR")?;
        radiance::decode(path, bytes, options.max_memory, warnings)
    } else {
        Err(no_environment(path, bytes))
    }
}
