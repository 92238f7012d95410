//! `glint-info`: sound packs, damaged packs of the corpus, frozen packs, plots.

use crate::support::{bake, info, json, maps, root};
use std::fs;
use std::path::PathBuf;

#[test]
fn text_shows_what_a_user_asks_for() {
    let folder = maps();
    let args = ["ndf-maps", "flakes.png", "-o", "out.glintpack", "--placement", "stochastic", "--compress"];
    bake(folder.path(), &args).ok();
    let text = info(folder.path(), &["out.glintpack"]).ok().stdout;
    for part in [
        "glintpack version 1.0",
        "NMDE \"flakes\"",
        "8 × 8 texels\n",
        "paper's layout 1,344 KiB",
        "E₁ mean",
        "energy",
        "stochastic, 32 × 32 cells",
        "seed         1",
        "flakes.png",
        "placement stochastic",
    ] {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
    let quiet = info(folder.path(), &["out.glintpack", "-q"]).ok();
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
}

/// What the corpus file of an issue ends with: warnings pass, newer files are unsupported, large ones exceed a limit.
fn expected_code(issue: &str) -> i32 {
    match issue {
        "G1031" => 0,
        "G1009" | "G1010" | "G1011" => 6,
        "G1004" | "G1006" | "G1014" | "G1016" | "G1030" | "G1032" => 5,
        _ => 4,
    }
}

#[test]
fn every_damaged_pack_is_named_by_its_issue() {
    let corpus = root().join("fixtures/corrupt");
    let mut seen = 0;
    for entry in fs::read_dir(&corpus).unwrap() {
        let folder = entry.unwrap().path();
        let issue = folder.file_name().unwrap().to_str().unwrap().to_owned();
        for file in fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()) {
            if file.extension().is_none_or(|e| e != "glintpack") {
                continue;
            }
            seen += 1;
            let path = file.to_str().unwrap();
            // The corpus of limits is made against limits that a test sets; with the usual ones those packs are sound.
            let shown = info(&root(), &[path, "--verify"]);
            if expected_code(&issue) == 6 && shown.code == 0 {
                continue;
            }
            assert_eq!(shown.code, expected_code(&issue), "{path}: {}{}", shown.stdout, shown.stderr);
            assert!(shown.stdout.contains(&issue), "{path}: {}", shown.stdout);
            let plain = info(&root(), &[path]);
            assert_eq!(plain.code, shown.code);
            assert!(plain.stderr.contains(&issue), "{path}: {}", plain.stderr);
            let data = json(&info(&root(), &[path, "--json"]).stdout);
            assert!(data["issues"].as_array().unwrap().iter().any(|i| i["code"] == issue.as_str()), "{path}: {data}");
        }
    }
    assert!(seen >= 50, "only {seen} damaged packs found");
}

#[test]
fn a_truncated_pack_is_refused_and_a_missing_one_cannot_be_read() {
    let folder = maps();
    bake(folder.path(), &["ndf-maps", "flakes.png", "-o", "out.glintpack"]).ok();
    let bytes = fs::read(folder.path().join("out.glintpack")).unwrap();
    for len in [0, 11, 39, 200, bytes.len() / 2, bytes.len() - 1] {
        fs::write(folder.path().join("cut.glintpack"), &bytes[..len]).unwrap();
        let shown = info(folder.path(), &["cut.glintpack"]);
        assert_eq!(shown.code, if len == 0 { shown.code } else { 4 }, "{len}: {}", shown.stderr);
        assert_ne!(shown.code, 0);
        assert!(shown.stderr.contains("cut.glintpack"), "{}", shown.stderr);
    }
    let missing = info(folder.path(), &["none.glintpack", "--json"]);
    assert_eq!(missing.code, 3);
    assert!(json(&missing.stdout)["error"].as_str().unwrap().contains("cannot be read"));
    assert!(missing.stderr.contains("none.glintpack"), "{}", missing.stderr);
    let limited = info(folder.path(), &["out.glintpack", "--max-memory", "1K"]);
    assert_eq!(limited.code, 6, "{}", limited.stderr);
}

/// Packs of released versions, which stay readable.
#[test]
fn frozen_packs_still_read() {
    let mut packs: Vec<PathBuf> = Vec::new();
    let folders = fs::read_dir(root().join("fixtures/packs")).unwrap().map(|e| e.unwrap().path());
    for version in folders.filter(|path| path.is_dir()) {
        packs.extend(fs::read_dir(version).unwrap().map(|e| e.unwrap().path()));
    }
    for pack in packs.iter().filter(|path| path.extension().is_some_and(|e| e == "glintpack")) {
        let report = json(&info(&root(), &[pack.to_str().unwrap(), "--json"]).ok().stdout);
        assert_eq!(report["issues"].as_array().unwrap().len(), 0, "{}", pack.display());
        let contents = |what: &str| report[what].as_array().unwrap().len();
        assert!(contents("materials") + contents("dictionaries") > 0, "{}", pack.display());
    }
    assert!(packs.len() >= 3, "the packs of version 1 are missing");
}

#[test]
fn plots_are_pictures() {
    let folder = maps();
    let args = ["ndf-maps", "flakes.png", "-o", "out.glintpack", "--placement", "stochastic", "--name", "a/b"];
    bake(folder.path(), &args).ok();
    info(folder.path(), &["out.glintpack", "--plot", "plots", "-q"]).ok();
    let size = |name: &str| image::open(folder.path().join("plots").join(name)).unwrap().to_rgb8().dimensions();
    // Eleven nodes of the finest windows a row, in twelve rows, and one of the whole example.
    assert_eq!(size("0-a_b-nodes-0.png"), (935, 1020));
    assert_eq!(size("0-a_b-nodes-6.png"), (320, 320));
    assert_eq!(size("0-a_b-normals.png"), (128, 128));
    assert_eq!(size("0-a_b-placement.png"), (768, 768));
    let svg = fs::read_to_string(folder.path().join("plots/0-a_b-errors.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("E₁ of 289 nodes") && svg.ends_with("</svg>\n"));
}
