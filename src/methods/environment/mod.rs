//! Environments: `glint-bake environment`.

pub mod args;
pub mod bake;
pub mod info;
pub mod plan;
pub mod plot;

pub use args::Args;
