//! `glint-bake area-light`: what it writes, says, refuses, and leaves alone; what `glint-info` says of it.

use crate::support::{bake, info, json, maps};
use std::fs;
use std::path::Path;

const DEFAULT: [&str; 4] = ["area-light", "scratches.png", "-o", "out.glintpack"];

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_map_becomes_a_pack_that_verifies_and_is_described() {
    let folder = maps();
    let done = bake(folder.path(), &[&DEFAULT[..], &["--anisotropic", "--base-roughness", "0.05"]].concat()).ok();
    assert!(done.stdout.is_empty(), "{}", done.stdout);
    assert!(done.stderr.contains("scratches: 16 × 8 texels, 5 mips"), "{}", done.stderr);
    assert_eq!(info(folder.path(), &["out.glintpack", "--verify"]).ok().stdout, "out.glintpack: intact\n");

    let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
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

    let text = info(folder.path(), &["out.glintpack"]).ok().stdout;
    for part in
        ["ALNM \"scratches\"", "R16G16B16A16_SFLOAT 16 × 8, 5 mips", "base α 0.05, meso anisotropic", "LTC tables"]
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
    assert!(one != pack_of(&["--format", "snorm8"]) && one != pack_of(&["--wrap", "clamp"]));
}

#[test]
fn every_flag_is_taken() {
    let folder = maps();
    let flags =
        ["--name", "Kratzer", "--crop", "5x3+2+1", "--normal-y", "down", "--channels", "xy", "--format", "snorm8"];
    bake(folder.path(), &[&DEFAULT[..], &flags, &["--compress", "--assume-linear", "--anisotropic"]].concat()).ok();
    let report = json(&info(folder.path(), &["out.glintpack", "--json"]).ok().stdout);
    let material = &report["area_lights"][0];
    assert_eq!((&material["name"], &material["width"], &material["height"]), (&"Kratzer".into(), &5.into(), &3.into()));
    assert_eq!(material["storage"], "snorm8");
    let coloured = bake(folder.path(), &[&DEFAULT[..], &["--height", "2"]].concat());
    assert!(coloured.code == 4 && coloured.stderr.contains("--height"), "{}", coloured.stderr);
    bake(folder.path(), &[&DEFAULT[..], &["--crop", "1x1+0+0"]].concat()).ok();
    assert_eq!(info(folder.path(), &["out.glintpack", "--verify"]).ok().stdout, "out.glintpack: intact\n");
}

#[test]
fn what_cannot_work_is_refused_by_the_name_of_its_flag() {
    let folder = maps();
    for (flag, value, code) in [
        ("--base-roughness", "0", 2),
        ("--base-roughness", "-0.1", 2),
        ("--base-roughness", "1.01", 2),
        ("--base-roughness", "0.0009", 2),
        ("--base-roughness", "nan", 2),
        ("--format", "u8", 2),
        ("--name", "", 2),
        ("--crop", "99x99+0+0", 4),
        ("--max-memory", "3K", 6),
    ] {
        let refused = bake(folder.path(), &[&DEFAULT[..], &[flag, value]].concat());
        assert_eq!(refused.code, code, "{flag} {value}: {}", refused.stderr);
        let named = refused.stderr.contains(flag) || refused.stderr.contains("crop");
        assert!(named, "{flag} {value}: {}", refused.stderr);
    }
    assert_eq!(bake(folder.path(), &["area-light", "none.png", "-o", "out.glintpack"]).code, 3);
    assert_eq!(bake(folder.path(), &["area-light", "scratches.png", "-o", "scratches.png"]).code, 2);
    assert_eq!(names_in(folder.path()), ["flakes.png", "scratches.png"]);
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let folder = maps();
    let done = bake(folder.path(), &[&DEFAULT[..], &["-n", "--report", "r.json", "--depfile", "d"]].concat()).ok();
    assert!(done.stderr.contains("16 × 8 texels, 5 mips, 1.3 KiB; dry run, nothing was written"), "{}", done.stderr);
    assert_eq!(names_in(folder.path()), ["flakes.png", "scratches.png"]);
}

#[test]
fn report_depfile_and_json_are_written_and_quiet_is_quiet() {
    let folder = maps();
    let flags = ["--json", "--report", "r.json", "--depfile", "out.d", "-q"];
    let done = bake(folder.path(), &[&DEFAULT[..], &flags].concat()).ok();
    assert!(done.stderr.is_empty(), "{}", done.stderr);
    let printed = info(folder.path(), &["out.glintpack", "--json"]).ok().stdout;
    assert_eq!(done.stdout, printed);
    assert_eq!(fs::read_to_string(folder.path().join("r.json")).unwrap(), printed);
    assert_eq!(fs::read_to_string(folder.path().join("out.d")).unwrap(), "out.glintpack: \\\n  scratches.png\n");
}

#[test]
fn fine_mips_can_be_left_out() {
    use glint_formats::area_light::NORMALS;
    use glint_formats::{Limits, Pack};
    let folder = maps();
    let normals = |flags: &[&str]| {
        bake(folder.path(), &[&DEFAULT[..], flags].concat()).ok();
        info(folder.path(), &["out.glintpack", "--verify"]).ok();
        let bytes = fs::read(folder.path().join("out.glintpack")).unwrap();
        let pack = Pack::from_bytes(bytes, &Limits::default()).unwrap();
        pack.payload(pack.find(NORMALS, "scratches").unwrap()).unwrap().to_vec()
    };
    // 16 × 8, 8 × 4, 4 × 2, 2 × 1, 1 × 1 texels of 8 bytes.
    let (all, some, last) = (normals(&[]), normals(&["--skip-mips", "2"]), normals(&["--skip-mips", "14"]));
    assert_eq!((all.len(), some.len(), last.len()), (8 * 171, 8 * 11, 8));
    assert!(all.ends_with(&some) && all.ends_with(&last));
    assert_eq!(bake(folder.path(), &[&DEFAULT[..], &["--skip-mips", "15"]].concat()).code, 2);
    let done = bake(folder.path(), &[&DEFAULT[..], &["--skip-mips", "1", "-n"]].concat()).ok();
    assert!(done.stderr.contains("8 × 4 texels, 4 mips, 0.3 KiB"), "{}", done.stderr);
}
