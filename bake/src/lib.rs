//! The algorithms of glint-bake: slices in, sections out. No files, no printing, no command line, no GPU.

pub mod brdf;
pub mod erf;
pub mod error;
pub mod footprint;
pub mod ggx;
pub mod hash;
mod methods;
pub mod microfacet;
pub mod moments;
pub mod normal_map;
mod pack_access;
pub mod progress;
pub mod quality;
pub mod rng;
mod shader;
pub mod shaders;
pub mod windows;
mod wrap;

pub use methods::*;
