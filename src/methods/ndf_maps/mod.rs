//! NDF maps of small normal maps: `glint-bake ndf-maps`.

pub mod args;
pub mod bake;
pub mod histogram;
pub mod info;
pub mod plan;
pub mod plot;

pub use args::Args;
