//! `glint-bake ndf-maps` and `demo`: what they write, say, and leave alone.

use crate::support::{bake, info, json, maps, root};
use std::fs;
use std::path::Path;

const BOTH: [&str; 5] = ["ndf-maps", "flakes.png", "scratches.png", "-o", "out.glintpack"];

#[test]
fn maps_become_materials_of_a_pack_that_verifies() {
    let folder = maps();
    let done = bake(folder.path(), &[&BOTH[..], &["--name", "paint", "--layers", "scratches:paint"]].concat()).ok();
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert!(done.stderr.contains("E₁ mean") && done.stderr.contains("written"), "{}", done.stderr);
    assert_eq!(info(folder.path(), &["out.glintpack", "--verify"]).ok().stdout, "out.glintpack: intact\n");
    let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
    let names: Vec<&str> =
        report["materials"].as_array().unwrap().iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["paint", "scratches"]);
    assert_eq!(report["layers"][0]["coat"], "scratches");
    assert_eq!(report["provenance"][0]["inputs"][0]["name"], "flakes.png");
    assert!(report["materials"][0]["measured"]["mean"].as_f64().unwrap() <= 0.0301);
}

#[test]
fn equal_inputs_give_equal_bytes_on_any_number_of_threads() {
    let folder = maps();
    for placement in ["tiled", "stochastic"] {
        let mut packs = Vec::new();
        for threads in ["1", "2", "7"] {
            bake(folder.path(), &[&BOTH[..], &["-j", threads, "--placement", placement, "--compress"]].concat()).ok();
            packs.push(fs::read(folder.path().join("out.glintpack")).unwrap());
        }
        assert!(packs[0] == packs[1] && packs[0] == packs[2], "{placement}");
    }
}

#[test]
fn real_maps_bake_when_they_are_at_hand() {
    let Some(data) = std::env::var_os("GLINT_DATA") else {
        return eprintln!("skipped: GLINT_DATA is not set");
    };
    let folder = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(Path::new(&data).join("tiny")).unwrap() {
        let path = entry.unwrap().path();
        let args = ["ndf-maps", path.to_str().unwrap(), "-o", "real.glintpack", "--placement", "stochastic"];
        bake(folder.path(), &[&args[..], &["--assume-linear"]].concat()).ok();
        info(folder.path(), &["real.glintpack", "--verify"]).ok();
    }
}

#[test]
fn an_unchanged_pack_keeps_its_time_stamp() {
    let folder = maps();
    let path = folder.path().join("out.glintpack");
    bake(folder.path(), &BOTH).ok();
    let before = fs::metadata(&path).unwrap().modified().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(20));
    assert!(bake(folder.path(), &BOTH).ok().stderr.contains("unchanged"));
    assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), before);
}

#[test]
fn every_preset_window_and_placement_flag_is_taken() {
    let folder = maps();
    for extra in [
        &["--preset", "accurate", "--roughness", "0.05"][..],
        &["--preset", "draft", "--crop", "4x4+2+1", "--normal-y", "down", "--wrap", "clamp"],
        &["--finest-window", "1.5"],
        &["--channels", "xy", "--transforms", "rotate=30,scale=2"],
        &["--placement", "stochastic", "--transforms", "rotate=0..90,mirror", "--palette", "3", "--cells", "4"],
        &["--placement", "stochastic", "--spacing", "0.5", "--seed", "9"],
    ] {
        let args = [&["ndf-maps", "flakes.png", "-o", "out.glintpack"], extra].concat();
        bake(folder.path(), &args).ok();
        info(folder.path(), &["out.glintpack", "--verify"]).ok();
    }
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let folder = maps();
    let before: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    let flags = ["-n", "--report", "r.json", "--depfile", "d"];
    let done = bake(folder.path(), &[&BOTH[..], &flags].concat()).ok();
    assert!(done.stderr.contains("nothing was written"), "{}", done.stderr);
    let after: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(before, after);
    assert_eq!(bake(folder.path(), &["ndf-maps", "none.png", "-o", "out.glintpack", "-n"]).code, 3);
}

#[test]
fn report_file_and_json_are_what_glint_info_prints() {
    let folder = maps();
    let done = bake(folder.path(), &[&BOTH[..], &["--json", "--report", "report.json"]].concat()).ok();
    let printed = info(folder.path(), &["out.glintpack", "--json"]).ok().stdout;
    assert_eq!(done.stdout, printed);
    assert_eq!(fs::read_to_string(folder.path().join("report.json")).unwrap(), printed);
}

#[test]
fn depfiles_are_read_by_make() {
    let folder = maps();
    fs::rename(folder.path().join("flakes.png"), folder.path().join("two words$1#.png")).unwrap();
    bake(folder.path(), &["ndf-maps", "two words$1#.png", "-o", "out.glintpack", "--depfile", "out.d"]).ok();
    let text = fs::read_to_string(folder.path().join("out.d")).unwrap();
    assert_eq!(text, "out.glintpack: \\\n  two\\ words$$1\\#.png\n");
}

#[test]
fn response_files_stand_for_arguments() {
    let folder = maps();
    fs::write(
        folder.path().join("args.rsp"),
        "# both maps\nndf-maps flakes.png\n'scratches.png' -o \"my pack.glintpack\"\n",
    )
    .unwrap();
    bake(folder.path(), &["@args.rsp", "-q"]).ok();
    assert!(folder.path().join("my pack.glintpack").exists());
    assert_eq!(bake(folder.path(), &["@missing.rsp"]).code, 3);
    fs::write(folder.path().join("open.rsp"), "'ndf-maps").unwrap();
    assert_eq!(bake(folder.path(), &["@open.rsp"]).code, 2);
}

#[test]
fn quiet_says_nothing_and_progress_goes_to_standard_error() {
    let folder = maps();
    let done = bake(folder.path(), &[&BOTH[..], &["-q"]].concat()).ok();
    assert_eq!((done.stdout.as_str(), done.stderr.as_str()), ("", ""));
    let done = bake(folder.path(), &[&BOTH[..], &["--progress", "always"]].concat()).ok();
    assert!(done.stdout.is_empty() && done.stderr.contains("NDF maps: 157 steps"), "{}", done.stderr);
    assert!(!bake(folder.path(), &BOTH).ok().stderr.contains("steps"));
}

#[test]
fn the_version_names_commit_and_pack_versions() {
    let text = bake(&root(), &["--version"]).ok().stdout;
    assert!(text.starts_with(&format!("glint-bake {} (git ", env!("CARGO_PKG_VERSION"))), "{text}");
    assert!(text.contains("packs: writes 1.0, reads 1.x"), "{text}");
}

#[test]
fn the_demo_bakes_verifies_and_paints() {
    let folder = tempfile::tempdir().unwrap();
    let done = bake(folder.path(), &["demo", "--size", "96x48"]).ok();
    assert!(done.stderr.contains("E₁ mean") && done.stderr.contains("intact"), "{}", done.stderr);
    info(folder.path(), &["glint-demo/demo.glintpack", "--verify"]).ok();
    assert!(folder.path().join("glint-demo/demo.png").exists());
}

#[test]
fn reflectances_of_layers_reach_the_pack() {
    let folder = maps();
    let layers = ["--layers", "scratches:flakes", "--coat-f0", "0.06", "--base-f0", "0.9,0.5,0.1"];
    bake(folder.path(), &[&BOTH[..], &layers].concat()).ok();
    let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
    let found = &report["layers"][0];
    assert_eq!((&found["coat_f0"], &found["base_f0"]), (&0.06.into(), &serde_json::json!([0.9, 0.5, 0.1])));
}

/// A ramp of one texel a column is a plane that is tilted by its slope.
#[test]
fn height_maps_are_read_by_their_scale() {
    let folder = maps();
    let ramp = image::GrayImage::from_fn(8, 8, |x, _| image::Luma([(30 * x.min(8 - x)) as u8]));
    ramp.save(folder.path().join("ramp.png")).unwrap();
    let normals = |scale: &str| {
        bake(folder.path(), &["ndf-maps", "ramp.png", "--height", scale, "-o", "out.glintpack"]).ok();
        info(folder.path(), &["out.glintpack", "--extract", "NMNO", "-o", "normals.bin", "-q"]).ok();
        let bytes = fs::read(folder.path().join("normals.bin")).unwrap();
        // Texel (2, 0), where the ramp rises, is the last corner of its patch.
        let at = 16 * 2 + 12;
        let x = i16::from_le_bytes([bytes[at], bytes[at + 1]]);
        f64::from(x) / 32767.0
    };
    for scale in ["1", "4"] {
        // White is `scale` texels high, so the slope is 30 / 255 of it, and the normal leans back.
        let slope = scale.parse::<f64>().unwrap() * 30.0 / 255.0;
        let expected = -slope / (1.0 + slope * slope).sqrt();
        assert!((normals(scale) - expected).abs() < 1e-3, "{scale}: {}, expected {expected}", normals(scale));
    }
}

#[test]
fn messages_are_coloured_when_asked() {
    let folder = maps();
    let refused =
        |flags: &[&str]| bake(folder.path(), &[&["ndf-maps", "none.png", "-o", "x.glintpack"], flags].concat());
    assert!(refused(&["--color", "always"]).stderr.contains("\x1b[1;31merror:"));
    for flags in [&["--color", "never"][..], &["--color", "auto"], &[]] {
        let plain = refused(flags).stderr;
        assert!(plain.contains("error: none.png") && !plain.contains('\x1b'), "{plain}");
    }
}

#[test]
fn fine_windows_can_be_left_out() {
    let folder = maps();
    let report = |flags: &[&str]| {
        bake(folder.path(), &[&["ndf-maps", "scratches.png", "-o", "out.glintpack"], flags].concat()).ok();
        info(folder.path(), &["out.glintpack", "--verify"]).ok();
        json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout)
    };
    let windows = |report: &serde_json::Value| -> Vec<f64> {
        let levels = report["materials"][0]["levels"].as_array().unwrap();
        levels.iter().map(|level| level["window"].as_f64().unwrap()).collect()
    };
    let (all, some, top) = (report(&[]), report(&["--finest-window", "2"]), report(&["--finest-window", "8192"]));
    let from = |finest: f64, count| (0..count).map(|k| finest * 2f64.powf(0.5 * f64::from(k))).collect::<Vec<f64>>();
    let is = |found: &[f64], expected: &[f64]| {
        let pairs = found.iter().zip(expected);
        assert!(
            found.len() == expected.len() && pairs.clone().all(|(a, b)| (a - b).abs() < 1e-4 * b),
            "{found:?}, {expected:?}"
        );
    };
    is(&windows(&all), &from(0.85, 8));
    is(&windows(&some), &from(2.0, 5));
    is(&windows(&top), &[8192.0]);
    let bytes = |report: &serde_json::Value| report["bytes"].as_u64().unwrap();
    assert!(bytes(&top) < bytes(&some) && bytes(&some) < bytes(&all));
    for bad in ["0", "0.2", "8193", "nan", "x"] {
        let refused = bake(folder.path(), &["ndf-maps", "scratches.png", "-o", "no.glintpack", "--finest-window", bad]);
        assert!(refused.code == 2 && refused.stderr.contains("--finest-window"), "{}", refused.stderr);
    }
}
