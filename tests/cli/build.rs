//! `glint-bake build`: what it bakes, what it leaves alone and why, and what it says of a project that is wrong.

use crate::projects::{PACKS, PROJECT, edit, packs, project};
use crate::support::{bake, info};
use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// Names of the packs that a build wrote or baked, from what it said.
fn baked(stderr: &str) -> Vec<&str> {
    let mut names: Vec<&str> = stderr
        .lines()
        .filter(|line| line.contains(": written, ") || line.contains(": unchanged, "))
        .filter_map(|line| line.strip_prefix("packs/")?.split(".glintpack").next())
        .collect();
    names.sort_unstable();
    names
}

#[track_caller]
fn build(folder: &Path) -> String {
    bake(folder, &["build"]).ok().stderr
}

#[test]
fn a_project_gives_the_packs_of_its_command_lines() {
    let folder = project();
    assert_eq!(baked(&build(folder.path())), PACKS);
    let built = packs(folder.path());
    assert_eq!(built.len(), PACKS.len());
    let commands: [&[&str]; 5] = [
        &["ndf-maps", "flakes.png", "--roughness", "0.05", "--preset", "draft"],
        &[
            "ndf-maps",
            "scratches.png",
            "flakes.png",
            "--name",
            "coat",
            "--name",
            "base",
            "--layers",
            "coat:base",
            "--base-f0",
            "0.9,0.6,0.3",
            "--placement",
            "stochastic",
            "--preset",
            "draft",
        ],
        &["area-light", "scratches.png", "--anisotropic"],
        &["dictionary", "--levels", "4", "--seed", "16"],
        &["environment", "sky.hdr", "--face-size", "16", "--levels", "auto"],
    ];
    for (command, name) in commands.iter().zip(PACKS) {
        let pack = format!("{name}.glintpack");
        bake(folder.path(), &[command, &["-o", &pack][..]].concat()).ok();
        assert!(fs::read(folder.path().join(&pack)).unwrap() == built[&pack], "{pack}");
        info(folder.path(), &[&format!("packs/{pack}"), "--verify"]).ok();
    }
}

#[test]
fn only_what_changed_is_baked_again() {
    let folder = project();
    let at = |name: &str| folder.path().join(name);
    build(folder.path());
    let first = packs(folder.path());
    let nothing = |stderr: &str| assert!(stderr.contains("0 written, 5 up to date"), "{stderr}");
    nothing(&build(folder.path()));

    // A touched input, and a copy of one, have the same content.
    let later = SystemTime::now() + Duration::from_secs(60);
    fs::File::options().append(true).open(at("flakes.png")).unwrap().set_modified(later).unwrap();
    fs::copy(at("scratches.png"), at("copy.png")).unwrap();
    fs::rename(at("copy.png"), at("scratches.png")).unwrap();
    nothing(&build(folder.path()));

    // So has an option that is now said, and equals the default.
    edit(&at("glint.toml"), "[materials.plate]", "[materials.plate]\nbase-roughness = 0.1");
    nothing(&build(folder.path()));

    // An option of one.
    edit(&at("glint.toml"), "roughness = 0.05", "roughness = 0.06");
    let stderr = build(folder.path());
    assert_eq!(baked(&stderr), ["flakes"]);
    assert!(stderr.contains("roughness is 0.06 instead of 0.05"), "{stderr}");

    // A default of a method.
    edit(&at("glint.toml"), "preset = \"draft\"", "preset = \"balanced\"");
    assert_eq!(baked(&build(folder.path())), ["flakes", "layered"]);

    // An input of two.
    fs::copy(at("flakes.png"), at("scratches.png")).unwrap();
    let stderr = build(folder.path());
    assert_eq!(baked(&stderr), ["layered", "plate"]);
    assert!(stderr.contains("scratches.png changed"), "{stderr}");

    // Back to where it began: the same bytes.
    fs::write(at("glint.toml"), PROJECT).unwrap();
    glint_bake::input::synthetic::scratches(16, 8, 1).save(at("scratches.png")).unwrap();
    assert_eq!(baked(&build(folder.path())), ["flakes", "layered", "plate"]);
    assert!(packs(folder.path()) == first);
    nothing(&build(folder.path()));
}

#[test]
fn packs_that_were_meddled_with_are_baked_again() {
    let folder = project();
    let at = |name: &str| folder.path().join(name);
    build(folder.path());
    let first = packs(folder.path());

    let mut bytes = first["plate.glintpack"].clone();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(at("packs/plate.glintpack"), bytes).unwrap();
    fs::remove_file(at("packs/studio.glintpack")).unwrap();
    let stderr = build(folder.path());
    assert_eq!(baked(&stderr), ["plate", "studio"]);
    assert!(stderr.contains("is not what was built") && stderr.contains("is missing"), "{stderr}");
    assert!(packs(folder.path()) == first);

    // Without records, or with damaged ones, everything is baked, and nothing is written.
    let before = fs::metadata(at("packs/flakes.glintpack")).unwrap().modified().unwrap();
    fs::remove_file(at("packs/.glint-build/flakes.json")).unwrap();
    fs::write(at("packs/.glint-build/plate.json"), "{\"tool\":").unwrap();
    let stderr = build(folder.path());
    assert_eq!(baked(&stderr), ["flakes", "plate"]);
    assert!(stderr.contains("0 written, 2 baked and unchanged, 3 up to date"), "{stderr}");
    assert_eq!(fs::metadata(at("packs/flakes.glintpack")).unwrap().modified().unwrap(), before);
    fs::remove_dir_all(at("packs/.glint-build")).unwrap();
    assert_eq!(baked(&build(folder.path())), PACKS);
    assert!(packs(folder.path()) == first);
}

#[test]
fn another_version_of_the_program_bakes_again() {
    let folder = project();
    build(folder.path());
    edit(&folder.path().join("packs/.glint-build/plate.json"), "\"tool\":\"", "\"tool\":\"0.0.9 ");
    edit(&folder.path().join("packs/.glint-build/studio.json"), "\"format\":\"", "\"format\":\"0.");
    let stderr = build(folder.path());
    assert_eq!(baked(&stderr), ["plate", "studio"]);
    assert!(stderr.contains("built by version 0.0.9") && stderr.contains("its format is 0."), "{stderr}");
}

#[test]
fn check_and_dry_run_say_why_and_touch_nothing() {
    let folder = project();
    let files = || walk(folder.path());
    let before = files();
    let done = bake(folder.path(), &["build", "--check"]);
    assert_eq!(done.code, 7, "{}", done.stderr);
    assert!(done.stderr.contains("plate: stale, not built yet") && done.stderr.contains("5 of 5"), "{}", done.stderr);
    let done = bake(folder.path(), &["build", "-n"]).ok();
    assert!(done.stderr.contains("plate: would write packs/plate.glintpack: not built yet"), "{}", done.stderr);
    assert!(done.stderr.contains("5 to bake, 0 up to date"), "{}", done.stderr);
    assert_eq!(files(), before);

    build(folder.path());
    let before = files();
    assert!(bake(folder.path(), &["build", "--check"]).ok().stderr.contains("5 up to date"));
    edit(&folder.path().join("glint.toml"), "levels = 4", "levels = 5");
    let done = bake(folder.path(), &["build", "--check"]);
    assert_eq!(done.code, 7);
    assert!(done.stderr.contains("procedural: stale, levels is 5 instead of 4"), "{}", done.stderr);
    assert!(done.stderr.contains("1 of 5"), "{}", done.stderr);
    let done = bake(folder.path(), &["build", "--dry-run", "-v"]).ok();
    assert!(done.stderr.contains("1 to bake, 4 up to date") && done.stderr.contains("plate: up to date"));
    edit(&folder.path().join("glint.toml"), "levels = 5", "levels = 4");
    assert_eq!(files(), before);
    // What cannot be looked at is worse than what is stale.
    fs::remove_file(folder.path().join("sky.hdr")).unwrap();
    assert_eq!(bake(folder.path(), &["build", "--check"]).code, 3);
    assert_eq!(bake(folder.path(), &["build", "-n"]).code, 3);
}

/// Every file with its bytes.
fn walk(folder: &Path) -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.push((path.clone(), Vec::new()));
            all.extend(walk(&path));
        } else {
            all.push((path.clone(), fs::read(&path).unwrap()));
        }
    }
    all.sort();
    all
}

#[test]
fn a_failure_does_not_stop_the_others() {
    let folder = project();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("flakes.png"), b"\x89PNG\r\n\x1a\n and no more").unwrap();
    fs::remove_file(at("sky.hdr")).unwrap();
    let done = bake(folder.path(), &["build", "--depfile", "all.d"]);
    // The first that failed, in the order of the file, is the damaged map.
    assert_eq!(done.code, 4, "{}", done.stderr);
    assert_eq!(baked(&done.stderr), ["plate", "procedural"]);
    for part in ["error: flakes: flakes.png: ", "error: studio: sky.hdr: cannot be read", "2 written, 3 failed"] {
        assert!(done.stderr.contains(part), "{part}: {}", done.stderr);
    }
    assert!(!at("all.d").exists());
    glint_bake::input::synthetic::flakes(8, 8, 1).save(at("flakes.png")).unwrap();
    let done = bake(folder.path(), &["build"]);
    assert_eq!(done.code, 3, "{}", done.stderr);
    assert_eq!(baked(&done.stderr), ["flakes", "layered"]);
}

#[test]
fn the_same_bytes_whatever_the_threads_and_the_order() {
    let folder = project();
    bake(folder.path(), &["build", "-j", "1"]).ok();
    let first = packs(folder.path());
    for flags in [&["-j", "2", "--in-flight", "5"][..], &["-j", "3", "--in-flight", "1"], &["--in-flight", "2"]] {
        fs::remove_dir_all(folder.path().join("packs")).unwrap();
        bake(folder.path(), &[&["build"], flags].concat()).ok();
        assert!(packs(folder.path()) == first, "{flags:?}");
    }
}

#[test]
fn one_pack_at_a_time_from_another_folder() {
    let folder = project();
    let name = folder.path().file_name().unwrap().to_str().unwrap();
    let file = format!("{name}/glint.toml");
    let above = folder.path().parent().unwrap();
    let args = ["build", &file, "--only", "plate", "--only", "procedural", "--depfile"];
    bake(above, &[&args[..], &[&format!("{name}/two.d")]].concat()).ok();
    assert_eq!(packs(folder.path()).keys().collect::<Vec<_>>(), ["plate.glintpack", "procedural.glintpack"]);
    assert_eq!(
        fs::read_to_string(folder.path().join("two.d")).unwrap(),
        format!(
            "{name}/packs/plate.glintpack: \\\n  {file} \\\n  {name}/scratches.png\n\
             {name}/packs/procedural.glintpack: \\\n  {file}\n"
        )
    );
    // Seen from within, they are the same packs.
    assert!(build(folder.path()).contains("3 written, 2 up to date"));
    let done = bake(folder.path(), &["build", "--only", "nothing"]);
    assert_eq!(done.code, 2);
    assert!(done.stderr.contains("flakes, layered, plate, procedural, studio"), "{}", done.stderr);
}

#[test]
fn what_a_killed_build_left_is_removed_once_it_is_old() {
    let folder = project();
    fs::create_dir(folder.path().join("packs")).unwrap();
    let [old, young, other] =
        [".glintpack-old.tmp", ".glintpack-young.tmp", "mine.tmp"].map(|name| folder.path().join("packs").join(name));
    let long_ago = SystemTime::now() - Duration::from_secs(2 * 3600);
    for (path, time) in [(&old, long_ago), (&young, SystemTime::now()), (&other, long_ago)] {
        fs::write(path, "part").unwrap();
        fs::File::options().append(true).open(path).unwrap().set_modified(time).unwrap();
    }
    bake(folder.path(), &["build", "--only", "procedural"]).ok();
    assert_eq!([old, young, other].map(|path| path.exists()), [false, true, true]);
}

#[test]
fn a_report_beside_a_pack_is_looked_after_too() {
    let folder = project();
    let at = |name: &str| folder.path().join(name);
    edit(&at("glint.toml"), "levels = 4", "levels = 4\nreport = \"procedural.json\"\nmax-memory = \"1M\"");
    build(folder.path());
    let report = fs::read(at("procedural.json")).unwrap();
    fs::write(at("procedural.json"), "{}").unwrap();
    let stderr = build(folder.path());
    assert!(stderr.contains("procedural.json is not what was built"), "{stderr}");
    assert!(fs::read(at("procedural.json")).unwrap() == report);
    // A limit on memory is no property of the pack; one that is missed is a failure.
    edit(&at("glint.toml"), "\"1M\"", "\"2M\"");
    assert!(build(folder.path()).contains("0 written, 5 up to date"));
    edit(&at("glint.toml"), "\"2M\"", "64");
    fs::remove_file(at("procedural.json")).unwrap();
    assert_eq!(bake(folder.path(), &["build"]).code, 6);
}

#[test]
fn every_mistake_is_named_with_its_line() {
    let folder = project();
    let text = "outptu = 'x'\n[defaults.ndf-map]\na = 1\n[defaults.environment]\nface-siz = 3\n\
        [materials.a]\nmethod = 'ndf-maps'\ninput = 'x.png'\nroughnes = 2\n\
        [materials.b]\nmethod = 'ndf-maps'\ninput = 'x.png'\nroughness = 'no'\n\
        [materials.c]\nmethod = 'ndf-maps'\n[materials.'d/x']\nmethod = 'dictionary'\n\
        [materials.E]\nmethod = 'dictionary'\noutput = 'y'\n[materials.f]\nmethod = 'dictionary'\ninput = 'y'\n\
        [materials.g]\nmethod = 'dictionary'\nthreads = 2\n[materials.h]\nmethod = 'demo'\n\
        [materials.i]\nmethod = 'area-light'\ninput = ['a', 'b']\n\
        [materials.j]\nmethod = 'area-light'\ninput = 'b'\nanisotropic = 1\n\
        [materials.k]\nmethod = 'dictionary'\nhelp = true\n[materials.n]\nmethod = 'dictionary'\n[materials.N]\nmethod = 'dictionary'\n\
        [environments.l]\ninput = 'x.hdr'\n";
    fs::write(folder.path().join("bad.toml"), text).unwrap();
    let done = bake(folder.path(), &["build", "bad.toml"]);
    assert_eq!(done.code, 2);
    for part in [
        "bad.toml:1: outptu: expected output,",
        "bad.toml:2: defaults.ndf-map: expected ndf-maps, ",
        "bad.toml:5: defaults.environment.face-siz: unexpected argument '--face-siz' found tip: a similar argument exists: \
         '--face-size'",
        "bad.toml:9: materials.a.roughnes: unexpected argument '--roughnes'",
        "bad.toml:13: materials.b.roughness: invalid value 'no' for '--roughness <SIGMA>': expected a number above 0",
        "bad.toml:14: materials.c: expected the files to bake",
        "bad.toml:16: materials.d/x: a pack is named after it",
        "bad.toml:20: materials.E.output: ",
        "bad.toml:23: materials.f.input: dictionary has no input",
        "bad.toml:26: materials.g.threads: ",
        "bad.toml:28: materials.h.method: expected ndf-maps, ",
        "bad.toml:31: materials.i.input: area-light takes one file, found 2",
        "bad.toml:35: materials.j.anisotropic: expected true or false",
        "bad.toml:38: materials.k.help: unexpected argument '--help'",
        "bad.toml:41: materials.N: a pack is named after it, and \"n\" is there already",
    ] {
        assert!(done.stderr.contains(part), "{part} is not in\n{}", done.stderr);
    }
    assert!(!folder.path().join("packs").exists());
    fs::write(folder.path().join("bad.toml"), "[materials\n").unwrap();
    let done = bake(folder.path(), &["build", "bad.toml"]);
    assert_eq!(done.code, 2);
    assert!(done.stderr.contains("bad.toml:1: "), "{}", done.stderr);
    assert_eq!(bake(folder.path(), &["build", "none.toml"]).code, 3);
    // An output that is an input is refused before any work.
    fs::write(folder.path().join("bad.toml"), "[materials.a]\nmethod='dictionary'\nreport='bad.toml'\n").unwrap();
    assert_eq!(bake(folder.path(), &["build", "bad.toml"]).code, 2);
}

#[test]
fn progress_and_warnings_name_the_pack() {
    let folder = project();
    edit(&folder.path().join("glint.toml"), "[materials.plate]", "[materials.plate]\nnormal-y = \"down\"");
    let done = bake(folder.path(), &["build", "--progress", "always", "-v"]).ok();
    assert!(done.stdout.is_empty());
    for part in ["flakes: NDF maps: ", "plate: mips: ", "studio: filter: ", "layered: base: 289 nodes"] {
        assert!(done.stderr.contains(part), "{part}: {}", done.stderr);
    }
    let done = bake(folder.path(), &["build", "-q"]).ok();
    assert_eq!((done.stdout.as_str(), done.stderr.as_str()), ("", ""));
}
