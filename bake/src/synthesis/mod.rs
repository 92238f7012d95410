//! A large surface from patches of a small sample: Tan, Zhu, Xu, Meng, Wang, Yan, *Real-Time Microstructure Rendering with
//! MIP-mapped Normal Map Samples*, 2022, section 5.1.1. `docs/methods/surface.md` has the equations and what deviates.
//!
//! [`bake()`] chooses patches (`candidates`, `pair_errors`, [`choose`]) and cuts seams ([`seams`]) by the distance of
//! [`features`]; `corner_tiles` does so for a surface without end. `eval` finds the sample texel, or the whole block, that the
//! surface shows, by `grid` or `tiles` and the stored `paths`; [`assemble()`] is that for a whole piece.
//! [`reference`](mod@reference) pastes patches into an image and tries every path, [`quality`] tells what a surface is like,
//! [`sections`] is it as a pack.

mod assemble;
mod bake;
mod baked;
mod candidates;
pub mod choose;
mod corner_tiles;
mod eval;
pub mod features;
mod grid;
mod options;
mod pair_errors;
mod paths;
pub mod quality;
pub mod reference;
pub mod seams;
pub mod sections;
mod tiles;

crate::shader::shaders!("synthesis": "eval", "paths", "grid", "tiles");

pub use assemble::assemble;
pub use bake::bake;
pub use baked::Synthesis;
pub use options::{SynthesisOptions, Target};
pub use paths::Place;
