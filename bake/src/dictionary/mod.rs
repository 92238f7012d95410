//! Slope dictionary: glints from products of tabulated 1D slope distributions, with no normal map.
//!
//! Method: Chermain et al. 2020, "Procedural Physically based BRDF for Real-Time Rendering of Glints", sections 4 to 6
//! and appendix A. A small table of 1D marginals P_i(x, level) is baked once ([`bake()`]). At run time a cell of the
//! surface picks two of them by hash, and P_i(x) · P_j(y), rotated and scaled to the wished roughness, is the cell's
//! slope distribution; cells are averaged over the pixel footprint and put into a microfacet BRDF ([`eval`]). [`reference`]
//! says the same from the definitions in f64, and [`quality`] measures one by the other.
//!
//! What deviates from the paper, and why, stands on top of each file and in `docs/methods/dictionary.md`. The main points:
//! - samples sit at bin centres, and a marginal is normalised as linear filtering with clamp to edge reads it, after
//!   rounding to half floats ([`bake::to_half_with_sum`]);
//! - lobe means are stratified across the dictionary, and drawn so that lobe and sampler together give the target's
//!   variance ([`bake::Draws`]);
//! - GGX is a target too, through a radial warp of the slope plane ([`eval`]);
//! - no cell inside the footprint is left out, and the number of cells is bounded ([`eval`]);
//! - the hash is a bijection of the cell index ([`crate::hash`]).

pub mod bake;
pub mod baked;
pub mod eval;
pub mod options;
pub mod quality;
pub mod reference;
pub mod sections;

crate::shader::shaders!("dictionary": "eval");

pub use bake::bake;
pub use baked::Dictionary;
pub use options::DictionaryOptions;
