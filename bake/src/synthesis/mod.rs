//! A large surface from patches of a small sample: Tan, Zhu, Xu, Meng, Wang, Yan, *Real-Time Microstructure Rendering with
//! MIP-mapped Normal Map Samples*, 2022, section 5.1.1. `docs/methods/surface.md` has the equations and what deviates.
//!
//! [`bake()`] chooses patches ([`candidates`], [`strips`], [`cut_errors`], [`runs`], [`choose`]) and cuts seams ([`seams`]) by the
//! distance of [`features`]; [`mod@tiles`] does so for a surface without end. [`eval`] finds the sample texel, or the whole
//! block, that the surface shows; [`mod@assemble`] is that for a whole piece. [`reference`](mod@reference) pastes patches
//! into an image and tries every path, [`mod@measure`] tells what a surface is like, [`sections`] is it as a pack.

pub mod assemble;
pub mod bake;
pub mod candidates;
pub mod choose;
pub mod cut_errors;
pub mod eval;
mod eval_tiles;
pub mod features;
pub mod measure;
pub mod options;
pub mod reference;
pub mod runs;
pub mod seams;
pub mod sections;
pub mod strips;
pub mod tiles;

crate::shader::shaders!("synthesis": "eval", "paths", "grid", "tiles");

pub use assemble::assemble;
pub use bake::{Synthesis, bake};
pub use options::{SynthesisOptions, Target};
