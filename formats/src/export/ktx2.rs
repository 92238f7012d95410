//! A texture as a KTX2 file (Khronos Texture 2.0, sections 3 to 5). Without supercompression any loader reads it; with
//! Zstandard each level is a frame of its own.
//!
//! A pack and a KTX2 file order the images of a mip alike; the file has the smallest mip first and aligns each.

use super::blocks::Blocks;
use super::image::Texture;
use super::{dfd, texel};

const IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";
const HEADER_BYTES: usize = 80;
const LEVEL_ENTRY_BYTES: usize = 24;

/// How hard levels are compressed; more gains little on normals.
const ZSTD_LEVEL: i32 = 9;
/// Number of Zstandard among the schemes of supercompression.
const SCHEME_ZSTD: usize = 2;

/// Bytes of a KTX2 file with this texture, not supercompressed. `metadata` are keys with text values; those that begin with `KTX` are
/// Khronos's. A texture of one layer is no array, one of six faces is a cube. `None` for a format that neither packs
/// nor [`Blocks`] have.
pub fn write(texture: &Texture, payload: &[u8], metadata: &[(&str, &str)]) -> Option<Vec<u8>> {
    let levels: Vec<&[u8]> = (0..texture.mips).map(|mip| &payload[texture.mip_range(mip)]).collect();
    file(texture, &levels, 0, metadata)
}

/// The same with levels compressed by Zstandard.
pub fn write_zstd(texture: &Texture, payload: &[u8], metadata: &[(&str, &str)]) -> Option<Vec<u8>> {
    let compress = |mip| zstd::bulk::compress(&payload[texture.mip_range(mip)], ZSTD_LEVEL).ok();
    let levels: Vec<Vec<u8>> = (0..texture.mips).map(compress).collect::<Option<_>>()?;
    let levels: Vec<&[u8]> = levels.iter().map(Vec::as_slice).collect();
    file(texture, &levels, SCHEME_ZSTD, metadata)
}

/// A file of these levels, the largest first.
fn file(texture: &Texture, levels: &[&[u8]], scheme: usize, metadata: &[(&str, &str)]) -> Option<Vec<u8>> {
    let (dfd, type_size) = match Blocks::of(texture.vk_format) {
        Some(blocks) => (dfd::of_blocks(blocks), 1),
        None => {
            let layout = texel::layout(texture.vk_format)?;
            let whole_bytes = layout.bits % 8 == 0;
            let type_size = if whole_bytes { (layout.bits / 8).max(1) as usize } else { texture.texel_bytes() };
            (dfd::descriptor(&layout, texture.texel_bytes() as u8), type_size)
        }
    };
    let kvd = key_values(metadata);
    let dfd_at = HEADER_BYTES + LEVEL_ENTRY_BYTES * texture.mips as usize;
    let kvd_at = dfd_at + dfd.len();

    // Where each mip lies: the last first, each at a multiple of its texel or block, and of 4; compressed ones at any byte.
    let alignment = if scheme == 0 { texture.texel_bytes().max(4) } else { 1 };
    let mut end = kvd_at + kvd.len();
    let mut places = vec![0; texture.mips as usize];
    for mip in (0..texture.mips).rev() {
        places[mip as usize] = end.next_multiple_of(alignment);
        end = places[mip as usize] + levels[mip as usize].len();
    }

    let mut out = Vec::with_capacity(end);
    out.extend(IDENTIFIER);
    let layers = if texture.layers > 1 { texture.layers } else { 0 };
    let word = |value: usize| value as u32;
    for value in [
        texture.vk_format,
        word(type_size),
        texture.width,
        texture.height,
        0, // not a volume
        layers,
        texture.faces,
        texture.mips,
        word(scheme),
        word(dfd_at),
        word(dfd.len()),
        if kvd.is_empty() { 0 } else { word(kvd_at) },
        word(kvd.len()),
    ] {
        out.extend(value.to_le_bytes());
    }
    out.extend([0; 16]); // no data of a supercompression
    for (mip, place) in places.iter().enumerate() {
        for value in [*place as u64, levels[mip].len() as u64, texture.mip_bytes(mip as u32) as u64] {
            out.extend(value.to_le_bytes());
        }
    }
    out.extend(dfd);
    out.extend(kvd);
    for mip in (0..texture.mips).rev() {
        out.resize(places[mip as usize], 0);
        out.extend(levels[mip as usize]);
    }
    // Khronos's ktx2check 4.0 expects the padding behind the last mip too; others read up to that mip's end.
    out.resize(end.next_multiple_of(alignment), 0);
    Some(out)
}

/// Keys and values in the order of their keys, each padded to four bytes.
fn key_values(metadata: &[(&str, &str)]) -> Vec<u8> {
    let mut sorted = metadata.to_vec();
    sorted.sort();
    let mut out = Vec::new();
    for (key, value) in sorted {
        out.extend(((key.len() + value.len() + 2) as u32).to_le_bytes());
        for text in [key, value] {
            out.extend(text.as_bytes());
            out.push(0);
        }
        out.resize(out.len().next_multiple_of(4), 0);
    }
    out
}
