//! How a file is to be understood.

use super::error::InputError;
use glint_bake_core::normal_map::GreenAxis;
use glint_formats::Wrap;
use std::path::Path;

/// Default of [`InputOptions::max_memory`]: 4 GiB.
pub const DEFAULT_MAX_MEMORY: u64 = 4 << 30;

/// Which channels hold the normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channels {
    /// x, y, z in red, green, blue.
    Xyz,
    /// x, y in red, green; z is √(1 − x² − y²) (BC5 style).
    Xy,
}

/// A rectangle of texels, from the top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub w: u32,
    /// Rows.
    pub h: u32,
}

/// How a file is to be understood.
#[derive(Clone, Debug, PartialEq)]
pub struct InputOptions {
    /// Which way green points.
    pub y: GreenAxis,
    /// What lies beyond the edge; of the crop, when there is one.
    pub wrap: Wrap,
    /// Which channels hold the normal.
    pub channels: Channels,
    /// When given, the file is a height map, and this is the height in texels of the value 1.0.
    pub height: Option<f32>,
    /// The part to use. Heights are turned into normals before they are cropped, so that a crop's edge keeps its slope.
    pub crop: Option<Crop>,
    /// Take the values of a file tagged as sRGB as they are.
    pub assume_linear: bool,
    /// The layer of an EXR file to read; empty for the unnamed one. When not given, the layer that fits is found.
    pub layer: Option<String>,
    /// Most bytes to hold for this file while loading.
    pub max_memory: u64,
}

impl InputOptions {
    /// Refuses to choose a layer of a file whose format has none.
    pub(super) fn check_has_layers(&self, path: &Path, format: &str) -> Result<(), InputError> {
        match &self.layer {
            None => Ok(()),
            Some(layer) => Err(InputError::bad(
                path,
                format!("--layer asks for layer {layer:?} of an EXR file, and this is {format}; leave --layer out"),
            )),
        }
    }
}

impl Default for InputOptions {
    fn default() -> InputOptions {
        InputOptions {
            y: GreenAxis::Up,
            wrap: Wrap::Repeat,
            channels: Channels::Xyz,
            height: None,
            crop: None,
            assume_linear: false,
            layer: None,
            max_memory: DEFAULT_MAX_MEMORY,
        }
    }
}
