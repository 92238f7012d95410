//! MIP-mapped lobes of normal maps, and of surfaces made of patches of one: `glint-bake lobes`.

pub mod args;
pub mod bake;
pub mod info;
pub mod plot;
pub mod surface;
pub mod surface_info;

pub use args::Args;
