//! Density texels where a spline finds all that it needs in one load: three by three of them in every place, those beyond the
//! tile as zeros. Sixteen times the bytes, which tiny examples can afford; larger ones stay as they are.

use super::baked::BakedNdfMaps;
use glint_formats::binding::TABLE_WIDTH;
use glint_formats::ndf_maps::{DensityStorage, MAX_BLOCKS, TileRecord};

/// Bytes of a block.
pub(super) const BLOCK_BYTES: usize = 16;

/// Density of a material in blocks.
pub(super) struct Blocks {
    /// First block of each tile.
    pub(super) first: Vec<u32>,
    /// Blocks of all tiles: three rows of three texels each, the lowest bits first, and one unused. With room for the table's last row.
    pub(super) payload: Vec<u8>,
}

/// Blocks of a material; none where texels are not of 8 bits, or there would be too many.
pub(super) fn blocks(maps: &BakedNdfMaps) -> Option<Blocks> {
    let count: u64 = maps.tiles.iter().map(|tile| blocks_of(tile) as u64).sum();
    if maps.params.storage != DensityStorage::SqrtU8 || count > MAX_BLOCKS {
        return None;
    }
    let mut first = Vec::with_capacity(maps.tiles.len());
    let mut payload = Vec::with_capacity((count as usize).next_multiple_of(TABLE_WIDTH as usize) * BLOCK_BYTES);
    for tile in &maps.tiles {
        first.push((payload.len() / BLOCK_BYTES) as u32);
        add_blocks(maps, tile, &mut payload);
    }
    Some(Blocks { first, payload })
}

/// Blocks of a tile.
fn blocks_of(tile: &TileRecord) -> usize {
    ((tile.width() + 2) * (tile.height() + 2)) as usize
}

/// Adds the blocks of a tile, which begin two rows and columns before it.
fn add_blocks(maps: &BakedNdfMaps, tile: &TileRecord, payload: &mut Vec<u8>) {
    let (width, height) = (tile.width() as usize, tile.height() as usize);
    let first = tile.first as usize;
    let row =
        |j: usize| if (2..height + 2).contains(&j) { &maps.density[first + (j - 2) * width..][..width] } else { &[] };
    for y in 0..height + 2 {
        let rows = [row(y), row(y + 1), row(y + 2)];
        // A step to the right drops the first texel of each row and takes one more.
        let mut words = [0u32; 3];
        for x in 0..width + 2 {
            for (word, row) in words.iter_mut().zip(rows) {
                *word = *word >> 8 | u32::from(row.get(x).copied().unwrap_or(0)) << 16;
            }
            payload.extend_from_slice(bytemuck::bytes_of(&[words[0], words[1], words[2], 0]));
        }
    }
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
