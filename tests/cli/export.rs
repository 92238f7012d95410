//! `glint-bake export`: every resource of every method's pack as files, read back by other people's readers, byte for
//! byte; the JSON beside them; selections and refusals.

use crate::schema::check_against;
use crate::support::{bake, frozen_packs, json, packs};
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use glint_formats::export::{Texture, texel};
use glint_formats::{Limits, Pack};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The payload that a KTX2 file holds.
fn from_ktx2(file: &[u8], texture: &Texture) -> Vec<u8> {
    let reader = ktx2::Reader::new(file).unwrap();
    assert_eq!(reader.header().format.unwrap().value(), texture.vk_format);
    reader.levels().flat_map(|level| level.data.to_vec()).collect()
}

/// The payload that a DDS file holds, its images put in the order of a pack.
fn from_dds(file: &[u8], texture: &Texture) -> Vec<u8> {
    let dds = ddsfile::Dds::read(file).unwrap();
    let mut out = vec![0; texture.images().map(|image| image.range.len()).sum()];
    for layer in 0..texture.layers {
        for face in 0..texture.faces {
            let mut rest = dds.get_data(layer * texture.faces + face).unwrap();
            for mip in 0..texture.mips {
                let range = texture.image(mip, layer, face).range;
                out[range.clone()].copy_from_slice(&rest[..range.len()]);
                rest = &rest[range.len()..];
            }
        }
    }
    out
}

/// Says whether an EXR file has the numbers of the payload; that they give its bytes back is tested beside the writer.
fn check_exr(file: &Path, texture: &Texture, payload: &[u8]) {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let image = reader.all_attributes().from_file(file).unwrap();
    let layout = texel::layout(texture.vk_format).unwrap();
    assert_eq!(image.layer_data.len(), texture.images().count());
    for (part, image) in image.layer_data.iter().zip(texture.images()) {
        let channels = ["R", "G", "B", "A"].map(|name| part.channel_data.list.iter().find(|c| c.name.eq(name)));
        for (at, texel) in payload[image.range].chunks_exact(texture.texel_bytes()).enumerate() {
            for (channel, expected) in channels.iter().zip(layout.decode(texel)).take(layout.components) {
                let found = match &channel.unwrap().sample_data {
                    FlatSamples::F16(values) => values[at].to_f64(),
                    FlatSamples::F32(values) => f64::from(values[at]),
                    FlatSamples::U32(values) => f64::from(values[at]),
                };
                assert!(found as f32 == expected as f32, "{}: {found}, expected {expected}", file.display());
            }
        }
    }
}

fn files_of(sidecar: &Value) -> &Vec<Value> {
    sidecar["files"].as_array().unwrap()
}

fn check_export(folder: &Path, pack_path: &str, target: &str) {
    bake(folder, &["export", pack_path, "--to", target, "-o", "out", "-q"]).ok();
    let pack = Pack::open(folder.join(pack_path), &Limits::default()).unwrap();
    let stem = Path::new(pack_path).file_stem().unwrap().to_str().unwrap();
    let sidecar = json(&fs::read_to_string(folder.join(format!("out/{stem}.json"))).unwrap());
    check_against("glint-export.schema.json", &sidecar, pack_path);
    let listed = files_of(&sidecar).len() + sidecar["parameters"].as_array().unwrap().len();
    assert_eq!(listed + 1, pack.sections().len(), "every section is a file, parameters or provenance");
    for listed in files_of(&sidecar) {
        assert_ne!(listed["resource"]["type"], "parameters", "src/info/parameters.rs has no row for {listed}");
        let find = |entry: &&glint_formats::SectionEntry| {
            listed["kind"] == entry.kind.to_string().as_str() && listed["name"] == entry.name.as_str()
        };
        let entry = pack.sections().iter().find(find).unwrap();
        let payload = pack.payload(entry).unwrap();
        let path = folder.join("out").join(listed["file"].as_str().unwrap());
        let file = fs::read(&path).unwrap();
        assert_eq!(listed["bytes"], file.len());
        let texture = Texture::of(&entry.resource);
        match (listed["format"].as_str().unwrap(), texture) {
            ("ktx2", Some(texture)) => assert!(from_ktx2(&file, &texture) == *payload, "{}", path.display()),
            ("dds", Some(texture)) => assert!(from_dds(&file, &texture) == *payload, "{}", path.display()),
            ("exr", Some(texture)) => check_exr(&path, &texture, &payload),
            ("raw", _) => assert!(file == *payload, "{}", path.display()),
            other => panic!("{other:?}"),
        }
        assert_eq!(listed["format"] == "raw", target == "raw" || texture.is_none(), "{listed}");
        assert_eq!(listed["note"].is_null(), listed["format"] == target, "{listed}");
    }
}

#[test]
fn every_methods_pack_comes_back_from_every_format() {
    let (folder, names) = packs();
    for name in names {
        for target in ["ktx2", "dds", "exr", "raw"] {
            check_export(folder.path(), name, target);
        }
    }
    for pack in frozen_packs() {
        for target in ["ktx2", "dds", "exr", "raw"] {
            check_export(folder.path(), pack.to_str().unwrap(), target);
        }
    }
}

/// Khronos's own validators, where one is installed: `ktx validate`, or ktx2check before version 4.3.
#[test]
fn khronos_finds_nothing_wrong() {
    let (folder, names) = packs();
    for name in names {
        bake(folder.path(), &["export", name, "--to", "ktx2", "-o", "out", "-q"]).ok();
    }
    for entry in fs::read_dir(folder.path().join("out")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "ktx2") {
            continue;
        }
        let run = |program: &str, args: &[&str]| std::process::Command::new(program).args(args).arg(&path).output();
        let Ok(output) = run("ktx", &["validate"]).or_else(|_| run("ktx2check", &[])) else {
            return eprintln!("skipped: neither ktx nor ktx2check can be run");
        };
        let message = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{}: {message}", path.display());
    }
}

#[test]
fn parameters_and_provenance_are_those_of_the_pack() {
    let (folder, _) = packs();
    bake(folder.path(), &["export", "layered.glintpack", "--to", "raw", "-o", "deep/er"]).ok();
    let sidecar = json(&fs::read_to_string(folder.path().join("deep/er/layered.json")).unwrap());
    assert_eq!((&sidecar["target"], &sidecar["pack"]["name"]), (&"raw".into(), &"layered.glintpack".into()));
    let kinds: Vec<_> = sidecar["parameters"].as_array().unwrap().iter().map(|of| of["kind"].clone()).collect();
    assert_eq!(kinds, ["NMPP", "PLPP", "NMPP", "PLPP", "LAYR"]);
    assert_eq!(sidecar["parameters"][0]["value"]["width"], 8);
    assert_eq!(sidecar["provenance"][0]["method"], "ndf-maps");
}

#[test]
fn a_second_export_leaves_everything_alone() {
    let (folder, _) = packs();
    let args = ["export", "sky.glintpack", "--to", "ktx2", "-o", "out"];
    let first = bake(folder.path(), &args).ok().stderr;
    assert_eq!(first.matches("written").count(), 7, "{first}");
    let times = || {
        let files = fs::read_dir(folder.path().join("out")).unwrap().map(|entry| entry.unwrap());
        files.map(|file| (file.file_name(), file.metadata().unwrap().modified().unwrap())).collect::<Vec<_>>()
    };
    let before = times();
    std::thread::sleep(std::time::Duration::from_millis(20));
    let again = bake(folder.path(), &args).ok().stderr;
    assert_eq!((again.matches("unchanged").count(), again.contains("written")), (7, false), "{again}");
    assert_eq!(times(), before);
}

#[test]
fn sections_and_names_select_files() {
    let (folder, _) = packs();
    let export = |flags: &[&str]| {
        let args = ["export", "layered.glintpack", "--to", "dds", "-o", "out"];
        bake(folder.path(), &[&args[..], flags].concat()).ok();
        let sidecar = json(&fs::read_to_string(folder.path().join("out/layered.json")).unwrap());
        let names: Vec<String> =
            files_of(&sidecar).iter().map(|listed| listed["file"].as_str().unwrap().to_owned()).collect();
        (names, sidecar["parameters"].as_array().unwrap().len())
    };
    assert_eq!(export(&["--section", "PLNO"]), (vec!["PLNO-flakes.dds".into(), "PLNO-scratches.dds".into()], 5));
    let (names, parameters) = export(&["--section", "PLNO", "--section", "NMUB", "--name", "flakes"]);
    assert_eq!((names, parameters), (vec!["NMUB-flakes.bin".into(), "PLNO-flakes.dds".into()], 2));
}

#[test]
fn names_that_no_file_can_have_are_replaced_and_numbered() {
    let (folder, _) = packs();
    let args = ["ndf-maps", "flakes.png", "scratches.png", "--name", "a/b", "--name", "A:B", "-o", "odd.glintpack"];
    bake(folder.path(), &args).ok();
    bake(folder.path(), &["export", "odd.glintpack", "--to", "raw", "--section", "NMNO", "-o", "out"]).ok();
    let sidecar = json(&fs::read_to_string(folder.path().join("out/odd.json")).unwrap());
    assert_eq!((&sidecar["files"][0]["file"], &sidecar["files"][0]["name"]), (&"NMNO-a_b.bin".into(), &"a/b".into()));
    assert_eq!(sidecar["files"][1]["file"], "NMNO-A_B-2.bin");
}

#[test]
fn a_dry_run_and_refusals_write_nothing() {
    let (folder, _) = packs();
    fs::write(folder.path().join("file"), b"in the way").unwrap();
    let done = bake(folder.path(), &["export", "sky.glintpack", "--to", "exr", "-o", "out", "-n"]).ok();
    assert!(done.stderr.contains("ENRA-sky.exr") && done.stderr.contains("nothing was written"), "{}", done.stderr);
    let bytes = fs::read(folder.path().join("sky.glintpack")).unwrap();
    fs::write(folder.path().join("cut.glintpack"), &bytes[..bytes.len() - 1]).unwrap();
    for (args, code, cause) in [
        (&["sky.glintpack", "--to", "bmp"][..], 2, "--to"),
        (&["sky.glintpack"], 2, "--to"),
        (&["sky.glintpack", "--to", "raw", "--section", "NMDE"], 2, "expected one of PROV, ENPP, ENUB, ENMI, ENRA"),
        (&["sky.glintpack", "--to", "raw", "--name", "night"], 2, "expected one of sky, found night"),
        (&["none.glintpack", "--to", "raw"], 3, "none.glintpack"),
        (&["cut.glintpack", "--to", "raw"], 4, "G1005"),
        (&["sky.glintpack", "--to", "raw", "--max-memory", "1K"], 6, "G1009"),
    ] {
        let refused = bake(folder.path(), &[&["export", "-o", "out"], args].concat());
        assert_eq!(refused.code, code, "{args:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(cause), "{args:?}: {}", refused.stderr);
    }
    assert!(!folder.path().join("out").exists());
    let refused = bake(folder.path(), &["export", "sky.glintpack", "--to", "raw", "-o", "file"]);
    assert_eq!(refused.code, 3, "{}", refused.stderr);
    // A pack whose name is that of the JSON beside the files.
    fs::copy(folder.path().join("sky.glintpack"), folder.path().join("sky.json")).unwrap();
    let refused = bake(folder.path(), &["export", "sky.json", "--to", "raw", "-o", "."]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
}
