//! PNG, TIFF, JPEG, WebP and TGA as strangers write them, and files that are none of these: what is read, what is refused and
//! with which code. TIFFs are built byte by byte here, since no encoder writes the odd ones.

use crate::support::{bake, sky};
use glint_bake::input::{InputError, InputOptions, LoadedMap, load_normal_map};
use glint_bake_core::normal_map::{GreenAxis, RawNormals};
use glint_formats::Wrap;
use image::{GrayImage, ImageEncoder, ImageFormat, RgbImage};
use std::fs;
use std::path::{Path, PathBuf};

/// Columns and rows of the maps here: no multiple of a tile or of the rows of a strip.
const SIZE: (usize, usize) = (20, 13);

/// The height of a surface without any symmetry, in texels.
fn height(i: f64, j: f64) -> f64 {
    1.3 * (0.55 * i + 0.2 * j).sin() + 0.9 * (0.8 * j - 0.1 * i).cos() + 0.02 * i * j / 4.0
}

/// Normals of the surface with +Y up, seen on `size` texels of which `at` gives the place.
fn normals(size: (usize, usize), at: impl Fn(usize, usize) -> (usize, usize)) -> Vec<[f32; 3]> {
    let heights: Vec<f32> = (0..size.0 * size.1)
        .map(|k| at(k % size.0, k / size.0))
        .map(|(i, j)| height(i as f64, j as f64) as f32)
        .collect();
    RawNormals::from_heights(size.0 as u32, size.1 as u32, &heights, 1.0, Wrap::Clamp).unwrap().vectors
}

/// Vectors as 0…1.
fn unorm(vectors: &[[f32; 3]]) -> Vec<[f64; 3]> {
    vectors.iter().map(|v| v.map(|c| 0.5 * f64::from(c) + 0.5)).collect()
}

/// How a sample is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sample {
    U8,
    U16,
    U32,
    F32,
    F64,
}

impl Sample {
    const ALL: [Sample; 5] = [Sample::U8, Sample::U16, Sample::U32, Sample::F32, Sample::F64];

    fn bits(self) -> u64 {
        match self {
            Sample::U8 => 8,
            Sample::U16 => 16,
            Sample::U32 | Sample::F32 => 32,
            Sample::F64 => 64,
        }
    }

    /// The bytes, and what they stand for.
    fn bytes(self, value: f64, big_endian: bool) -> (Vec<u8>, f64) {
        let whole = |most: f64| (value * most).round();
        let (mut bytes, value) = match self {
            Sample::U8 => (vec![whole(255.0) as u8], whole(255.0) / 255.0),
            Sample::U16 => ((whole(65535.0) as u16).to_be_bytes().to_vec(), whole(65535.0) / 65535.0),
            Sample::U32 => ((whole(4294967295.0) as u32).to_be_bytes().to_vec(), value),
            Sample::F32 => ((value as f32).to_be_bytes().to_vec(), value),
            Sample::F64 => (value.to_be_bytes().to_vec(), value),
        };
        if !big_endian {
            bytes.reverse();
        }
        (bytes, value)
    }
}

/// A TIFF to be written.
#[derive(Clone, Debug)]
struct Tiff {
    size: (usize, usize),
    sample: Sample,
    big_endian: bool,
    big: bool,
    planar: bool,
    tile: Option<usize>,
    /// Compressed by LZW.
    lzw: bool,
    photometric: u64,
    /// Further tags.
    tags: Vec<(u16, u64)>,
}

impl Tiff {
    fn new(size: (usize, usize), sample: Sample, photometric: u64) -> Tiff {
        let (big_endian, big, planar, lzw) = (false, false, false, false);
        Tiff { size, sample, big_endian, big, planar, tile: None, lzw, photometric, tags: Vec::new() }
    }

    /// A number of a field of this many bytes.
    fn number(&self, value: u64, bytes: usize) -> Vec<u8> {
        let mut number = value.to_be_bytes()[8 - bytes..].to_vec();
        if !self.big_endian {
            number.reverse();
        }
        number
    }

    /// The samples of the part of one chunk that begins at a texel.
    fn chunk(
        &self,
        texels: &[Vec<f64>],
        (left, top): (usize, usize),
        (wide, high): (usize, usize),
        plane: Option<usize>,
    ) -> Vec<u8> {
        let mut bytes = Vec::new();
        for j in top..top + high {
            for i in left..left + wide {
                let inside = i < self.size.0 && j < self.size.1;
                let outside = vec![0.3; texels[0].len()];
                let texel = if inside { &texels[j * self.size.0 + i] } else { &outside };
                let channels = plane.map_or(0..texel.len(), |plane| plane..plane + 1);
                channels.for_each(|c| bytes.extend(self.sample.bytes(texel[c], self.big_endian).0));
            }
        }
        bytes
    }

    /// The file with these texels; their channels are 0…1.
    fn bytes(&self, texels: &[Vec<f64>]) -> Vec<u8> {
        const STRIP_ROWS: usize = 5;
        let samples = texels[0].len();
        let (wide, high) = self.tile.map_or((self.size.0, STRIP_ROWS), |side| (side, side));
        let planes: Vec<Option<usize>> = if self.planar { (0..samples).map(Some).collect() } else { vec![None] };
        let mut file = self.number(if self.big_endian { 0x4d4d } else { 0x4949 }, 2);
        file.extend(if self.big {
            [self.number(43, 2), self.number(8, 2), self.number(0, 2)].concat()
        } else {
            self.number(42, 2)
        });
        let pointer = file.len();
        let word = if self.big { 8 } else { 4 };
        file.extend(vec![0; word]);
        let (mut offsets, mut lengths) = (Vec::new(), Vec::new());
        for plane in planes {
            for top in (0..self.size.1).step_by(high) {
                for left in (0..self.size.0).step_by(wide) {
                    let rows = if self.tile.is_some() { high } else { high.min(self.size.1 - top) };
                    let chunk = self.chunk(texels, (left, top), (wide, rows), plane);
                    let chunk = if self.lzw { lzw(&chunk) } else { chunk };
                    offsets.push(file.len() as u64);
                    lengths.push(chunk.len() as u64);
                    file.extend(chunk);
                }
            }
        }
        let float = matches!(self.sample, Sample::F32 | Sample::F64);
        let mut tags: Vec<(u16, Vec<u64>)> = vec![
            (256, vec![self.size.0 as u64]),
            (257, vec![self.size.1 as u64]),
            (258, vec![self.sample.bits(); samples]),
            (259, vec![if self.lzw { 5 } else { 1 }]),
            (262, vec![self.photometric]),
            (277, vec![samples as u64]),
            (284, vec![if self.planar { 2 } else { 1 }]),
            (339, vec![if float { 3 } else { 1 }; samples]),
        ];
        tags.extend(match self.tile {
            Some(side) => vec![(322, vec![side as u64]), (323, vec![side as u64]), (324, offsets), (325, lengths)],
            None => vec![(273, offsets), (278, vec![high as u64]), (279, lengths)],
        });
        tags.retain(|(tag, _)| !self.tags.iter().any(|(other, _)| other == tag));
        tags.extend(self.tags.iter().map(|&(tag, value)| (tag, vec![value])));
        tags.sort();
        // Values that do not fit their entry come before the directory.
        let mut entries = Vec::new();
        for (tag, values) in &tags {
            let (kind, width) = if matches!(tag, 256 | 257 | 273 | 278 | 279 | 322..=325) { (4, 4) } else { (3, 2) };
            let mut field: Vec<u8> = values.iter().flat_map(|&v| self.number(v, width)).collect();
            if field.len() > word {
                let at = self.number(file.len() as u64, word);
                file.extend(std::mem::replace(&mut field, at));
            }
            field.resize(word, 0);
            let count = self.number(values.len() as u64, word);
            entries.extend([self.number(u64::from(*tag), 2), self.number(kind, 2), count, field].concat());
        }
        let at = self.number(file.len() as u64, word);
        file.splice(pointer..pointer + word, at);
        file.extend(self.number(tags.len() as u64, if self.big { 8 } else { 2 }));
        file.extend(entries);
        file.extend(vec![0; word]);
        file
    }

    fn rgb(&self, texels: &[[f64; 3]]) -> Vec<u8> {
        self.bytes(&texels.iter().map(|t| t.to_vec()).collect::<Vec<_>>())
    }
}

/// An LZW stream of literals: codes of 9 bits, and a table that is cleared before it would ask for more.
fn lzw(bytes: &[u8]) -> Vec<u8> {
    const CLEAR: u16 = 256;
    const END: u16 = 257;
    let literals = bytes.chunks(200).flat_map(|part| [CLEAR].into_iter().chain(part.iter().map(|&b| u16::from(b))));
    let bits: Vec<u16> = literals.chain([END]).flat_map(|code| (0..9).rev().map(move |bit| code >> bit & 1)).collect();
    bits.chunks(8).map(|byte| byte.iter().enumerate().map(|(k, bit)| (*bit as u8) << (7 - k)).sum()).collect()
}

/// Loads bytes under a name.
fn load(folder: &Path, name: &str, bytes: &[u8], options: &InputOptions) -> Result<LoadedMap, InputError> {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    load_normal_map(&path, options)
}

fn clamped() -> InputOptions {
    InputOptions { wrap: Wrap::Clamp, ..InputOptions::default() }
}

/// Looks that a map has these normals, within `most`.
#[track_caller]
fn same(found: &LoadedMap, expected: &[[f32; 3]], most: f32, what: &str) {
    assert_eq!(found.map.projected.len(), expected.len(), "{what}");
    for (k, (found, expected)) in found.map.projected.iter().zip(expected).enumerate() {
        let off = (found[0] - expected[0]).abs().max((found[1] - expected[1]).abs());
        assert!(off <= most, "{what}: texel {k} is {found:?}, expected {expected:?}");
    }
}

#[test]
fn tiffs_of_every_layout_hold_the_same_map() {
    let folder = tempfile::tempdir().unwrap();
    let vectors = normals(SIZE, |i, j| (i, j));
    for bits in 0..16 {
        for sample in Sample::ALL {
            let mut tiff = Tiff::new(SIZE, sample, 2);
            (tiff.big_endian, tiff.big, tiff.planar) = (bits & 1 != 0, bits & 2 != 0, bits & 4 != 0);
            tiff.tile = (bits & 8 != 0).then_some(16);
            let loaded = load(folder.path(), "a.tif", &tiff.rgb(&unorm(&vectors)), &clamped()).unwrap();
            let step = if sample == Sample::U8 { 0.006 } else { 3e-5 };
            assert_eq!((loaded.map.width as usize, loaded.map.height as usize), SIZE);
            same(&loaded, &vectors, step, &format!("{tiff:?}"));
        }
    }
}

#[test]
fn tiles_of_lzw_that_stick_out_are_whole() {
    let folder = tempfile::tempdir().unwrap();
    // Tiles of 16 that stick out by 1 to 15 columns: what is left of a stream after the last row is a few bits to many.
    for width in 17..32 {
        let vectors = normals((width, 13), |i, j| (i, j));
        for planar in [false, true] {
            let mut tiff = Tiff::new((width, 13), Sample::U8, 2);
            (tiff.planar, tiff.lzw, tiff.tile) = (planar, true, Some(16));
            let loaded = load(folder.path(), "a.tif", &tiff.rgb(&unorm(&vectors)), &clamped()).unwrap();
            same(&loaded, &vectors, 0.006, &format!("{tiff:?}"));
        }
    }
}

#[test]
fn heights_of_every_sample_type() {
    let folder = tempfile::tempdir().unwrap();
    let options = InputOptions { height: Some(10.0), ..clamped() };
    let of = |at: &dyn Fn(f64) -> f64| -> Vec<f64> {
        (0..SIZE.0 * SIZE.1).map(|k| at(0.5 + height((k % SIZE.0) as f64, (k / SIZE.0) as f64) / 10.0)).collect()
    };
    let vectors = normals(SIZE, |i, j| (i, j));
    for sample in Sample::ALL {
        for (photometric, heights) in [(1, of(&|h| h)), (0, of(&|h| 1.0 - h))] {
            let mut tiff = Tiff::new(SIZE, sample, photometric);
            (tiff.big_endian, tiff.big) = (sample == Sample::F32, sample == Sample::F64);
            let texels: Vec<Vec<f64>> = heights.iter().map(|&h| vec![h]).collect();
            let loaded = load(folder.path(), "h.tif", &tiff.bytes(&texels), &options).unwrap();
            let step = if sample == Sample::U8 { 0.05 } else { 3e-4 };
            same(&loaded, &vectors, step, &format!("{tiff:?}"));
            let inverted = loaded.warnings.iter().any(|w| w.contains("white is 0"));
            assert_eq!(inverted, photometric == 0, "{:?}", loaded.warnings);
        }
    }
    // One bit, two and four.
    for depth in [png::BitDepth::One, png::BitDepth::Two, png::BitDepth::Four] {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 16, 2);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(depth);
        let row = 16 * depth as usize / 8;
        encoder.write_header().unwrap().write_image_data(&[vec![0x00; row], vec![0xff; row]].concat()).unwrap();
        let loaded = load(folder.path(), "bits.png", &bytes, &InputOptions { height: Some(1.0), ..clamped() }).unwrap();
        // White below black: the step of 1 leans all normals up.
        same(&loaded, &[[0.0, 0.5f32.sqrt(), 0.0]; 32], 1e-6, &format!("{depth:?}"));
    }
}

/// The texel of the shown picture that each stored one is, as TIFF 6.0 words it: the place of the 0th row, of the 0th column.
fn shown_at(tag: u64, (width, height): (usize, usize), (i, j): (usize, usize)) -> (usize, usize) {
    let (right, bottom) = (width - 1, height - 1);
    match tag {
        1 => (i, j),                  // top, left
        2 => (right - i, j),          // top, right
        3 => (right - i, bottom - j), // bottom, right
        4 => (i, bottom - j),         // bottom, left
        5 => (j, i),                  // left, top
        6 => (right - j, i),          // right, top
        7 => (right - j, bottom - i), // right, bottom
        _ => (j, bottom - i),         // left, bottom
    }
}

/// A picture as a file with the tag stores it: of the surface as it lies in the stored rows, or else of the vectors of the shown
/// picture, moved.
fn stored(tag: u64, of_rows: bool, y: GreenAxis) -> ((usize, usize), Vec<[f32; 3]>) {
    let size = if tag < 5 { SIZE } else { (SIZE.1, SIZE.0) };
    let at = |i: usize, j: usize| shown_at(tag, SIZE, (i, j));
    let mut vectors = if of_rows {
        normals(size, at)
    } else {
        let shown = normals(SIZE, |i, j| (i, j));
        (0..size.0 * size.1).map(|k| at(k % size.0, k / size.0)).map(|(i, j)| shown[j * SIZE.0 + i]).collect()
    };
    if y == GreenAxis::Down {
        vectors.iter_mut().for_each(|v| v[1] = -v[1]);
    }
    (size, vectors)
}

#[test]
fn orientations_of_tiff_turn_the_picture_and_the_vectors_that_lie_in_its_rows() {
    let folder = tempfile::tempdir().unwrap();
    let expected = normals(SIZE, |i, j| (i, j));
    for tag in 1..=8 {
        for y in [GreenAxis::Up, GreenAxis::Down] {
            for of_rows in [true, false] {
                // After half a turn either reading is a surface: the vectors are turned, which the next test looks at.
                if tag == 3 && !of_rows {
                    continue;
                }
                let (size, vectors) = stored(tag, of_rows, y);
                let mut tiff = Tiff::new(size, Sample::F32, 2);
                tiff.tags = vec![(274, tag)];
                let options = InputOptions { y, ..clamped() };
                let loaded = load(folder.path(), "a.tif", &tiff.rgb(&unorm(&vectors)), &options).unwrap();
                assert_eq!((loaded.map.width as usize, loaded.map.height as usize), SIZE);
                same(&loaded, &expected, 1e-5, &format!("{tag}, {y:?}, of the stored rows: {of_rows}"));
                let said = |words: &str| loaded.warnings.iter().any(|w| w.contains(words));
                assert_eq!(said("orientation tag"), tag != 1, "{:?}", loaded.warnings);
                assert_eq!(said("are kept"), tag != 1 && !of_rows, "{:?}", loaded.warnings);
            }
        }
    }
}

#[test]
fn vectors_that_do_not_tell_are_turned() {
    let folder = tempfile::tempdir().unwrap();
    // All vectors alike; in texels shown, by the same formulas for points instead of places.
    let vector = [0.6f32, 0.0, 0.8];
    for (tag, [x, y]) in
        [[0.6, 0.0], [-0.6, 0.0], [-0.6, 0.0], [0.6, 0.0], [0.0, -0.6], [0.0, -0.6], [0.0, 0.6], [0.0, 0.6]]
            .into_iter()
            .enumerate()
            .map(|(k, v)| (k as u64 + 1, v))
    {
        let mut tiff = Tiff::new(SIZE, Sample::F32, 2);
        tiff.tags = vec![(274, tag)];
        let texels = unorm(&vec![vector; SIZE.0 * SIZE.1]);
        let loaded = load(folder.path(), "a.tif", &tiff.rgb(&texels), &clamped()).unwrap();
        same(&loaded, &vec![[x, y, 0.8]; SIZE.0 * SIZE.1], 1e-5, &format!("{tag}"));
        assert!(tag == 1 || loaded.warnings.iter().any(|w| w.contains("does not tell")), "{:?}", loaded.warnings);
    }
}

/// EXIF with an orientation.
fn exif(tag: u64) -> Vec<u8> {
    let mut exif = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
    exif.extend([tag as u8, 0, 0, 0, 0, 0, 0]);
    exif
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 })
    })
}

fn png_chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let named = [kind, content].concat();
    [&(content.len() as u32).to_be_bytes()[..], &named, &crc32(&named).to_be_bytes()].concat()
}

fn webp_chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut chunk = [kind, &(content.len() as u32).to_le_bytes()[..], content].concat();
    chunk.resize(chunk.len().next_multiple_of(2), 0);
    chunk
}

fn encoded(image: &RgbImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    match format {
        ImageFormat::Jpeg => {
            let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100);
            encoder.write_image(image, image.width(), image.height(), image::ExtendedColorType::Rgb8).unwrap();
        }
        _ => image.write_to(&mut bytes, format).unwrap(),
    }
    bytes.into_inner()
}

fn picture((width, height): (usize, usize), vectors: &[[f32; 3]]) -> RgbImage {
    let bytes = unorm(vectors).iter().flat_map(|v| v.map(|c| (c * 255.0).round() as u8)).collect();
    RgbImage::from_vec(width as u32, height as u32, bytes).unwrap()
}

#[test]
fn orientations_of_exif_are_those_of_tiff() {
    let folder = tempfile::tempdir().unwrap();
    let expected = normals(SIZE, |i, j| (i, j));
    for tag in 1..=8 {
        let (size, vectors) = stored(tag, true, GreenAxis::Up);
        let image = picture(size, &vectors);
        let mut before = encoded(&image, ImageFormat::Png);
        let mut after = before.clone();
        before.splice(33..33, png_chunk(b"eXIf", &exif(tag)));
        let end = after.len() - 12;
        after.splice(end..end, png_chunk(b"eXIf", &exif(tag)));
        let mut jpeg = encoded(&image, ImageFormat::Jpeg);
        let segment = [b"Exif\0\0", &exif(tag)[..]].concat();
        jpeg.splice(2..2, [&[0xff, 0xe1, 0, segment.len() as u8 + 2], &segment[..]].concat());
        let lossless = encoded(&image, ImageFormat::WebP);
        let canvas = [size.0 as u8 - 1, 0, 0, size.1 as u8 - 1, 0, 0];
        let chunks = [
            webp_chunk(b"VP8X", &[&[8, 0, 0, 0], &canvas[..]].concat()),
            lossless[12..].to_vec(),
            webp_chunk(b"EXIF", &[b"Exif\0\0", &exif(tag)[..]].concat()),
        ]
        .concat();
        let webp = [b"RIFF", &(chunks.len() as u32 + 4).to_le_bytes()[..], b"WEBP", &chunks].concat();
        for (name, bytes, most) in
            [("a.png", &before, 0.006), ("b.png", &after, 0.006), ("c.jpg", &jpeg, 0.1), ("d.webp", &webp, 0.006)]
        {
            let loaded = load(folder.path(), name, bytes, &clamped()).unwrap();
            assert_eq!((loaded.map.width as usize, loaded.map.height as usize), SIZE, "{name}, {tag}");
            same(&loaded, &expected, most, &format!("{name}, {tag}"));
            let said = loaded.warnings.iter().any(|w| w.contains("orientation tag"));
            assert_eq!(said, tag != 1, "{name}: {:?}", loaded.warnings);
        }
        // Heights have nothing to turn.
        let grey = GrayImage::from_fn(size.0 as u32, size.1 as u32, |i, j| {
            let (i, j) = shown_at(tag, SIZE, (i as usize, j as usize));
            image::Luma([(127.5 + 40.0 * height(i as f64, j as f64)).round() as u8])
        });
        let mut bytes = std::io::Cursor::new(Vec::new());
        grey.write_to(&mut bytes, ImageFormat::Png).unwrap();
        let mut bytes = bytes.into_inner();
        bytes.splice(33..33, png_chunk(b"eXIf", &exif(tag)));
        let options = InputOptions { height: Some(255.0 / 40.0), ..clamped() };
        same(&load(folder.path(), "h.png", &bytes, &options).unwrap(), &expected, 0.02, &format!("heights, {tag}"));
    }
}

/// A TGA of 24 or 32 bits whose first texel is at a corner: bits 4 (right) and 5 (top) of the descriptor.
fn tga(descriptor: u8, depth: u8, texels: &RgbImage, fourth: u8) -> Vec<u8> {
    let (width, height) = texels.dimensions();
    let mut bytes = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    bytes.extend([width as u8, 0, height as u8, 0, depth, descriptor]);
    for j in 0..height {
        for i in 0..width {
            let i = if descriptor & 0x10 != 0 { width - 1 - i } else { i };
            let j = if descriptor & 0x20 != 0 { j } else { height - 1 - j };
            let [r, g, b] = texels[(i, j)].0;
            bytes.extend(&[b, g, r, fourth][..depth as usize / 8]);
        }
    }
    bytes
}

#[test]
fn tga_begins_at_any_corner_and_has_alpha_where_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let expected = normals(SIZE, |i, j| (i, j));
    let image = picture(SIZE, &expected);
    for corner in [0x00, 0x10, 0x20, 0x30] {
        let loaded = load(folder.path(), "a.tga", &tga(corner, 24, &image, 0), &clamped()).unwrap();
        same(&loaded, &expected, 0.006, &format!("corner {corner:#x}"));
        // No bits of the fourth byte are alpha, so its zeros mean nothing.
        let loaded = load(folder.path(), "b.tga", &tga(corner, 32, &image, 0), &clamped()).unwrap();
        same(&loaded, &expected, 0.006, &format!("padded, corner {corner:#x}"));
        assert!(!loaded.warnings.iter().any(|w| w.contains("alpha")), "{:?}", loaded.warnings);
    }
}

#[test]
fn alpha_that_was_multiplied_in_is_divided_out_and_further_pictures_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let expected = normals(SIZE, |i, j| (i, j));
    let mut tiff = Tiff::new(SIZE, Sample::F32, 2);
    tiff.tags = vec![(338, 1)];
    let texels: Vec<Vec<f64>> =
        unorm(&expected).iter().map(|v| v.iter().map(|c| 0.5 * c).chain([0.5]).collect()).collect();
    let loaded = load(folder.path(), "a.tif", &tiff.bytes(&texels), &clamped()).unwrap();
    same(&loaded, &expected, 1e-5, "associated alpha");
    assert!(loaded.warnings.iter().any(|w| w.contains("multiplied by alpha")), "{:?}", loaded.warnings);

    // The pointer to a next directory, the last bytes, leads to the first one again, or to another.
    let mut pages = Tiff::new(SIZE, Sample::U8, 2).rgb(&unorm(&expected));
    let first = u32::from_le_bytes(pages[4..8].try_into().unwrap());
    let at = pages.len() - 4;
    let second = pages.len() as u32;
    let directory = pages[first as usize..].to_vec();
    pages.splice(at.., second.to_le_bytes());
    pages.extend(directory);
    let loaded = load(folder.path(), "pages.tif", &pages, &clamped()).unwrap();
    same(&loaded, &expected, 0.006, "pages");
    assert!(loaded.warnings.iter().any(|w| w.contains("further pictures")), "{:?}", loaded.warnings);

    let mut animated = encoded(&picture(SIZE, &expected), ImageFormat::Png);
    animated.splice(33..33, png_chunk(b"acTL", &[0, 0, 0, 1, 0, 0, 0, 0]));
    let loaded = load(folder.path(), "a.png", &animated, &clamped()).unwrap();
    assert!(loaded.warnings.iter().any(|w| w.contains("animation")), "{:?}", loaded.warnings);
}

/// A JPEG as far as its frame.
fn jpeg_frame(marker: u8, bits: u8, channels: u8) -> Vec<u8> {
    let mut bytes = vec![0xff, 0xd8, 0xff, marker, 0, 8 + 3 * channels, bits, 0, 8, 0, 8, channels];
    (0..channels).for_each(|c| bytes.extend([c + 1, 0x11, 0]));
    bytes.extend([0xff, 0xda, 0, 2, 0xff, 0xd9]);
    bytes
}

/// Files that are not read, their code, and what they are called.
fn foreign() -> Vec<(&'static str, Vec<u8>, i32, &'static str)> {
    let tiff = |tag: u16, value: u64, photometric: u64| {
        let mut tiff = Tiff::new((4, 4), Sample::U8, photometric);
        tiff.tags = vec![(tag, value)];
        tiff.rgb(&[[0.5, 0.5, 1.0]; 16])
    };
    let named = |bytes: &[u8]| [bytes, &[7; 64]].concat();
    vec![
        (
            "lfs.png",
            b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n".to_vec(),
            5,
            "git lfs pull",
        ),
        (
            "lfs.tif",
            b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n".to_vec(),
            5,
            "Git LFS pointer",
        ),
        ("a.jp2", named(b"\0\0\0\x0cjP  \r\n\x87\n"), 5, "JPEG 2000"),
        ("a.j2k", named(b"\xff\x4f\xff\x51"), 5, "JPEG 2000"),
        ("a.jxl", named(b"\0\0\0\x0cJXL \r\n\x87\n"), 5, "JPEG XL"),
        ("b.jxl", named(b"\xff\x0a"), 5, "JPEG XL"),
        ("a.avif", named(b"\0\0\0\x20ftypavif"), 5, "AVIF"),
        ("a.heic", named(b"\0\0\0\x20ftypheic"), 5, "HEIF"),
        ("a.pcx", named(&[0x0a, 5, 1, 8]), 5, "PCX"),
        ("a.png.gz", named(b"\x1f\x8b\x08"), 5, "gzip"),
        ("maps.zip", named(b"PK\x03\x04"), 5, "ZIP"),
        ("a.psd", named(b"8BPS\0\x01"), 5, "Photoshop"),
        ("a.bmp", [b"BM\x9a\0\0\0\0\0\0\0", &[0; 64][..]].concat(), 5, "BMP"),
        ("a.gif", named(b"GIF89a"), 5, "GIF"),
        ("a.dds", named(b"DDS \x7c\0\0\0"), 5, "DDS"),
        ("a.ktx", named(b"\xabKTX 11\xbb\r\n\x1a\n"), 5, "KTX"),
        ("a.ktx2", named(b"\xabKTX 20\xbb\r\n\x1a\n"), 5, "KTX2"),
        ("a.svg", b"<?xml version='1.0'?>\n<!-- a --><svg xmlns='http://www.w3.org/2000/svg'/>".to_vec(), 5, "SVG"),
        ("page.png", b"\xef\xbb\xbf\n<!DOCTYPE HTML>\n<html>".to_vec(), 5, "web page"),
        ("page.jpg", b"<html><body>404</body></html>".to_vec(), 5, "web page"),
        ("text.png", b"normal map, see the wiki\n".to_vec(), 4, "text starting with"),
        ("junk.png", named(&[1, 2, 3]), 4, "no image"),
        ("zeros.png", vec![0; 4096], 4, "never filled"),
        ("empty.png", Vec::new(), 4, "empty"),
        ("12.jpg", jpeg_frame(0xc1, 12, 3), 5, "12 bits"),
        ("lossless.jpg", jpeg_frame(0xc3, 8, 3), 5, "lossless"),
        ("arithmetic.jpg", jpeg_frame(0xc9, 8, 3), 5, "arithmetic"),
        ("ls.jpg", jpeg_frame(0xf7, 8, 3), 5, "JPEG-LS"),
        ("cmyk.jpg", jpeg_frame(0xc0, 8, 4), 5, "CMYK"),
        ("palette.tif", tiff(266, 1, 3), 5, "palette"),
        ("cmyk.tif", tiff(266, 1, 5), 5, "CMYK"),
        ("lab.tif", tiff(266, 1, 8), 5, "Lab"),
        ("signed.tif", tiff(339, 2, 2), 5, "with a sign"),
        ("bits.tif", tiff(266, 2, 2), 5, "reverse order"),
        ("codec.tif", tiff(259, 34925, 2), 5, "34925"),
    ]
}

#[test]
fn files_that_are_not_read_are_named_as_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, code, words) in foreign() {
        let error = load(folder.path(), name, &bytes, &InputOptions::default()).unwrap_err();
        let message = error.to_string();
        assert_eq!(i32::from(error.exit_code()), code, "{message}");
        assert!(message.contains(name) && message.contains(words), "no {words:?} in: {message}");
    }
}

#[test]
fn a_jpeg_with_damaged_data_is_refused_and_one_with_odd_headers_read() {
    let folder = tempfile::tempdir().unwrap();
    let sound = encoded(&picture(SIZE, &normals(SIZE, |i, j| (i, j))), ImageFormat::Jpeg);
    let scan = sound.windows(2).position(|w| w == [0xff, 0xda]).unwrap();
    let middle = scan + (sound.len() - scan) / 3;
    let with = |at: usize, bytes: &[u8]| {
        let mut file = sound.clone();
        file.splice(at..at, bytes.iter().copied());
        file
    };
    let damaged = [("frame.jpg", with(middle, &[0xff, 0xc0])), ("start.jpg", with(middle, &[0xff, 0xd8]))];
    for (name, bytes) in damaged {
        let loaded = load(folder.path(), name, &bytes, &InputOptions::default());
        let error = loaded.map(|_| name).unwrap_err();
        assert_eq!(error.exit_code(), 4, "{error}");
        assert!(error.to_string().contains("damaged"), "{error}");
    }
    // Bytes between headers, and after the end, belong to no pixel.
    let plain = load(folder.path(), "plain.jpg", &sound, &InputOptions::default()).unwrap();
    let end = sound.len();
    for (name, bytes) in [("between.jpg", with(scan, &[0; 7])), ("after.jpg", with(end, b"trailer"))] {
        let loaded = load(folder.path(), name, &bytes, &InputOptions::default()).unwrap();
        assert!(loaded.map == plain.map, "{name}");
    }
}

#[test]
fn environments_are_named_as_what_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let png = encoded(&picture(SIZE, &normals(SIZE, |i, j| (i, j))), ImageFormat::Png);
    let files: Vec<_> =
        foreign().into_iter().filter(|(name, ..)| !name.ends_with(".jpg") && !name.ends_with(".tif")).collect();
    let maps =
        [("map.png", png, 5, "no range for lights"), ("map.jpg", jpeg_frame(0xc0, 8, 3), 5, "no range for lights")];
    for (name, bytes, code, words) in files.into_iter().chain(maps) {
        fs::write(folder.path().join(name), bytes).unwrap();
        let done = bake(folder.path(), &["environment", name, "-o", "out.glintpack"]);
        assert_eq!(done.code, code, "{name}: {}", done.stderr);
        assert!(done.stderr.contains(name) && done.stderr.contains(words), "no {words:?} in: {}", done.stderr);
    }
}

#[test]
fn a_build_bakes_what_is_sound_and_lists_each_bad_file() {
    let folder = tempfile::tempdir().unwrap();
    let expected = normals(SIZE, |i, j| (i, j));
    fs::write(folder.path().join("sound.tif"), Tiff::new(SIZE, Sample::U8, 2).rgb(&unorm(&expected))).unwrap();
    sky(&folder.path().join("sky.hdr"));
    let mut project = String::from(
        "[defaults.ndf-maps]\npreset = 'draft'\n[environments.sky]\nmethod = 'environment'\ninput = 'sky.hdr'\nface-size = 8\n",
    );
    for (k, (name, bytes, ..)) in foreign().into_iter().enumerate() {
        fs::write(folder.path().join(name), bytes).unwrap();
        project += &format!("[materials.bad{k}]\nmethod = 'ndf-maps'\ninput = '{name}'\n");
    }
    project += "[materials.sound]\nmethod = 'ndf-maps'\ninput = 'sound.tif'\n";
    fs::write(folder.path().join("glint.toml"), project).unwrap();
    let done = bake(folder.path(), &["build"]);
    assert_eq!(done.code, 5, "{}", done.stderr);
    assert!(done.stderr.contains(&format!("2 written, {} failed", foreign().len())), "{}", done.stderr);
    for (k, (name, _, _, words)) in foreign().into_iter().enumerate() {
        let line = done.stderr.lines().find(|line| line.contains(&format!("bad{k}: "))).unwrap_or_default();
        assert!(line.contains(name) && line.contains(words), "{name}: {line:?}");
    }
    assert!(
        folder.path().join("packs/sound.glintpack").is_file() && folder.path().join("packs/sky.glintpack").is_file()
    );
}

/// The folder of cases, or None (said) where there is none.
fn cases() -> Option<PathBuf> {
    let data = std::env::var_os("GLINT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let cases = data.join("cases");
    if cases.is_dir() {
        return Some(cases);
    }
    eprintln!("skipped: no cases in {} (set GLINT_DATA)", data.display());
    None
}

#[test]
fn the_cases_have_their_results() {
    let Some(cases) = cases() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| cases.join(name).to_str().unwrap().to_owned();
    for (name, flags, code, words) in [
        ("tiled_planar.tif", &[][..], 0, ""),
        ("orientation_bottom_left.tif", &[], 0, "mirrored top to bottom"),
        ("height_float.tif", &["--height", "3"], 0, ""),
        ("jpeg12.jpg", &[], 5, "12 bits"),
    ] {
        let done = bake(
            folder.path(),
            &[&["ndf-maps", &file(name), "-o", "out.glintpack", "--preset", "draft"], flags].concat(),
        );
        assert_eq!(done.code, code, "{name}: {}", done.stderr);
        assert!(done.stderr.contains(words), "{name}: {}", done.stderr);
    }
    // The mirrored map is the sound one, rows from the bottom.
    let load = |name: &str| load_normal_map(&cases.join(name), &InputOptions::default()).unwrap();
    assert_eq!(load("orientation_bottom_left.tif").map, load("sound.png").map);

    // As the first of two packs.
    let table = |key: &str, name: &str| {
        format!("[materials.{key}]\nmethod = 'ndf-maps'\npreset = 'draft'\ninput = '{}'\n", file(name))
    };
    for (first, code, said) in [("tiled_planar.tif", 0, "2 written"), ("jpeg12.jpg", 5, "1 written, 1 failed")] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("glint.toml"), table("a", first) + &table("b", "sound.png")).unwrap();
        let done = bake(folder.path(), &["build"]);
        assert_eq!(done.code, code, "{}", done.stderr);
        assert!(done.stderr.contains(said), "{}", done.stderr);
    }
}
