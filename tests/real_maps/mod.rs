//! Real maps that tests and reports measure on, found by `GLINT_DATA`.

use glint_bake::input::{Crop, InputOptions, load_normal_map};
use glint_bake_core::normal_map::NormalMap;
use std::path::{Path, PathBuf};

/// The data folder, or None (said on stderr) where there is none.
pub fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("GLINT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: no real maps in {} (set GLINT_DATA)", folder.display());
    None
}

/// A map of the data folder, or a square crop of it: left, top, edge.
#[allow(dead_code)] // Tests of environments read no normal maps.
pub fn load(data: &Path, name: &str, crop: Option<(u32, u32, u32)>) -> NormalMap {
    let crop = crop.map(|(x, y, edge)| Crop { x, y, w: edge, h: edge });
    let options = InputOptions { crop, assume_linear: true, ..InputOptions::default() };
    load_normal_map(&data.join(name), &options).unwrap().map
}
