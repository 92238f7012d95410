//! P-NDFs of a synthesised surface: lobes of a small sample, read through the patches that the surface is made of.
//!
//! Tan, Zhu, Xu, Meng, Wang, Yan, *Real-Time Microstructure Rendering with MIP-mapped Normal Map Samples*, 2022, sections
//! 5.1 and 5.2. The paper stores clustered lobes for every patch of the surface; here cells of the sample's MIP begin at all
//! multiples of the patches' alignment, so that one small set serves every patch wherever it was cut from.
//! `docs/methods/surface.md` has what deviates.
//!
//! [`bake()`] makes both parts. [`Surface::p_ndf`] sums what a footprint sees, by blocks that follow every seam or none;
//! [`quality`] compares that with the assembled map; [`sections`] is all as a pack.

mod bake;
mod baked;
mod blocks;
mod eval;
mod options;
pub mod quality;
mod query;
mod seams;
pub mod sections;

crate::shader::shaders!("surface": "query", "seams", "blocks", "eval");

pub use bake::bake;
pub use baked::Surface;
pub use options::{ALIGNMENT, SurfaceOptions};
pub use query::SurfaceSettings;
