//! Files that are read: normal maps, environments, and maps that are made by formula.

mod chunks;
mod colour_tag;
#[cfg(test)]
mod corpus;
pub mod environment;
mod error;
mod exr;
mod foreign;
mod format;
mod guard;
mod icc;
mod limits;
mod meaning;
mod normal_map;
mod one_channel;
mod options;
mod orientation;
mod picture;
mod pixels;
mod primaries;
mod radiance;
mod raster;
mod scalar_map;
pub mod synthetic;
mod tiff_file;
mod transfer;

pub use error::InputError;
pub use guard::{guarded, is_decoding};
pub use limits::MAX_SIDE;
pub use normal_map::{LoadedMap, load_normal_map, normal_map_of};
pub use options::{AlphaUse, Channels, ColourSpace, Crop, DEFAULT_MAX_MEMORY, InputOptions};
pub use picture::{Picture, Texels, picture_of};
pub use scalar_map::{LoadedScalar, load_scalar_map, scalar_map_of};
