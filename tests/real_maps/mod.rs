//! Real maps that tests and reports measure on.

mod folder;

pub use folder::data;

use glint_bake::input::{ColourSpace, Crop, InputOptions, load_normal_map};
use glint_bake_core::normal_map::NormalMap;
use std::path::Path;

/// A map of the data folder, or a square crop of it: left, top, edge.
pub fn load(data: &Path, name: &str, crop: Option<(u32, u32, u32)>) -> NormalMap {
    let crop = crop.map(|(x, y, edge)| Crop { x, y, w: edge, h: edge });
    let options = InputOptions { crop, colour_space: ColourSpace::Linear, ..InputOptions::default() };
    load_normal_map(&data.join(name), &options).unwrap().map
}
