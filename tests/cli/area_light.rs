//! `glint-bake area-light`: what it writes, says, refuses, and leaves alone; what `glint-info` says of it.

use crate::support::{Case, bake, maps};

fn case() -> Case {
    Case { folder: maps(), args: &["area-light", "scratches.png", "-o", "out.glintpack"] }
}

#[test]
fn a_map_becomes_a_pack_that_verifies_and_is_described() {
    let case = case();
    let done = case.bake(&["--anisotropic", "--base-roughness", "0.05"]).ok();
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert!(done.stderr.contains("scratches: 16 × 8 texels, 5 mips"), "{}", done.stderr);
    case.verify();

    let report = case.report();
    let material = &report["area_lights"][0];
    assert_eq!((&material["name"], &material["storage"]), (&"scratches".into(), &"f16".into()));
    assert_eq!((&material["map_bytes"], &material["table_bytes"]), (&(171 * 16).into(), &(64 * 1024).into()));
    let measured = |name: &str| material["measured"][name].as_f64().unwrap();
    assert!(measured("normal_angle") < 1e-3 && measured("roughness") < 5e-3, "{material}");
    let top = |name: &str| material["top"][name].as_f64().unwrap();
    assert!(
        top("length") <= 1.0 && top("alpha_minor") < top("alpha") && top("alpha") < top("alpha_major"),
        "{material}"
    );
    assert_eq!(report["provenance"][0]["method"], "area-light");
    assert_eq!(report["provenance"][0]["options"][0], serde_json::json!(["base-roughness", "0.05"]));

    let text = case.info(&[]).ok().stdout;
    for part in
        ["ALNM \"scratches\"", "R16G16B16A16_SFLOAT 16 × 8, 5 mips", "base α 0.05, meso anisotropic", "LTC tables"]
    {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
}

#[test]
fn the_same_flags_give_the_same_bytes_on_any_number_of_threads() {
    let case = case();
    let one = case.same_on_any_threads();
    assert!(case.bake(&[]).ok().stderr.contains("unchanged"));
    assert!(one != case.pack(&["--format", "snorm8"]) && one != case.pack(&["--wrap", "clamp"]));
}

#[test]
fn every_flag_is_taken() {
    let case = case();
    let flags =
        ["--name", "Kratzer", "--crop", "5x3+2+1", "--normal-y", "down", "--channels", "xy", "--format", "snorm8"];
    case.bake(&[&flags[..], &["--compress", "--assume-linear", "--anisotropic"]].concat()).ok();
    let report = case.report();
    let material = &report["area_lights"][0];
    assert_eq!((&material["name"], &material["width"], &material["height"]), (&"Kratzer".into(), &5.into(), &3.into()));
    assert_eq!(material["storage"], "snorm8");
    let coloured = case.bake(&["--height", "2"]);
    assert!(coloured.code == 4 && coloured.stderr.contains("--height"), "{}", coloured.stderr);
    case.bake(&["--crop", "1x1+0+0"]).ok();
    case.verify();
}

#[test]
fn what_cannot_work_is_refused_by_the_name_of_its_flag() {
    let case = case();
    for (flag, value, code) in [
        ("--base-roughness", "0", 2),
        ("--base-roughness", "-0.1", 2),
        ("--base-roughness", "1.01", 2),
        ("--base-roughness", "0.0009", 2),
        ("--base-roughness", "nan", 2),
        ("--format", "u8", 2),
        ("--name", "", 2),
        ("--max-memory", "3K", 6),
    ] {
        case.refuses(&[flag, value], code, flag);
    }
    case.refuses(&["--crop", "99x99+0+0"], 4, "crop");
    assert_eq!(bake(case.folder.path(), &["area-light", "none.png", "-o", "out.glintpack"]).code, 3);
    assert_eq!(bake(case.folder.path(), &["area-light", "scratches.png", "-o", "scratches.png"]).code, 2);
    assert_eq!(case.names(), ["flakes.png", "scratches.png"]);
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let case = case();
    let done = case.bake(&["-n", "--report", "r.json", "--depfile", "d"]).ok();
    assert!(done.stderr.contains("16 × 8 texels, 5 mips, 1.3 KiB; dry run, nothing was written"), "{}", done.stderr);
    assert_eq!(case.names(), ["flakes.png", "scratches.png"]);
}

#[test]
fn report_depfile_and_json_are_written_and_quiet_is_quiet() {
    case().check_outputs(&["scratches.png"]);
}

#[test]
fn fine_mips_can_be_left_out() {
    use glint_formats::area_light::NORMALS;
    use glint_formats::{Limits, Pack};
    let case = case();
    let normals = |flags: &[&str]| {
        let bytes = case.pack(flags);
        case.verify();
        let pack = Pack::from_bytes(bytes, &Limits::default()).unwrap();
        pack.payload(pack.find(NORMALS, "scratches").unwrap()).unwrap().to_vec()
    };
    // 16 × 8, 8 × 4, 4 × 2, 2 × 1, 1 × 1 texels of 8 bytes.
    let (all, some, last) = (normals(&[]), normals(&["--skip-mips", "2"]), normals(&["--skip-mips", "14"]));
    assert_eq!((all.len(), some.len(), last.len()), (8 * 171, 8 * 11, 8));
    assert!(all.ends_with(&some) && all.ends_with(&last));
    case.refuses(&["--skip-mips", "15"], 2, "--skip-mips");
    let done = case.bake(&["--skip-mips", "1", "-n"]).ok();
    assert!(done.stderr.contains("8 × 4 texels, 4 mips, 0.3 KiB"), "{}", done.stderr);
}
