//! docs/examples/read_pack.py, which was written from docs/FORMAT.md alone: it reads every pack as glint-info does, and
//! refuses what is damaged.

use crate::support::{frozen_packs, info, json, packs, root};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs the reader; `None` without Python.
fn read(pack: &Path) -> Option<Output> {
    let script = root().join("docs/examples/read_pack.py");
    // Without -B a folder of compiled files would appear in docs.
    match Command::new("python3").arg("-B").arg(script).arg(pack).output() {
        Ok(output) => Some(output),
        Err(error) => {
            eprintln!("skipped: python3 cannot be run: {error}");
            None
        }
    }
}

/// Equal, but that FORMAT.md writes variants as `GgxNl` where some of our JSON has `ggx-nl`.
fn same(ours: &Value, theirs: &Value) -> bool {
    match (ours, theirs) {
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(key, a)| b.get(key).is_some_and(|b| same(a, b)))
        }
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        (Value::Number(a), Value::Number(b)) => a == b || a.as_f64() == b.as_f64() && a.is_f64() | b.is_f64(),
        (Value::String(a), Value::String(b)) => a == b || a.replace('-', "") == b.to_lowercase(),
        _ => ours == theirs,
    }
}

#[test]
fn it_reads_every_pack_as_glint_info_does() {
    let (folder, names) = packs();
    let mut files: Vec<_> = names.into_iter().map(|name| folder.path().join(name)).collect();
    files.extend(frozen_packs());
    for file in files {
        let Some(output) = read(&file) else { return };
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {message}", file.display());
        let theirs = json(std::str::from_utf8(&output.stdout).unwrap());
        let mut ours = json(&info(&root(), &[file.to_str().unwrap(), "--json"]).ok().stdout);
        // What it could not decompress it names.
        let left_out = |of: &Value| {
            let name = format!("decompression of {} {}", of["kind"].as_str().unwrap(), of["name"].as_str().unwrap());
            theirs["left_out"].as_array().unwrap().contains(&name.into())
        };
        ours["parameters"].as_array_mut().unwrap().retain(|of| !left_out(of));
        for part in ["file", "bytes", "version", "sections", "parameters", "provenance"] {
            let (a, b) = (&ours[part], &theirs[part]);
            assert!(same(a, b), "{}: {part}:\n{a:#}\nbut read_pack.py says\n{b:#}", file.display());
        }
        let is_texture = |section: &&Value| section["resource"]["type"] == "texture" && !left_out(section);
        let textures = ours["sections"].as_array().unwrap().iter().filter(is_texture).count();
        assert_eq!(theirs["textures"].as_array().unwrap().len(), textures, "{}", file.display());
        assert!(theirs["left_out"][0].as_str().unwrap().contains("contents"));
    }
}

#[test]
fn it_refuses_damaged_packs() {
    // Left out, as it says: limits of its own, decompression, kinds that may be skipped, the form of names and digests in
    // provenance, contents.
    let left_out = ["G1009", "G1010", "G1011", "G1028", "G1029", "G1031", "G2004"];
    let mut refused = 0;
    for entry in fs::read_dir(root().join("fixtures/corrupt")).unwrap() {
        let folder = entry.unwrap().path();
        let id = folder.file_name().unwrap().to_str().unwrap().to_owned();
        if id.as_str() >= "G3" || left_out.contains(&id.as_str()) {
            continue;
        }
        let Some(output) = read(&folder.join("bad.glintpack")) else { return };
        assert_eq!(output.status.code(), Some(4), "{id}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(output.stdout.is_empty(), "{id}");
        refused += 1;
    }
    assert!(refused >= 28, "only {refused} damaged packs were tried");
}

#[test]
fn it_is_short() {
    let script = fs::read_to_string(root().join("docs/examples/read_pack.py")).unwrap();
    assert!(script.lines().count() < 200);
    let imports: Vec<&str> = script.lines().filter(|line| line.trim_start().starts_with("import ")).collect();
    assert_eq!(imports, ["import json", "import struct", "import sys"]);
}
