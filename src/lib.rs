//! What the programs share: flags, files, progress, reports, projects, the preview.

mod blocks;
pub mod canvas;
pub mod cli;
pub mod commands;
pub mod delivery;
mod depfile;
pub mod exit;
mod exr_file;
mod gltf;
pub mod info;
pub mod input;
pub mod methods;
pub mod output;
pub mod pack;
pub mod plan;
pub mod plot;
pub mod preview;
pub mod progress;
pub mod project;
pub mod quantities;
pub mod reading;
mod report;
pub mod scene;
mod srgb;
pub mod textures;
