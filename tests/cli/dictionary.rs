//! `glint-bake dictionary`: what it writes, says, refuses, and leaves alone; what `glint-info` says of it.

use crate::support::{bake, info, json};
use std::fs;
use std::path::Path;

const DEFAULT: [&str; 3] = ["dictionary", "-o", "out.glintpack"];

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn the_default_dictionary_verifies_and_is_described() {
    let folder = folder();
    let done = bake(folder.path(), &DEFAULT).ok();
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert!(done.stderr.contains("192 marginals × 16 levels × 64 entries, 384 KiB"), "{}", done.stderr);
    assert!(done.stderr.contains("written"), "{}", done.stderr);
    assert_eq!(info(folder.path(), &["out.glintpack", "--verify"]).ok().stdout, "out.glintpack: intact\n");

    let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
    let dictionary = &report["dictionaries"][0];
    assert_eq!((&dictionary["name"], &dictionary["table_bytes"]), (&"dictionary".into(), &(384 * 1024).into()));
    let measured = |name: &str| dictionary["measured"][name].as_f64().unwrap();
    assert!(measured("normalisation") <= 1e-4);
    assert!(measured("mean_l1_first_level") <= 0.03);
    assert!(measured("ks_last_level") <= 0.0019);
    assert_eq!(report["provenance"][0]["method"], "dictionary");
    assert_eq!(report["provenance"][0]["options"][0], serde_json::json!(["marginals", "192"]));

    let text = info(folder.path(), &["out.glintpack"]).ok().stdout;
    for part in ["SDTB \"dictionary\"", "R16_SFLOAT 64 × 3072", "192 marginals", "α 0.5", "KS to the target 0.001"] {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
}

#[test]
fn the_same_flags_give_the_same_bytes_on_any_number_of_threads() {
    let folder = folder();
    let pack_of = |flags: &[&str]| {
        bake(folder.path(), &[&DEFAULT[..], flags].concat()).ok();
        fs::read(folder.path().join("out.glintpack")).unwrap()
    };
    let one = pack_of(&["-j", "1"]);
    assert!(one == pack_of(&["-j", "2"]) && one == pack_of(&["-j", "7"]) && one == pack_of(&[]));
    assert!(one != pack_of(&["--seed", "1"]));
}

#[test]
fn an_unchanged_pack_keeps_its_time_stamp() {
    let folder = folder();
    let path = folder.path().join("out.glintpack");
    bake(folder.path(), &DEFAULT).ok();
    let before = fs::metadata(&path).unwrap().modified().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(20));
    assert!(bake(folder.path(), &DEFAULT).ok().stderr.contains("unchanged"));
    assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), before);
}

#[test]
fn every_flag_is_taken_and_the_smallest_and_largest_verify() {
    let folder = folder();
    for flags in [
        &["--marginals", "1", "--levels", "1", "--entries", "3", "--lobe-std", "0.17", "--seed", "9"][..],
        &["--marginals", "12", "--levels", "12", "--alpha-dict", "10", "--lobe-std", "0.3", "--compress"],
        &["--marginals", "400", "--levels", "2", "--entries", "8192"],
        &["--marginals", "5", "--alpha-dict", "0.01", "--lobe-std", "0.0004"],
        &["--marginals", "9", "--levels", "2", "--alpha-dict", "0.01", "--lobe-std", "0.00001", "--entries", "2048"],
    ] {
        bake(folder.path(), &[&DEFAULT[..], flags].concat()).ok();
        info(folder.path(), &["out.glintpack", "--verify"]).ok();
    }
}

#[test]
fn what_cannot_work_is_refused_by_the_name_of_its_flag() {
    let folder = folder();
    for (flag, value, code) in [
        ("--marginals", "0", 2),
        ("--marginals", "-1", 2),
        ("--levels", "0", 2),
        ("--levels", "21", 2),
        ("--entries", "0", 2),
        ("--entries", "24", 2),
        ("--alpha-dict", "0", 2),
        ("--alpha-dict", "-0.5", 2),
        ("--alpha-dict", "nan", 2),
        ("--alpha-dict", "11", 2),
        ("--lobe-std", "0", 2),
        ("--lobe-std", "0.000009", 2),
        ("--lobe-std", "0.0001", 2),
        ("--lobe-std", "0.36", 2),
        ("--lobe-std", "2", 2),
        ("--lobe-std", "inf", 2),
        ("--seed", "x", 2),
        ("--marginals", "1000", 6),
        ("--max-memory", "1K", 6),
    ] {
        let refused = bake(folder.path(), &[&DEFAULT[..], &[flag, value]].concat());
        assert_eq!(refused.code, code, "{flag} {value}: {}", refused.stderr);
        assert!(refused.stderr.contains(flag), "{flag} {value}: {}", refused.stderr);
    }
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let folder = folder();
    let flags = ["-n", "--report", "r.json", "--depfile", "d"];
    let done = bake(folder.path(), &[&DEFAULT[..], &flags].concat()).ok();
    assert!(done.stderr.contains("384 KiB; dry run, nothing was written"), "{}", done.stderr);
    assert!(names_in(folder.path()).is_empty());
    assert_eq!(bake(folder.path(), &["dictionary", "-o", "none/out.glintpack", "-n"]).code, 3);
    assert_eq!(bake(folder.path(), &[&DEFAULT[..], &["--report", "out.glintpack"]].concat()).code, 2);
}

#[test]
fn report_depfile_and_json_are_written_and_quiet_is_quiet() {
    let folder = folder();
    let flags = ["--json", "--report", "r.json", "--depfile", "out.d", "-q"];
    let done = bake(folder.path(), &[&DEFAULT[..], &flags].concat()).ok();
    assert!(done.stderr.is_empty(), "{}", done.stderr);
    let printed = info(folder.path(), &["out.glintpack", "--json"]).ok().stdout;
    assert_eq!(done.stdout, printed);
    assert_eq!(fs::read_to_string(folder.path().join("r.json")).unwrap(), printed);
    assert_eq!(fs::read_to_string(folder.path().join("out.d")).unwrap(), "out.glintpack:\n");
    assert_eq!(names_in(folder.path()), ["out.d", "out.glintpack", "r.json"]);
}

#[test]
fn the_plot_has_a_panel_a_level() {
    let folder = folder();
    bake(folder.path(), &[&DEFAULT[..], &["--marginals", "12"]].concat()).ok();
    info(folder.path(), &["out.glintpack", "--plot", "plots", "-q"]).ok();
    let svg = fs::read_to_string(folder.path().join("plots/0-dictionary-marginals.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    for level in 0..16 {
        assert!(svg.contains(&format!("level {level}, {} lobes", 2 << level)), "level {level}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}
