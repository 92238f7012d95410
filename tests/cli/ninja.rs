//! `glint-bake ninja`: ninja builds what `glint-bake build` would, and no more.

use crate::projects::{PACKS, edit, packs, program, project};
use crate::support::bake;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, SystemTime};

/// Runs ninja; the packs that it baked. None, said on standard error, where there is no ninja.
fn ninja(folder: &Path) -> Option<Vec<String>> {
    let Ok(output) = Command::new("ninja").current_dir(folder).output() else {
        eprintln!("skipped: ninja is not installed");
        return None;
    };
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    let bakes = text.lines().filter_map(|line| line.split("] bake packs/").nth(1)?.strip_suffix(".glintpack"));
    let mut names: Vec<String> = bakes.map(str::to_owned).collect();
    names.sort();
    Some(names)
}

fn write_manifest(folder: &Path) {
    let program = program("glint-bake");
    bake(folder, &["ninja", "glint.toml", "-o", "build.ninja", "--program", program.to_str().unwrap()]).ok();
}

#[test]
fn ninja_agrees_with_build() {
    let folder = project();
    let at = |name: &str| folder.path().join(name);
    bake(folder.path(), &["build"]).ok();
    let built = packs(folder.path());
    fs::remove_dir_all(at("packs")).unwrap();
    write_manifest(folder.path());
    let Some(baked) = ninja(folder.path()) else { return };
    assert_eq!(baked, PACKS);
    assert!(packs(folder.path()) == built);
    assert!(ninja(folder.path()).unwrap().is_empty());

    // Ninja goes by time stamps: a touched input is baked, and gives a pack that is left alone.
    let before = fs::metadata(at("packs/studio.glintpack")).unwrap().modified().unwrap();
    let later = SystemTime::now() + Duration::from_secs(1);
    fs::File::options().append(true).open(at("sky.hdr")).unwrap().set_modified(later).unwrap();
    assert_eq!(ninja(folder.path()).unwrap(), ["studio"]);
    assert_eq!(fs::metadata(at("packs/studio.glintpack")).unwrap().modified().unwrap(), before);

    // An input of two packs; an option of one; a default of two; a pack more.
    let rested = || std::thread::sleep(Duration::from_millis(20));
    rested();
    fs::copy(at("flakes.png"), at("scratches.png")).unwrap();
    assert_eq!(ninja(folder.path()).unwrap(), ["layered", "plate"]);
    for (old, new, baked) in [
        ("roughness = 0.05", "roughness = 0.06", &["flakes"][..]),
        ("preset = \"draft\"", "preset = \"balanced\"", &["flakes", "layered"]),
        ("[materials.plate]", "# nothing new\n[materials.plate]", &[]),
        (
            "[environments.studio]",
            "[materials.more]\nmethod = 'dictionary'\nlevels = 2\n[environments.studio]",
            &["more"],
        ),
    ] {
        rested();
        edit(&at("glint.toml"), old, new);
        assert_eq!(ninja(folder.path()).unwrap(), baked, "{new}");
    }
    let by_ninja = packs(folder.path());
    fs::remove_dir_all(at("packs")).unwrap();
    bake(folder.path(), &["build"]).ok();
    assert!(packs(folder.path()) == by_ninja);
}

#[test]
fn odd_names_reach_the_bake() {
    let folder = project();
    let odd = "two words$1 it's (new).png";
    fs::rename(folder.path().join("flakes.png"), folder.path().join(odd)).unwrap();
    let text =
        format!("output = \"out put\"\n[materials.\"a $b\"]\nmethod = 'ndf-maps'\ninput = \"{odd}\"\nname = 'x y'\n");
    fs::write(folder.path().join("glint.toml"), text).unwrap();
    write_manifest(folder.path());
    if ninja(folder.path()).is_none() {
        return;
    }
    bake(folder.path(), &["ndf-maps", odd, "--name", "x y", "-o", "direct.glintpack"]).ok();
    let direct = fs::read(folder.path().join("direct.glintpack")).unwrap();
    assert!(fs::read(folder.path().join("out put/a $b.glintpack")).unwrap() == direct);
}

#[test]
fn the_build_file_is_printed_or_written_when_it_changes() {
    let folder = project();
    let printed = bake(folder.path(), &["ninja"]).ok().stdout;
    assert!(printed.contains("glint_bake = glint-bake\n"), "{printed}");
    assert!(printed.contains("build build.ninja: manifest glint.toml\n"), "{printed}");
    assert!(printed.contains("build packs/layered.glintpack: bake scratches.png flakes.png\n"), "{printed}");
    bake(folder.path(), &["ninja", "--output", "build.ninja"]).ok();
    assert_eq!(fs::read_to_string(folder.path().join("build.ninja")).unwrap(), printed);
    let before = fs::metadata(folder.path().join("build.ninja")).unwrap().modified().unwrap();
    bake(folder.path(), &["ninja", "--output", "build.ninja"]).ok();
    assert_eq!(fs::metadata(folder.path().join("build.ninja")).unwrap().modified().unwrap(), before);
    assert_eq!(bake(folder.path(), &["ninja", "--output", "glint.toml"]).code, 2);
    assert_eq!(bake(folder.path(), &["ninja", "none.toml"]).code, 3);
}
