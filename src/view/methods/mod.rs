//! From the sections of a pack to what the WGSL of each method binds.

pub mod dictionary;
pub mod environment;
pub mod lobes;
pub mod ndf_maps;
