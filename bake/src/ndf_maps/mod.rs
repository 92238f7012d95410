//! Multi-scale NDF maps of tiny examples (Xing et al. 2024).

pub mod bake;
mod disk;
pub mod eval;
mod fine_grid;
pub mod measure;
pub mod micro_normals;
pub mod placement;
pub mod reference;
pub mod reference_surface;
pub mod sections;
mod spline;
pub mod surface;
mod tile_fit;
pub mod transform;
