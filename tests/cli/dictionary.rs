//! `glint-bake dictionary`: what it writes, says, refuses, and leaves alone; what `glint-info` says of it.

use crate::support::{Case, bake};
use std::fs;

fn case() -> Case {
    Case { folder: tempfile::tempdir().unwrap(), args: &["dictionary", "-o", "out.glintpack"] }
}

#[test]
fn the_default_dictionary_verifies_and_is_described() {
    let case = case();
    let done = case.bake(&[]).ok();
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert!(done.stderr.contains("192 marginals × 16 levels × 64 entries, 768 KiB"), "{}", done.stderr);
    assert!(done.stderr.contains("written"), "{}", done.stderr);
    case.verify();

    let report = case.report();
    let dictionary = &report["dictionaries"][0];
    assert_eq!((&dictionary["name"], &dictionary["table_bytes"]), (&"dictionary".into(), &(768 * 1024).into()));
    let measured = |name: &str| dictionary["measured"][name].as_f64().unwrap();
    assert!(measured("normalisation") <= 1e-4);
    assert!(measured("mean_l1_first_level") <= 0.03);
    assert!(measured("ks_last_level") <= 0.0019);
    assert_eq!(report["provenance"][0]["method"], "dictionary");
    assert_eq!(report["provenance"][0]["options"][0], serde_json::json!(["marginals", "192"]));

    let text = case.info(&[]).ok().stdout;
    for part in ["SDTB \"dictionary\"", "196608 × 4 bytes", "192 marginals", "α 0.5", "KS to the target 0.001"] {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
}

#[test]
fn the_same_flags_give_the_same_bytes_on_any_number_of_threads() {
    let case = case();
    let one = case.same_on_any_threads();
    assert!(one != case.pack(&["--seed", "1"]));
}

#[test]
fn an_unchanged_pack_keeps_its_time_stamp() {
    let case = case();
    let path = case.path("out.glintpack");
    case.bake(&[]).ok();
    let before = fs::metadata(&path).unwrap().modified().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(20));
    assert!(case.bake(&[]).ok().stderr.contains("unchanged"));
    assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), before);
}

#[test]
fn every_flag_is_taken_and_the_smallest_and_largest_verify() {
    let case = case();
    for flags in [
        &["--marginals", "1", "--levels", "1", "--entries", "3", "--lobe-std", "0.17", "--seed", "9"][..],
        &["--marginals", "12", "--levels", "12", "--alpha-dict", "10", "--lobe-std", "0.3", "--compress"],
        &["--marginals", "400", "--levels", "2", "--entries", "8192"],
        &["--marginals", "5", "--alpha-dict", "0.01", "--lobe-std", "0.0004"],
        &["--marginals", "9", "--levels", "2", "--alpha-dict", "0.01", "--lobe-std", "0.00001", "--entries", "2048"],
    ] {
        case.bake(flags).ok();
        case.verify();
    }
}

#[test]
fn what_cannot_work_is_refused_by_the_name_of_its_flag() {
    let case = case();
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
        case.refuses(&[flag, value], code, flag);
    }
    assert!(case.names().is_empty());
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let case = case();
    let flags = ["-n", "--report", "r.json", "--depfile", "d"];
    let done = case.bake(&flags).ok();
    assert!(done.stderr.contains("768 KiB; dry run, nothing was written"), "{}", done.stderr);
    assert!(case.names().is_empty());
    assert_eq!(bake(case.folder.path(), &["dictionary", "-o", "none/out.glintpack", "-n"]).code, 3);
    assert_eq!(case.bake(&["--report", "out.glintpack"]).code, 2);
}

#[test]
fn report_depfile_and_json_are_written_and_quiet_is_quiet() {
    case().check_outputs(&[]);
}

#[test]
fn the_plot_has_a_panel_a_level() {
    let case = case();
    case.bake(&["--marginals", "12"]).ok();
    case.info(&["--plot", "plots", "-q"]).ok();
    let svg = fs::read_to_string(case.path("plots/0-dictionary-marginals.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    for level in 0..16 {
        assert!(svg.contains(&format!("level {level}, {} lobes", 2 << level)), "level {level}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}
