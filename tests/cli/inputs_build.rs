//! `glint-bake build` over a project with one bad file of each kind: all sound ones are built, every bad one is listed with
//! its code.

use crate::inputs_files::cases;
use crate::support::{bake, info, sky};
use glint_bake::input::synthetic;
use std::fs;
use std::path::Path;

/// An input, the method and options that it is baked with, and the code that it ends with by itself.
type Case<'a> = (&'a str, &'a str, i32);

const NORMALS: &str = "method = 'area-light'\n";
const HEIGHTS: &str = "method = 'area-light'\nheight = 3\n";
const SKY: &str = "method = 'environment'\nface-size = 4\nlevels = 2\n";

/// The files of the table of cases, as it says what should become of them.
const CASES: [Case<'_>; 21] = [
    ("env_layers_mixed.exr", SKY, 0),
    ("env_cryptomatte.exr", SKY, 0),
    ("normal_aov.exr", NORMALS, 0),
    ("tiled_planar.tif", NORMALS, 0),
    ("orientation_bottom_left.tif", NORMALS, 0),
    ("normal_cropped_window.exr", NORMALS, 5),
    ("env_shifted_window.exr", SKY, 5),
    ("env_acescg.exr", SKY, 0),
    ("normal_uint.exr", NORMALS, 5),
    ("dxt5nm.png", NORMALS, 4),
    ("bc5_blue0.png", NORMALS, 4),
    ("bc5_blue255.png", NORMALS, 4),
    ("alpha0_half.png", NORMALS, 0),
    ("object_space.png", NORMALS, 4),
    ("rgbe_magic.hdr", SKY, 0),
    ("exposure_comma.hdr", SKY, 0),
    ("height_float.tif", HEIGHTS, 0),
    ("height_rgb_grey.exr", HEIGHTS, 0),
    ("gimp_linear_profile.png", NORMALS, 0),
    ("zstd.exr", SKY, 5),
    ("jpeg12.jpg", NORMALS, 5),
];

/// Files that no project bakes: meshes and response files.
const NO_INPUTS: [&str; 5] = ["uv_gltfpack.glb", "bom.obj", "bom.rsp", "concave.obj", "sound.png"];

/// Builds a project of these cases in `folder`, and looks at what became of each.
#[track_caller]
fn builds_all_but_the_bad(folder: &Path, cases: &[Case<'_>]) {
    let mut text = String::new();
    for (k, (input, options, _)) in cases.iter().enumerate() {
        text += &format!("[materials.m{k:02}]\ninput = '{input}'\n{options}");
    }
    fs::write(folder.join("glint.toml"), text).unwrap();
    let done = bake(folder, &["build"]);
    let mut listed = Vec::new();
    for (k, (input, _, code)) in cases.iter().enumerate() {
        let (name, pack) = (format!("m{k:02}"), format!("packs/m{k:02}.glintpack"));
        let error = format!("error: {name}: ");
        if *code == 0 {
            assert!(!done.stderr.contains(&error), "{input}: {}", done.stderr);
            info(folder, &[&pack, "--verify"]).ok();
        } else {
            assert!(done.stderr.contains(&error), "{input} is not said: {}", done.stderr);
            assert!(!folder.join(&pack).exists(), "{input}");
            listed.push((format!("{name} (code {code})"), *code));
        }
    }
    // The code of the whole is that of the first; all are listed with their own.
    let names: Vec<&str> = listed.iter().map(|(name, _)| name.as_str()).collect();
    let line = format!("{} of {} packs could not be built: {}\n", listed.len(), cases.len(), names.join(", "));
    assert!(done.stderr.ends_with(&line), "expected {line}found {}", done.stderr);
    assert_eq!(done.code, listed.first().map_or(0, |(_, code)| *code));
    assert!(!done.stderr.contains("panicked") && !done.stderr.contains("please report"), "{}", done.stderr);
    // What is sound is not built again, what is bad is looked at again.
    let again = bake(folder, &["build"]);
    let sound = cases.len() - listed.len();
    assert!(
        again.stderr.contains(&format!("0 written, {sound} up to date, {} failed", listed.len())),
        "{}",
        again.stderr
    );
}

#[test]
fn sound_packs_are_built_beside_one_bad_file_of_each_kind() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    synthetic::flakes(8, 8, 1).save(at("sound.png")).unwrap();
    sky(&at("sky.hdr"));
    let (sound, radiance) = (fs::read(at("sound.png")).unwrap(), fs::read(at("sky.hdr")).unwrap());
    fs::write(at("empty.png"), b"").unwrap();
    fs::write(at("cut.png"), &sound[..sound.len() / 2]).unwrap();
    fs::write(at("text.png"), b"this is not an image at all").unwrap();
    fs::write(at("dds.png"), b"DDS and then whatever follows").unwrap();
    fs::write(at("cut.hdr"), &radiance[..radiance.len() - 9]).unwrap();
    fs::write(at("picture.hdr"), &sound).unwrap();
    fs::create_dir(at("folder.png")).unwrap();
    image::RgbImage::new(8, 8).save(at("black.png")).unwrap();
    image::RgbImage::from_pixel(256, 256, image::Rgb([128, 128, 255])).save(at("large.png")).unwrap();
    let nan = |x: usize, y: usize| if (x, y) == (3, 2) { (f32::NAN, 0.0, 1.0) } else { (0.0, 0.0, 1.0) };
    exr::prelude::write_rgb_file(at("nan.exr"), 8, 8, nan).unwrap();
    let whole = "method = 'ndf-maps'\npreset = 'draft'\n";
    builds_all_but_the_bad(
        folder.path(),
        &[
            ("sound.png", whole, 0),
            ("large.png", whole, 6),
            ("empty.png", whole, 4),
            ("cut.png", "method = 'area-light'\n", 4),
            ("text.png", "method = 'lobes'\n", 4),
            ("sky.hdr", SKY, 0),
            ("dds.png", whole, 5),
            ("missing.png", whole, 3),
            ("folder.png", whole, 3),
            ("cut.hdr", SKY, 4),
            ("picture.hdr", SKY, 5),
            ("black.png", whole, 4),
            ("nan.exr", whole, 4),
            ("sound.png", "method = 'lobes'\n", 0),
        ],
    );
}

#[test]
fn the_table_of_cases_is_built_as_it_says() {
    let Some(cases) = cases() else { return };
    let folder = tempfile::tempdir().unwrap();
    let table = fs::read_to_string(cases.join("CASES.tsv")).unwrap();
    let files = table.lines().skip(1).filter_map(|line| line.split('\t').next()).filter(|name| !name.starts_with('('));
    for name in files {
        assert!(NO_INPUTS.contains(&name) || CASES.iter().any(|(case, ..)| *case == name), "{name} is not tried");
    }
    for name in CASES.iter().map(|(name, ..)| *name).chain(["sound.png"]) {
        fs::copy(cases.join(name), folder.path().join(name)).unwrap();
    }
    let sound: [Case<'_>; 2] =
        [("sound.png", NORMALS, 0), ("sound.png", "method = 'ndf-maps'\npreset = 'draft'\ncrop = '4x4+0+0'\n", 0)];
    builds_all_but_the_bad(folder.path(), &[&sound[..1], &CASES, &sound[1..]].concat());
}
