//! `glint-bake lobes`: what it writes, says, refuses, and leaves alone; what `glint-info` says of it.

use crate::support::{Case, bake, maps};

fn case() -> Case {
    Case { folder: maps(), args: &["lobes", "scratches.png", "-o", "out.glintpack"] }
}

#[test]
fn a_map_becomes_a_pack_that_verifies_and_is_described() {
    let case = case();
    let done = case.bake(&[]).ok();
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert!(done.stderr.contains("scratches: 16 × 8 texels, 1 level, lobes 1.0 KiB"), "{}", done.stderr);
    case.verify();

    let report = case.report();
    let lobes = &report["lobes"][0];
    assert_eq!(
        (&lobes["name"], &lobes["merge"], &lobes["levels"]),
        (&"scratches".into(), &"runnalls".into(), &1.into())
    );
    // Two cells of 8 texels.
    assert_eq!(lobes["lobe_bytes"], 2 * 32 * 16);
    let error = lobes["measured"][0]["mean"].as_f64().unwrap();
    assert!(error > 0.0 && error < 0.1, "{lobes}");
    assert_eq!(report["provenance"][0]["method"], "lobes");
    assert_eq!(report["provenance"][0]["options"][0], serde_json::json!(["roughness", "0.02"]));

    case.info(&["--plot", "plots", "-q"]).ok();
    assert_eq!(image::image_dimensions(case.path("plots/0-scratches-ndf.png")).unwrap(), (512, 512));

    let text = case.info(&[]).ok().stdout;
    for part in
        ["LOBE \"scratches\"", "64 × 16 bytes", "32 a cell, 1 level from 8 texels on", "runnalls from 4 a texel"]
    {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
}

#[test]
fn the_same_flags_give_the_same_bytes_on_any_number_of_threads() {
    let case = case();
    let one = case.same_on_any_threads();
    assert!(case.bake(&[]).ok().stderr.contains("unchanged"));
    assert!(one != case.pack(&["--storage", "f16"]) && one != case.pack(&["--wrap", "clamp"]));
}

#[test]
fn every_flag_is_taken() {
    let case = case();
    let flags = ["--name", "Kratzer", "--crop", "5x3+2+1", "--normal-y", "down", "--channels", "xy", "--k", "7"];
    let more = ["--cell", "4", "--merge", "kmeans", "--seeds", "1", "--nearest", "--normals", "8", "--seed", "5"];
    let rest = ["--storage", "f16", "--compress", "--assume-linear", "--max-error", "2", "--roughness", "0.1"];
    case.bake(&[&flags[..], &more, &rest].concat()).ok();
    let report = case.report();
    let lobes = &report["lobes"][0];
    assert_eq!((&lobes["name"], &lobes["width"], &lobes["height"]), (&"Kratzer".into(), &5.into(), &3.into()));
    assert_eq!(
        (&lobes["storage"], &lobes["filter"], &lobes["normal_bits"]),
        (&"f16".into(), &"nearest".into(), &8.into())
    );
    assert_eq!((&lobes["merge"], &lobes["lobes_per_cell"], &lobes["seeds"]), (&"kmeans".into(), &7.into(), &1.into()));
    case.refuses(&["--height", "2"], 4, "--height");
    case.bake(&["--crop", "1x1+0+0"]).ok();
    case.verify();
}

#[test]
fn an_error_that_is_missed_fails_and_writes_nothing() {
    let case = case();
    case.refuses(&["--max-error", "0.00001"], 6, "E1 of 0.00001");
    case.refuses(&["--max-error", "0.00001"], 6, "nothing was written");
    assert_eq!(case.names(), ["flakes.png", "scratches.png"]);
    case.bake(&["--max-error", "0.5"]).ok();
}

#[test]
fn what_cannot_work_is_refused_by_the_name_of_its_flag() {
    let case = case();
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
        ("--max-memory", "1K", 6),
    ] {
        case.refuses(&[&format!("{flag}={value}")], code, flag);
    }
    case.refuses(&["--crop", "99x99+0+0"], 4, "crop");
    assert_eq!(bake(case.folder.path(), &["lobes", "none.png", "-o", "out.glintpack"]).code, 3);
    assert_eq!(bake(case.folder.path(), &["lobes", "scratches.png", "-o", "scratches.png"]).code, 2);
    assert_eq!(case.names(), ["flakes.png", "scratches.png"]);
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let case = case();
    let done = case.bake(&["-n", "--report", "r.json", "--depfile", "d"]).ok();
    let said = "16 × 8 texels, 32 lobes a cell of 8 texels, 2.9 KiB at most; dry run, nothing was written";
    assert!(done.stderr.contains(said), "{}", done.stderr);
    assert_eq!(case.names(), ["flakes.png", "scratches.png"]);
}

#[test]
fn report_depfile_and_json_are_written_and_quiet_is_quiet() {
    case().check_outputs(&["scratches.png"]);
}
