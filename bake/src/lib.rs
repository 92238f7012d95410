//! The algorithms of glint-bake: slices in, sections out. No files, no printing, no command line, no GPU.

pub mod area_light;
pub mod brdf;
pub mod counting;
pub mod dictionary;
pub mod environment;
pub mod erf;
pub mod error;
pub mod footprint;
pub mod ggx;
pub mod hash;
pub mod lobes;
pub mod ndf_maps;
pub mod normal_map;
mod pack_access;
pub mod progress;
pub mod quality;
pub mod rng;
mod shader;
pub mod shaders;
pub mod surface;
pub mod synthesis;
mod wrap;
