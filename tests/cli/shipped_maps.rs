//! The small inputs of `fixtures/maps`, which README and docs name, are what the generators here make.
//! `GLINT_BLESS=1 cargo test --test cli shipped_maps` writes them anew.

use crate::support::root;
use glint_bake::input::synthetic::{self, Material};
use image::ImageFormat;
use std::io::Cursor;

/// Maps by formula: file, material, edge in texels, seed.
const MAPS: [(&str, Material, u32, u64); 4] = [
    ("brushed.png", synthetic::brushed, 16, 1),
    ("flakes.png", synthetic::flakes, 16, 1),
    ("leather.png", synthetic::leather, 128, 1),
    ("scratches.png", synthetic::scratches, 64, 1),
];

/// Most bytes that the folder may take of the repository.
const MOST_BYTES: usize = 150 << 10;

/// Columns of the sky; it has half as many rows.
const SKY_COLUMNS: u32 = 64;

/// Every file of the folder, by name.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let mut files: Vec<(&str, Vec<u8>)> = MAPS.map(|(name, make, edge, seed)| (name, png(make, edge, seed))).to_vec();
    files.push(("studio.hdr", studio()));
    files
}

fn png(make: Material, edge: u32, seed: u64) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    make(edge, edge, seed).write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A studio as a Radiance file without run lengths: a dim room that is lighter above, a soft box, and two small lamps, a warm
/// one of 100 times the room's radiance and a blue one.
fn studio() -> Vec<u8> {
    let rows = SKY_COLUMNS / 2;
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {SKY_COLUMNS}\n").into_bytes();
    for y in 0..rows {
        for x in 0..SKY_COLUMNS {
            let up = 1.0 - (y as f32 + 0.5) / rows as f32;
            let room = [0.10 + 0.15 * up, 0.11 + 0.16 * up, 0.12 + 0.20 * up];
            let colour = match (x, y) {
                (12..20, 5..9) => [6.0, 5.8, 5.4],
                (40, 9) => [60.0, 42.0, 24.0],
                (52..54, 13) => [4.0, 8.0, 24.0],
                _ => room,
            };
            bytes.extend(rgbe(colour));
        }
    }
    bytes
}

/// A colour with a shared exponent: mantissas of the largest component are 128 to 255.
fn rgbe(colour: [f32; 3]) -> [u8; 4] {
    let largest = colour.into_iter().fold(0.0, f32::max);
    let (mut scale, mut exponent) = (256.0, 128);
    while largest * scale >= 256.0 {
        (scale, exponent) = (scale * 0.5, exponent + 1);
    }
    while largest * scale < 128.0 {
        (scale, exponent) = (scale * 2.0, exponent - 1);
    }
    let [r, g, b] = colour.map(|c| (c * scale) as u8);
    [r, g, b, exponent]
}

#[test]
fn the_shipped_maps_are_those_of_the_generators() {
    let folder = root().join("fixtures/maps");
    if std::env::var_os("GLINT_BLESS").is_some() {
        std::fs::create_dir_all(&folder).unwrap();
        files().into_iter().for_each(|(name, bytes)| std::fs::write(folder.join(name), bytes).unwrap());
    }
    let mut total = 0;
    for (name, bytes) in files() {
        let found = std::fs::read(folder.join(name)).unwrap_or_default();
        assert!(found == bytes, "fixtures/maps/{name} is not what the generator makes; GLINT_BLESS=1 writes it anew");
        total += bytes.len();
    }
    assert!(total <= MOST_BYTES, "{total} bytes");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "README.md")
        .collect();
    names.sort();
    assert_eq!(names, files().into_iter().map(|(name, _)| name).collect::<Vec<_>>(), "a file that no generator makes");
}
