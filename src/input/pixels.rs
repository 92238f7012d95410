//! Decoded pixels with what their file says of them, as stored: nothing is decoded, signed or chosen here.

use super::colour_tag::ColourTag;
use super::orientation::Orientation;

/// Decoded pixels, row-major from the first row and column of the file, and how they were stored.
pub(super) struct Pixels {
    pub width: u32,
    pub height: u32,
    pub values: Values,
    pub stored: Stored,
}

impl Pixels {
    /// Rows and columns as their orientation says; what the values mean is not touched.
    pub fn shown(self) -> Pixels {
        let Pixels { width, height, values, stored } = self;
        let orientation = stored.orientation;
        let values = match values {
            Values::Grey(v) => Values::Grey(orientation.texels((width, height), v)),
            Values::GreyAlpha(v) => Values::GreyAlpha(orientation.texels((width, height), v)),
            Values::Rgb(v) => Values::Rgb(orientation.texels((width, height), v)),
            Values::Rgba(v) => Values::Rgba(orientation.texels((width, height), v)),
        };
        let (width, height) = orientation.size((width, height));
        Pixels { width, height, values, stored }
    }
}

/// Stored values: 0…1 where they were whole numbers (v / (2ᵇ − 1)), as they are where they were floats.
pub(super) enum Values {
    /// One channel.
    Grey(Vec<f32>),
    /// One channel and alpha.
    GreyAlpha(Vec<[f32; 2]>),
    /// Three channels in the order of the file.
    Rgb(Vec<[f32; 3]>),
    /// Three channels and alpha.
    Rgba(Vec<[f32; 4]>),
}

impl Values {
    /// Number of texels.
    pub fn len(&self) -> usize {
        match self {
            Values::Grey(v) => v.len(),
            Values::GreyAlpha(v) => v.len(),
            Values::Rgb(v) => v.len(),
            Values::Rgba(v) => v.len(),
        }
    }

    /// A texel as red, green, blue and alpha: grey is all three colours, and alpha is 1 where there is none.
    pub fn texel(&self, at: usize) -> [f32; 4] {
        match self {
            Values::Grey(v) => [v[at], v[at], v[at], 1.0],
            Values::GreyAlpha(v) => [v[at][0], v[at][0], v[at][0], v[at][1]],
            Values::Rgb(v) => [v[at][0], v[at][1], v[at][2], 1.0],
            Values::Rgba(v) => v[at],
        }
    }

    /// All texels in order.
    pub fn texels(&self) -> impl Iterator<Item = [f32; 4]> {
        (0..self.len()).map(|at| self.texel(at))
    }

    /// Whether texels have an alpha of their own.
    pub fn has_alpha(&self) -> bool {
        matches!(self, Values::GreyAlpha(_) | Values::Rgba(_))
    }

    /// Whether the three colours are one channel.
    pub fn is_grey(&self) -> bool {
        matches!(self, Values::Grey(_) | Values::GreyAlpha(_))
    }
}

/// How pixels were stored.
#[derive(Default)]
pub(super) struct Stored {
    /// Bits a whole number had; `None` for floats.
    pub bits: Option<u8>,
    /// The codec that lost precision, such as "JPEG".
    pub lossy: Option<&'static str>,
    /// What the file says of its colours.
    pub tag: ColourTag,
    /// Which way up the rows and columns are shown.
    pub orientation: Orientation,
}
