//! From the sections of a pack, or the textures of a file, to what the WGSL of each method binds.

pub mod dictionary;
pub mod environment;
pub mod lobes;
pub mod ndf_maps;
pub mod textures;
