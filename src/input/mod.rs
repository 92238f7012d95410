//! Files that are read: normal maps, environments, and maps that are made by formula.

mod colour_tag;
pub mod environment;
mod error;
mod exr;
mod format;
mod guard;
mod limits;
mod meaning;
mod normal_map;
mod options;
mod pixels;
mod primaries;
mod raster;
pub mod synthetic;

pub use error::InputError;
pub use guard::{guarded, is_decoding};
pub use limits::MAX_SIDE;
pub use normal_map::{LoadedMap, load_normal_map};
pub use options::{Channels, Crop, DEFAULT_MAX_MEMORY, InputOptions};
