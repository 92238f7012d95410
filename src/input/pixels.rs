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
    /// Three channels in the order of the file.
    Rgb(Vec<[f32; 3]>),
    /// Three channels and alpha.
    Rgba(Vec<[f32; 4]>),
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
