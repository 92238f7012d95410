//! Density texels where a spline finds all that it needs in one load: three by three of them in every place, those beyond the
//! tile as zeros. Sixteen times the bytes, which tiny examples can afford; larger ones stay as they are.

use super::baked::BakedNdfMaps;
use glint_formats::ndf_maps::{DensityStorage, MAX_BLOCKS, TileRecord};

/// Density of a material in blocks.
pub(super) struct Blocks {
    /// First block of each tile.
    pub(super) first: Vec<u32>,
    /// Three rows of three texels, the lowest bits first, and one unused.
    pub(super) blocks: Vec<[u32; 4]>,
}

/// Blocks of a material; none where texels are not of 8 bits, or there would be too many.
pub(super) fn blocks(maps: &BakedNdfMaps) -> Option<Blocks> {
    let count: u64 = maps.tiles.iter().map(|tile| blocks_of(tile) as u64).sum();
    if maps.params.storage != DensityStorage::SqrtU8 || count > MAX_BLOCKS {
        return None;
    }
    let mut found = Blocks { first: Vec::with_capacity(maps.tiles.len()), blocks: Vec::with_capacity(count as usize) };
    for tile in &maps.tiles {
        found.first.push(found.blocks.len() as u32);
        for y in -2..tile.height() as i32 {
            for x in -2..tile.width() as i32 {
                let row = |j: i32| (0..3).fold(0, |bits, i| bits | texel(maps, tile, x + i, y + j) << (8 * i));
                found.blocks.push([row(0), row(1), row(2), 0]);
            }
        }
    }
    Some(found)
}

/// Blocks of a tile.
fn blocks_of(tile: &TileRecord) -> usize {
    ((tile.width() + 2) * (tile.height() + 2)) as usize
}

/// Bits of a texel of a tile, 0 beyond it.
fn texel(maps: &BakedNdfMaps, tile: &TileRecord, x: i32, y: i32) -> u32 {
    let (width, height) = (tile.width() as i32, tile.height() as i32);
    let inside = (0..width).contains(&x) && (0..height).contains(&y);
    if inside { u32::from(maps.density[tile.first as usize + (y * width + x) as usize]) } else { 0 }
}

/// Each texel once, tile after tile; `tiles` name their first blocks and are made to name their first texels. Nothing where a tile
/// lies beyond the blocks.
pub(super) fn texels_of(blocks: &[[u32; 4]], tiles: &mut [TileRecord]) -> Option<Vec<u8>> {
    let mut texels = Vec::new();
    for tile in tiles {
        let (width, height, first) = (tile.width() as usize, tile.height() as usize, tile.first as usize);
        let of_tile = blocks.get(first..first + blocks_of(tile))?;
        tile.first = texels.len() as u32;
        for y in 0..height {
            // The block that begins at a texel, two rows and columns of zeros before.
            let row = &of_tile[(y + 2) * (width + 2) + 2..];
            texels.extend(row[..width].iter().map(|block| (block[0] & 0xff) as u8));
        }
    }
    Some(texels)
}
