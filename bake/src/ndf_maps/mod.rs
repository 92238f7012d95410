//! Multi-scale NDF maps of tiny examples: Xing, Tan, Xu, Wang, *A Tiny Example Based Procedural Model for Real-Time
//! Glinty Appearance Rendering*, JCST 39(4), 2024.
//!
//! `docs/methods/ndf-maps.md` has the equations, and what deviates from the paper.
//!
//! [`bake`] makes the maps of one example (section 5) and [`placement`] covers a surface with it (section 6.2): together a
//! [`baked::Material`], which [`sections`] keeps in a pack. [`query`] finds what a footprint sees and [`eval`] evaluates it
//! (section 6.3, Eq. 1); [`reference`] and [`reference_surface`] are the same by definition, in f64, and [`quality`] is the
//! difference.

pub mod bake;
pub mod baked;
mod blocks;
mod ellipse;
pub mod eval;
mod fine_grid;
mod micro_normals;
pub mod options;
pub mod placement;
pub mod quality;
pub mod query;
mod reach;
pub mod reference;
pub mod reference_surface;
mod regions;
pub mod sections;
mod spline;
mod tile_fit;
mod view;

crate::shader::shaders!("ndf_maps": "eval", "ellipse", "view", "regions", "query");
