//! `glint-bake report`: tables and a plot with a row for every setting, and refusals before any work.

use crate::bad_input::tagged_srgb;
use crate::support::bake;
use glint_bake::input::synthetic;
use std::fs;

#[test]
fn a_report_has_its_tables_and_its_plot() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("leather.png");
    synthetic::leather(8, 8, 1).save(&path).unwrap();
    fs::write(&path, tagged_srgb(&fs::read(&path).unwrap())).unwrap();
    let report = ["report", "leather.png", "-o", ".", "--footprints", "1", "--crop", "4x4+2+1"];
    let refused = bake(folder.path(), &report);
    assert_eq!(refused.code, 4, "{}", refused.stderr);
    assert!(refused.stderr.contains("--assume-linear"), "{}", refused.stderr);
    bake(folder.path(), &[&report[..], &["--assume-linear"]].concat()).ok();
    let text = fs::read_to_string(folder.path().join("ACCURACY.md")).unwrap();
    for part in ["## leather, 4 × 4", "the paper's layout", "| tiled | 0.5 | 1 |", "| stochastic | 32 | 4 |", "★"] {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
    let plot = fs::read_to_string(folder.path().join("accuracy-leather.svg")).unwrap();
    assert!(plot.starts_with("<svg") && plot.trim_end().ends_with("</svg>"));
    // Eight settings at each of three roughnesses.
    assert_eq!(plot.matches("<circle").count(), 24);
}

#[test]
fn a_missing_folder_is_refused_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = bake(folder.path(), &["report", "none.png", "-o", "nowhere"]);
    assert_eq!(outcome.code, 3);
    assert!(outcome.stderr.contains("nowhere"), "{}", outcome.stderr);
}
