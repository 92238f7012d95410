//! The blocks of one part, decompressed a few at a time into the channels that are wanted.
//!
//! Blocks are found by the part's offset table, and every block of the largest level must be there once: a table that was
//! never finished, or leads to the same block twice, would leave pixels black.

use super::dwa;
use super::fault::Fault;
use super::header::{Bytes, File};
use crate::input::error::InputError;
use crate::input::guard::guarded;
use exr::block::UncompressedBlock;
use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock, CompressedTileBlock, TileCoordinates};
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use half::f16;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;

/// Blocks a thread that are held at once, where memory allows.
const BLOCKS_A_THREAD: usize = 4;
/// Bytes of an entry of the offset table.
const OFFSET: usize = 8;

/// The values of some channels of a part, row-major from the top left.
pub(super) fn read<const N: usize>(
    path: &Path,
    file: &File<'_>,
    part: usize,
    channels: [usize; N],
    max_memory: u64,
) -> Result<Vec<[f32; N]>, InputError> {
    let header = &file.meta.headers[part];
    let of_file = |fault: Fault| fault.of(path);
    check_compression(header).and_then(|()| check_samples(header, &channels)).map_err(of_file)?;
    let offsets = offsets(file, part).map_err(of_file)?;
    let texels = header.layer_size.area();
    let held = (texels * N * size_of::<f32>() + file.bytes.len()) as u64;
    let batch = blocks_at_once(header, max_memory.saturating_sub(held), max_memory).map_err(of_file)?;
    // Each on the thread that decodes it, so that the library's panic is an error wherever it happens.
    let guarded_block = |offset: &u64| guarded(path, || block(file, part, *offset).map_err(of_file));

    let mut values = vec![[0.0; N]; texels];
    let mut seen = BTreeSet::new();
    let mut filled = 0;
    for offsets in offsets.chunks(batch) {
        let blocks: Vec<_> = offsets.par_iter().map(guarded_block).collect();
        for block in blocks {
            let Some(block) = block? else { continue };
            let Vec2(x, y) = block.index.pixel_position;
            if !seen.insert((x, y)) {
                return Err(of_file(Fault::damaged(format_args!("its block at ({x}, {y}) is there twice"))));
            }
            filled += block.index.pixel_size.area();
            place(header, &block, &channels, &mut values);
        }
    }
    if filled != texels {
        let missing = texels.abs_diff(filled);
        return Err(of_file(Fault::damaged(format_args!("{missing} of {texels} pixels are in no block"))));
    }
    Ok(values)
}

/// Refuses what the library knows by name only.
fn check_compression(header: &Header) -> Result<(), Fault> {
    let name = match header.compression {
        Compression::HTJ2K32 => "HTJ2K32",
        Compression::HTJ2K256 => "HTJ2K256",
        _ => return Ok(()),
    };
    Err(Fault::Unsupported(format!(
        "{name} compression (high-throughput JPEG 2000) is not read; export it with ZIP compression"
    )))
}

/// Refuses whole numbers, which are counts and ids.
fn check_samples(header: &Header, channels: &[usize]) -> Result<(), Fault> {
    let list = &header.channels.list;
    match channels.iter().map(|channel| &list[*channel]).find(|channel| channel.sample_type == SampleType::U32) {
        None => Ok(()),
        Some(channel) => Err(Fault::Unsupported(format!(
            "channel {} holds whole numbers (uint), which have no scale; expected half or float: export it as half",
            channel.name
        ))),
    }
}

/// Where the blocks of a part begin.
fn offsets(file: &File<'_>, part: usize) -> Result<Vec<u64>, Fault> {
    let counts = || file.meta.headers.iter().map(|header| header.chunk_count);
    let bytes_of = |count: usize| count.checked_mul(OFFSET).ok_or_else(Fault::cut_off);
    let before = bytes_of(counts().take(part).sum())?;
    let table = Bytes::new(file.bytes, file.tables_at.saturating_add(before))
        .take(bytes_of(file.meta.headers[part].chunk_count)?)?;
    let first = file.tables_at.saturating_add(bytes_of(counts().sum())?) as u64;
    let offsets: Vec<u64> = table.as_chunks().0.iter().map(|bytes: &[u8; OFFSET]| u64::from_le_bytes(*bytes)).collect();
    match offsets.iter().find(|offset| **offset < first || **offset >= file.bytes.len() as u64) {
        // Writers fill the table in last.
        Some(0) => Err(Fault::cut_off()),
        Some(far) if *far >= file.bytes.len() as u64 => Err(Fault::cut_off()),
        Some(odd) => Err(Fault::damaged(format_args!("its table of blocks leads to byte {odd}, within the header"))),
        None => Ok(offsets),
    }
}

/// How many blocks may be held at once in `room` bytes.
fn blocks_at_once(header: &Header, room: u64, max_memory: u64) -> Result<usize, Fault> {
    let most = header.max_block_pixel_size();
    let (width, height) = (most.0.min(header.layer_size.0) as u64, most.1.min(header.layer_size.1) as u64);
    // A block is held compressed, decompressed, and twice in between; DWA keeps transforms of three floats beside it.
    let needed = width * height * (4 * header.channels.bytes_per_pixel as u64 + 16);
    let fitting = (room / needed.max(1)) as usize;
    if fitting == 0 {
        return Err(Fault::Limit(format!(
            "the image is {} × {} in blocks of {width} × {height} with {} channels, of which one needs {needed} bytes \
             to decompress; the limit is {max_memory} for all: raise --max-memory, or export scan lines or fewer channels",
            header.layer_size.0,
            header.layer_size.1,
            header.channels.list.len()
        )));
    }
    Ok(fitting.min(BLOCKS_A_THREAD * rayon::current_num_threads()))
}

/// The block at an offset; none when it is one of a smaller level.
fn block(file: &File<'_>, part: usize, offset: u64) -> Result<Option<UncompressedBlock>, Fault> {
    let header = &file.meta.headers[part];
    let mut bytes = Bytes::new(file.bytes, usize::try_from(offset).map_err(|_| Fault::cut_off())?);
    let of = format!("its block at byte {offset}");
    if file.meta.requirements.is_multilayer() {
        let found = bytes.count("the part of a block")?;
        if found != part {
            return Err(Fault::damaged(format_args!("{of} is of part {found}, expected part {part}")));
        }
    }
    let (coordinates, line) = match header.blocks {
        BlockDescription::ScanLines => (None, bytes.int()?),
        BlockDescription::Tiles(_) => {
            let mut next = || bytes.count("a coordinate of a tile");
            let (tile_index, level_index) = (Vec2(next()?, next()?), Vec2(next()?, next()?));
            (Some(TileCoordinates { tile_index, level_index }), 0)
        }
    };
    if coordinates.is_some_and(|tile| tile.level_index != Vec2(0, 0)) {
        return Ok(None);
    }
    let size = bytes.count("the size of a block")?;
    if size == 0 {
        return Err(Fault::damaged(format_args!("{of} is empty")));
    }
    let compressed = bytes.take(size)?;
    let compressed_pixels_le = compressed.to_vec();
    let compressed_block = match coordinates {
        Some(coordinates) => CompressedBlock::Tile(CompressedTileBlock { coordinates, compressed_pixels_le }),
        None => CompressedBlock::ScanLine(CompressedScanLineBlock { y_coordinate: line, compressed_pixels_le }),
    };
    let in_library = |error| Fault::from_library(error, &of);
    if matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        let tile = header.get_block_data_indices(&compressed_block).map_err(in_library)?;
        let pixels = header.get_absolute_block_pixel_coordinates(tile).map_err(in_library)?;
        dwa::check(&header.channels, pixels.size, compressed)
            .map_err(|what| Fault::damaged(format_args!("{of}: {what}")))?;
    }
    let chunk = Chunk { layer_index: part, compressed_block };
    UncompressedBlock::decompress_chunk(chunk, &file.meta, false).map(Some).map_err(in_library)
}

/// Puts the wanted channels of a block where they belong.
fn place<const N: usize>(header: &Header, block: &UncompressedBlock, channels: &[usize; N], values: &mut [[f32; N]]) {
    for line in block.lines(&header.channels) {
        let Vec2(x, y) = line.location.position;
        let row = &mut values[y * header.layer_size.0 + x..][..line.location.sample_count];
        for (to, _) in channels.iter().enumerate().filter(|(_, channel)| **channel == line.location.channel) {
            if header.channels.list[line.location.channel].sample_type == SampleType::F16 {
                for (value, bytes) in row.iter_mut().zip(line.value.as_chunks().0) {
                    value[to] = f16::from_ne_bytes(*bytes).to_f32();
                }
            } else {
                for (value, bytes) in row.iter_mut().zip(line.value.as_chunks().0) {
                    value[to] = f32::from_ne_bytes(*bytes);
                }
            }
        }
    }
}
