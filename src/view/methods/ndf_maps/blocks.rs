//! Density texels where a spline finds all that it needs in one load: three by three of them in every place, those beyond the
//! tile as zeros. Sixteen times the bytes of the pack, which tiny examples can afford; larger ones stay as they are.

use glint_bake_core::ndf_maps::baked::BakedNdfMaps;
use glint_formats::ndf_maps::{DensityStorage, TileRecord};

/// Blocks of a material, at most: 32 MiB of them.
const MOST: usize = 1 << 21;

/// Blocks of a material.
pub struct Blocks {
    /// First block of each tile.
    pub first: Vec<u32>,
    /// Three rows of three texels, the lowest bits first, and one unused.
    pub blocks: Vec<[u32; 4]>,
}

/// How many blocks a material has; none where texels are not of 8 bits, or there are too many.
pub fn count(maps: &BakedNdfMaps) -> Option<usize> {
    let count: usize = maps.tiles.iter().map(|tile| ((tile.width() + 2) * (tile.height() + 2)) as usize).sum();
    (maps.params.storage == DensityStorage::SqrtU8 && count <= MOST).then_some(count)
}

/// Blocks of a material after `before` others.
pub fn of(maps: &BakedNdfMaps, before: usize) -> Option<Blocks> {
    let mut found = Blocks { first: Vec::with_capacity(maps.tiles.len()), blocks: Vec::with_capacity(count(maps)?) };
    for tile in &maps.tiles {
        found.first.push((before + found.blocks.len()) as u32);
        for y in -2..tile.height() as i32 {
            for x in -2..tile.width() as i32 {
                let row = |j: i32| (0..3).fold(0, |bits, i| bits | texel(maps, tile, x + i, y + j) << (8 * i));
                found.blocks.push([row(0), row(1), row(2), 0]);
            }
        }
    }
    Some(found)
}

/// Bits of a texel of a tile, 0 beyond it.
fn texel(maps: &BakedNdfMaps, tile: &TileRecord, x: i32, y: i32) -> u32 {
    let (width, height) = (tile.width() as i32, tile.height() as i32);
    let inside = (0..width).contains(&x) && (0..height).contains(&y);
    if inside { u32::from(maps.density[tile.texel_offset as usize + (y * width + x) as usize]) } else { 0 }
}
