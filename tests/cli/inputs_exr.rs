//! EXR files as renderers and painting programs write them: which layer is read, what attributes change, what is refused.

use crate::support::{Outcome, bake, json, run};
use exr::meta::attribute::{Chromaticities, EnvironmentMap, IntegerBounds, SampleType};
use exr::prelude::*;
use glint_bake::input::environment::{LoadedEnvironment, load_environment};
use glint_bake::input::{Channels, InputError, InputOptions, LoadedMap, load_normal_map};
use std::fs;
use std::path::{Path, PathBuf};

/// Flags of an environment that is baked fast.
const QUICK: [&str; 10] =
    ["--face-size", "8", "--min-face-size", "4", "--levels", "1", "--filter-error", "0.2", "--measure", "0"];
const ENCODING: Encoding =
    Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
const MEMORY: u64 = 1 << 30;

/// A folder of EXR files.
struct Files(tempfile::TempDir);

/// Channels and their value in every pixel, more in the left half.
type Flat<'a> = &'a [(&'a str, f32)];

impl Files {
    fn new() -> Files {
        Files(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes parts of 16 × 8 pixels, each with a name, none for a file of one part without.
    fn write(&self, name: &str, parts: &[(&str, Flat<'_>)]) -> PathBuf {
        self.write_with(name, parts, |_| (), |_, _| ())
    }

    fn write_with(
        &self,
        name: &str,
        parts: &[(&str, Flat<'_>)],
        image: impl Fn(&mut ImageAttributes),
        layer: impl Fn(usize, &mut Layer<AnyChannels<FlatSamples>>),
    ) -> PathBuf {
        let mut layers = Vec::new();
        for (i, (part, channels)) in parts.iter().enumerate() {
            let channel = |(name, value): &(&str, f32)| {
                let values = (0..16 * 8).map(|at| if at % 16 < 8 { *value } else { 0.75 * value }).collect();
                AnyChannel::new(*name, FlatSamples::F32(values))
            };
            let channels = AnyChannels::sort(channels.iter().map(channel).collect());
            let attributes =
                LayerAttributes { layer_name: (!part.is_empty()).then(|| Text::from(*part)), ..Default::default() };
            let mut built = Layer::new((16, 8), attributes, ENCODING, channels);
            layer(i, &mut built);
            layers.push(built);
        }
        let mut attributes = ImageAttributes::new(IntegerBounds::from_dimensions((16, 8)));
        image(&mut attributes);
        let path = self.path(name);
        Image::from_layers(attributes, layers).write().to_file(&path).unwrap();
        path
    }
}

fn environment(path: &Path, layer: Option<&str>) -> std::result::Result<LoadedEnvironment, InputError> {
    load_environment(path, layer, MEMORY)
}

fn map(path: &Path, layer: Option<&str>) -> std::result::Result<LoadedMap, InputError> {
    load_normal_map(path, &InputOptions { layer: layer.map(str::to_owned), ..InputOptions::default() })
}

#[track_caller]
fn refused<T>(result: std::result::Result<T, InputError>, code: u8, words: &[&str]) {
    let error = result.err().expect("it was accepted");
    assert_eq!(error.exit_code(), code, "{error}");
    for word in words {
        assert!(error.to_string().contains(word), "no {word:?} in: {error}");
    }
}

#[track_caller]
fn noted(notes: &[String], words: &[&str]) {
    for word in words {
        assert!(notes.iter().any(|note| note.contains(word)), "no {word:?} in: {notes:?}");
    }
}

const RGB: Flat<'_> = &[("R", 0.5), ("G", 0.25), ("B", 0.875)];
const N: Flat<'_> = &[("X", -0.36), ("Y", 0.48), ("Z", 0.8)];

/// Channels with a prefix.
fn prefixed(prefix: &'static str, channels: Flat<'static>) -> Vec<(&'static str, f32)> {
    channels.iter().map(|(name, value)| (&*format!("{prefix}.{name}").leak(), *value)).collect()
}

/// The first pixel of an environment.
fn first(loaded: &LoadedEnvironment) -> [f32; 3] {
    loaded.image.pixels[0]
}

/// Looks that the first normal is the one of [`N`].
#[track_caller]
fn is_n(loaded: &LoadedMap) {
    let [x, y] = loaded.map.projected[0];
    assert!((x + 0.36).abs() < 1e-6 && (y - 0.48).abs() < 1e-6, "({x}, {y})");
}

#[test]
fn radiance_is_of_one_layer() {
    let files = Files::new();
    let sets = [
        (
            "RGB over data",
            [RGB.to_vec(), vec![("Z", 9.0)], prefixed("AO", RGB), prefixed("crypto00", RGB)].concat(),
            "",
        ),
        ("unnamed before light", [prefixed("Diffuse", N), RGB.to_vec()].concat(), "Diffuse (X, Y, Z)"),
        (
            "Combined among passes",
            [prefixed("V.Combined", RGB), prefixed("V.DiffDir", RGB)].concat(),
            "V.DiffDir (R, G, B)",
        ),
        (
            "one light",
            [prefixed("Diffuse", RGB), prefixed("Normal", RGB), prefixed("Depth", &[("Z", 1.0)])].concat(),
            "layer Diffuse",
        ),
        (
            "names of colours",
            [prefixed("rgba", &[("red", 0.5), ("green", 0.25), ("blue", 0.875)]), vec![("Z", 1.0)]].concat(),
            "red, green, blue",
        ),
    ];
    for (name, channels, note) in sets {
        let loaded = environment(&files.write(name, &[("", &channels)]), None).unwrap();
        assert_eq!(first(&loaded), [0.5, 0.25, 0.875], "{name}");
        noted(&loaded.warnings, &["reads", note]);
    }
    let luminance = environment(&files.write("grey.exr", &[("", &[("Y", 0.5)])]), None).unwrap();
    assert_eq!(first(&luminance), [0.5; 3]);
    let alone = environment(&files.write("alone.exr", &[("", &prefixed("anything", RGB))]), None).unwrap();
    assert!(alone.warnings.is_empty(), "{:?}", alone.warnings);
}

#[test]
fn data_are_no_radiance_unless_asked() {
    let files = Files::new();
    for (name, channels) in [
        ("depth", vec![("Z", 1.0)]),
        ("normals", prefixed("N", N)),
        ("albedo", prefixed("Denoising Albedo", RGB)),
        ("ids", prefixed("CryptoObject00", RGB)),
        ("positions", prefixed("P", RGB)),
        ("alpha", vec![("A", 1.0)]),
        ("half a colour", vec![("R", 1.0), ("G", 1.0)]),
    ] {
        let path = files.write(name, &[("", &channels)]);
        refused(
            environment(&path, None),
            4,
            &[name, "expected a layer of colours", channels[0].0.rsplit('.').next().unwrap()],
        );
    }
    let albedo = environment(&files.path("albedo"), Some("Denoising Albedo")).unwrap();
    assert_eq!(first(&albedo), [0.5, 0.25, 0.875]);
}

#[test]
fn layers_that_are_equally_good_are_listed() {
    let files = Files::new();
    let lights = [prefixed("key", RGB), prefixed("fill", &[("R", 0.1), ("G", 0.1), ("B", 0.1)]), prefixed("AO", RGB)];
    let path = files.write("lights.exr", &[("", &lights.concat())]);
    refused(environment(&path, None), 4, &["--layer", "key (R, G, B)", "fill (R, G, B)", "AO (R, G, B)"]);
    assert_eq!(first(&environment(&path, Some("fill")).unwrap()), [0.1; 3]);
    assert_eq!(first(&environment(&path, Some("KEY")).unwrap()), [0.5, 0.25, 0.875]);
    refused(environment(&path, Some("rim")), 4, &["no layer \"rim\"", "key (R, G, B)"]);
    refused(environment(&path, Some("")), 4, &["no layer \"\""]);

    let two = files.write("two.exr", &[("", &[prefixed("A.Normal", N), prefixed("B.Normal", N)].concat())]);
    refused(map(&two, None), 4, &["--layer", "A.Normal (X, Y, Z)", "B.Normal (X, Y, Z)"]);
    map(&two, Some("B.Normal")).unwrap();
    let bare = files.write("bare.exr", &[("", &[N, &prefixed("N", N)].concat())]);
    refused(map(&bare, None), 4, &["--layer", "the unnamed layer (X, Y, Z)", "N (X, Y, Z)"]);
    map(&bare, Some("")).unwrap();
}

#[test]
fn parts_are_layers_too() {
    let files = Files::new();
    let depth: Flat<'_> = &[("Z", 5.0)];
    let path = files.write("parts.exr", &[("depth", depth), ("beauty", RGB), ("N", N), ("crypto", RGB)]);
    let loaded = environment(&path, None).unwrap();
    assert_eq!(first(&loaded), [0.5, 0.25, 0.875]);
    noted(&loaded.warnings, &["reads R, G, B of layer beauty", "depth (Z)", "N (X, Y, Z)"]);
    let loaded = map(&path, None).unwrap();
    is_n(&loaded);
    noted(&loaded.warnings, &["reads X, Y, Z of layer N", "beauty (R, G, B)"]);
    refused(map(&path, Some("depth")), 4, &["found depth (Z)"]);

    let grouped = [prefixed("N", N), RGB.to_vec()].concat();
    let path = files.write("grouped.exr", &[("left", &grouped), ("right", &prefixed("right.N", N))]);
    refused(map(&path, None), 4, &["left.N", "right.N", "--layer"]);
    is_n(&map(&path, Some("left.N")).unwrap());
}

#[test]
fn views_are_noted_and_the_first_is_taken() {
    let files = Files::new();
    let other: Flat<'_> = &[("R", 7.0), ("G", 7.0), ("B", 7.0)];
    let view = |i: usize, layer: &mut Layer<_>| layer.attributes.view_name = Some(["left", "right"][i].into());
    let parts = files.write_with("parts.exr", &[("rgba_left", RGB), ("rgba_right", other)], |_| (), view);
    let loaded = environment(&parts, None).unwrap();
    assert_eq!(first(&loaded), [0.5, 0.25, 0.875]);
    noted(&loaded.warnings, &["the view left of several", "rgba_right"]);
    assert_eq!(first(&environment(&parts, Some("rgba_right")).unwrap()), [7.0; 3]);

    let both = [RGB.to_vec(), prefixed("right", other)].concat();
    let views = |_: usize, layer: &mut Layer<_>| {
        layer.attributes.multi_view_names = Some(vec!["left".into(), "right".into()]);
    };
    let one = files.write_with("one.exr", &[("", &both)], |_| (), views);
    let loaded = environment(&one, None).unwrap();
    assert_eq!(first(&loaded), [0.5, 0.25, 0.875]);
    noted(&loaded.warnings, &["the views left, right", "right (R, G, B)"]);
}

#[test]
fn normals_come_before_a_picture() {
    let files = Files::new();
    for (name, layer) in [
        ("N.exr", "N"),
        ("blender.exr", "ViewLayer.Normal"),
        ("nrm.exr", "nrm"),
        ("upper.exr", "NORMALS"),
        ("bump.exr", "scene.bumpnormals"),
    ] {
        let depth = prefixed("Depth", &[("Z", 3.0)]);
        let path = files.write(name, &[("", &[RGB.to_vec(), prefixed(layer, N), depth].concat())]);
        let loaded = map(&path, None).unwrap();
        is_n(&loaded);
        noted(&loaded.warnings, &[&format!("reads X, Y, Z of layer {layer}"), "the unnamed layer (R, G, B)"]);
    }
    let coded: Flat<'_> = &[("R", 0.32), ("G", 0.74), ("B", 0.9)];
    let as_colours = files.write("colours.exr", &[("", &[RGB.to_vec(), prefixed("normals", coded)].concat())]);
    is_n(&map(&as_colours, None).unwrap());
    let bare = files.write("bare.exr", &[("", &[RGB, N].concat())]);
    let loaded = map(&bare, None).unwrap();
    is_n(&loaded);
    noted(&loaded.warnings, &["reads X, Y, Z and leaves out R, G, B"]);
    let unnamed = files.write("unnamed.exr", &[("", &[coded, &prefixed("specular", RGB)].concat())]);
    noted(&map(&unnamed, None).unwrap().warnings, &["reads R, G, B of the unnamed layer"]);
}

#[test]
fn normals_of_another_space_are_said_and_positions_never_taken() {
    let files = Files::new();
    let world = files.write("world.exr", &[("", &[RGB.to_vec(), prefixed("worldNormal", N)].concat())]);
    noted(&map(&world, None).unwrap().warnings, &["worldNormal may hold normals of the world's"]);
    let both = files.write("both.exr", &[("", &[prefixed("N", N), prefixed("worldNormal", N)].concat())]);
    noted(&map(&both, None).unwrap().warnings, &["reads X, Y, Z of layer N"]);
    let position = files.write("position.exr", &[("", &[prefixed("P", N), prefixed("albedo", RGB)].concat())]);
    refused(map(&position, None), 4, &["expected a layer of normals", "P (X, Y, Z)", "albedo (R, G, B)", "--layer"]);
}

#[test]
fn two_channels_are_of_one_layer() {
    let files = Files::new();
    let options = InputOptions { channels: Some(Channels::Xy), ..InputOptions::default() };
    for (name, channels) in [
        ("xy.exr", vec![("X", -0.36), ("Y", 0.48)]),
        ("rg.exr", vec![("R", 0.32), ("G", 0.74)]),
        (
            "layer.exr",
            [RGB.to_vec(), prefixed("N", &[("X", -0.36), ("Y", 0.48)]), prefixed("uv", &[("X", 0.9), ("Y", 0.9)])]
                .concat(),
        ),
    ] {
        let path = files.write(name, &[("", &channels)]);
        let loaded = load_normal_map(&path, &options).unwrap();
        is_n(&loaded);
    }
}

#[test]
fn x_may_be_in_alpha_of_the_same_layer() {
    let files = Files::new();
    let options = InputOptions { channels: Some(Channels::Ag), ..InputOptions::default() };
    let swizzled: Flat<'_> = &[("R", 1.0), ("G", 0.74), ("B", 1.0), ("A", 0.32)];
    let path = files.write("ag.exr", &[("", &[swizzled, &prefixed("specular", RGB)].concat())]);
    is_n(&load_normal_map(&path, &options).unwrap());
    let path = files.write("no_alpha.exr", &[("", &[RGB, &prefixed("mask", &[("A", 1.0)])].concat())]);
    refused(load_normal_map(&path, &options), 4, &["R, G, B, A", "mask (A)"]);
}

#[test]
fn heights_are_one_channel_of_one_layer() {
    let files = Files::new();
    let options = InputOptions { height: Some(1.0), ..InputOptions::default() };
    let grey: Flat<'_> = &[("R", 0.5), ("G", 0.5), ("B", 0.5)];
    for (name, channels, note) in [
        ("Y.exr", vec![("Y", 0.5)], ""),
        ("RGB.exr", grey.to_vec(), "grey"),
        ("named.exr", vec![("height", 0.5), ("Z", 3.0)], "reads height and leaves out Z"),
        ("layer.exr", [RGB.to_vec(), prefixed("displacement", grey)].concat(), "reads R, G, B of layer displacement"),
        ("single.exr", prefixed("disp", &[("R", 0.5)]), ""),
        ("any.exr", vec![("V", 0.5)], ""),
    ] {
        let loaded = load_normal_map(&files.write(name, &[("", &channels)]), &options);
        let loaded = loaded.unwrap_or_else(|error| panic!("{error}"));
        // The step of an eighth lies between columns 7 and 8, and at the edges of the repeated map.
        assert!((loaded.map.projected[7][0] - 0.0624).abs() < 1e-3, "{name}: {:?}", loaded.map.projected[7]);
        if !note.is_empty() {
            noted(&loaded.warnings, &[note]);
        }
    }
    let refuse = |name: &str, channels: Flat<'_>, words: &[&str]| {
        refused(load_normal_map(&files.write(name, &[("", channels)]), &options), 4, words);
    };
    refuse("coloured.exr", RGB, &["coloured"]);
    refuse("vector.exr", N, &["--height expects one channel", "X, Y, Z"]);
    refuse("two.exr", &[prefixed("height", grey), prefixed("displacement", grey)].concat(), &["--layer"]);
}

#[test]
fn windows_must_be_the_same() {
    let files = Files::new();
    let window = |x: i32, y: i32, w: usize, h: usize| {
        move |image: &mut ImageAttributes| image.display_window = IntegerBounds::new((x, y), (w, h))
    };
    for (name, display, found) in [
        ("larger.exr", (0, 0, 64, 32), "(0, 0) to (63, 31) of 64 × 32"),
        ("smaller.exr", (0, 0, 8, 4), "(0, 0) to (7, 3) of 8 × 4"),
        ("right.exr", (1, 0, 16, 8), "(1, 0) to (16, 7) of 16 × 8"),
        ("up.exr", (0, -3, 16, 8), "(0, -3) to (15, 4) of 16 × 8"),
    ] {
        let (x, y, w, h) = display;
        let path = files.write_with(name, &[("", RGB)], window(x, y, w, h), |_, _| ());
        for result in [environment(&path, None).err(), map(&path, None).err()] {
            refused::<()>(Err(result.unwrap()), 5, &["(0, 0) to (15, 7) of 16 × 8", found]);
        }
    }
    let both = files.write_with("both.exr", &[("", RGB)], window(5, 6, 16, 8), |_, layer| {
        layer.attributes.layer_position = Vec2(5, 6);
    });
    assert_eq!(first(&environment(&both, None).unwrap()), [0.5, 0.25, 0.875]);
}

const P3: [[f32; 2]; 4] = [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], [0.3127, 0.329]];
const REC_2020: [[f32; 2]; 4] = [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], [0.3127, 0.329]];
const REC_709: [[f32; 2]; 4] = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];

fn chromaticities([red, green, blue, white]: [[f32; 2]; 4]) -> impl Fn(&mut ImageAttributes) {
    let point = |[x, y]: [f32; 2]| Vec2(x, y);
    let all = Chromaticities { red: point(red), green: point(green), blue: point(blue), white: point(white) };
    move |image| image.chromaticities = Some(all)
}

#[test]
fn primaries_are_converted_and_said() {
    let files = Files::new();
    let with = |name: &str, points| files.write_with(name, &[("", RGB)], chromaticities(points), |_, _| ());
    // 0.5, 0.25, 0.875 computed apart from the chromaticities.
    for (name, points, expected, said) in [
        ("2020.exr", REC_2020, [0.61959, 0.21364, 0.94467], "Rec. 2020"),
        ("p3.exr", P3, [0.55624, 0.23949, 0.93151], "Display P3"),
    ] {
        let loaded = environment(&with(name, points), None).unwrap();
        for (found, expected) in first(&loaded).into_iter().zip(expected) {
            assert!((found - expected).abs() < 2e-5, "{name}: {:?}", first(&loaded));
        }
        noted(&loaded.warnings, &[said, "converted to Rec. 709"]);
        let map = map(&files.path(name), None).unwrap();
        noted(&map.warnings, &[said, "a map holds no colours"]);
    }
    let odd = environment(&with("odd.exr", [[0.6, 0.3], [0.3, 0.6], [0.15, 0.06], [0.31, 0.32]]), None).unwrap();
    noted(&odd.warnings, &["red (0.6, 0.3), green (0.3, 0.6)", "converted"]);
    let same = environment(&with("709.exr", REC_709), None).unwrap();
    assert_eq!(first(&same), [0.5, 0.25, 0.875]);
    assert!(same.warnings.is_empty(), "{:?}", same.warnings);
    refused(environment(&with("zero.exr", [[0.0; 2]; 4]), None), 4, &["chromaticities make no colours", "red (0, 0)"]);
    map(&with("zero_map.exr", [[0.0; 2]; 4]), None).unwrap();
}

#[test]
fn other_attributes_are_noted_or_refused() {
    let files = Files::new();
    let with = |name: &str, layer: fn(&mut LayerAttributes)| {
        files.write_with(name, &[("", RGB)], |_| (), move |_, built| layer(&mut built.attributes))
    };
    let cube = with("cube.exr", |a| a.environment_map = Some(EnvironmentMap::Cube));
    refused(environment(&cube, None), 5, &["faces of a cube", "equirectangular"]);
    refused(map(&cube, None), 5, &["faces of a cube"]);
    let panorama = with("panorama.exr", |a| a.environment_map = Some(EnvironmentMap::LatitudeLongitude));
    assert!(environment(&panorama, None).unwrap().warnings.is_empty());
    noted(&map(&panorama, None).unwrap().warnings, &["a panorama of an environment"]);
    let white = with("white.exr", |a| {
        a.white_luminance = Some(100.0);
        a.adopted_neutral = Some(Vec2(0.31, 0.33));
    });
    noted(&environment(&white, None).unwrap().warnings, &["a luminance of 100 cd/m²", "a neutral of (0.31, 0.33)"]);
    let clamped = with("clamped.exr", |a| a.wrap_mode_name = Some("clamp".into()));
    noted(&map(&clamped, None).unwrap().warnings, &["wrap modes clamp; --wrap repeat holds"]);
    let wide = files.write_with("wide.exr", &[("", RGB)], |image| image.pixel_aspect = 2.0, |_, _| ());
    for notes in [environment(&wide, None).unwrap().warnings, map(&wide, None).unwrap().warnings] {
        noted(&notes, &["a pixel aspect ratio of 2"]);
    }
    let named = with("named.exr", |a| {
        a.other.insert("colorInteropID".into(), AttributeValue::Text("lin_ap1_scene".into()));
    });
    noted(&environment(&named, None).unwrap().warnings, &["lin_ap1_scene", "taken as linear Rec. 709"]);
}

#[test]
fn whole_numbers_are_refused_where_they_are_read() {
    let files = Files::new();
    let counts = |i: usize, layer: &mut Layer<AnyChannels<FlatSamples>>| {
        for channel in layer.channel_data.list.iter_mut().filter(|c| i == 0 && c.name != *"id.R") {
            channel.sample_data = FlatSamples::U32(vec![7; 128]);
        }
    };
    let path = files.write_with("uint.exr", &[("", &[("R", 1.0), ("G", 1.0), ("B", 1.0)])], |_| (), counts);
    for error in [environment(&path, None).err(), map(&path, None).err()] {
        refused::<()>(Err(error.unwrap()), 5, &["channel R holds whole numbers", "half or float"]);
    }
    let height = InputOptions { height: Some(1.0), ..InputOptions::default() };
    let path = files.write_with("uint_height.exr", &[("", &[("Y", 1.0)])], |_| (), counts);
    refused(load_normal_map(&path, &height), 5, &["channel Y holds whole numbers"]);
    let beside = files.write_with("beside.exr", &[("ids", RGB), ("rgba", RGB)], |_| (), counts);
    assert_eq!(first(&environment(&beside, None).unwrap()), [0.5, 0.25, 0.875]);
    assert_eq!(SampleType::U32.bytes_per_sample(), 4);
}

/// Replaces bytes of a file that stand in it once.
#[track_caller]
fn patched(files: &Files, from: &Path, name: &str, old: &[u8], new: &[u8]) -> PathBuf {
    let mut bytes = fs::read(from).unwrap();
    let at = bytes.windows(old.len()).position(|window| window == old).unwrap();
    bytes.splice(at..at + old.len(), new.iter().copied());
    fs::write(files.path(name), bytes).unwrap();
    files.path(name)
}

#[test]
fn what_is_not_read_is_unsupported_not_damaged() {
    let files = Files::new();
    let rgb = files.write("rgb.exr", &[("", RGB)]);
    let compression = |number: u8| [&b"compression\0compression\0\x01\0\0\0"[..], &[number]].concat();
    for (number, name) in [(10, "HTJ2K256"), (11, "HTJ2K32"), (12, "LJ2K"), (13, "ZSTD"), (99, "99 (unknown)")] {
        let path = patched(&files, &rgb, "compressed.exr", &compression(3), &compression(number));
        refused(environment(&path, None), 5, &[name, "ZIP"]);
    }
    let version = |flags: u32| (2 | flags).to_le_bytes();
    let head = |flags: u32| [&[0x76, 0x2f, 0x31, 0x01][..], &version(flags)].concat();
    let deep = patched(&files, &rgb, "deep.exr", &head(0), &head(1 << 11));
    refused(environment(&deep, None), 5, &["deep data"]);
    let future = patched(&files, &rgb, "future.exr", &head(0), &head(1 << 13));
    refused(environment(&future, None), 5, &["features that are not read"]);
    let third = patched(&files, &rgb, "third.exr", &head(0), &[0x76, 0x2f, 0x31, 0x01, 3, 0, 0, 0]);
    refused(environment(&third, None), 5, &["version 3"]);
    let kind = patched(&files, &rgb, "kind.exr", b"scanlineimage", b"deepscanlines");
    refused(environment(&kind, None), 5, &["\"deepscanlines\""]);

    let chroma = files.write("chroma.exr", &[("", &[("Y", 0.5), ("RY", 0.1), ("BY", 0.1)])]);
    refused(environment(&chroma, None), 5, &["luminance and chroma"]);
    // The first channel, BY: float, linear, reserved bytes, then every how many columns and rows.
    let every = |n: u8| [b"BY\0\x02\0\0\0\x01\0\0\0", &[n, 0, 0, 0, n, 0, 0, 0][..]].concat();
    let sampled = patched(&files, &chroma, "sampled.exr", &every(1), &every(2));
    refused(environment(&sampled, None), 5, &["channel BY is subsampled 2 × 2", "luminance and chroma"]);
}

/// Runs a program that may hold 3 GB of addresses; the threads' stacks are among them.
#[cfg(unix)]
fn within_memory(folder: &Path, args: &[&str]) -> Outcome {
    let program = assert_cmd::cargo::cargo_bin("glint-bake");
    let words: Vec<String> = args.iter().map(|arg| format!("'{arg}'")).collect();
    let line = format!("ulimit -v 3000000; exec '{}' {}", program.display(), words.join(" "));
    let output = std::process::Command::new("sh").args(["-c", &line]).current_dir(folder).output().unwrap();
    Outcome {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// What rows of the table give: code, and words of what is said.
const TABLE: [(&str, &[&str], i32, &[&str]); 9] = [
    (
        "env_layers_mixed.exr",
        &["environment"],
        0,
        &["reads R, G, B of the unnamed layer", "Diffuse (R, G, B)", "--layer"],
    ),
    ("env_cryptomatte.exr", &["environment"], 0, &["reads R, G, B of the unnamed layer", "CryptoAsset00"]),
    ("normal_aov.exr", &["ndf-maps"], 0, &["reads X, Y, Z of layer N", "the unnamed layer (R, G, B)"]),
    ("normal_cropped_window.exr", &["ndf-maps"], 5, &["(10, 20) to (25, 35)", "(0, 0) to (63, 63)"]),
    ("env_shifted_window.exr", &["environment"], 5, &["(8, 0) to (39, 15)", "(0, 0) to (31, 15)"]),
    ("env_acescg.exr", &["environment"], 0, &["ACES AP1 (ACEScg)", "converted to Rec. 709"]),
    ("normal_uint.exr", &["ndf-maps"], 5, &["channel R holds whole numbers"]),
    ("height_rgb_grey.exr", &["ndf-maps", "--height", "3"], 0, &["grey"]),
    ("zstd.exr", &["environment"], 5, &["13 (ZSTD)"]),
];

#[test]
fn rows_of_the_table_have_their_result() {
    let Some(data) = crate::folder::data() else { return };
    let rows = fs::read_to_string(data.join("cases/CASES.tsv")).unwrap();
    let rows: Vec<&str> =
        rows.lines().filter_map(|row| row.split('\t').next()).filter(|f| f.ends_with(".exr")).collect();
    let mut known: Vec<&str> = TABLE.iter().map(|row| row.0).collect();
    for row in &rows {
        assert!(known.contains(row), "{row} is not looked at");
    }
    known.retain(|row| !rows.contains(row));
    assert!(known.is_empty(), "{known:?} are no rows");

    let folder = tempfile::tempdir().unwrap();
    for (file, command, code, words) in TABLE {
        let file = data.join("cases").join(file);
        let quick: &[&str] = if command[0] == "environment" { &QUICK } else { &[] };
        let args = [command, &[file.to_str().unwrap(), "-o", "out.glintpack"], quick].concat();
        let done = bake(folder.path(), &args);
        assert_eq!(done.code, code, "{args:?}: {}", done.stderr);
        for word in words {
            assert!(done.stderr.contains(word), "{args:?}: no {word:?} in {}", done.stderr);
        }
    }
}

#[test]
#[cfg(unix)]
fn a_block_that_claims_much_is_damaged_and_memory_bounded() {
    let files = Files::new();
    let half = |_: usize, layer: &mut Layer<AnyChannels<FlatSamples>>| {
        layer.encoding.compression = Compression::DWAA(None);
        for channel in &mut layer.channel_data.list {
            channel.sample_data = FlatSamples::F16((0..128).map(|at| f16::from_f32(at as f32 / 99.0)).collect());
        }
    };
    let whole = fs::read(files.write_with("whole.exr", &[("", RGB)], |_| (), half)).unwrap();
    let block = (0..whole.len() - 8).rfind(|at| whole[*at..][..8] == 2u64.to_le_bytes()).unwrap();
    let mut claims: Vec<PathBuf> = Vec::new();
    for counter in [1, 6, 7, 8, 9] {
        let mut bytes = whole.clone();
        bytes[block + 8 * counter..][..8].copy_from_slice(&(1u64 << 37).to_le_bytes());
        claims.push(files.path(&format!("claim{counter}.exr")));
        fs::write(claims.last().unwrap(), bytes).unwrap();
    }
    claims.extend(crate::folder::data().map(|data| data.join("hostile/dwaa-abort.exr")));
    for path in claims {
        let done =
            within_memory(files.0.path(), &["area-light", path.to_str().unwrap(), "-o", "out.glintpack", "-j", "2"]);
        assert_eq!(done.code, 4, "{}: {}", path.display(), done.stderr);
        assert!(done.stderr.contains("the EXR is damaged") && done.stderr.contains("claims"), "{}", done.stderr);
    }
}

#[test]
fn a_layer_is_chosen_by_flag_and_recorded() {
    let files = Files::new();
    files.write("sky.exr", &[("", &[prefixed("key", RGB), prefixed("fill", N), prefixed("fill", RGB)].concat())]);
    files.write("map.exr", &[("", &[N.to_vec(), prefixed("N", N)].concat())]);
    let folder = files.0.path();
    let sky = |flags: &[&str]| {
        bake(folder, &[&["environment", "sky.exr", "-o", "sky.glintpack"], &QUICK[..], flags].concat())
    };
    let recorded = || {
        let report = json(&run("glint-info", folder, &["sky.glintpack", "--json"]).ok().stdout);
        report.to_string().replace(' ', "")
    };
    sky(&["--layer", "fill"]).ok();
    assert!(recorded().contains("[\"layer\",\"fill\"]") || recorded().contains("\"layer\":\"fill\""), "{}", recorded());
    let refused = sky(&["--layer", "rim"]);
    assert_eq!(refused.code, 4, "{}", refused.stderr);
    assert!(refused.stderr.contains("key (R, G, B)"), "{}", refused.stderr);
    for command in ["ndf-maps", "lobes", "area-light"] {
        let done = bake(folder, &[command, "map.exr", "-o", "map.glintpack", "-n"]);
        assert_eq!(done.code, 4, "{command}: {}", done.stderr);
        bake(folder, &[command, "map.exr", "-o", "map.glintpack", "-n", "--layer", "N"]).ok();
        bake(folder, &[command, "map.exr", "-o", "map.glintpack", "-n", "--layer", ""]).ok();
    }
    image::RgbImage::from_pixel(8, 8, image::Rgb([128, 128, 255])).save(files.path("plain.png")).unwrap();
    crate::support::sky(&files.path("sky.hdr"));
    for (command, file, format) in [("area-light", "plain.png", "PNG"), ("environment", "sky.hdr", "Radiance HDR")] {
        let done = bake(folder, &[command, file, "-o", "out.glintpack", "--layer", "N"]);
        assert_eq!(done.code, 4, "{}", done.stderr);
        assert!(done.stderr.contains("--layer") && done.stderr.contains(format), "{}", done.stderr);
    }
}

#[test]
fn a_layer_is_chosen_by_a_project() {
    let files = Files::new();
    files.write("sky.exr", &[("", &[prefixed("key", RGB), prefixed("fill", RGB)].concat())]);
    files.write("map.exr", &[("", &[N.to_vec(), prefixed("N", N)].concat())]);
    let project = r#"
output = "packs"

[materials.named]
method = "area-light"
input = "map.exr"
layer = "N"

[materials.unnamed]
method = "area-light"
input = "map.exr"
layer = ""

[environments.sky]
input = "sky.exr"
layer = "fill"
face-size = 8
min-face-size = 4
levels = 1
measure = 0
filter-error = 0.2
"#;
    fs::write(files.path("glint.toml"), project).unwrap();
    let done = bake(files.0.path(), &["build"]).ok();
    for pack in ["named", "unnamed", "sky"] {
        assert!(files.path(&format!("packs/{pack}.glintpack")).is_file(), "{pack}: {}", done.stderr);
    }
    fs::write(files.path("glint.toml"), project.replace("\"fill\"", "\"rim\"")).unwrap();
    let done = bake(files.0.path(), &["build"]);
    assert_eq!(done.code, 4, "{}", done.stderr);
    assert!(done.stderr.contains("no layer \"rim\""), "{}", done.stderr);
}
