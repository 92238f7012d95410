//! `glint-view`: pictures, turntables, comparison, the list, the bench, what it refuses. Without an adapter the tests say that
//! they are skipped; with `GLINT_REQUIRE_ADAPTER=1` they fail instead.

use crate::schema::check_against;
use crate::support::{Outcome, info, json, packs, run};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Runs glint-view in `folder`.
pub fn view(folder: &Path, args: &[&str]) -> Outcome {
    run("glint-view", folder, args)
}

/// The folder of packs, if there is an adapter.
pub fn folder() -> Option<tempfile::TempDir> {
    let folder = packs().0;
    let listed = view(folder.path(), &["dictionary.glintpack", "--list"]);
    if listed.code == 5 && std::env::var_os("GLINT_REQUIRE_ADAPTER").is_none_or(|value| value != "1") {
        eprintln!("skipped: {}", listed.stderr);
        return None;
    }
    listed.ok();
    Some(folder)
}

/// Width, height and pixels of a PNG.
pub fn png(path: &Path) -> (u32, u32, Vec<u8>) {
    let picture = image::open(path).unwrap().to_rgb8();
    (picture.width(), picture.height(), picture.into_raw())
}

/// How much two pictures of a size differ, 0 to 255.
pub fn difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
}

/// Draws into a file of its own; the pixels.
fn shot(folder: &Path, out: &Path, flags: &[&str]) -> Vec<u8> {
    let path = out.join("shot.png");
    let headless = ["dictionary.glintpack", "--size", "96x64", "--headless", path.to_str().unwrap()];
    view(folder, &[&headless[..], flags].concat()).ok();
    let (width, height, pixels) = png(&path);
    assert_eq!((width, height), (96, 64));
    pixels
}

#[test]
fn a_picture_is_the_same_twice_and_every_flag_changes_it() {
    let Some(folder) = folder() else { return };
    let folder = folder.path();
    let out = tempfile::tempdir().unwrap();
    let plain = shot(folder, out.path(), &[]);
    assert!(plain == shot(folder, out.path(), &[]));
    assert!(plain.iter().any(|&value| value > 200) && plain.iter().any(|&value| value < 40), "no light or no dark");
    let flags: &[&[&str]] = &[
        &["--method", "smooth"],
        &["--against", "smooth"],
        &["--against", "smooth", "--compare", "error"],
        &["--reference", "--samples", "4"],
        &["--overlay", "lod"],
        &["--exposure", "-2"],
        &["--tone", "linear"],
        &["--vary-seed", "--samples", "8"],
        &["--shape", "sphere"],
        &["--camera", "40,50,2.5"],
        &["--light", "points,rect"],
        &["--sun", "-1,1,0.5"],
        &["--uv-scale", "3"],
        &["--alpha", "0.1,0.3"],
        &["--target", "ggx"],
        &["--density", "1e4"],
        &["--relative-area", "0.3"],
        &["--density-randomisation", "3"],
        &["--max-anisotropy", "1"],
        &["--f0", "0.9,0.3,0.2"],
        &["--colour", "1,0,0", "--colour", "0,0,1"],
        &["--seed", "77"],
    ];
    for flags in flags {
        let changed = shot(folder, out.path(), flags);
        assert!(difference(&plain, &changed) > 0.05, "{flags:?} change nothing");
    }
}

#[test]
fn maps_and_environments_take_their_flags() {
    let Some(folder) = folder() else { return };
    let folder = folder.path();
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("a.png");
    let draw = |pack: &str, flags: &[&str]| {
        let headless = [pack, "--size", "96x64", "--headless", path.to_str().unwrap(), "-q"];
        view(folder, &[&headless[..], flags].concat()).ok();
        png(&path).2
    };
    for (pack, plain, flags) in [
        ("lobes.glintpack", &["--light", "sun"][..], &["--light", "sun", "--intrinsic-roughness", "0.2"][..]),
        ("lobes.glintpack", &["--light", "sun"], &["--light", "sun", "--texels-per-unit", "3"]),
        ("light.glintpack", &[], &["--lobes", "0", "--alpha", "0.4"]),
        ("layered.glintpack", &["--texels-per-unit", "64"], &["--texels-per-unit", "64", "--swap-layers"]),
        ("sky.glintpack", &["--shape", "sphere"], &["--shape", "sphere", "--turn", "90"]),
        ("facets.glintpack", &["--light", "sun"], &["--light", "sun", "--sun-size", "30"]),
        ("facets.glintpack", &["--light", "points"], &["--light", "points", "--point-radius", "0.7"]),
        ("facets.glintpack", &["--light", "sun"], &["--light", "sun", "--facet-spread", "20"]),
        ("facets.glintpack", &["--shape", "sphere"], &["--shape", "sphere", "--in-space"]),
        (
            "facets.glintpack",
            &["sky.glintpack", "--light", "environment"],
            &["sky.glintpack", "--light", "environment", "--sky-spread", "2"],
        ),
    ] {
        let changed = difference(&draw(pack, plain), &draw(pack, flags));
        assert!(changed > 0.01, "{pack}: {flags:?} change nothing ({changed})");
    }
}

#[test]
fn a_turntable_goes_around() {
    let Some(folder) = folder() else { return };
    let folder = folder.path();
    let out = tempfile::tempdir().unwrap();
    let around = out.path().join("around");
    let flags = ["dictionary.glintpack", "--size", "64x48", "--frames", "3", "--turntable", around.to_str().unwrap()];
    view(folder, &flags).ok();
    let pictures = ["00000.png", "00001.png", "00002.png"].map(|name| png(&around.join(name)).2);
    assert_eq!(fs::read_dir(&around).unwrap().count(), 3);
    assert!(difference(&pictures[0], &pictures[1]) > 0.05 && difference(&pictures[1], &pictures[2]) > 0.05);
}

#[test]
fn the_list_names_what_can_be_shown_and_the_bench_measures_it() {
    let Some(folder) = folder() else { return };
    let folder = folder.path();
    let both = ["dictionary.glintpack", "light.glintpack"];
    let listed = view(folder, &[&both[..], &["--list"]].concat()).ok().stdout;
    for part in ["adapter", "dictionary:", "area-light:", "plain-ltc:", "smooth"] {
        assert!(listed.contains(part), "{listed}");
    }
    let measured = view(folder, &[&both[..], &["--bench", "--frames", "1", "--size", "64x36"]].concat()).ok().stdout;
    for part in ["| dictionary |", "| area-light |", "| plain-ltc |", "64 x 36"] {
        assert!(measured.contains(part), "{measured}");
    }
}

#[test]
fn the_bench_is_data_too() {
    let Some(folder) = folder() else { return };
    let folder = folder.path();
    let packs = ["dictionary.glintpack", "light.glintpack", "sky.glintpack", "facets.glintpack"];
    let flags = ["--bench", "--json", "--frames", "1", "--size", "64x36", "--verbose"];
    let measured = view(folder, &[&packs[..], &flags].concat()).ok();
    assert!(measured.stderr.contains("adapter: "), "{}", measured.stderr);
    let document = json(&measured.stdout);
    check_against("glint-bench.schema.json", &document, "--bench --json");
    assert_eq!(document["size"], serde_json::json!([64, 36]));
    let rows = document["rows"].as_array().unwrap();
    // Counted facets have a row a lighting.
    let lightings = rows.iter().filter(|row| row["method"] == "glints" && row["error"].is_null());
    assert_eq!(lightings.count(), 12);
    for method in ["dictionary", "area-light", "environment"] {
        let of_method: Vec<&Value> = rows.iter().filter(|row| row["method"] == method).collect();
        let from: Vec<&str> = of_method.iter().map(|row| row["from"].as_str().unwrap()).collect();
        assert_eq!(from, ["ahead", "60 degrees"], "{method}");
        for row in of_method {
            let positive = |field: &str| row[field].as_f64().unwrap() > 0.0;
            assert!(["ratio", "operations", "look_ups", "bytes"].into_iter().all(positive), "{row}");
            let errors = [&row["error"], &row["noise"]];
            assert!(errors.into_iter().all(|error| error.is_null() == (method == "environment")), "{row}");
            if let [Some(error), Some(noise)] = errors.map(Value::as_f64) {
                // Sparse glints may be off by more than what there is.
                assert!((0.0..2.0).contains(&error) && (0.0..1.0).contains(&noise), "{row}");
            }
        }
    }
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let folder = packs().0;
    let folder = folder.path();
    let refuses = |args: &[&str], code: i32, part: &str| {
        let refused = view(folder, args);
        assert_eq!(refused.code, code, "{args:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(part), "{args:?}: {}", refused.stderr);
    };
    refuses(&[], 2, "PACK");
    assert!(view(folder, &["--version"]).ok().stdout.contains("reads 1.x"));
    refuses(&["none.glintpack", "--list"], 3, "none.glintpack");
    refuses(&["dictionary.glintpack", "--alpha", "0.1,0.2,0.3", "--list"], 2, "--alpha");
    refuses(&["dictionary.glintpack", "--json"], 2, "--bench");
    refuses(&["flakes.png", "--list"], 4, "flakes.png");
    refuses(&["dictionary.glintpack", "--headless", "none/a.png"], 3, "none");
    refuses(&["dictionary.glintpack", "--headless", "dictionary.glintpack"], 2, "an input");
    refuses(&["dictionary.glintpack", "--camera", "1,2", "--list"], 2, "azimuth,elevation,distance");
    refuses(&["dictionary.glintpack", "--mesh", "none.obj", "--list"], 3, "none.obj");
    refuses(&["dictionary.glintpack", "--list", "--max-memory", "1K"], 6, "dictionary.glintpack");
    let adapter = ["dictionary.glintpack", "--adapter", "no such adapter", "--list"];
    refuses(&adapter, 5, "mesa-vulkan-drivers");
    if self::folder().is_some() {
        refuses(&["dictionary.glintpack", "--method", "lobes", "--headless", "a.png"], 2, "there is dictionary");
        refuses(&["dictionary.glintpack", "--against", "lobes", "--headless", "a.png"], 2, "there is dictionary");
        refuses(
            &["dictionary.glintpack", "--size", "16384x4", "--headless", "a.png"],
            6,
            "pixels a side, found 16384x4",
        );
    }
}

/// A layered material binds the sections of both its materials and its own.
#[test]
fn the_list_has_the_bytes_that_glint_info_has() {
    let Some(folder) = folder() else { return };
    let mut compared = 0;
    for pack in packs().1 {
        let report = json(&info(folder.path(), &[pack, "--json"]).ok().stdout);
        let bytes_of = |name: &str| {
            let all = report["gpu_bytes"].as_array().unwrap();
            all.iter().find(|of| of["name"] == name).map_or(0, |of| of["bytes"].as_u64().unwrap())
        };
        let listed = view(folder.path(), &[pack, "--list"]).ok().stdout;
        for line in listed.lines().filter(|line| line.ends_with(" bytes on the GPU")) {
            let (subject, bytes) = line.trim_end_matches(" bytes on the GPU").rsplit_once("  ").unwrap();
            let Some((_, name)) = subject.trim().split_once(':') else { continue };
            let layers = report["layers"].as_array().unwrap().iter().find(|layers| {
                let [coat, base] = ["coat", "base"].map(|layer| layers[layer].as_str().unwrap());
                name == format!("{coat}+{base}")
            });
            let expected = match layers {
                None => bytes_of(name),
                Some(layers) => {
                    let [coat, base] = ["coat", "base"].map(|layer| layers[layer].as_str().unwrap());
                    bytes_of(coat) + bytes_of(base) + bytes_of(&format!("{coat}:{base}"))
                }
            };
            assert!(expected > 0, "{pack}: {line}");
            assert_eq!(bytes.trim().parse::<u64>().unwrap(), expected, "{pack}: {line}");
            compared += 1;
        }
    }
    assert!(compared > 8, "only {compared} materials were compared");
}
