//! Multi-scale NDF maps of tiny examples: Xing, Tan, Xu, Wang, *A Tiny Example Based Procedural Model for Real-Time
//! Glinty Appearance Rendering*, JCST 39(4), 2024.
//!
//! `docs/methods/ndf-maps.md` has the equations, and what deviates from the paper.
//!
//! [`bake`] makes the maps of one example, [`placement`] covers a surface with it, [`sections`] is both as a pack.
//! [`surface`] finds what a footprint sees and [`eval`] evaluates it; [`reference`] and [`reference_surface`] are the
//! same by definition, in f64, and [`measure`] is the difference.

pub mod bake;
mod cells;
mod disk;
mod ellipse;
pub mod eval;
mod fine_grid;
pub mod measure;
pub mod micro_normals;
pub mod placement;
mod probes;
pub mod reference;
pub mod reference_surface;
pub mod sections;
mod spline;
pub mod surface;
mod tile_fit;
pub mod transform;

crate::shader::shaders!("ndf_maps": "eval", "ellipse", "material", "tiles", "lobes", "view", "tiled", "regions", "classes", "probes", "stochastic");
