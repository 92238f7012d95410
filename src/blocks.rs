//! Levels of textures in blocks of 4 × 4 texels, BC4, BC5 and BC7, and back: another library's encoders on rows of blocks.

use block_compression::decode::decompress_blocks_as_rgba8;
use block_compression::encode::compress_rgba8;
use block_compression::{BC7Settings, CompressionVariant};
use glint_formats::export::blocks::{Blocks, EDGE};
use rayon::prelude::*;

fn variant(blocks: Blocks) -> CompressionVariant {
    match blocks {
        Blocks::Bc4 => CompressionVariant::BC4,
        Blocks::Bc5 => CompressionVariant::BC5,
        // Alpha may hold smoothness.
        Blocks::Bc7 => CompressionVariant::BC7(BC7Settings::alpha_basic()),
    }
}

/// The blocks of a level, row by row. `texel` gives texel k, row by row, of 8 bits; where a level's edge is no multiple of a
/// block's, its last texels are repeated.
pub fn compress(blocks: Blocks, (width, height): (u32, u32), texel: impl Fn(usize) -> [u8; 4] + Sync) -> Vec<u8> {
    let padded = width.next_multiple_of(EDGE);
    let row_bytes = (padded / EDGE * blocks.bytes()) as usize;
    let mut out = vec![0; row_bytes * height.div_ceil(EDGE) as usize];
    // Each row of blocks for itself, so that threads change nothing.
    out.par_chunks_mut(row_bytes).enumerate().for_each(|(row, out)| {
        let mut texels = Vec::with_capacity((padded * EDGE * 4) as usize);
        for j in 0..EDGE {
            let j = (row as u32 * EDGE + j).min(height - 1);
            for i in 0..padded {
                texels.extend(texel(j as usize * width as usize + i.min(width - 1) as usize));
            }
        }
        compress_rgba8(variant(blocks), &texels, out, padded, EDGE, padded * 4);
    });
    out
}

/// The texels of a level, of 8 bits, as a GPU reads its blocks.
pub fn decompress(blocks: Blocks, (width, height): (u32, u32), bytes: &[u8]) -> Vec<[u8; 4]> {
    let (wide, high) = (width.next_multiple_of(EDGE), height.next_multiple_of(EDGE));
    let mut texels = vec![0; (wide * high * 4) as usize];
    decompress_blocks_as_rgba8(variant(blocks), wide, high, bytes, &mut texels);
    let row = |j: u32| texels[(j * wide * 4) as usize..].chunks_exact(4).take(width as usize);
    (0..height).flat_map(row).map(|texel| [texel[0], texel[1], texel[2], texel[3]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slopes are smooth, so that two values and the steps between them are near all texels of a block.
    #[test]
    fn blocks_come_back_as_what_they_were() {
        for (blocks, channels) in [(Blocks::Bc4, 1), (Blocks::Bc5, 2), (Blocks::Bc7, 4)] {
            for (width, height) in [(16, 8), (13, 7), (1, 1), (3, 9)] {
                let texel = |k: usize| {
                    let (i, j) = ((k % width as usize) as u8, (k / width as usize) as u8);
                    [90 + 4 * i, 200 - 4 * j, 255, 60 + 2 * i]
                };
                let bytes = compress(blocks, (width, height), texel);
                assert_eq!(bytes.len() as u32, width.div_ceil(4) * height.div_ceil(4) * blocks.bytes());
                let back = decompress(blocks, (width, height), &bytes);
                assert_eq!(back.len(), (width * height) as usize);
                for (k, found) in back.iter().enumerate() {
                    let near = found.iter().zip(texel(k)).take(channels).all(|(a, b)| a.abs_diff(b) <= 3);
                    assert!(near, "{blocks:?} {width} × {height}, texel {k}: {found:?}, {:?}", texel(k));
                }
            }
        }
    }
}
