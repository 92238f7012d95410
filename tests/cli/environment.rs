//! `glint-bake environment`: what it writes, says and refuses; what `glint-info` says of it.

use crate::support::{Case, bake, info, json, root};
use std::fs;
use std::path::Path;

/// A Radiance file of plain pixels (mantissas and exponent), without run lengths.
fn write_hdr(path: &Path, width: usize, height: usize, pixel: impl Fn(usize, usize) -> [u8; 4]) {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for y in 0..height {
        for x in 0..width {
            bytes.extend(pixel(x, y));
        }
    }
    fs::write(path, bytes).unwrap();
}

/// An EXR file of floats.
fn write_exr(path: &Path, width: usize, height: usize, pixel: impl Fn(usize, usize) -> (f32, f32, f32) + Sync) {
    exr::prelude::write_rgb_file(path, width, height, pixel).unwrap();
}

const DEFAULT: [&str; 4] = ["environment", "sky.hdr", "-o", "out.glintpack"];
const SMALL: [&str; 6] = ["environment", "sky.hdr", "-o", "out.glintpack", "--face-size", "16"];

/// A grey sky with a sun 2^17 times as bright.
fn sky(args: &'static [&'static str]) -> Case {
    let case = Case { folder: tempfile::tempdir().unwrap(), args };
    write_hdr(&case.path("sky.hdr"), 32, 16, |x, y| {
        if (x, y) == (20, 4) { [200, 180, 150, 145] } else { [100, 120, 140, 128] }
    });
    case
}

#[test]
fn an_environment_verifies_and_is_described() {
    let case = sky(&SMALL);
    let flags =
        ["--levels", "8", "--coloured", "--look-ups", "3", "--json", "--report", "r.json", "--depfile", "out.d"];
    let done = case.bake(&flags).ok();
    assert!(done.stderr.contains("sky: 16² × 6, 4 roughnesses") && done.stderr.contains("written"), "{}", done.stderr);
    case.verify();
    assert_eq!(fs::read_to_string(case.path("r.json")).unwrap(), done.stdout);
    assert!(fs::read_to_string(case.path("out.d")).unwrap().contains("sky.hdr"));

    let report = json(&done.stdout);
    let params = &report["environments"][0]["params"];
    assert_eq!((&params["face_size"], &params["kernel"]), (&16.into(), &"ggx-soft".into()));
    assert_eq!((params["levels"].as_array().unwrap().len(), &params["coloured"]), (8, &true.into()));
    assert_eq!(params["look_ups"], 3);
    assert!(params["measured"]["energy"].as_f64().unwrap() < 1e-3);
    assert!(params["radiance_scale"].as_f64().unwrap() > 1.0);
    assert_eq!(report["provenance"][0]["method"], "environment");

    let text = case.info(&[]).ok().stdout;
    for part in [
        "ENIN \"sky\"",
        "R16G16B16A16_SFLOAT 16 × 16 × 6 faces ",
        "8 × 8 × 6 faces × 8 layers ",
        "reads        α ≥ 0.04: relative error ",
        "32 × 16 pixels, 0 of them negative",
        "levels       optimal, with colours: 0.00000 ",
        "look-ups     3 for a surface",
        "64 × 64 × 4 layers",
    ] {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
}

#[test]
fn the_same_pack_on_any_number_of_threads_and_from_other_flags_another() {
    let case = sky(&SMALL);
    let one = case.same_on_any_threads();
    assert!(case.bake(&[]).ok().stderr.contains("unchanged"));
    for flags in [
        &["--levels", "1"][..],
        &["--levels", "auto", "--max-moment-error", "0.5"],
        &["--level-choice", "log-uniform", "--floor", "0.01"],
        // Its kink cuts a sun that is one pixel, an eighth of a radian wide.
        &["--kernel", "ggx-nl", "--filter-error", "0.01"],
        &["--kernel", "ndf"],
        &["--roughnesses", "2"],
        &["--look-ups", "2"],
        &["--max-error", "0.9"],
        &["--compress"],
        &["--min-face-size", "4", "--measure", "0", "--filter-error", "0.02"],
    ] {
        assert!(one != case.pack(flags), "{flags:?}");
        case.verify();
    }
}

#[test]
fn exr_is_read_and_negative_pixels_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    write_exr(&folder.path().join("sky.exr"), 16, 8, |x, y| (if (x, y) == (3, 2) { -1.0 } else { 1.0 }, 0.5, x as f32));
    let flags = ["environment", "sky.exr", "-o", "out.glintpack", "--face-size", "8"];
    let done = bake(folder.path(), &flags).ok();
    assert!(done.stderr.contains("1 pixels are negative, the first of them (3, 2); taken as 0"), "{}", done.stderr);
    let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
    assert_eq!(report["environments"][0]["params"]["negative_pixels"], 1);
    assert!(report["provenance"][0]["notes"][0].as_str().unwrap().contains("(3, 2)"));
}

#[test]
fn what_cannot_be_used_is_refused_with_its_reason() {
    let case = sky(&DEFAULT);
    write_exr(&case.path("nan.exr"), 16, 8, |x, y| (1.0, if (x, y) == (5, 6) { f32::NAN } else { 1.0 }, 1.0));
    write_exr(&case.path("inf.exr"), 16, 8, |x, y| (1.0, 1.0, if (x, y) == (15, 0) { f32::INFINITY } else { 1.0 }));
    write_hdr(&case.path("square.hdr"), 16, 16, |_, _| [128; 4]);
    let whole = fs::read(case.path("sky.hdr")).unwrap();
    fs::write(case.path("cut.hdr"), &whole[..whole.len() - 100]).unwrap();
    fs::write(case.path("text.hdr"), b"hello").unwrap();
    for (file, code, part) in [
        ("nan.exr", 4, "pixel (5, 6) has green NaN"),
        ("inf.exr", 4, "pixel (15, 0) has blue inf"),
        ("square.hdr", 4, "twice as many columns as rows"),
        ("cut.hdr", 4, "cut off"),
        ("text.hdr", 4, "Radiance HDR or OpenEXR"),
        ("missing.hdr", 3, "cannot be read"),
    ] {
        let refused = bake(case.folder.path(), &["environment", file, "-o", "out.glintpack"]);
        assert_eq!(refused.code, code, "{file}: {}", refused.stderr);
        assert!(refused.stderr.contains(file) && refused.stderr.contains(part), "{file}: {}", refused.stderr);
    }
    for (flags, code) in [
        (&["--face-size", "20"][..], 2),
        (&["--min-face-size", "512"], 2),
        (&["--levels", "17"], 2),
        (&["--levels", "none"], 2),
        (&["--roughnesses", "9"], 2),
        (&["--look-ups", "0"], 2),
        (&["--look-ups", "4"], 2),
        (&["--filter-error", "0"], 2),
        (&["--max-error", "0"], 2),
        (&["--max-error", "0.1", "--measure", "0"], 2),
        (&["--face-size", "16", "--max-error", "0.0001"], 6),
        (&["--max-moment-error", "-1"], 2),
        (&["--floor", "0"], 2),
        (&["--level-choice", "log-uniform", "--levels", "auto"], 2),
        (&["--coloured", "--levels", "1"], 2),
        (&["--max-memory", "64K"], 6),
    ] {
        case.refuses(flags, code, flags[0]);
    }
    let dry = case.bake(&["-n"]).ok();
    assert!(dry.stderr.contains("nothing was written"), "{}", dry.stderr);
    assert!(!case.path("out.glintpack").exists());
}

/// Every image of the shared data, small faces; says so where there is none.
#[test]
fn real_environments_bake() {
    let data = std::env::var("GLINT_DATA").map_or(root().join("../shared/data"), Into::into).join("hdri");
    let Ok(entries) = fs::read_dir(&data) else {
        eprintln!("skipped: {} is not there; set GLINT_DATA", data.display());
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for entry in entries {
        let path = entry.unwrap().path();
        let flags = ["--face-size", "16", "--levels", "8", "--measure", "0", "-q", "--json"];
        let done = bake(
            folder.path(),
            &[&["environment", path.to_str().unwrap(), "-o", "out.glintpack"], &flags[..]].concat(),
        )
        .ok();
        let report = json(&done.stdout);
        assert!(
            report["environments"][0]["params"]["measured"]["energy"].as_f64().unwrap() < 1e-3,
            "{}",
            path.display()
        );
        info(folder.path(), &["out.glintpack", "--verify"]).ok();
    }
}
