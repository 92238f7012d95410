//! Decoded pixels with what their file says of them, as stored: nothing is decoded, signed or chosen here.

use super::colour_tag::ColourTag;
use super::options::Crop;
use super::orientation::Orientation;
use glint_bake_core::error::BakeError;
use glint_bake_core::normal_map::crop_rows;

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
            Values::Rgb8(v) => Values::Rgb8(orientation.texels((width, height), v)),
            Values::Rgba8(v) => Values::Rgba8(orientation.texels((width, height), v)),
        };
        let (width, height) = orientation.size((width, height));
        Pixels { width, height, values, stored }
    }
}

/// The number that 8 bits stand for.
pub(super) fn unorm8(v: u8) -> f32 {
    v as f32 / 255.0
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
    /// Three channels of 8 bits, as most maps have them: a quarter of the memory, and no work where they are not looked at.
    Rgb8(Vec<[u8; 3]>),
    /// Three channels and alpha of 8 bits.
    Rgba8(Vec<[u8; 4]>),
}

impl Values {
    /// Number of texels.
    pub fn len(&self) -> usize {
        match self {
            Values::Grey(v) => v.len(),
            Values::GreyAlpha(v) => v.len(),
            Values::Rgb(v) => v.len(),
            Values::Rgba(v) => v.len(),
            Values::Rgb8(v) => v.len(),
            Values::Rgba8(v) => v.len(),
        }
    }

    /// A texel as red, green, blue and alpha: grey is all three colours, and alpha is 1 where there is none.
    pub fn texel(&self, at: usize) -> [f32; 4] {
        match self {
            Values::Grey(v) => [v[at], v[at], v[at], 1.0],
            Values::GreyAlpha(v) => [v[at][0], v[at][0], v[at][0], v[at][1]],
            Values::Rgb(v) => [v[at][0], v[at][1], v[at][2], 1.0],
            Values::Rgba(v) => v[at],
            Values::Rgb8(v) => {
                let [r, g, b] = v[at].map(unorm8);
                [r, g, b, 1.0]
            }
            Values::Rgba8(v) => v[at].map(unorm8),
        }
    }

    /// All texels in order.
    pub fn texels(&self) -> impl Iterator<Item = [f32; 4]> {
        (0..self.len()).map(|at| self.texel(at))
    }

    /// The texels of a rectangle of an image that is `of` large.
    ///
    /// # Errors
    /// Those of [`crop_rows`].
    pub fn crop(&self, of: (u32, u32), Crop { x, y, w, h }: Crop) -> Result<Values, BakeError> {
        let (from, size) = ((x, y), (w, h));
        Ok(match self {
            Values::Grey(v) => Values::Grey(crop_rows(v, of, from, size)?),
            Values::GreyAlpha(v) => Values::GreyAlpha(crop_rows(v, of, from, size)?),
            Values::Rgb(v) => Values::Rgb(crop_rows(v, of, from, size)?),
            Values::Rgba(v) => Values::Rgba(crop_rows(v, of, from, size)?),
            Values::Rgb8(v) => Values::Rgb8(crop_rows(v, of, from, size)?),
            Values::Rgba8(v) => Values::Rgba8(crop_rows(v, of, from, size)?),
        })
    }

    /// Whether texels have an alpha of their own.
    pub fn has_alpha(&self) -> bool {
        matches!(self, Values::GreyAlpha(_) | Values::Rgba(_) | Values::Rgba8(_))
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
