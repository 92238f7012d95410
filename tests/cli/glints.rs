//! `glint-bake glints`: what it writes, says, refuses, and leaves alone; what `glint-info` says of it.

use crate::support::Case;
use std::fs;

fn case() -> Case {
    Case { folder: tempfile::tempdir().unwrap(), args: &["glints", "-o", "out.glintpack"] }
}

#[test]
fn the_default_material_verifies_and_is_described() {
    let case = case();
    let done = case.bake(&[]).ok();
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert!(done.stderr.contains("1000000 facets a unit², 64.1 KiB"), "{}", done.stderr);
    assert!(done.stderr.contains("written"), "{}", done.stderr);
    case.verify();
    let report = case.report();
    let facets = &report["counted_facets"][0];
    assert_eq!((&facets["name"], &facets["gpu_bytes"]), (&"glints".into(), &65_664.into()));
    assert_eq!(facets["params"]["slopes"], "Ggx");
    assert_eq!(report["provenance"][0]["method"], "glints");
    let text = case.info(&[]).ok().stdout;
    for part in ["GLLT \"glints\"", "counted facets \"glints\"", "α 0.3 by 0.3", "1000000 facets a unit² on 100.0 %"]
    {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
}

#[test]
fn the_same_flags_give_the_same_bytes_on_any_number_of_threads() {
    let case = case();
    let one = case.same_on_any_threads();
    assert!(one != case.pack(&["--seed", "2"]));
}

#[test]
fn every_flag_is_taken_and_changes_what_it_says() {
    let case = case();
    let plain = case.pack(&[]);
    for (flags, field, value) in [
        (&["--target", "beckmann"][..], "slopes", serde_json::json!("Beckmann")),
        (&["--alpha", "0.5"], "alpha", serde_json::json!([0.5, 0.5])),
        (&["--alpha", "0.5,0.25"], "alpha", serde_json::json!([0.5, 0.25])),
        (&["--turn", "-180"], "turn", serde_json::json!(-std::f32::consts::PI)),
        (&["--f0", "0.5,0.25,0"], "f0", serde_json::json!([0.5, 0.25, 0.0])),
        (&["--density", "1e16"], "density", serde_json::json!(1e16f32)),
        (&["--relative-area", "0.5"], "relative_area", serde_json::json!(0.5)),
        (&["--facet-spread", "28"], "facet_spread", serde_json::json!(28f64.to_radians() as f32)),
        (&["--sky-spread", "180"], "sky_spread", serde_json::json!(std::f32::consts::PI)),
        (
            &["--colour", "1,0.5,0", "--colour", "0,0.5,1"],
            "colours",
            serde_json::json!([[1.0, 0.5, 0.0], [0.0, 0.5, 1.0]]),
        ),
        (&["--diffuse", "0.5,0.25,0"], "diffuse", serde_json::json!([0.5, 0.25, 0.0])),
        (&["--coat", "0.5"], "coat", serde_json::json!(0.5)),
        (&["--coat-alpha", "0.25"], "coat_alpha", serde_json::json!(0.25)),
        (&["--seed", "4294967295"], "seed", serde_json::json!(4_294_967_295u32)),
    ] {
        assert!(case.pack(flags) != plain, "{flags:?}");
        case.verify();
        let found = &case.report()["counted_facets"][0]["params"][field];
        let near = match (found.as_f64(), value.as_f64()) {
            (Some(found), Some(value)) => (found - value).abs() <= 1e-6 * value.abs(),
            _ => *found == value,
        };
        assert!(near, "{flags:?}: {found}, expected {value}");
    }
    assert!(case.pack(&["--compress"]).len() < plain.len());
    case.bake(&["--name", "flakes"]).ok();
    assert_eq!(case.report()["counted_facets"][0]["name"], "flakes");
}

#[test]
fn what_cannot_work_is_refused_by_the_name_of_its_flag() {
    let case = case();
    for (flag, value, code) in [
        ("--alpha", "0", 2),
        ("--alpha", "1.5", 2),
        ("--alpha", "0.0001", 2),
        ("--alpha", "0.1,nan", 2),
        ("--alpha", "0.1,0.2,0.3", 2),
        ("--turn", "181", 2),
        ("--f0", "1.1,0,0", 2),
        ("--f0", "0.5", 2),
        ("--density", "0", 2),
        ("--density", "-1", 2),
        ("--density", "1e17", 2),
        ("--relative-area", "1.01", 2),
        ("--facet-spread", "0.001", 2),
        ("--facet-spread", "60", 2),
        ("--sky-spread", "-1", 2),
        ("--sky-spread", "181", 2),
        ("--colour", "2,0,0", 2),
        ("--diffuse", "1.5,0,0", 2),
        ("--diffuse", "0.5", 2),
        ("--coat", "1.01", 2),
        ("--coat", "-0.5", 2),
        ("--coat-alpha", "0", 2),
        ("--coat-alpha", "0.0001", 2),
        ("--coat-alpha", "1.5", 2),
        ("--target", "phong", 2),
        ("--seed", "-1", 2),
        ("--max-memory", "1K", 6),
    ] {
        case.refuses(&[flag, value], code, flag);
    }
    let many: Vec<&str> = (0..257).flat_map(|_| ["--colour", "1,1,1"]).collect();
    case.refuses(&many, 2, "--colour");
    assert!(case.names().is_empty());
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let case = case();
    let done = case.bake(&["-n", "--report", "r.json", "--depfile", "d"]).ok();
    assert!(done.stderr.contains("64 KiB of tables; dry run, nothing was written"), "{}", done.stderr);
    assert!(case.names().is_empty());
}

#[test]
fn report_depfile_and_json_are_written_and_quiet_is_quiet() {
    case().check_outputs(&[]);
}

#[test]
fn the_plot_shows_facets_and_contrast_by_the_size_of_a_pixel() {
    let case = case();
    case.bake(&[]).ok();
    case.info(&["--plot", "plots", "-q"]).ok();
    let svg = fs::read_to_string(case.path("plots/0-glints-facets.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    assert!(svg.contains("facets lit") && svg.contains("60°") && !svg.contains("NaN") && !svg.contains("inf"));
}
