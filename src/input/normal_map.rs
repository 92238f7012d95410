//! From a file on disk to a validated normal map: format by content, limits before decoding, errors that name the file.
//!
//! Rules for every format:
//! - 8- and 16-bit values decode as a GPU reads UNORM: v / (2ᵇ − 1), then n = 2x − 1. So (128, 128, 255), which painting
//!   programs mean as flat, leans by 0.0039; that is what a renderer sees, and so what is baked.
//! - Float values are 0…1 or −1…1; which of them is told from the data and noted.
//! - Normals are linear data, whatever a file's colour tag says: tags are believed only where the data bear them out
//!   (`meaning`).

use super::error::InputError;
use super::format::{self, Format};
use super::guard::guarded;
use super::limits::{digest, from_bake, read};
use super::options::{AlphaUse, Channels, Crop, InputOptions};
use super::pixels::Pixels;
use super::{exr, meaning, one_channel, raster, tiff_file};
use glint_bake_core::normal_map::{GreenAxis, NormalMap, NormalOptions, NormalReport};
use glint_formats::provenance::InputDigest;
use image::ImageFormat;
use std::path::Path;

/// Mean normals that lean further than this (degrees) are worth a warning: real maps stay below 13.
const TILT_DEGREES: f64 = 20.0;

/// A normal map with where it came from and what was noticed.
#[derive(Clone, Debug)]
pub struct LoadedMap {
    /// The validated map, +Y up.
    pub map: NormalMap,
    /// What was measured and mended.
    pub report: NormalReport,
    /// Name without folders, size and digest of the bytes that were read.
    pub digest: InputDigest,
    /// What the user should know, one sentence each.
    pub warnings: Vec<String>,
    /// Alpha, one value a texel, 0 to 1, where it was asked for.
    pub alpha: Option<Vec<f32>>,
    /// The convention that the file was read with, for provenance.
    pub convention: String,
}

/// Loads and validates a normal map (or, with `options.height`, a height map).
///
/// # Errors
/// [`InputError`]; each kind has its own exit code, and the message names the file, what was expected and found, and
/// what to do.
pub fn load_normal_map(path: &Path, options: &InputOptions) -> Result<LoadedMap, InputError> {
    let bytes = read(path, options.max_memory)?;
    normal_map_of(path, &bytes, options)
}

/// The same for bytes that are there already; `path` is what messages call them.
///
/// # Errors
/// Those of [`load_normal_map`].
pub fn normal_map_of(path: &Path, bytes: &[u8], options: &InputOptions) -> Result<LoadedMap, InputError> {
    let (pixels, mut warnings) = guarded(path, || decode(path, bytes, options))?;
    let orientation = pixels.stored.orientation;
    let alpha = match options.alpha {
        AlphaUse::Taken { flag } if flag.is_some() || pixels.values.has_alpha() => {
            Some(one_channel::alpha_of(path, &pixels, flag.unwrap_or_default(), options.crop)?)
        }
        AlphaUse::Taken { .. } | AlphaUse::Ignored { .. } | AlphaUse::Dropped => None,
    };
    // Vectors that may have to be turned are looked at as a whole.
    let (part, rest) = if orientation.is_as_stored() { (options.crop, None) } else { (None, options.crop) };
    let raw = meaning::raw_normals(path, pixels, part, options, &mut warnings)?;
    let raw = if options.height.is_some() {
        orientation.say_moved(&mut warnings);
        raw
    } else {
        orientation.settle(raw, options, &mut warnings)
    };
    let raw = match rest {
        Some(Crop { x, y, w, h }) => raw.crop(x, y, w, h).map_err(|e| from_bake(path, e))?,
        None => raw,
    };
    let normal_options =
        NormalOptions { wrap: options.wrap, y: if options.height.is_some() { GreenAxis::Up } else { options.y } };
    let (map, report) = NormalMap::from_vectors(&raw, &normal_options).map_err(|e| from_bake(path, e))?;
    warn_of(&report, options, &mut warnings);
    let digest = digest(path, bytes, &mut warnings);
    Ok(LoadedMap { map, report, digest, warnings, alpha, convention: convention(options) })
}

/// Pixels of any format as they are shown, and the notes of reading them.
pub(super) fn decode(path: &Path, bytes: &[u8], options: &InputOptions) -> Result<(Pixels, Vec<String>), InputError> {
    let format = format::detect(path, bytes)?;
    let mut notes: Vec<String> = format::extension_note(path, format).into_iter().collect();
    let pixels = match format {
        Format::Exr => exr::decode(path, bytes, options, &mut notes)?,
        Format::Raster(raster) => {
            options.check_has_layers(path, format.name())?;
            match raster {
                ImageFormat::Tiff => tiff_file::decode(path, bytes, options, &mut notes)?,
                raster => raster::decode(path, bytes, raster, options, &mut notes)?,
            }
        }
    };
    Ok((pixels.shown(), notes))
}

/// What the measurements tell that the user should know.
fn warn_of(report: &NormalReport, options: &InputOptions, warnings: &mut Vec<String>) {
    let percent = |count: u64| 100.0 * count as f64 / report.texels as f64;
    if report.off_unit > 0 {
        warnings.push(format!(
            "{:.1} % of the normals are off unit length by more than 1 % ({:.3} to {:.3}); renormalised",
            percent(report.off_unit),
            report.min_length,
            report.max_length
        ));
    }
    if report.below_horizon > 0 {
        warnings
            .push(format!("{} normals point below the horizon (z ≤ 0); pushed just above it", report.below_horizon));
    }
    if report.zero_length > 0 {
        warnings.push(format!("{} normals have no direction (mid-grey); taken as flat", report.zero_length));
    }
    if report.flipped_green_suspected && options.height.is_none() {
        let (this, other) = match options.y {
            GreenAxis::Up => ("up", "down"),
            GreenAxis::Down => ("down", "up"),
        };
        warnings.push(format!(
            "the green channel looks flipped (curl correlation {:+.2}): read as +Y {this}; if glints move the wrong \
             way, give --normal-y {other}",
            report.curl_correlation.unwrap_or(0.0)
        ));
    }
    if report.seam_suspected {
        warnings.push(
            "opposite edges do not fit, so the repeated map shows a seam; give --wrap clamp if it is not meant to tile"
                .into(),
        );
    }
    let tilt = report.mean_normal[0].hypot(report.mean_normal[1]).atan2(report.mean_normal[2]).to_degrees();
    if tilt > TILT_DEGREES {
        warnings.push(format!("the mean normal leans by {tilt:.0}°; is this a tangent-space normal map?"));
    }
    if report.is_flat {
        warnings.push("the map is flat to within one 8-bit step; it can make no glints of its own".into());
    }
}

fn convention(options: &InputOptions) -> String {
    if let Some(scale) = options.height {
        return format!("height map, white {scale} texels high");
    }
    let y = match options.y {
        GreenAxis::Up => "+Y up (OpenGL)",
        GreenAxis::Down => "+Y down (DirectX)",
    };
    match options.channels.and_then(Channels::two) {
        None => y.to_owned(),
        Some(_) => format!("{y}, two channels"),
    }
}
