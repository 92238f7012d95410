//! `glint-bake lobes`: what it writes, says, refuses, and leaves alone; what `glint-info` says of it.

use crate::support::{bake, info, json, maps};
use std::fs;
use std::path::Path;

const DEFAULT: [&str; 4] = ["lobes", "scratches.png", "-o", "out.glintpack"];

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_map_becomes_a_pack_that_verifies_and_is_described() {
    let folder = maps();
    let done = bake(folder.path(), &DEFAULT).ok();
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert!(done.stderr.contains("scratches: 16 × 8 texels, 2 levels, lobes 1.5 KiB"), "{}", done.stderr);
    assert_eq!(info(folder.path(), &["out.glintpack", "--verify"]).ok().stdout, "out.glintpack: intact\n");

    let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
    let lobes = &report["lobes"][0];
    assert_eq!(
        (&lobes["name"], &lobes["merge"], &lobes["levels"]),
        (&"scratches".into(), &"runnalls".into(), &2.into())
    );
    // Two cells of 8 texels and one of 16.
    assert_eq!(lobes["lobe_bytes"], 3 * 32 * 16);
    let error = lobes["measured"][0]["mean"].as_f64().unwrap();
    assert!(error > 0.0 && error < 0.1, "{lobes}");
    assert_eq!(report["provenance"][0]["method"], "lobes");
    assert_eq!(report["provenance"][0]["options"][0], serde_json::json!(["roughness", "0.02"]));

    let text = info(folder.path(), &["out.glintpack"]).ok().stdout;
    for part in
        ["LOBE \"scratches\"", "96 × 16 bytes", "32 a cell, 2 levels from 8 texels on", "runnalls from 4 a texel"]
    {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
}

#[test]
fn the_same_flags_give_the_same_bytes_on_any_number_of_threads() {
    let folder = maps();
    let pack_of = |flags: &[&str]| {
        bake(folder.path(), &[&DEFAULT[..], flags].concat()).ok();
        fs::read(folder.path().join("out.glintpack")).unwrap()
    };
    let one = pack_of(&["-j", "1"]);
    assert!(one == pack_of(&["-j", "2"]) && one == pack_of(&["-j", "7"]) && one == pack_of(&[]));
    assert!(bake(folder.path(), &DEFAULT).ok().stderr.contains("unchanged"));
    assert!(one != pack_of(&["--storage", "f16"]) && one != pack_of(&["--wrap", "clamp"]));
}

#[test]
fn every_flag_is_taken() {
    let folder = maps();
    let flags = ["--name", "Kratzer", "--crop", "5x3+2+1", "--normal-y", "down", "--channels", "xy", "--k", "7"];
    let more = ["--cell", "4", "--merge", "kmeans", "--seeds", "1", "--nearest", "--normals", "8", "--seed", "5"];
    let rest = ["--storage", "f16", "--compress", "--assume-linear", "--max-error", "2", "--roughness", "0.1"];
    bake(folder.path(), &[&DEFAULT[..], &flags, &more, &rest].concat()).ok();
    let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
    let lobes = &report["lobes"][0];
    assert_eq!((&lobes["name"], &lobes["width"], &lobes["height"]), (&"Kratzer".into(), &5.into(), &3.into()));
    assert_eq!(
        (&lobes["storage"], &lobes["filter"], &lobes["normal_bits"]),
        (&"f16".into(), &"nearest".into(), &8.into())
    );
    assert_eq!((&lobes["merge"], &lobes["lobes_per_cell"], &lobes["seeds"]), (&"kmeans".into(), &7.into(), &1.into()));
    let coloured = bake(folder.path(), &[&DEFAULT[..], &["--height", "2"]].concat());
    assert!(coloured.code == 4 && coloured.stderr.contains("--height"), "{}", coloured.stderr);
    bake(folder.path(), &[&DEFAULT[..], &["--crop", "1x1+0+0"]].concat()).ok();
    assert_eq!(info(folder.path(), &["out.glintpack", "--verify"]).ok().stdout, "out.glintpack: intact\n");
}

#[test]
fn an_error_that_is_missed_fails_and_writes_nothing() {
    let folder = maps();
    let missed = bake(folder.path(), &[&DEFAULT[..], &["--max-error", "0.00001"]].concat());
    assert_eq!(missed.code, 6, "{}", missed.stderr);
    assert!(
        missed.stderr.contains("E1 of 0.00001") && missed.stderr.contains("nothing was written"),
        "{}",
        missed.stderr
    );
    assert_eq!(names_in(folder.path()), ["flakes.png", "scratches.png"]);
    bake(folder.path(), &[&DEFAULT[..], &["--max-error", "0.5"]].concat()).ok();
}

#[test]
fn what_cannot_work_is_refused_by_the_name_of_its_flag() {
    let folder = maps();
    for (flag, value, code) in [
        ("--roughness", "0", 2),
        ("--roughness", "1.01", 2),
        ("--roughness", "nan", 2),
        ("--k", "0", 2),
        ("--k", "257", 2),
        ("--cell", "7", 2),
        ("--cell", "128", 2),
        ("--seeds", "3", 2),
        ("--merge", "lloyd", 2),
        ("--storage", "u8", 2),
        ("--normals", "12", 2),
        ("--max-error", "-1", 2),
        ("--name", "", 2),
        ("--crop", "99x99+0+0", 4),
        ("--max-memory", "1K", 6),
    ] {
        let refused = bake(folder.path(), &[&DEFAULT[..], &[&format!("{flag}={value}")]].concat());
        assert_eq!(refused.code, code, "{flag} {value}: {}", refused.stderr);
        let named = refused.stderr.contains(flag) || refused.stderr.contains("crop");
        assert!(named, "{flag} {value}: {}", refused.stderr);
    }
    assert_eq!(bake(folder.path(), &["lobes", "none.png", "-o", "out.glintpack"]).code, 3);
    assert_eq!(bake(folder.path(), &["lobes", "scratches.png", "-o", "scratches.png"]).code, 2);
    assert_eq!(names_in(folder.path()), ["flakes.png", "scratches.png"]);
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let folder = maps();
    let done = bake(folder.path(), &[&DEFAULT[..], &["-n", "--report", "r.json", "--depfile", "d"]].concat()).ok();
    let said = "16 × 8 texels, 32 lobes a cell of 8 texels, 2.0 KiB at most; dry run, nothing was written";
    assert!(done.stderr.contains(said), "{}", done.stderr);
    assert_eq!(names_in(folder.path()), ["flakes.png", "scratches.png"]);
}
