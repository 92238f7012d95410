//! Maps for rectangle lights: `glint-bake area-light`.

pub mod args;
pub mod bake;
pub mod info;
pub mod plan;
pub mod plot;

pub use args::Args;
