//! The examples of docs/PIPELINES.md, with the tools that are there.

use crate::projects::{packs, program};
use crate::support::{bake, root, sky};
use glint_bake::input::synthetic;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const PACKS: [&str; 5] = ["brushed", "paint", "plate", "procedural", "studio"];

/// The examples in a folder, with small maps, and the packs that they should give.
fn examples() -> (tempfile::TempDir, std::collections::BTreeMap<String, Vec<u8>>) {
    let folder = tempfile::tempdir().unwrap();
    let maps = folder.path().join("maps");
    fs::create_dir(&maps).unwrap();
    synthetic::brushed(8, 8, 1).save(maps.join("brushed.png")).unwrap();
    synthetic::flakes(8, 8, 1).save(maps.join("flakes.png")).unwrap();
    sky(&maps.join("studio.hdr"));
    for entry in fs::read_dir(root().join("docs/examples")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    bake(folder.path(), &["build"]).ok();
    let built = packs(folder.path());
    assert_eq!(built.len(), PACKS.len());
    fs::remove_dir_all(folder.path().join("packs")).unwrap();
    (folder, built)
}

/// Runs a tool with glint-bake in PATH; None, said on standard error, where it is not installed.
fn tool(folder: &Path, name: &str, args: &[&str]) -> Option<Output> {
    let mut path = program("glint-bake").parent().unwrap().as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    match Command::new(name).args(args).current_dir(folder).env("PATH", path).output() {
        Ok(output) => Some(output),
        Err(e) => {
            eprintln!("skipped: {name}: {e}");
            None
        }
    }
}

/// Lines of a tool's output that run glint-bake.
#[track_caller]
fn bakes(output: &Output) -> usize {
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    text.lines().filter(|line| line.starts_with("glint-bake ")).count()
}

#[test]
fn the_makefile_builds_what_changed() {
    let (folder, built) = examples();
    let make = || tool(folder.path(), "make", &["-j2"]);
    let Some(first) = make() else { return };
    assert_eq!(bakes(&first), 5);
    let found = packs(folder.path());
    for (name, bytes) in &built {
        assert!(found.get(name) == Some(bytes), "{name}");
    }
    assert_eq!(bakes(&make().unwrap()), 0);
    std::thread::sleep(std::time::Duration::from_millis(20));
    synthetic::flakes(8, 8, 2).save(folder.path().join("maps/flakes.png")).unwrap();
    assert_eq!(bakes(&make().unwrap()), 1);
    assert!(packs(folder.path())["paint.glintpack"] != built["paint.glintpack"]);
    bake(folder.path(), &["build", "--check"]).ok();
}

#[test]
fn the_job_array_builds_a_pack_a_task() {
    let (folder, built) = examples();
    for index in 0..=PACKS.len() {
        let script = format!("SLURM_ARRAY_TASK_ID={index} sh slurm.sh");
        let Some(output) = tool(folder.path(), "sh", &["-c", &script]) else { return };
        let expected = if index < PACKS.len() { 0 } else { 2 };
        assert_eq!(output.status.code(), Some(expected), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert!(packs(folder.path()) == built);
}

/// Bazel itself is not run here; the commands that its rules make are, as a shell would see them.
#[test]
fn the_options_of_the_bazel_rules_are_those_of_the_project() {
    let (folder, built) = examples();
    let text = fs::read_to_string(folder.path().join("BUILD.bazel")).unwrap();
    for line in text.lines().filter(|line| line.trim_start().starts_with("(\"")) {
        let words: Vec<&str> = line.split('"').skip(1).step_by(2).collect();
        let [name, method, options, input] = words[..] else { panic!("{line}") };
        let output = format!("{name}.glintpack");
        let mut args = vec![method, "-o", &output];
        args.extend(options.split(' '));
        args.extend(["--", input]);
        bake(folder.path(), &args).ok();
        assert!(fs::read(folder.path().join(&output)).unwrap() == built[&output], "{name}");
    }
}

#[test]
fn the_page_shows_what_the_example_says() {
    let page = fs::read_to_string(root().join("docs/PIPELINES.md")).unwrap();
    let project = fs::read_to_string(root().join("docs/examples/glint.toml")).unwrap();
    let block_of = |begin: &str| {
        let blocks = page.split("```toml\n").skip(1).map(|text| text.split("```").next().unwrap());
        blocks.into_iter().find(|block| block.starts_with(begin)).unwrap()
    };
    let block = block_of("output = ");
    let scene = fs::read_to_string(root().join("docs/examples/scene.toml")).unwrap();
    let of_scene = block_of("[scene]");
    for line in of_scene.lines().map(|line| line.split('#').next().unwrap().trim()).filter(|line| !line.is_empty()) {
        assert!(scene.contains(line), "{line}");
    }
    for line in block.lines().map(|line| line.split('#').next().unwrap().trim()).filter(|line| !line.is_empty()) {
        assert!(project.contains(line), "{line}");
    }
    let makefile = fs::read_to_string(root().join("docs/examples/Makefile")).unwrap();
    for line in ["packs/%.glintpack: ", "--only $* --depfile $@.d -q", "-include $(PACKS:=.d)"] {
        assert!(page.contains(line) && makefile.contains(line), "{line}");
    }
}
