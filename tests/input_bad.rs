//! Input files that are damaged, mislabelled or not what they should be: the kind of error, its exit code, its words.

use std::fs;
use std::path::PathBuf;

use exr::prelude::{Image, SpecificChannels, WritableImage};
use glint_bake::input::synthetic::leather;
use glint_bake::input::{Channels, ColourSpace, Crop, InputError, InputOptions, LoadedMap, load_normal_map};
use glint_bake_core::normal_map::GreenAxis;
use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb, RgbImage};
use tempfile::TempDir;

/// A folder of files that goes away with the test.
struct Files(TempDir);

impl Files {
    fn new() -> Files {
        Files(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.path(name), bytes).unwrap();
        self.path(name)
    }

    fn load(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<LoadedMap, InputError> {
        load_normal_map(&self.write(name, bytes), &InputOptions::default())
    }

    /// Loading must fail with this exit code; the message must hold the file's name and all of `words`.
    #[track_caller]
    fn refuse(&self, name: &str, bytes: impl AsRef<[u8]>, code: u8, words: &[&str]) {
        refused(self.load(name, bytes), code, name, words);
    }
}

#[track_caller]
fn refused(result: Result<LoadedMap, InputError>, code: u8, name: &str, words: &[&str]) {
    let error = result.err().unwrap_or_else(|| panic!("{name} was accepted"));
    let message = error.to_string();
    assert_eq!(error.exit_code(), code, "{message}");
    for word in words.iter().chain([&name]) {
        assert!(message.contains(word), "no \"{word}\" in: {message}");
    }
}

fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn sound_png() -> Vec<u8> {
    encoded(leather(32, 32, 1), ImageFormat::Png)
}

/// A PNG with another width and height in its header; its checksum is made right again.
fn png_of_size(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = sound_png();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let crc = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    bytes
}

/// A PNG with one more chunk after its header.
fn png_with_chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut chunk = (content.len() as u32).to_be_bytes().to_vec();
    chunk.extend(kind);
    chunk.extend(content);
    chunk.extend(crc32(&chunk[4..]).to_be_bytes());
    let mut bytes = sound_png();
    bytes.splice(33..33, chunk);
    bytes
}

fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= *byte as u32;
        for _ in 0..8 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

fn exr(files: &Files, name: &str, channels: [&str; 3], value: impl Sync + Fn(usize, usize) -> [f32; 3]) -> PathBuf {
    let path = files.path(name);
    let [a, b, c] = channels;
    let channels = SpecificChannels::build().with_channel(a).with_channel(b).with_channel(c);
    let pixels = channels.with_pixel_fn(|at: exr::math::Vec2<usize>| {
        let [x, y, z] = value(at.x(), at.y());
        (x, y, z)
    });
    Image::from_channels((16, 16), pixels).write().to_file(&path).unwrap();
    path
}

#[test]
fn missing_folder_and_empty() {
    let files = Files::new();
    let default = InputOptions::default();
    refused(load_normal_map(&files.path("none.png"), &default), 3, "none.png", &["cannot be read"]);
    fs::create_dir(files.path("folder")).unwrap();
    refused(load_normal_map(&files.path("folder"), &default), 3, "folder", &["is a folder"]);
    files.refuse("empty.png", b"", 4, &["empty"]);
}

#[test]
fn no_image_at_all() {
    let files = Files::new();
    files.refuse("text.png", b"hello, this is text\n", 4, &["no image", "expected PNG", "hello"]);
    files.refuse("one.png", b"\x89", 4, &["no image"]);
    files.refuse("text.tga", b"hello, this is text\n", 4, &["no image"]);
}

#[test]
fn formats_that_are_not_read_are_named() {
    let files = Files::new();
    files.refuse("a.ktx2", b"\xabKTX 20\xbb\r\n\x1a\n", 5, &["KTX2", "convert"]);
    files.refuse("a.dds", b"DDS \x7c\0\0\0", 5, &["DDS", "convert"]);
    files.refuse("a.hdr", b"#?RADIANCE\n", 5, &["Radiance"]);
    files.refuse("a.png", b"GIF89a..........", 5, &["GIF"]);
}

#[test]
fn cut_off_anywhere() {
    let files = Files::new();
    let picture = leather(64, 64, 1);
    for (name, format) in [
        ("a.png", ImageFormat::Png),
        ("a.jpg", ImageFormat::Jpeg),
        ("a.tga", ImageFormat::Tga),
        ("a.tif", ImageFormat::Tiff),
        ("a.webp", ImageFormat::WebP),
    ] {
        let whole = encoded(picture.clone(), format);
        files.load(name, &whole).unwrap();
        for part in [0.01, 0.1, 0.5, 0.9] {
            let length = (whole.len() as f64 * part) as usize;
            let error = files.load(name, &whole[..length.max(1)]).err();
            let error = error.unwrap_or_else(|| panic!("{name} cut to {length} of {} was accepted", whole.len()));
            assert_eq!(error.exit_code(), 4, "{part} of {name}: {error}");
        }
    }
    let path = exr(&files, "whole.exr", ["R", "G", "B"], |x, y| [0.4 + 0.01 * x as f32, 0.4 + 0.01 * y as f32, 1.0]);
    let whole = fs::read(&path).unwrap();
    for length in (1..whole.len()).step_by(7) {
        let error = files.load("cut.exr", &whole[..length]).err();
        let error = error.unwrap_or_else(|| panic!("cut to {length} of {} was accepted", whole.len()));
        assert_eq!(error.exit_code(), 4, "{length}: {error}");
    }
}

#[test]
fn sizes_are_checked_before_decoding() {
    let files = Files::new();
    files.refuse("zero.png", png_of_size(0, 0), 4, &["0×0"]);
    files.refuse("line.png", png_of_size(0, 7), 4, &["0×7"]);
    files.refuse("long.png", png_of_size(100_000, 1), 6, &["100000×1", "16384"]);
    files.refuse("huge.png", png_of_size(i32::MAX as u32, i32::MAX as u32), 6, &["16384"]);
    // Within the limits, but the file is far too short for it.
    files.refuse("hollow.png", png_of_size(8_000, 8_000), 4, &["cut off"]);
    let mut tga = encoded(leather(32, 32, 1), ImageFormat::Tga);
    tga[12..16].copy_from_slice(&[0x00, 0x30, 0x00, 0x30]);
    files.refuse("hollow.tga", &tga, 4, &["cut off"]);
    tga[12..16].copy_from_slice(&[0xff, 0xff, 0xff, 0xff]);
    files.refuse("huge.tga", &tga, 6, &["65535×65535"]);
}

#[test]
fn memory_is_limited() {
    let files = Files::new();
    let path = files.write("a.png", sound_png());
    let refuse = |max_memory| {
        refused(
            load_normal_map(&path, &InputOptions { max_memory, ..Default::default() }),
            6,
            "a.png",
            &["--max-memory"],
        )
    };
    refuse(100);
    refuse(20_000);
    let exr = exr(&files, "a.exr", ["R", "G", "B"], |_, _| [0.5, 0.5, 1.0]);
    refused(
        load_normal_map(&exr, &InputOptions { max_memory: 5_000, ..Default::default() }),
        6,
        "a.exr",
        &["--max-memory"],
    );
}

#[test]
fn tags_that_the_data_contradict_are_noted_and_can_be_overridden() {
    let files = Files::new();
    let plain = files.load("plain.png", sound_png()).unwrap().map;
    let chunks: [(&str, &[u8; 4], &[u8]); 3] = [
        ("srgb.png", b"sRGB", &[0]),
        ("cicp.png", b"cICP", &[1, 13, 0, 1]),
        ("gama.png", b"gAMA", &[0, 0, 0xb1, 0x8f]),
    ];
    for (name, kind, content) in chunks {
        let loaded = files.load(name, png_with_chunk(kind, content)).unwrap();
        assert!(loaded.warnings.iter().any(|w| w.contains("not encoded")), "{:?}", loaded.warnings);
        assert_eq!(loaded.map, plain);
        let options = InputOptions { colour_space: ColourSpace::Linear, ..Default::default() };
        let loaded = load_normal_map(&files.path(name), &options).unwrap();
        assert!(loaded.warnings.iter().any(|w| w.contains("as asked")), "{:?}", loaded.warnings);
        assert_eq!(loaded.map, plain);
    }
    let odd = files.load("profile.jpg", jpeg_with_profile(b"...desc...sRGB IEC61966-2.1...")).unwrap();
    assert!(odd.warnings.iter().any(|w| w.contains("cannot be read")), "{:?}", odd.warnings);
}

/// A JPEG with a colour profile in an APP2 segment.
fn jpeg_with_profile(profile: &[u8]) -> Vec<u8> {
    let mut segment = vec![0xff, 0xe2];
    segment.extend((profile.len() as u16 + 16).to_be_bytes());
    segment.extend(b"ICC_PROFILE\0\x01\x01");
    segment.extend(profile);
    let mut bytes = encoded(leather(32, 32, 1), ImageFormat::Jpeg);
    bytes.splice(2..2, segment);
    bytes
}

#[test]
fn pictures_that_are_no_normal_map() {
    let files = Files::new();
    files.refuse("black.png", encoded(RgbImage::new(8, 8), ImageFormat::Png), 4, &["not a normal map", "64 of 64"]);
    let mid = RgbImage::from_pixel(8, 8, Rgb([128; 3]));
    files.refuse("mid.png", encoded(mid, ImageFormat::Png), 4, &["not a normal map", "zero vector"]);
    files.refuse("grey.png", encoded(GrayImage::new(8, 8), ImageFormat::Png), 4, &["grey", "--height"]);
    let path = exr(&files, "black.exr", ["R", "G", "B"], |_, _| [0.0; 3]);
    refused(load_normal_map(&path, &InputOptions::default()), 4, "black.exr", &["not a normal map"]);
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = v.iter().map(|c| c * c).sum::<f32>().sqrt();
    v.map(|c| c / length)
}

#[test]
fn exr_channels_and_ranges() {
    let files = Files::new();
    let default = InputOptions::default();
    let wave = |x: usize, y: usize| unit([0.3 * (x as f32 - 7.5) / 8.0, 0.2 * (y as f32 - 7.5) / 8.0, 0.9]);
    let signed = load_normal_map(&exr(&files, "xyz.exr", ["X", "Y", "Z"], wave), &default).unwrap();
    assert!(signed.warnings.iter().any(|w| w.contains("−1…1")), "{:?}", signed.warnings);
    let unsigned = |x: usize, y: usize| wave(x, y).map(|c| 0.5 * c + 0.5);
    let unsigned = load_normal_map(&exr(&files, "rgb.exr", ["R", "G", "B"], unsigned), &default).unwrap();
    assert!(unsigned.warnings.iter().any(|w| w.contains("0…1")), "{:?}", unsigned.warnings);
    for (a, b) in signed.map.projected.iter().zip(&unsigned.map.projected) {
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-6);
    }
    let flat = load_normal_map(&exr(&files, "flat.exr", ["X", "Y", "Z"], |_, _| [0.0, 0.0, 1.0]), &default).unwrap();
    assert!(flat.report.is_flat && flat.map.projected.iter().all(|s| *s == [0.0; 2]));
    let nan = |x: usize, y: usize| if (x, y) == (5, 3) { [f32::NAN, 0.5, 1.0] } else { [0.5, 0.5, 1.0] };
    let nan = exr(&files, "nan.exr", ["R", "G", "B"], nan);
    refused(load_normal_map(&nan, &default), 4, "nan.exr", &["(5, 3)", "NaN"]);
    let odd = exr(&files, "odd.exr", ["U", "V", "W"], wave);
    refused(load_normal_map(&odd, &default), 4, "odd.exr", &["R, G, B or X, Y, Z", "U, V, W"]);
}

#[test]
fn content_counts_not_the_name() {
    let files = Files::new();
    let loaded = files.load("a.jpg", sound_png()).unwrap();
    assert!(loaded.warnings.iter().any(|w| w.contains("content is PNG")), "{:?}", loaded.warnings);
    assert_eq!(loaded.map, files.load("a.png", sound_png()).unwrap().map);
}

#[test]
fn options_that_do_not_fit_the_file() {
    let files = Files::new();
    let path = files.write("a.png", sound_png());
    let height = InputOptions { height: Some(1.0), ..Default::default() };
    refused(load_normal_map(&path, &height), 4, "a.png", &["coloured", "--height"]);
    let crop = InputOptions { crop: Some(Crop { x: 30, y: 0, w: 4, h: 4 }), ..Default::default() };
    refused(load_normal_map(&path, &crop), 4, "a.png", &["(30, 0)", "32×32"]);
}

#[test]
fn a_bump_looks_the_same_as_heights_and_as_normals_of_either_convention() {
    let files = Files::new();
    let side = 64u32;
    let dome = |i: u32, j: u32| {
        let (x, y) = ((i as f64 - 31.5) / 32.0, (j as f64 - 31.5) / 32.0);
        (1.0 - x * x - y * y).max(0.0).powi(2)
    };
    let heights = image::ImageBuffer::<Luma<u16>, _>::from_fn(side, side, |i, j| Luma([(dome(i, j) * 65535.0) as u16]));
    let scale = 10.0;
    // As a painter of an OpenGL map would: lit from above, so that the upper side is bright green.
    let normals = RgbImage::from_fn(side, side, |i, j| {
        let (x, y) = ((i as f64 - 31.5) / 32.0, (31.5 - j as f64) / 32.0);
        let steep = 4.0 * (1.0 - x * x - y * y).max(0.0) * scale / 32.0;
        let n = [steep * x, steep * y, 1.0];
        let length = n.iter().map(|c| c * c).sum::<f64>().sqrt();
        Rgb(n.map(|c| ((c / length * 0.5 + 0.5) * 255.0).round() as u8))
    });
    assert!(normals.get_pixel(31, 12)[1] > 150, "the upper side is bright green");
    let flipped = RgbImage::from_fn(side, side, |i, j| {
        let Rgb([r, g, b]) = *normals.get_pixel(i, j);
        Rgb([r, 255 - g, b])
    });
    let options = InputOptions { height: Some(scale as f32), ..Default::default() };
    let from_heights = load_normal_map(&files.write("h.png", encoded(heights, ImageFormat::Png)), &options).unwrap();
    let up = files.load("up.png", encoded(normals, ImageFormat::Png)).unwrap();
    let options = InputOptions { y: GreenAxis::Down, ..Default::default() };
    let down = load_normal_map(&files.write("down.png", encoded(flipped, ImageFormat::Png)), &options).unwrap();
    let two = InputOptions { channels: Some(Channels::Xy), ..Default::default() };
    let two = load_normal_map(&files.path("up.png"), &two).unwrap();
    for other in [&up, &down, &two] {
        let step = |(a, b): (&[f32; 2], &[f32; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
        let worst = from_heights.map.projected.iter().zip(&other.map.projected).map(step).fold(0.0, f32::max);
        assert!(worst < 0.03, "{worst}");
        assert!(!other.report.flipped_green_suspected);
    }
    assert!(files.load("down.png", fs::read(files.path("down.png")).unwrap()).unwrap().report.flipped_green_suspected);
}
