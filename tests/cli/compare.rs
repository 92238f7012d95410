//! `glint-info --diff`, `--extract` and the pictures of environments and area lights.

use crate::schema::check_against;
use crate::support::{bake, info, json, packs, root};
use glint_formats::{Limits, Pack};
use serde_json::{Value, json as value};
use std::fs;
use std::path::Path;

/// The JSON of a comparison that finds a difference, checked against its schema.
#[track_caller]
fn differences(folder: &Path, a: &str, b: &str) -> Value {
    let done = info(folder, &["--diff", a, b, "--json"]);
    assert_eq!(done.code, 7, "{}", done.stderr);
    let diff = json(&done.stdout);
    check_against("glint-diff.schema.json", &diff, &format!("{a} {b}"));
    assert_eq!((&diff["a"]["file"], &diff["b"]["file"], &diff["equal"]), (&a.into(), &b.into(), &false.into()));
    diff
}

/// The change of a field, as (before, after).
#[track_caller]
fn field(diff: &Value, kind: &str, field: &str) -> (Value, Value) {
    let fields = diff["fields"].as_array().unwrap();
    let found = fields.iter().find(|change| change["kind"] == kind && change["field"] == field);
    let found = found.unwrap_or_else(|| panic!("{kind} {field} is not among {fields:#?}"));
    (found["a"].clone(), found["b"].clone())
}

#[track_caller]
fn section<'a>(diff: &'a Value, kind: &str) -> &'a Value {
    let sections = diff["sections"].as_array().unwrap();
    sections.iter().find(|change| change["kind"] == kind).unwrap_or_else(|| panic!("{kind}: {sections:#?}"))
}

#[test]
fn equal_packs_are_said_to_be_equal() {
    let (folder, names) = packs();
    for name in names {
        fs::copy(folder.path().join(name), folder.path().join("copy.glintpack")).unwrap();
        let done = info(folder.path(), &["--diff", name, "copy.glintpack"]).ok();
        assert!(done.stdout.contains("the packs are equal"), "{}", done.stdout);
        let diff = json(&info(folder.path(), &[name, "--diff", "copy.glintpack", "--json"]).ok().stdout);
        check_against("glint-diff.schema.json", &diff, name);
        assert_eq!((&diff["equal"], &diff["sections"]), (&true.into(), &value!([])));
    }
}

#[test]
fn options_parameters_and_texels_that_differ_are_named() {
    let (folder, _) = packs();
    bake(folder.path(), &["dictionary", "--marginals", "3", "--lobe-std", "0.03", "-o", "wide.glintpack"]).ok();
    let diff = differences(folder.path(), "dictionary.glintpack", "wide.glintpack");
    assert_eq!(field(&diff, "PROV", "options.lobe-std"), ("0.02".into(), "0.03".into()));
    assert_eq!(field(&diff, "SDPP", "lobe_std"), (0.02.into(), 0.03.into()));
    let table = section(&diff, "SDTB");
    assert_eq!(table["differs"], value!(["payload"]));
    assert_ne!(table["a"]["xxh3_128"], table["b"]["xxh3_128"]);
    assert_eq!(table["records"]["records"], table["a"]["resource"]["count"]);

    // The numbers, from the texels themselves.
    let sky =
        ["environment", "sky.hdr", "--face-size", "8", "--min-face-size", "2", "--coloured", "--kernel", "ggx-nl"];
    bake(folder.path(), &[&sky[..], &["-o", "nl.glintpack"]].concat()).ok();
    let cubes = differences(folder.path(), "sky.glintpack", "nl.glintpack");
    let radiance = section(&cubes, "ENRA");
    let values = |name: &str| -> Vec<f64> {
        let pack = Pack::open(folder.path().join(name), &Limits::default()).unwrap();
        let entry = pack.sections().iter().find(|entry| entry.kind.to_string() == "ENRA").unwrap();
        let bytes = pack.payload(entry).unwrap();
        bytes.chunks(2).map(|pair| half::f16::from_le_bytes([pair[0], pair[1]]).to_f64()).collect()
    };
    let (a, b) = (values("sky.glintpack"), values("nl.glintpack"));
    let apart: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).collect();
    let max = apart.iter().copied().fold(0.0, f64::max);
    let found = &radiance["texels"];
    assert!(max > 0.0);
    assert_eq!((found["max"].as_f64(), &found["texels"]), (Some(max), &(a.len() / 4).into()));
    let mean = apart.iter().sum::<f64>() / a.len() as f64;
    assert!((found["mean"].as_f64().unwrap() - mean).abs() <= 1e-12 * mean);
    let [mip, layer, face, column, row, component] =
        [0, 1, 2, 3, 4, 5].map(|k| found["max_at"][k].as_u64().unwrap() as usize);
    let edge = 4 >> mip;
    let texels_before: usize = (0..mip).map(|mip| 4 * 6 * (4 >> mip) * (4 >> mip)).sum();
    let texel = texels_before + ((6 * layer + face) * edge + row) * edge + column;
    assert_eq!(apart[4 * texel + component], max);

    let text = info(folder.path(), &["--diff", "dictionary.glintpack", "wide.glintpack"]);
    for part in
        ["a: dictionary.glintpack", "options.lobe-std", "0.02 → 0.03", "SDTB \"dictionary\": payload", "records differ"]
    {
        assert!(text.stdout.contains(part), "{part} is missing from:\n{}", text.stdout);
    }
    let quiet = info(folder.path(), &["--diff", "dictionary.glintpack", "wide.glintpack", "-q"]);
    assert_eq!((quiet.code, quiet.stdout.as_str()), (7, ""));
}

#[test]
fn sections_of_one_pack_records_and_codecs_are_named() {
    let (folder, _) = packs();
    let diff = differences(folder.path(), "layered.glintpack", "tiled.glintpack");
    assert_eq!((&section(&diff, "LAYR")["b"], &section(&diff, "PLNO")["b"]), (&Value::Null, &Value::Null));
    assert_eq!(field(&diff, "NMPP", "finest_variance"), (0.36.into(), 1.0.into()));
    assert_eq!(section(&diff, "NMDE")["differs"], value!(["codec", "resource", "payload"]));
    let uniform = &section(&diff, "NMUB")["records"];
    assert_eq!((&uniform["records"], &uniform["first"]), (&1.into(), &0.into()));

    bake(folder.path(), &["dictionary", "--marginals", "3", "--compress", "-o", "small.glintpack"]).ok();
    let diff = differences(folder.path(), "dictionary.glintpack", "small.glintpack");
    for kind in ["SDPP", "SDUB", "SDTB"] {
        let change = section(&diff, kind);
        assert_eq!(change["differs"], value!(["codec"]));
        assert_eq!(change["a"]["xxh3_128"], change["b"]["xxh3_128"]);
    }
    assert_eq!(diff["sections"].as_array().unwrap().len(), 3);
}

#[test]
fn inputs_that_differ_are_named_by_digest() {
    let (folder, _) = packs();
    for (map, pack) in [("flakes.png", "a.glintpack"), ("scratches.png", "b.glintpack")] {
        fs::rename(folder.path().join(map), folder.path().join("map.png")).unwrap();
        bake(folder.path(), &["ndf-maps", "map.png", "--crop", "8x8+0+0", "-o", pack]).ok();
    }
    let diff = differences(folder.path(), "a.glintpack", "b.glintpack");
    let (a, b) = field(&diff, "PROV", "inputs.map.png.xxh3_128");
    assert_eq!((a.as_str().unwrap().len(), b.as_str().unwrap().len()), (32, 32));
}

#[test]
fn a_pack_that_cannot_be_used_is_not_compared() {
    let (folder, _) = packs();
    let bad = root().join("fixtures/corrupt/G1027/bad.glintpack");
    for (a, b, code, cause) in
        [("sky.glintpack", bad.to_str().unwrap(), 4, "G1027"), ("none.glintpack", "sky.glintpack", 3, "none.glintpack")]
    {
        let done = info(folder.path(), &["--diff", a, b, "--json"]);
        assert_eq!(done.code, code, "{}", done.stderr);
        assert!(done.stderr.contains(cause), "{}", done.stderr);
        let diff = json(&done.stdout);
        check_against("glint-diff.schema.json", &diff, a);
        assert!(diff["equal"].is_null());
    }
}

#[test]
fn sections_are_extracted_decompressed() {
    let (folder, names) = packs();
    for name in names {
        let pack = Pack::open(folder.path().join(name), &Limits::default()).unwrap();
        for entry in pack.sections() {
            let section = format!("{}:{}", entry.kind, entry.name);
            info(folder.path(), &[name, "--extract", &section, "-o", "out.bin"]).ok();
            assert!(fs::read(folder.path().join("out.bin")).unwrap() == *pack.payload(entry).unwrap(), "{section}");
        }
    }
    let done = info(folder.path(), &["sky.glintpack", "--extract", "ENRA", "--output", "enra.bin"]).ok();
    assert!(done.stderr.contains("enra.bin: written") && done.stdout.is_empty(), "{}", done.stderr);
}

#[test]
fn what_cannot_be_extracted_is_refused() {
    let (folder, _) = packs();
    let path = |name: &str| folder.path().join(name);
    let bytes = fs::read(path("layered.glintpack")).unwrap();
    fs::write(path("cut.glintpack"), &bytes[..bytes.len() - 1]).unwrap();
    for (args, code, cause) in [
        (&["layered.glintpack", "--extract", "NMDE", "-o", "x"][..], 2, "NMDE:flakes, NMDE:scratches; say which"),
        (&["layered.glintpack", "--extract", "ENRA", "-o", "x"], 2, "expected one of PROV, NMPP:flakes"),
        (&["layered.glintpack", "--extract", "NMDE:gold", "-o", "x"], 2, "found NMDE:gold"),
        (&["layered.glintpack", "--extract", "PROV"], 2, "--output"),
        (&["layered.glintpack", "-o", "x"], 2, "--extract"),
        (&["layered.glintpack", "--extract", "PROV", "-o", "layered.glintpack"], 2, "an input as well"),
        (&["layered.glintpack", "--extract", "PROV", "-o", "none/x"], 3, "none/x"),
        (&["cut.glintpack", "--extract", "PROV", "-o", "x"], 4, "G1005"),
    ] {
        let refused = info(folder.path(), args);
        assert_eq!(refused.code, code, "{args:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(cause), "{args:?}: {}", refused.stderr);
    }
    assert!(!path("x").exists());
    assert!(fs::read(path("layered.glintpack")).unwrap() == bytes);
}

#[test]
fn environments_and_area_lights_have_pictures() {
    let (folder, _) = packs();
    let picture = |name: &str| image::open(folder.path().join("plots").join(name)).unwrap().to_rgb8();
    info(folder.path(), &["sky.glintpack", "--plot", "plots", "-q"]).ok();
    let radiance = picture("0-sky-radiance.png");
    // Six faces a row; the mirror of 8 texels, and all of the eight roughnesses on faces of 4 and 2.
    assert_eq!(radiance.dimensions(), (6 * 130 + 2, 9 * 130 + 2));
    // The sun stands above the horizon, to the right of −Z, which is the last face; the sky is blue, the sun is not.
    let mean = |face: u32, row: u32| {
        let at = |x: u32, y: u32| radiance.get_pixel(2 + 130 * face + x, 2 + 130 * row + y).0.map(u64::from);
        let all = (0..128 * 128).map(|i| at(i % 128, i / 128));
        all.fold([0; 3], |sum, pixel| [sum[0] + pixel[0], sum[1] + pixel[1], sum[2] + pixel[2]])
    };
    let up = mean(2, 0);
    assert!(up[2] > up[0], "the zenith is blue: {up:?}");
    assert!(mean(3, 0)[2] < up[2], "the ground is less so");
    // Levels: the dark one takes almost all, and adds up to white with the rest where there is no tint.
    assert_eq!(picture("0-sky-levels.png").dimensions(), (12 * 130 + 2, 4 * 130 + 2));

    info(folder.path(), &["light.glintpack", "--plot", "plots", "-q"]).ok();
    for what in ["mean-normals", "roughness", "directions"] {
        let sheet = picture(&format!("0-scratches-{what}.png"));
        // 16 × 8 texels, 5 mips, four a row.
        assert_eq!(sheet.dimensions(), (4 * 196 + 4, 2 * 100 + 4), "{what}");
    }
    // The last mip is one texel: its square is of one colour.
    let normals = picture("0-scratches-mean-normals.png");
    let last = |x: u32, y: u32| *normals.get_pixel(4 + x, 104 + y);
    assert_eq!((last(0, 0), last(100, 50)), (last(191, 95), last(191, 95)));
    info(folder.path(), &["snorm.glintpack", "--plot", "plots", "-q"]).ok();
    assert!(!folder.path().join("plots/0-flakes-directions.png").exists(), "an isotropic material has no directions");
}
