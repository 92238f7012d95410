//! `glint-bake build` with thirty real maps, and interrupted.

use crate::projects::{packs, program, project};
use crate::support::bake;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Maps of the data folder, None (said) where there is none.
fn real_maps() -> Option<Vec<PathBuf>> {
    let data = std::env::var_os("GLINT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let Ok(entries) = fs::read_dir(data.join("normals")) else {
        eprintln!("skipped: no real maps in {} (set GLINT_DATA)", data.display());
        return None;
    };
    let mut maps: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    // Smooth reading of the large ones would be most of the test's time.
    maps.retain(|path| fs::metadata(path).unwrap().len() < 400_000 && !path.ends_with("ridges_1d_khronos_2048x1.png"));
    maps.sort();
    Some(maps)
}

/// Thirty crops of real maps.
fn thirty(maps: &[PathBuf]) -> String {
    let mut text = "[defaults.ndf-maps]\nassume-linear = true\npreset = 'draft'\nroughness = 0.05\n".to_owned();
    for k in 0..30 {
        let map = &maps[k % maps.len()];
        let at = 16 * (k / maps.len());
        write!(
            text,
            "[materials.map{k:02}]\nmethod = 'ndf-maps'\ninput = '{}'\ncrop = '8x8+{at}+{at}'\n",
            map.display()
        )
        .unwrap();
    }
    text
}

#[test]
fn thirty_real_maps_build_once() {
    let Some(maps) = real_maps() else { return };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("glint.toml"), thirty(&maps)).unwrap();
    assert!(bake(folder.path(), &["build"]).ok().stderr.contains("30 written"));
    assert_eq!(packs(folder.path()).len(), 30);
    let again = bake(folder.path(), &["build"]).ok().stderr;
    assert_eq!(again, "0 written, 30 up to date\n");
}

fn start(folder: &Path) -> Child {
    let mut command = Command::new(program("glint-bake"));
    command.args(["build", "-j", "2"]).current_dir(folder).stderr(Stdio::null()).spawn().unwrap()
}

#[test]
fn a_build_that_was_killed_goes_on_to_the_same_bytes() {
    let folder = project();
    bake(folder.path(), &["build"]).ok();
    let undisturbed = packs(folder.path());
    fs::remove_dir_all(folder.path().join("packs")).unwrap();
    let (mut delay, mut killed) = (Duration::from_millis(3), 0);
    // Killed ever later, until it is through.
    let status = loop {
        let mut child = start(folder.path());
        std::thread::sleep(delay);
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        (delay, killed) = (delay.mul_f64(1.4), killed + 1);
    };
    assert!(status.success() && killed > 3, "{status}, killed {killed} times");
    let found = packs(folder.path());
    for (name, bytes) in &undisturbed {
        assert!(found.get(name) == Some(bytes), "{name}");
    }
    bake(folder.path(), &["build", "--check"]).ok();
}

#[cfg(unix)]
#[test]
fn an_interrupted_build_says_so_and_leaves_no_parts() {
    let folder = project();
    bake(folder.path(), &["build"]).ok();
    let undisturbed = packs(folder.path());
    let mut interrupted = 0;
    for step in 0..30 {
        fs::remove_dir_all(folder.path().join("packs")).unwrap();
        let mut child = start(folder.path());
        std::thread::sleep(Duration::from_millis(10 + 3 * step));
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        match child.wait().unwrap().code() {
            Some(130) => interrupted += 1,
            Some(0) => break,
            // Before the handler is there, the shell sees the signal itself.
            code => assert_eq!(code, None),
        }
        if folder.path().join("packs").is_dir() {
            for (name, bytes) in packs(folder.path()) {
                assert!(undisturbed.get(&name) == Some(&bytes), "{name} is a part of something");
            }
        }
        fs::create_dir_all(folder.path().join("packs")).unwrap();
    }
    assert!(interrupted > 0);
}
