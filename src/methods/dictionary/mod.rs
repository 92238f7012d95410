//! Slope dictionaries: `glint-bake dictionary`.

pub mod args;
pub mod bake;
pub mod info;
pub mod plot;

pub use args::Args;
