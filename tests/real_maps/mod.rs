//! Real maps that tests and reports measure on, found by `GLINT_DATA`.

use glint_bake::input::{Crop, InputOptions, load_normal_map};
use glint_bake_core::normal_map::NormalMap;
use std::path::{Path, PathBuf};

/// All of the tiny maps.
pub const TINY: [&str; 6] = [
    "tiny/flakes_8x8.png",
    "tiny/brushed_16x16.png",
    "tiny/scratches_32x32.png",
    "tiny/leather_64x64.png",
    "tiny/diamond_plate_64x32.png",
    "tiny/wicker_box16_32x32.png",
];

/// 16² crops: file, left, top.
pub const CROPS_16: [(&str, u32, u32); 6] = [
    ("normals/brushed_aluminium_godot_745.png", 300, 300),
    ("normals/carpaint_flakes_khronos_128.png", 40, 40),
    ("normals/bluenoise_bevy_512_rgba.png", 100, 100),
    ("normals/hammered_pebbles_pmndrs0015.jpg", 500, 500),
    ("normals/wood_grain_pmndrs0019.jpg", 400, 400),
    ("normals/riverbed_rock_polyhaven_gl_512_16bit.png", 200, 200),
];

/// 32² crops: file, left, top.
pub const CROPS_32: [(&str, u32, u32); 6] = [
    ("normals/scratched_gold_cgbookcase_rgba.png", 500, 500),
    ("normals/technical_fabric_sheencloth_256_rgba.png", 100, 100),
    ("normals/hammered_pebbles_pmndrs0015.jpg", 500, 500),
    ("normals/snow_02_polyhaven_gl.jpg", 300, 300),
    ("normals/carpaint_flakes_khronos_128.png", 0, 0),
    ("normals/leather_008_3dtextures.jpg", 600, 200),
];

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
pub fn load(data: &Path, name: &str, crop: Option<(u32, u32, u32)>) -> NormalMap {
    let crop = crop.map(|(x, y, edge)| Crop { x, y, w: edge, h: edge });
    let options = InputOptions { crop, assume_linear: true, ..InputOptions::default() };
    load_normal_map(&data.join(name), &options).unwrap().map
}
