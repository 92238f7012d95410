//! `glint-bake shaders`: the files that are there, that they are the same each time, and what is refused.

use crate::schema::check_against;
use crate::support::{bake, json, root};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Files by their path from `folder`.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap()) {
        let name = entry.file_name().into_string().unwrap();
        if entry.path().is_dir() {
            files.extend(contents(&entry.path()).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            files.insert(name, fs::read(entry.path()).unwrap());
        }
    }
    files
}

#[test]
fn every_language_is_written_and_listed() {
    let folder = tempfile::tempdir().unwrap();
    for (lang, file) in [
        ("wgsl", "area_light/eval.wgsl"),
        ("hlsl", "glint_area_light.hlsl"),
        ("glsl", "glint_area_light.glsl"),
        ("msl", "glint_area_light.metal"),
        ("spirv", "example_area_light.spv"),
    ] {
        let args = ["shaders", "--lang", lang, "--output", lang, "--json"];
        let printed = json(&bake(folder.path(), &args).ok().stdout);
        check_against("glint-shaders.schema.json", &printed, lang);
        let files = contents(&folder.path().join(lang));
        assert!(files.contains_key(file), "{lang}: {:?}", files.keys());
        let listed = printed["files"].as_array().unwrap();
        assert_eq!(listed.len(), files.len());
        for entry in listed {
            let bytes = &files[entry["file"].as_str().unwrap()];
            assert_eq!(entry["bytes"].as_u64().unwrap(), bytes.len() as u64);
        }
        let interface = json(std::str::from_utf8(&files["glint_area_light.json"]).unwrap());
        check_against("glint-interface.schema.json", &interface, lang);
        let again = bake(folder.path(), &args[..5]).ok();
        assert!(again.stdout.is_empty() && again.stderr.contains("unchanged"), "{}", again.stderr);
        assert!(!again.stderr.contains(": written"), "{}", again.stderr);
        assert_eq!(contents(&folder.path().join(lang)), files);
    }
    let library = fs::read(root().join("bake/src/hash.wgsl")).unwrap();
    assert_eq!(contents(&folder.path().join("wgsl"))["hash.wgsl"], library);
}

#[test]
fn methods_can_be_chosen_and_a_dry_run_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["shaders", "--lang", "glsl", "-o", "out", "--method", "dictionary"];
    let dry = bake(folder.path(), &[&args[..], &["-n"]].concat()).ok();
    assert!(dry.stderr.contains("would write") && dry.stderr.contains("glint_dictionary.glsl"), "{}", dry.stderr);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    bake(folder.path(), &args).ok();
    assert_eq!(
        contents(&folder.path().join("out")).into_keys().collect::<Vec<_>>(),
        ["example_dictionary.comp", "glint_dictionary.glsl", "glint_dictionary.json"]
    );
}

#[test]
fn what_cannot_be_written_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), b"x").unwrap();
    assert_eq!(bake(folder.path(), &["shaders", "--lang", "wgsl", "-o", "file"]).code, 3);
    assert_eq!(bake(folder.path(), &["shaders", "--lang", "wgsl", "-o", "file", "--dry-run"]).code, 3);
    fs::create_dir_all(folder.path().join("taken/example_dictionary.spv")).unwrap();
    let refused = bake(folder.path(), &["shaders", "--lang", "spirv", "-o", "taken"]);
    assert_eq!(refused.code, 3, "{}", refused.stderr);
    assert_eq!(fs::read_dir(folder.path().join("taken")).unwrap().count(), 1);
    let unknown = bake(folder.path(), &["shaders", "--lang", "wgsl", "-o", "out", "--method", "none"]);
    assert!(unknown.code == 2 && unknown.stderr.contains("area_light"), "{}", unknown.stderr);
    assert_eq!(bake(folder.path(), &["shaders", "--lang", "cg", "-o", "out"]).code, 2);
    assert!(!folder.path().join("out").exists());
}

#[test]
fn vectors_are_the_same_twice_and_stand_alone() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["shaders", "--vectors", "--method", "glints", "--method", "lobes", "-o", "vectors", "--json"];
    let printed = json(&bake(folder.path(), &args).ok().stdout);
    check_against("glint-shaders.schema.json", &printed, "vectors");
    assert_eq!(printed["files"].as_array().unwrap().len(), 8);
    assert!(printed["language"].is_null());
    let vectors = json(&fs::read_to_string(folder.path().join("vectors/vectors_glints.json")).unwrap());
    check_against("glint-vectors.schema.json", &vectors, "glints");
    let again = bake(folder.path(), &args[..8]).ok();
    assert!(!again.stderr.contains(": written"), "{}", again.stderr);
    assert_eq!(bake(folder.path(), &["shaders", "-o", "none"]).code, 2);
}
