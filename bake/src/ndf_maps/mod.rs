//! Multi-scale NDF maps of tiny examples: Xing, Tan, Xu, Wang, *A Tiny Example Based Procedural Model for Real-Time
//! Glinty Appearance Rendering*, JCST 39(4), 2024.
//!
//! `docs/methods/ndf-maps.md` has the equations, and what deviates from the paper.
//!
//! [`bake`] makes the maps of one example, nodes prefiltered by [`windows`], and [`placement`] covers a surface with it (section
//! 6.2): together a [`baked::Material`], which [`sections`] keeps in a pack. [`query`] finds what a footprint sees and [`eval`]
//! evaluates it (section 6.3, Eq. 1); [`reference`] and [`reference_surface`] are the same by definition, in f64, and [`quality`] is
//! the difference.

mod atlas;
pub mod bake;
pub mod baked;
pub mod eval;
mod fine_grid;
mod hats;
mod lobe_norm;
pub mod moments;
mod normal_bins;
pub mod options;
mod owners;
pub mod pixel_errors;
pub mod placement;
pub mod quality;
pub mod query;
mod reach;
pub mod reference;
pub mod reference_surface;
pub mod sections;
mod table_fit;
mod view;
pub mod windows;

crate::shader::shaders!("ndf_maps": "eval", "view", "owners", "query", "moments");
