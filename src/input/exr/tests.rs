//! Damaged files of every compression: an error or pixels, never a panic past the boundary, an abort or a hang.

use super::{decode, decode_radiance};
use crate::input::error::InputError;
use crate::input::options::InputOptions;
use exr::math::RoundingMode;
use exr::prelude::*;
use std::io::Cursor;
use std::path::Path;

const SIZE: Vec2<usize> = Vec2(20, 12);

const COMPRESSIONS: [Compression; 10] = [
    Compression::Uncompressed,
    Compression::RLE,
    Compression::ZIP1,
    Compression::ZIP16,
    Compression::PIZ,
    Compression::PXR24,
    Compression::B44,
    Compression::B44A,
    Compression::DWAA(None),
    Compression::DWAB(None),
];

/// A smooth value with a little of everything.
fn value(channel: usize, at: usize) -> f32 {
    let (x, y) = (at % SIZE.0, at / SIZE.0);
    0.2 + 0.03 * x as f32 * (channel as f32 + 1.0) / 3.0 + 0.02 * y as f32 + if at == 77 { 3.0 } else { 0.0 }
}

/// A small file: half colours, which DWA transforms; alpha, which it codes by run lengths; and float depth.
fn file(compression: Compression, blocks: Blocks) -> Vec<u8> {
    let channel = |i: usize, name: &str| {
        let values = (0..SIZE.area()).map(move |at| value(i, at));
        let samples = match name {
            "Z" => FlatSamples::F32(values.collect()),
            _ => FlatSamples::F16(values.map(f16::from_f32).collect()),
        };
        AnyChannel::new(name, samples)
    };
    let channels = ["A", "B", "G", "R", "Z"].iter().enumerate().map(|(i, name)| channel(i, name)).collect();
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let layer = Layer::new(SIZE, LayerAttributes::default(), encoding, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn read(bytes: &[u8]) -> std::result::Result<Vec<[f32; 3]>, InputError> {
    let options = InputOptions { max_memory: 1 << 20, ..InputOptions::default() };
    decode_radiance(Path::new("a.exr"), bytes, &options, &mut Vec::new()).map(|(_, _, pixels)| pixels)
}

#[test]
fn every_compression_is_read() {
    for compression in COMPRESSIONS {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 16)), Blocks::Tiles(Vec2(64, 64))] {
            let pixels = read(&file(compression, blocks)).unwrap();
            for (at, pixel) in pixels.iter().enumerate() {
                for (c, found) in pixel.iter().enumerate() {
                    let expected = value(3 - c, at);
                    let most = if compression.may_loose_data() { 0.12 * expected } else { 1e-3 * expected };
                    assert!((found - expected).abs() < most, "{compression} {blocks:?}: {found}, expected {expected}");
                }
            }
        }
    }
}

#[test]
fn changed_bytes_are_an_error_or_pixels() {
    for compression in COMPRESSIONS {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 16))] {
            let whole = file(compression, blocks);
            let mut refused = 0;
            for at in 0..whole.len() {
                let mut bytes = whole.clone();
                let change = [0x01, 0x80, 0xff][at % 3];
                bytes[at] ^= change;
                if let Err(error) = read(&bytes) {
                    refused += 1;
                    assert!((4..=6).contains(&error.exit_code()), "{compression}: byte {at} ^ {change}: {error}");
                }
            }
            assert!(refused > 100, "{compression}: {refused}");
        }
    }
}

#[test]
fn every_cut_is_an_error() {
    for compression in COMPRESSIONS {
        let whole = file(compression, Blocks::ScanLines);
        for length in 8..whole.len() {
            let error = read(&whole[..length]).expect_err(&format!("{compression} cut to {length}"));
            assert_eq!(error.exit_code(), 4, "{compression} cut to {length}: {error}");
        }
    }
}

/// The counters of a DWA block, each made larger than the block can need.
#[test]
fn sizes_that_a_dwa_block_claims_are_bounded() {
    for compression in [Compression::DWAA(None), Compression::DWAB(None)] {
        let whole = file(compression, Blocks::ScanLines);
        // The only block: version 2 as its first counter, behind row and size.
        let block = (0..whole.len() - 8).rfind(|at| whole[*at..][..8] == 2u64.to_le_bytes()).unwrap();
        for counter in [1, 6, 7, 8, 9] {
            for claimed in [1u64 << 38, 1 << 62, u64::MAX >> 1, 1 << 20] {
                let mut bytes = whole.clone();
                bytes[block + 8 * counter..][..8].copy_from_slice(&claimed.to_le_bytes());
                let error = read(&bytes).unwrap_err();
                assert_eq!(error.exit_code(), 4, "{error}");
                assert!(error.to_string().contains(&format!("claims {claimed}")), "{error}");
            }
        }
    }
}

#[test]
fn tables_that_lead_astray_are_damaged() {
    let whole = file(Compression::ZIP1, Blocks::ScanLines);
    let table = whole.len() - (SIZE.1 * 8 + blocks_length(&whole));
    let entry = |bytes: &[u8], i: usize| u64::from_le_bytes(bytes[table + 8 * i..][..8].try_into().unwrap());
    for (value, words) in [
        (entry(&whole, 0), "there twice"),
        (0, "cut off"),
        (1, "byte 1, within the header"),
        (u64::MAX, "cut off"),
        (entry(&whole, 1) + 1, "copy or export it again"),
    ] {
        let mut bytes = whole.clone();
        bytes[table + 8..][..8].copy_from_slice(&value.to_le_bytes());
        let error = read(&bytes).unwrap_err();
        assert_eq!(error.exit_code(), 4, "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// Bytes of all blocks of a file of single lines.
fn blocks_length(whole: &[u8]) -> usize {
    // The first entry of the table leads to the byte behind the table.
    let at = (8..whole.len() - 8)
        .find(|at| u64::from_le_bytes(whole[*at..][..8].try_into().unwrap()) == (at + SIZE.1 * 8) as u64)
        .unwrap();
    whole.len() - at - SIZE.1 * 8
}

/// A block of the whole picture with many channels needs far more than the few that are read.
#[test]
fn one_large_block_is_held_against_the_limit() {
    let bytes = file(Compression::ZIP16, Blocks::Tiles(Vec2(64, 64)));
    let options = InputOptions { max_memory: 12_000, ..InputOptions::default() };
    let error = decode_radiance(Path::new("a.exr"), &bytes, &options, &mut Vec::new()).unwrap_err();
    assert_eq!(error.exit_code(), 6, "{error}");
    assert!(error.to_string().contains("blocks of 20 × 12 with 5 channels"), "{error}");
}

/// Tiles of any claimed size are cut to the picture; the largest level is read.
#[test]
fn smaller_levels_are_left_out() {
    let level = |size: Vec2<usize>, scale: f32| {
        let values = |c: usize| (0..size.area()).map(move |at| scale * value(c, at)).collect();
        let channels = ["B", "G", "R"].iter().enumerate();
        AnyChannels::sort(channels.map(|(i, name)| AnyChannel::new(*name, FlatSamples::F32(values(i + 1)))).collect())
    };
    let sizes = [(20, 12), (10, 6), (5, 3), (2, 1), (1, 1)].map(|(w, h)| Vec2(w, h));
    let of = |c: usize| {
        let samples = sizes.map(|size| level(size, if size == SIZE { 1.0 } else { 100.0 }).list[c].sample_data.clone());
        Levels::Mip { rounding_mode: RoundingMode::Down, level_data: samples.to_vec() }
    };
    let channels = ["B", "G", "R"].iter().enumerate().map(|(c, name)| AnyChannel::new(*name, of(c))).collect();
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::Tiles(Vec2(8, 8)),
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(SIZE, LayerAttributes::default(), encoding, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    let pixels = read(&bytes.into_inner()).unwrap();
    assert_eq!(pixels[25], [3, 2, 1].map(|c| value(c, 25)));
    assert_eq!(pixels[SIZE.area() - 1], [3, 2, 1].map(|c| value(c, SIZE.area() - 1)));
}

#[test]
fn heights_too() {
    let options = InputOptions { height: Some(1.0), ..InputOptions::default() };
    let bytes = file(Compression::ZIP16, Blocks::ScanLines);
    let mut notes = Vec::new();
    decode(Path::new("a.exr"), &bytes, &options, &mut notes).unwrap();
    assert!(notes.iter().any(|note| note.contains("reads Z")), "{notes:?}");
}
