//! How a file is to be understood.

use super::error::InputError;
use glint_bake_core::normal_map::GreenAxis;
use glint_formats::Wrap;
use std::path::Path;

/// Default of [`InputOptions::max_memory`]: 4 GiB.
pub const DEFAULT_MAX_MEMORY: u64 = 4 << 30;

/// Which channels hold the normal. Of two letters the first says where x is; z is then √(1 − x² − y²).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Channels {
    /// x, y, z in red, green, blue.
    #[default]
    Xyz,
    /// x in red, y in green (BC5).
    Xy,
    /// x in green, y in red.
    Yx,
    /// x in alpha, y in green (DXT5nm).
    Ag,
    /// x in green, y in alpha.
    Ga,
    /// x in red or grey, y in alpha (RRRG of Basis and KTX2).
    Ra,
    /// x in alpha, y in red or grey.
    Ar,
}

impl Channels {
    /// Whether alpha is a part of the normal.
    pub fn uses_alpha(self) -> bool {
        self.two().is_some_and(|columns| columns.contains(&3))
    }

    /// Columns of a texel (red, green, blue, alpha) that hold x and y, where z is computed.
    pub(super) fn two(self) -> Option<[usize; 2]> {
        match self {
            Channels::Xyz => None,
            Channels::Xy => Some([0, 1]),
            Channels::Yx => Some([1, 0]),
            Channels::Ag => Some([3, 1]),
            Channels::Ga => Some([1, 3]),
            Channels::Ra => Some([0, 3]),
            Channels::Ar => Some([3, 0]),
        }
    }
}

/// How stored values are to be decoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColourSpace {
    /// What a file's tag claims is believed where the data bear it out.
    #[default]
    Auto,
    /// As they are, whatever the file claims.
    Linear,
    /// By the sRGB curve, whatever the file claims.
    Srgb,
}

/// What becomes of alpha that is no part of the normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlphaUse {
    /// Nothing. Where it holds something that is noted, with the flag that says what to do with it, where there is one.
    Ignored {
        /// As it is typed.
        flag: Option<&'static str>,
    },
    /// Nothing, as was asked for.
    Dropped,
    /// It is given beside the map. It has to be there where a flag asks for it.
    Taken {
        /// As it is typed.
        flag: Option<&'static str>,
    },
}

impl Default for AlphaUse {
    fn default() -> AlphaUse {
        AlphaUse::Ignored { flag: None }
    }
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
    /// Which channels hold the normal. None: x, y, z, unless the data say that they are something else, which is refused.
    pub channels: Option<Channels>,
    /// When given, the file is a height map, and this is the height in texels of the value 1.0.
    pub height: Option<f32>,
    /// The part to use. Heights are turned into normals before they are cropped, so that a crop's edge keeps its slope.
    pub crop: Option<Crop>,
    /// How stored values are to be decoded.
    pub colour_space: ColourSpace,
    /// The layer of an EXR file to read; empty for the unnamed one. When not given, the layer that fits is found.
    pub layer: Option<String>,
    /// What becomes of alpha.
    pub alpha: AlphaUse,
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
            channels: None,
            height: None,
            crop: None,
            colour_space: ColourSpace::Auto,
            layer: None,
            alpha: AlphaUse::default(),
            max_memory: DEFAULT_MAX_MEMORY,
        }
    }
}
