//! MIP-mapped position-normal lobes: Tan, Zhu, Xu, Meng, Wang, Yan, *Real-Time Microstructure Rendering with MIP-mapped
//! Normal Map Samples*, CGF 41(1), 2022. `docs/methods/lobes.md` has the equations and what deviates from the paper.
//!
//! [`seeds`] turns texels into lobes, [`merge`] reduces them, [`bake`] builds the MIP and [`quantise`] packs it.
//! [`query`] finds what a footprint sees as a sum over placed cells, [`eval`] is the arithmetic of one lobe;
//! [`reference`] is the same by definition, in f64, and [`quality`] the difference; [`edge_levels`] reads what the paper would,
//! [`rim`] tells what may be left out. [`sections`] is all as a pack.

pub mod bake;
pub mod edge_levels;
pub mod eval;
pub mod gaussian;
mod kmeans;
pub mod merge;
pub mod options;
pub mod quality;
pub mod quantise;
pub mod query;
pub mod reference;
pub mod reference_lobes;
pub mod rim;
mod runnalls;
pub mod sections;
pub mod seeds;
pub(crate) mod span;

crate::shader::shaders!("lobes": "eval", "query", "boxes", "packed", "half");

pub use bake::{BakedLobes, bake};
pub use options::LobesOptions;
