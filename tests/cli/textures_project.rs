//! Textures in projects: `build`, `--check` and `ninja` treat them as packs.

use crate::gltf_file::{Gltf, glb, quad_parts};
use crate::projects::{edit, program};
use crate::support::{bake, maps};
use std::fs;
use std::path::Path;
use std::process::Command;

const PROJECT: &str = r#"
output = "out"

[defaults.textures]
zstd = true

[materials.bumps]
method = "textures"
input = "flakes.png"
target = "unreal"
roughness = 0.4

[materials.model]
method = "textures"
gltf = "in/model.gltf"
gltf-images = "ktx2-only"

[materials.plate]
method = "area-light"
input = "scratches.png"
"#;

/// A folder with [`PROJECT`], whose model has its normals beside it.
fn project() -> tempfile::TempDir {
    let folder = maps();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("in")).unwrap();
    let (text, binary) = quad_parts(r#"[{"normalTexture": {"index": 0}}]"#);
    fs::write(at("in.glb"), glb(&text, &binary)).unwrap();
    fs::write(at("in/normal.png"), Gltf::read(&at("in.glb")).image(0)).unwrap();
    fs::write(at("in/data.bin"), &binary).unwrap();
    let text = text
        .replace(r#"{"bufferView": 1, "mimeType": "image/png", "name""#, r#"{"uri": "normal.png", "name""#)
        .replace("\"buffers\": [{", "\"buffers\": [{\"uri\": \"data.bin\", ");
    fs::write(at("in/model.gltf"), text).unwrap();
    fs::write(at("glint.toml"), PROJECT).unwrap();
    folder
}

const FILES: [&str; 8] = [
    "bumps.json",
    "bumps_normal.ktx2",
    "bumps_orm.ktx2",
    "data.bin",
    "model-0-metallic-roughness.ktx2",
    "model-0-normal.ktx2",
    "model.gltf",
    "plate.glintpack",
];

/// Bytes of all files of the output folder.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder.join("out")).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<(String, Vec<u8>)> = entries
        .filter(|path| path.is_file())
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap()))
        .collect();
    files.sort();
    files
}

fn names(files: &[(String, Vec<u8>)]) -> Vec<&str> {
    files.iter().map(|(name, _)| name.as_str()).collect()
}

#[test]
fn a_project_builds_textures_and_knows_when_they_are_stale() {
    let folder = project();
    let folder = folder.path();
    let at = |name: &str| folder.join(name);
    let said = bake(folder, &["build", "--depfile", "d"]).ok().stderr;
    assert!(said.contains("3 written"), "{said}");
    let built = files(folder);
    assert_eq!(names(&built), FILES);
    let rules = fs::read_to_string(at("d")).unwrap();
    assert!(rules.contains("out/bumps.json: \\\n  glint.toml \\\n  flakes.png\n"), "{rules}");
    assert!(rules.contains("in/model.gltf \\\n  in/data.bin \\\n  in/normal.png\n"), "{rules}");
    // What the commands write.
    let flags = ["--target", "unreal", "--roughness", "0.4", "--zstd", "--name", "bumps", "-o", "direct"];
    bake(folder, &[&["textures", "flakes.png"], &flags[..]].concat()).ok();
    let gltf =
        ["textures", "--gltf", "in/model.gltf", "--gltf-images", "ktx2-only", "--zstd", "-o", "direct/model.gltf"];
    bake(folder, &gltf).ok();
    for (name, bytes) in built.iter().filter(|(name, _)| name != "plate.glintpack") {
        assert!(fs::read(at("direct").join(name)).unwrap() == *bytes, "{name}");
    }
    let fresh = || {
        let said = bake(folder, &["build", "--check"]).ok().stderr;
        assert!(said.contains("3 up to date"), "{said}");
    };
    let stale = |part: &str| {
        let found = bake(folder, &["build", "--check"]);
        assert!(found.code == 7 && found.stderr.contains(part), "{part}: {}", found.stderr);
        let said = bake(folder, &["build"]).ok().stderr;
        assert!(said.contains("1 written, 2 up to date") || said.contains("1 baked and unchanged"), "{part}: {said}");
    };
    fresh();
    fs::remove_file(at("out/bumps_orm.ktx2")).unwrap();
    stale("bumps: stale, bumps_orm.ktx2 is missing");
    fs::write(at("out/model-0-normal.ktx2"), b"other").unwrap();
    stale("model: stale, model-0-normal.ktx2 is not what was built");
    assert!(files(folder) == built);
    fs::copy(at("scratches.png"), at("in/normal.png")).unwrap();
    stale("model: stale, normal.png changed");
    assert!(files(folder) != built);
    edit(&at("glint.toml"), "roughness = 0.4", "roughness = 0.3");
    stale("bumps: stale, roughness is 0.3 instead of 0.4");
    fresh();
    let said = bake(folder, &["build", "--only", "bumps", "-n"]).ok().stderr;
    assert!(said.contains("1 up to date"), "{said}");
}

#[test]
fn ninja_builds_the_same_textures() {
    let folder = project();
    let folder = folder.path();
    bake(folder, &["build"]).ok();
    let built = files(folder);
    fs::remove_dir_all(folder.join("out")).unwrap();
    let program = program("glint-bake");
    bake(folder, &["ninja", "glint.toml", "-o", "build.ninja", "--program", program.to_str().unwrap()]).ok();
    let run = || Command::new("ninja").current_dir(folder).output();
    let Ok(output) = run() else { return eprintln!("skipped: ninja is not installed") };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    assert!(files(folder).into_iter().filter(|(name, _)| !name.starts_with('.')).eq(built));
    assert!(String::from_utf8_lossy(&run().unwrap().stdout).contains("no work to do"));
}

#[test]
fn tables_of_textures_that_are_wrong_are_said_with_their_line() {
    let folder = project();
    for (from, to, part) in [
        ("target = \"unreal\"", "name = \"x\"", "materials.bumps.name: textures are named after their table"),
        ("target = \"unreal\"", "output = \"x\"", "materials.bumps.output: "),
        ("target = \"unreal\"", "json = true", "materials.bumps.json: --json is given to glint-bake build"),
        ("target = \"unreal\"", "target = \"blender\"", "glint.toml:10: materials.bumps.target: "),
        ("target = \"unreal\"", "format = \"png\"", "--zstd: is for --format ktx2"),
        ("input = \"flakes.png\"", "input = \"f.<UDIM>.png\"", "in a project give each tile a table"),
        ("input = \"flakes.png\"", "", "expected the files to bake as input"),
        ("gltf-images = \"ktx2-only\"", "roughness = 0.5", "materials.model"),
    ] {
        fs::write(folder.path().join("glint.toml"), PROJECT.replacen(from, to, 1)).unwrap();
        let refused = bake(folder.path(), &["build"]);
        assert!(refused.code == 2 && refused.stderr.contains(part), "{to}: {}", refused.stderr);
    }
    assert!(!folder.path().join("out").exists());
}
