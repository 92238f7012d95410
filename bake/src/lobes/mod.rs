//! MIP-mapped position-normal lobes: Tan, Zhu, Xu, Meng, Wang, Yan, *Real-Time Microstructure Rendering with MIP-mapped
//! Normal Map Samples*, CGF 41(1), 2022. `docs/methods/lobes.md` has the equations and what deviates from the paper.
//!
//! [`mod@bake`] turns texels into lobes and builds the MIP, [`merge`] reduces the lobes of a cell, [`quantise`] packs them.
//! [`query`] finds what a footprint sees as a sum over placed cells and [`boxes`], [`eval`] is the arithmetic of one lobe;
//! [`reference`] is the same by definition, in f64, and [`quality`] the difference. [`sections`] is all as
//! a pack.

pub(crate) mod bake;
mod baked;
pub(crate) mod boxes;
pub mod eval;
pub(crate) mod gaussian;
mod half;
pub(crate) mod merge;
pub mod options;
mod packed;
pub mod quality;
mod quantise;
pub mod query;
pub mod reference;
pub mod sections;

crate::shader::shaders!("lobes": "eval", "query", "boxes", "packed", "half");

pub use bake::bake;
pub use baked::BakedLobes;
pub use options::LobesOptions;
