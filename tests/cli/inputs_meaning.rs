//! What stored values mean: colour tags, two channels, other spaces, unpainted texels, lossy codecs, heights. Each kind has
//! members made here; those of the data folder's table of cases are read where it is at hand.

use crate::bad_input::with_chunk;
use crate::folder::data;
use crate::support::{bake, info, json, root};
use glint_bake::input::synthetic::{MATERIALS, brushed, leather};
use glint_bake::input::{Channels, ColourSpace, InputOptions, LoadedMap, load_normal_map};
use glint_bake_core::normal_map::NormalMap;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{
    DynamicImage, GrayAlphaImage, ImageBuffer, ImageEncoder, ImageFormat, LumaA, Rgb, RgbImage, Rgba, RgbaImage,
};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A file, what is to be typed after its name, the exit code, and what the program says.
type Row<'a> = (&'a str, Vec<u8>, &'a [&'a str], i32, &'a str);

/// Writes each file and looks at what `lobes -n` makes of it.
#[track_caller]
fn check(rows: &[Row]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, flags, code, says) in rows {
        fs::write(folder.path().join(name), bytes).unwrap();
        let done = bake(folder.path(), &[&["lobes", name, "-o", "out.glintpack", "-n"], *flags].concat());
        assert_eq!(done.code, *code, "{name} {flags:?}: {}", done.stderr);
        assert!(done.stderr.contains(says), "{name} {flags:?}: no \"{says}\" in {}", done.stderr);
        assert!(*code == 0 || done.stderr.contains(name), "{name}: {}", done.stderr);
    }
    folder
}

fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    encoded(image, ImageFormat::Png)
}

/// Leather with another meaning of its red, green and blue.
fn rgb(of: impl Fn(u8, u8, u8) -> [u8; 3]) -> RgbImage {
    let mut map = leather(64, 64, 1);
    map.pixels_mut().for_each(|p| *p = Rgb(of(p[0], p[1], p[2])));
    map
}

/// The same with alpha.
fn rgba(of: impl Fn(u32, u32, [u8; 3]) -> [u8; 4]) -> RgbaImage {
    let map = leather(64, 64, 1);
    RgbaImage::from_fn(64, 64, |x, y| Rgba(of(x, y, map.get_pixel(x, y).0)))
}

fn load(path: &Path, options: InputOptions) -> LoadedMap {
    load_normal_map(path, &options).unwrap_or_else(|e| panic!("{e}"))
}

fn reading(channels: Channels) -> InputOptions {
    InputOptions { channels: Some(channels), ..InputOptions::default() }
}

/// The largest distance of projected normals.
fn distance(a: &NormalMap, b: &NormalMap) -> f32 {
    let step = |(a, b): (&[f32; 2], &[f32; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
    a.projected.iter().zip(&b.projected).map(step).fold(0.0, f32::max)
}

/// A file of the table of cases, with the folder that holds it.
fn case(name: &str) -> Option<PathBuf> {
    Some(data()?.join("cases").join(name))
}

#[test]
fn cases_of_the_table() {
    let Some(folder) = case("") else { return };
    for (name, flags, code, says) in [
        ("dxt5nm.png", &[][..], 4, "--channels ag"),
        ("dxt5nm.png", &["--channels", "ag"], 0, ""),
        ("dxt5nm.png", &["--channels", "wy"], 0, ""),
        ("bc5_blue0.png", &[], 4, "--channels xy"),
        ("bc5_blue0.png", &["--channels", "xy"], 0, ""),
        ("bc5_blue255.png", &[], 4, "--channels xy"),
        ("bc5_blue255.png", &["--channels", "xy"], 0, ""),
        ("alpha0_half.png", &[], 0, "128 of 256 texels are unpainted"),
        ("object_space.png", &[], 4, "object-space"),
        ("gimp_linear_profile.png", &[], 0, "taken as they are"),
    ] {
        let path = folder.join(name);
        let args = ["ndf-maps", path.to_str().unwrap(), "-o", "out.glintpack", "-n"];
        let done = bake(&root(), &[&args[..], flags].concat());
        assert_eq!(done.code, code, "{name}: {}", done.stderr);
        assert!(done.stderr.contains(says), "{name}: {}", done.stderr);
    }
    // The same surface in each encoding.
    let sound = load(&folder.join("sound.png"), InputOptions::default()).map;
    for (name, channels) in
        [("dxt5nm.png", Channels::Ag), ("bc5_blue0.png", Channels::Xy), ("bc5_blue255.png", Channels::Xy)]
    {
        let found = distance(&load(&folder.join(name), reading(channels)).map, &sound);
        assert!(found < 0.01, "{name}: {found}");
    }
    assert_eq!(load(&folder.join("gimp_linear_profile.png"), InputOptions::default()).map, sound);
}

#[test]
fn maps_of_two_channels_are_recognised_and_read_when_told() {
    let both = |r: u8, g: u8| LumaA([r, g]);
    let map = leather(64, 64, 1);
    let luma = GrayAlphaImage::from_fn(64, 64, |x, y| both(map.get_pixel(x, y)[0], map.get_pixel(x, y)[1]));
    let wide = ImageBuffer::<Rgb<u16>, _>::from_fn(64, 64, |x, y| {
        let [r, g, _] = map.get_pixel(x, y).0.map(|v| v as u16 * 257);
        Rgb([r, g, 0])
    });
    let files: [(&str, Vec<u8>, &str, Channels); 12] = [
        ("blue0.png", png(rgb(|r, g, _| [r, g, 0])), "xy", Channels::Xy),
        ("blue_half.png", png(rgb(|r, g, _| [r, g, 128])), "xy", Channels::Xy),
        ("blue1.png", png(rgb(|r, g, _| [r, g, 255])), "xy", Channels::Xy),
        ("swapped.png", png(rgb(|r, g, _| [g, r, 0])), "yx", Channels::Yx),
        ("sixteen.png", png(wide), "xy", Channels::Xy),
        ("blue0.tga", encoded(rgb(|r, g, _| [r, g, 0]), ImageFormat::Tga), "xy", Channels::Xy),
        ("unity.png", png(rgba(|_, _, [r, g, _]| [255, g, 255, r])), "ag", Channels::Ag),
        ("doom.png", png(rgba(|_, _, [r, g, _]| [0, g, 0, r])), "ag", Channels::Ag),
        ("green.png", png(rgba(|_, _, [r, g, _]| [g, g, g, r])), "ag", Channels::Ag),
        ("turned.png", png(rgba(|_, _, [r, g, _]| [0, r, 0, g])), "ga", Channels::Ga),
        ("rrrg.png", png(rgba(|_, _, [r, g, _]| [r, r, r, g])), "ra", Channels::Ra),
        ("luma.png", png(luma), "ra", Channels::Ra),
    ];
    let folder = tempfile::tempdir().unwrap();
    map.save(folder.path().join("plain.png")).unwrap();
    let plain = load(&folder.path().join("plain.png"), InputOptions::default()).map;
    for (name, bytes, value, channels) in files {
        let flag = ["--channels", value];
        let advice = flag.join(" ");
        // All values that are possible are named where the data leave several.
        let says = if ["swapped.png", "turned.png", "rrrg.png"].contains(&name) { value } else { &advice };
        let made = check(&[(name, bytes.clone(), &[], 4, says), (name, bytes, &flag, 0, "")]);
        let found = distance(&load(&made.path().join(name), reading(channels)).map, &plain);
        assert!(found < 0.02, "{name}: {found}");
    }
}

#[test]
fn lossy_maps_of_two_channels_are_recognised() {
    let jpeg = encoded(rgb(|r, g, _| [r, g, 0]), ImageFormat::Jpeg);
    check(&[("blue0.jpg", jpeg, &[], 4, "--channels")]);
}

#[test]
fn channels_that_are_not_there_are_named() {
    check(&[
        ("no_alpha.png", png(leather(32, 32, 1)), &["--channels", "ag"], 4, "--channels xy"),
        ("grey.png", png(image::GrayImage::new(8, 8)), &["--channels", "xy"], 4, "one channel"),
    ]);
}

#[test]
fn maps_of_three_channels_are_not_taken_for_less() {
    let flat = |r, g, b| RgbImage::from_pixel(64, 64, Rgb([r, g, b]));
    // Grooves along one axis: red is constant, and so is blue where they are shallow.
    let grooves = |depth: f32| {
        RgbImage::from_fn(64, 64, |_, y| {
            let slope = depth * (y as f32).sin();
            let length = (1.0 + slope * slope).sqrt();
            Rgb([0.0, slope / length, 1.0 / length].map(|c| ((c * 0.5 + 0.5) * 255.0).round() as u8))
        })
    };
    let rough = |map: RgbImage| {
        RgbaImage::from_fn(64, 64, |x, y| {
            let [r, g, b] = map.get_pixel(x, y).0;
            Rgba([r, g, b, (37 * x + 11 * y) as u8])
        })
    };
    check(&[
        ("flat.png", png(flat(128, 128, 255)), &[], 0, ""),
        ("tilted.png", png(flat(180, 128, 243)), &[], 0, ""),
        ("shallow.png", png(grooves(0.03)), &[], 0, ""),
        ("deep.png", png(grooves(1.0)), &[], 0, ""),
        ("flat_rough.png", png(rough(flat(128, 128, 255))), &[], 0, "alpha channel holds data"),
        ("shallow_rough.png", png(rough(grooves(0.03))), &[], 0, "alpha channel holds data"),
        ("deep_rough.png", png(rough(grooves(1.0))), &[], 0, "alpha channel holds data"),
    ]);
    let mut maps: Vec<PathBuf> =
        MATERIALS.iter().map(|(name, _)| root().join(format!("fixtures/maps/{name}.png"))).collect();
    if let Some(data) = data() {
        for folder in ["normals", "tiny"] {
            maps.extend(fs::read_dir(data.join(folder)).unwrap().map(|entry| entry.unwrap().path()));
        }
    }
    for path in maps {
        let warnings = load(&path, InputOptions::default()).warnings;
        assert!(!warnings.iter().any(|w| w.contains("unpainted")), "{}: {warnings:?}", path.display());
    }
}

/// A map whose vectors are given by column and row, 0…1.
fn vectors(of: impl Fn(f32, f32) -> [f32; 3]) -> RgbImage {
    RgbImage::from_fn(64, 64, |x, y| {
        let v = of((x as f32 + 0.5) / 64.0, (y as f32 + 0.5) / 64.0);
        let length = v.iter().map(|c| c * c).sum::<f32>().sqrt();
        Rgb(v.map(|c| ((c / length * 0.5 + 0.5) * 255.0).round() as u8))
    })
}

#[test]
fn maps_of_other_spaces_are_recognised() {
    let ball = vectors(|u, v| {
        let (around, up) = (u * std::f32::consts::TAU, (v - 0.5) * std::f32::consts::PI);
        [around.cos() * up.cos(), around.sin() * up.cos(), up.sin()]
    });
    let ground = vectors(|u, v| [0.3 * (20.0 * u).sin(), 1.0, 0.3 * (20.0 * v).sin()]);
    let wall = vectors(|u, v| [-1.0, 0.2 * (20.0 * u).sin(), 0.05 * (20.0 * v).sin()]);
    let inward = vectors(|u, v| [0.3 * (20.0 * u).sin(), 0.3 * (20.0 * v).sin(), -1.0]);
    let steep = vectors(|u, v| [3.0 * (20.0 * u).sin(), 3.0 * (20.0 * v).sin(), 1.0]);
    check(&[
        ("ball.png", png(ball.clone()), &[], 4, "object-space or world-space"),
        ("ball.jpg", encoded(ball.clone(), ImageFormat::Jpeg), &[], 4, "object-space or world-space"),
        ("ball.png", png(ball), &["--channels", "xyz"], 0, "below the horizon"),
        ("ground.png", png(ground), &[], 4, "below the surface"),
        ("wall.png", png(wall), &[], 4, "leans by"),
        ("inward.png", png(inward), &[], 4, "--channels xyz"),
        ("steep.png", png(steep), &[], 0, ""),
    ]);
}

#[test]
fn unpainted_texels_are_flat_counted_and_said() {
    let left = |x: u32| x < 32;
    let of = |below: [u8; 3]| {
        rgba(move |x, _, [r, g, b]| if left(x) { [below[0], below[1], below[2], 0] } else { [r, g, b, 255] })
    };
    let black =
        RgbImage::from_fn(64, 64, |x, y| if left(x) { Rgb([0; 3]) } else { *leather(64, 64, 1).get_pixel(x, y) });
    let mask = rgba(|x, _, [r, g, b]| [r, g, b, if left(x) { 0 } else { 255 }]);
    let soft = rgba(|x, y, [r, g, b]| if left(x) { [0, 0, 0, (x * y) as u8] } else { [r, g, b, (x + y) as u8] });
    let clear = rgba(|_, _, [r, g, b]| [r, g, b, 0]);
    let count = "2048 of 4096 texels are unpainted";
    let folder = check(&[
        ("alpha_black.png", png(of([0; 3])), &[], 0, count),
        ("alpha_white.png", png(of([255; 3])), &[], 0, count),
        ("alpha_grey.png", png(of([128; 3])), &[], 0, count),
        ("alpha.tga", encoded(of([255, 0, 0]), ImageFormat::Tga), &[], 0, count),
        ("black.png", png(black.clone()), &[], 0, count),
        ("black.tif", encoded(black.clone(), ImageFormat::Tiff), &[], 0, count),
        ("soft.png", png(soft), &[], 0, count),
        ("black.jpg", encoded(black, ImageFormat::Jpeg), &[], 0, "texels are unpainted"),
        ("mask.png", png(mask), &[], 0, "alpha channel holds data"),
        ("clear.png", png(clear), &[], 0, "alpha channel holds data"),
        ("nothing.png", png(RgbImage::new(8, 8)), &[], 4, "64 of 64 texels are unpainted"),
        ("no_paint.png", png(RgbaImage::new(8, 8)), &[], 4, "not a normal map"),
    ]);
    leather(64, 64, 1).save(folder.path().join("whole.png")).unwrap();
    let whole = load(&folder.path().join("whole.png"), InputOptions::default()).map;
    assert_eq!(load(&folder.path().join("mask.png"), InputOptions::default()).map, whole);
    for name in ["alpha_black.png", "alpha_white.png", "alpha_grey.png", "alpha.tga", "black.png", "soft.png"] {
        let map = load(&folder.path().join(name), InputOptions::default()).map;
        for (at, (found, painted)) in map.projected.iter().zip(&whole.projected).enumerate() {
            let expected = if left(at as u32 % 64) { [0.0; 2] } else { *painted };
            assert_eq!(*found, expected, "{name}, texel {at}");
        }
    }
}

#[test]
fn background_of_float_maps_is_unpainted_on_either_scale() {
    let folder = tempfile::tempdir().unwrap();
    let normal = |x: usize| {
        let slope = 0.3 * (x as f32).sin();
        let length = (1.0 + slope * slope).sqrt();
        [slope / length, 0.0, 1.0 / length]
    };
    let write = |name: &str, of: &(dyn Fn([f32; 3]) -> [f32; 3] + Sync)| {
        let pixel = |x: usize, y: usize| if y < 12 { (0.0, 0.0, 0.0) } else { of(normal(x)).into() };
        exr::prelude::write_rgb_file(folder.path().join(name), 16, 16, pixel).unwrap();
        load(&folder.path().join(name), InputOptions::default())
    };
    let signed = write("signed.exr", &|n| n);
    let unsigned = write("unsigned.exr", &|n| n.map(|c| 0.5 * c + 0.5));
    for loaded in [&signed, &unsigned] {
        assert!(loaded.warnings.iter().any(|w| w.starts_with("192 of 256 texels")), "{:?}", loaded.warnings);
        assert_eq!(loaded.map.projected[0], [0.0; 2]);
        assert!((loaded.map.projected[12 * 16 + 1][0] - normal(1)[0]).abs() < 1e-3);
    }
}

/// The sRGB curve on whole numbers.
fn srgb(v: u8) -> u8 {
    let v = v as f32 / 255.0;
    let encoded = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

/// A colour profile of three equal curves.
fn profile(curve: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0; 128];
    bytes[36..40].copy_from_slice(b"acsp");
    bytes.extend(3u32.to_be_bytes());
    for name in [b"rTRC", b"gTRC", b"bTRC"] {
        bytes.extend(name);
        bytes.extend(168u32.to_be_bytes());
        bytes.extend((curve.len() as u32).to_be_bytes());
    }
    bytes.extend(curve);
    let length = bytes.len() as u32;
    bytes[..4].copy_from_slice(&length.to_be_bytes());
    bytes
}

fn png_with_profile(map: &RgbImage, curve: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    encoder.set_icc_profile(profile(curve)).unwrap();
    encoder.write_image(map, map.width(), map.height(), image::ExtendedColorType::Rgb8).unwrap();
    bytes
}

fn jpeg_with_profile(map: &RgbImage, curve: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 95);
    encoder.set_icc_profile(profile(curve)).unwrap();
    encoder.write_image(map, map.width(), map.height(), image::ExtendedColorType::Rgb8).unwrap();
    bytes
}

const LINEAR: &[u8] = b"curv\0\0\0\0\0\0\0\0";
const GAMMA_2_2: &[u8] = b"curv\0\0\0\0\0\0\0\x01\x02\x33";

#[test]
fn colour_tags_are_believed_where_the_data_bear_them_out() {
    let (plain, dark) = (leather(64, 64, 1), rgb(|r, g, b| [srgb(r), srgb(g), srgb(b)]));
    let gamma = rgb(|r, g, b| [r, g, b].map(|v| (255.0 * (v as f32 / 255.0).powf(1.0 / 2.2)).round() as u8));
    let photo = RgbImage::from_fn(64, 64, |x, y| Rgb([40 + (x as u8), 60 + (y as u8), 30 + (y as u8)]));
    let chunk = |map: &RgbImage, kind: &[u8; 4], content: &[u8]| with_chunk(&png(map.clone()), kind, content);
    let gama = |map: &RgbImage, value: u32| chunk(map, b"gAMA", &value.to_be_bytes());
    let (kept, decoded) = ("taken as they are", "bear it out");
    // cICP comes before all others, and iCCP before sRGB and gAMA.
    let two_chunks = with_chunk(&chunk(&plain, b"gAMA", &45_455u32.to_be_bytes()), b"cICP", &[1, 8, 0, 1]);
    let folder = check(&[
        ("plain_srgb.png", chunk(&plain, b"sRGB", &[0]), &[], 0, kept),
        ("plain_gama.png", gama(&plain, 45_455), &[], 0, kept),
        ("plain_cicp.png", chunk(&plain, b"cICP", &[1, 13, 0, 1]), &[], 0, kept),
        ("plain_709.png", chunk(&plain, b"cICP", &[1, 1, 0, 1]), &[], 0, kept),
        ("plain_pq.png", chunk(&plain, b"cICP", &[9, 16, 0, 1]), &[], 0, "PQ"),
        ("plain_hlg.png", chunk(&plain, b"cICP", &[9, 18, 0, 1]), &[], 0, "HLG"),
        ("plain_linear.png", png_with_profile(&plain, LINEAR), &[], 0, ""),
        ("plain_profile.png", png_with_profile(&plain, GAMMA_2_2), &[], 0, kept),
        ("plain_profile.jpg", jpeg_with_profile(&plain, GAMMA_2_2), &[], 0, kept),
        ("plain_linear.jpg", jpeg_with_profile(&plain, LINEAR), &[], 0, ""),
        ("plain_two.png", two_chunks, &[], 0, ""),
        ("dark_srgb.png", chunk(&dark, b"sRGB", &[0]), &[], 0, decoded),
        ("dark_cicp.png", chunk(&dark, b"cICP", &[1, 13, 0, 1]), &[], 0, decoded),
        ("dark_gama.png", gama(&gamma, 45_455), &[], 0, decoded),
        ("dark_profile.png", png_with_profile(&gamma, GAMMA_2_2), &[], 0, decoded),
        ("dark_untagged.png", png(dark.clone()), &[], 0, "--colour-space srgb"),
        ("dark_linear.png", png_with_profile(&dark, LINEAR), &[], 0, "--colour-space srgb"),
        ("dark_asked.png", png(dark.clone()), &["--colour-space", "srgb"], 0, "as asked"),
        ("dark_kept.png", chunk(&dark, b"sRGB", &[0]), &["--colour-space", "linear"], 0, "as asked"),
        ("dark_pq.png", chunk(&dark, b"cICP", &[9, 16, 0, 1]), &[], 4, "--colour-space linear"),
        ("photo.png", chunk(&photo, b"sRGB", &[0]), &[], 4, "--colour-space linear"),
        ("dark_alias.png", chunk(&dark, b"sRGB", &[0]), &["--assume-linear"], 0, "as asked"),
        ("pair.png", chunk(&plain, b"sRGB", &[0]), &["--channels", "xy"], 0, "two channels have no lengths"),
    ]);
    let done = bake(folder.path(), &["lobes", "photo.png", "-o", "x", "--assume-linear", "--colour-space", "srgb"]);
    assert_eq!(done.code, 2, "{}", done.stderr);
    plain.save(folder.path().join("plain.png")).unwrap();
    let plain = load(&folder.path().join("plain.png"), InputOptions::default());
    for entry in fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if name.starts_with("plain") && name.ends_with("png") {
            let found = load(&path, InputOptions::default());
            assert_eq!(found.map, plain.map, "{name}");
            let says_nothing = name.contains("linear") || name.contains("two") || name == "plain.png";
            assert_eq!(found.warnings == plain.warnings, says_nothing, "{name}: {:?}", found.warnings);
        }
    }
    let srgb = InputOptions { colour_space: ColourSpace::Srgb, ..InputOptions::default() };
    for (name, options) in [
        ("dark_srgb.png", InputOptions::default()),
        ("dark_cicp.png", InputOptions::default()),
        ("dark_gama.png", InputOptions::default()),
        ("dark_profile.png", InputOptions::default()),
        ("dark_asked.png", srgb),
    ] {
        let found = distance(&load(&folder.path().join(name), options).map, &plain.map);
        assert!(found < 0.01, "{name}: {found}");
    }
}

#[test]
fn what_was_decided_goes_into_the_pack() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = with_chunk(&png(leather(16, 16, 1)), b"sRGB", &[0]);
    fs::write(folder.path().join("tagged.png"), bytes).unwrap();
    for (flags, note, option) in [
        (&[][..], "tagged.png: carries an sRGB chunk, but the values are not encoded", None),
        (&["--assume-linear"], "tagged.png: carries an sRGB chunk; taken as linear, as asked", Some("linear")),
        (&["--colour-space", "srgb"], "tagged.png: decoded by the sRGB curve, as asked", Some("srgb")),
    ] {
        bake(folder.path(), &[&["lobes", "tagged.png", "-o", "out.glintpack"], flags].concat()).ok();
        let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
        let provenance = report["provenance"].to_string();
        assert!(provenance.contains(note), "{flags:?}: {provenance}");
        let found = option.is_none_or(|option| provenance.contains(option));
        assert!(found && provenance.contains("colour-space") == option.is_some(), "{flags:?}: {provenance}");
    }
}

/// The numbers of all maps that are at hand, by `cargo test --test cli tags_on_real_maps -- --nocapture`.
#[test]
fn tags_on_real_maps_are_seen_through_both_ways() {
    let mut maps: Vec<PathBuf> =
        MATERIALS.iter().map(|(name, _)| root().join(format!("fixtures/maps/{name}.png"))).collect();
    if let Some(data) = data() {
        for folder in ["normals", "tiny"] {
            maps.extend(fs::read_dir(data.join(folder)).unwrap().map(|entry| entry.unwrap().path()));
        }
    }
    maps.sort();
    let folder = tempfile::tempdir().unwrap();
    for path in maps.iter().filter(|path| path.extension().is_some_and(|e| e != "exr")) {
        // A part, for the time it takes.
        let map = image::open(path).unwrap().into_rgb8();
        let map = image::imageops::crop_imm(&map, 0, 0, 256, 256).to_image();
        let dark = RgbImage::from_fn(map.width(), map.height(), |x, y| Rgb(map.get_pixel(x, y).0.map(srgb)));
        let name = path.file_name().unwrap().to_str().unwrap();
        for (map, kept) in [(map, true), (dark, false)] {
            let file = folder.path().join("tagged.png");
            fs::write(&file, with_chunk(&png(map), b"sRGB", &[0])).unwrap();
            let warnings = load(&file, InputOptions::default()).warnings;
            let note = warnings.iter().find(|w| w.contains("carries an sRGB chunk")).unwrap();
            println!("{name}: {note}");
            assert_eq!(note.contains("not encoded"), kept, "{name}: {note}");
            assert_eq!(note.contains("bear it out"), !kept, "{name}: {note}");
        }
    }
}

#[test]
fn lossy_maps_have_their_noise_noted() {
    let jpeg = |quality: u8, map: &RgbImage| {
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, quality).encode_image(map).unwrap();
        bytes
    };
    let map = brushed(64, 64, 1);
    let two = rgb(|r, g, _| [r, g, 0]);
    let folder = check(&[
        ("fine.jpg", jpeg(95, &map), &[], 0, "in slope"),
        ("coarse.jpg", jpeg(50, &map), &[], 0, "roughness below"),
        ("two.jpg", jpeg(90, &two), &["--channels", "xy"], 0, "no lengths"),
        ("two_heights.jpg", jpeg(90, &rgb(|r, _, _| [r; 3])), &["--height", "2"], 0, "JPEG is lossy"),
    ]);
    let noise = |name: &str| {
        let warnings = load(&folder.path().join(name), InputOptions::default()).warnings;
        let note = warnings.iter().find(|w| w.contains("is lossy")).unwrap().clone();
        let words: Vec<&str> = note.split(' ').collect();
        words[words.iter().position(|w| *w == "about").unwrap() + 1].parse::<f64>().unwrap()
    };
    let (fine, coarse) = (noise("fine.jpg"), noise("coarse.jpg"));
    assert!(0.003 < fine && 2.0 * fine < coarse && coarse < 0.3, "{fine} {coarse}");
}

#[test]
fn heights_in_every_grey_form() {
    let height = |x: u32, y: u32| (128.0 + 100.0 * (0.2 * x as f32).sin() * (0.3 * y as f32).cos()) as u8;
    let grey = image::GrayImage::from_fn(64, 64, |x, y| image::Luma([height(x, y)]));
    let alpha = GrayAlphaImage::from_fn(64, 64, |x, y| LumaA([height(x, y), 200]));
    let colour = RgbImage::from_fn(64, 64, |x, y| Rgb([height(x, y); 3]));
    let coloured = RgbaImage::from_fn(64, 64, |x, y| Rgba([height(x, y), height(x, y), height(x, y), 7]));
    let scale = ["--height", "3"];
    let folder = check(&[
        ("grey.png", png(grey.clone()), &scale, 0, ""),
        ("grey_alpha.png", png(alpha), &scale, 0, ""),
        ("colour.png", png(colour), &scale, 0, "green channel"),
        ("coloured.png", png(coloured), &scale, 0, "green channel"),
        ("tagged.png", with_chunk(&png(grey.clone()), b"sRGB", &[0]), &scale, 0, "heights have no lengths"),
        ("decoded.png", png(grey), &["--height", "3", "--colour-space", "srgb"], 0, "as asked"),
        ("normals.png", png(leather(32, 32, 1)), &scale, 4, "coloured"),
    ]);
    let options = InputOptions { height: Some(3.0), ..InputOptions::default() };
    let plain = load(&folder.path().join("grey.png"), options.clone()).map;
    for name in ["grey_alpha.png", "colour.png", "coloured.png", "tagged.png"] {
        assert_eq!(load(&folder.path().join(name), options.clone()).map, plain, "{name}");
    }
    // Floats in units of their own.
    let metres = |x: usize, y: usize| height(x as u32, y as u32) as f32 / 255.0 * 40.0 - 20.0;
    let path = folder.path().join("metres.exr");
    let channels = exr::prelude::SpecificChannels::build()
        .with_channel("height")
        .with_pixel_fn(|at: exr::math::Vec2<usize>| (metres(at.x(), at.y()),));
    use exr::prelude::WritableImage;
    exr::prelude::Image::from_channels((64, 64), channels).write().to_file(&path).unwrap();
    let loaded = load(&path, InputOptions { height: Some(3.0 / 40.0), ..options });
    assert!(loaded.warnings.iter().any(|w| w.contains("heights range from -")), "{:?}", loaded.warnings);
    assert!(distance(&loaded.map, &plain) < 1e-3);
}
