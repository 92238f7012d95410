//! Planning for a scene: `glint-bake plan`, and projects with a scene built.

use crate::projects::{edit, packs, program};
use crate::support::{bake, info, json, maps, sky};
use glint_formats::{Limits, Pack};
use std::fs;
use std::path::{Path, PathBuf};

/// Two maps and a sky, seen in a scene with every light. Rough enough that references are quick.
const SCENE: &str = "[scene]\nimage = '1280x720'\nfield-of-view = 40\n\
    lights = ['directional', 'rectangle', 'environment']\nerror = 0.3\nbytes = '1M'\n\
    [defaults.area-light]\nbase-roughness = 0.5\n\
    [materials.flakes]\ninput = 'flakes.png'\nroughness = 0.2\ndistance = [12, 30]\ntexels-per-metre = 2000\nerror = 0.9\n\
    [materials.plate]\nmethod = 'area-light'\ninput = 'scratches.png'\ndistance = [3, 9]\nuv-per-metre = 100\ntilt = 0\n\
    [materials.told]\nmethod = 'dictionary'\nlevels = 2\n\
    [environments.studio]\ninput = 'sky.hdr'\nalpha = [0.7, 0.9]\n";

/// One material, for what needs no more.
const SMALL: &str = "[scene]\nlights = ['rectangle']\nbytes = 1000\n\
    [materials.plate]\nmethod = 'area-light'\ninput = 'scratches.png'\nbase-roughness = 0.5\ndistance = [3, 9]\n\
    uv-per-metre = 100\nerror = 0.3\n";

fn scene(text: &str) -> tempfile::TempDir {
    let folder = maps();
    sky(&folder.path().join("sky.hdr"));
    fs::write(folder.path().join("glint.toml"), text).unwrap();
    folder
}

#[test]
fn what_is_planned_is_built_and_remembered() {
    let folder = scene(SCENE);
    let at = |name: &str| folder.path().join(name);
    let plan = bake(folder.path(), &["plan", "-j", "2"]).ok().stdout;
    for part in [
        "scene: 1280 × 720 pixels, field of view 40°, lights: point, rectangle, environment\n",
        "flakes (ndf-maps): footprints of σ 12.13 to 30.33 texels, up to 2.0 times as long\n",
        "flakes-area-light (area-light): footprints of σ 12.13 to 30.33 texels\n",
        "  drop     the 2 finest mips: no footprint reads them",
        "plate (area-light): footprints of σ 2.43 to 7.28 texels\n",
        "studio (environment): roughness α 0.7 to 0.9\n",
        "  tighter  ",
        " of 1,024 KiB allowed\n",
    ] {
        assert!(plan.contains(part), "{part} is not in\n{plan}");
    }
    assert!(!at("packs").exists());

    let built = bake(folder.path(), &["build"]).ok().stderr;
    assert!(built.contains(plan.trim_end()) && built.contains("5 written"), "{built}");
    let names: Vec<String> = packs(folder.path()).into_keys().collect();
    let expected = ["flakes-area-light", "flakes", "plate", "studio", "told"].map(|name| format!("{name}.glintpack"));
    assert_eq!(names, expected);
    // The pack says what was left out.
    let report = json(&info(folder.path(), &["packs/flakes.glintpack", "--json"]).ok().stdout);
    let options = report["provenance"][0]["options"].to_string();
    assert!(plan.contains("--finest-window=8") && options.contains("finest-window"), "{plan}{options}");

    // Nothing is drafted again, and nothing baked, until something changes.
    assert_eq!(bake(folder.path(), &["build"]).ok().stderr, "0 written, 5 up to date\n");
    bake(folder.path(), &["build", "--check"]).ok();
    edit(&at("glint.toml"), "distance = [3, 9]", "distance = [12, 36]");
    let done = bake(folder.path(), &["build", "--check"]);
    assert!(done.code == 7 && done.stderr.contains("skip-mips is 4 instead of 2"), "{}", done.stderr);
    assert!(bake(folder.path(), &["build"]).ok().stderr.contains("1 written, 4 up to date"));

    let measured = bake(folder.path(), &["plan", "--measure"]).ok().stdout;
    assert_eq!(measured.lines().count(), 4, "{measured}");
    fs::remove_file(at("packs/plate.glintpack")).unwrap();
    assert_eq!(bake(folder.path(), &["plan", "--measure"]).code, 3);
}

#[test]
fn budgets_that_cannot_be_kept_give_the_nearest_plan() {
    let folder = scene(SMALL);
    let done = bake(folder.path(), &["plan"]);
    assert_eq!(done.code, 4);
    assert!(done.stdout.contains("this is the nearest plan that is possible: "), "{}", done.stdout);
    assert!(done.stdout.contains("1.0 KiB was asked"), "{}", done.stdout);
    // It is built all the same, and the exit code says that it is not what was asked.
    let done = bake(folder.path(), &["build"]);
    assert!(done.code == 4 && done.stderr.contains("1 written"), "{}", done.stderr);
    assert_eq!(bake(folder.path(), &["build", "-q"]).code, 4);

    edit(&folder.path().join("glint.toml"), "error = 0.3", "error = 0.00001");
    let done = bake(folder.path(), &["plan"]);
    assert!(done.code == 4 && done.stdout.contains("plate has RMSE of highlights "), "{}", done.stdout);
}

#[test]
fn lights_choose_methods() {
    let plan = |lights: &str| {
        let text = SMALL
            .replace("bytes = 1000\n", "")
            .replace("method = 'area-light'\n", "")
            .replace("error = 0.3", "error = 2");
        let folder = scene(&text.replace("base-roughness = 0.5", "roughness = 0.2").replace("['rectangle']", lights));
        bake(folder.path(), &["plan"]).ok().stdout
    };
    let points = plan("['point']");
    assert!(points.contains("plate (ndf-maps): "), "{points}");
    assert!(points.contains("dropped: area-light maps of plate: the scene has no rectangle light"), "{points}");
    let rectangles = plan("['rectangle']");
    assert!(rectangles.contains("plate (area-light): "), "{rectangles}");
    assert!(
        rectangles.contains("dropped: glints of plate: the scene has no point or directional light"),
        "{rectangles}"
    );
}

#[test]
fn mistakes_in_scenes_are_named_with_their_line() {
    for (old, new, part) in [
        ("image = '1280x720'", "image = 3", "glint.toml:2: scene.image: expected WxH"),
        ("field-of-view = 40", "field-of-view = 400", "glint.toml:3: scene.field-of-view: "),
        ("'directional'", "'candle'", "glint.toml:4: scene.lights: "),
        ("error = 0.3", "error = 0", "glint.toml:5: scene.error: "),
        ("bytes = '1M'", "bytes = '1X'", "glint.toml:6: scene.bytes: "),
        ("bytes = '1M'", "byte = '1M'", "glint.toml:6: scene.byte: expected image, "),
        ("distance = [12, 30]", "distance = [30, 3]", "glint.toml:12: materials.flakes.distance: "),
        ("distance = [12, 30]\n", "", "glint.toml:9: materials.flakes: expected distance"),
        ("uv-per-metre = 100\n", "", "glint.toml:15: materials.plate: expected texels-per-metre"),
        ("uv-per-metre = 100", "uv-per-metre = -1", "materials.plate.uv-per-metre: "),
        ("tilt = 0", "tilt = 90", "materials.plate.tilt: "),
        ("alpha = [0.7, 0.9]", "alpha = [0.4, 1.8]", "environments.studio.alpha: "),
        ("levels = 2", "levels = 2\ndistance = [1, 2]\ntexels-per-metre = 1", "materials.told: nothing to plan"),
        ("roughness = 0.2", "roughnes = 0.2", "materials.flakes.roughnes: unexpected argument"),
        ("lights = ['directional', 'rectangle', 'environment']\n", "", "glint.toml:1: scene: expected lights"),
    ] {
        let folder = scene(SCENE);
        edit(&folder.path().join("glint.toml"), old, new);
        let done = bake(folder.path(), &["plan"]);
        assert!(done.code == 2 && done.stderr.contains(part), "{part} is not in\n{}", done.stderr);
    }
    let folder = scene("[materials.told]\nmethod = 'dictionary'\n");
    let done = bake(folder.path(), &["plan"]);
    assert!(done.code == 2 && done.stderr.contains("nothing to plan"), "{}", done.stderr);
}

#[test]
fn ninja_builds_what_is_planned() {
    let folder = scene(SCENE);
    let program = program("glint-bake");
    bake(folder.path(), &["ninja", "-o", "build.ninja", "--program", program.to_str().unwrap()]).ok();
    let text = fs::read_to_string(folder.path().join("build.ninja")).unwrap();
    assert!(text.contains("build build.ninja: manifest glint.toml flakes.png scratches.png sky.hdr\n"), "{text}");
    assert!(text.contains("--skip-mips=2"), "{text}");
    let Ok(done) = std::process::Command::new("ninja").current_dir(folder.path()).output() else {
        return eprintln!("skipped: ninja is not installed");
    };
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stdout));
    let by_ninja = packs(folder.path());
    for name in by_ninja.keys() {
        fs::remove_file(folder.path().join("packs").join(name)).unwrap();
    }
    bake(folder.path(), &["build"]).ok();
    assert!(packs(folder.path()) == by_ninja);
}

/// The real maps' folder; None, said, where there is none.
fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("GLINT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    if !folder.is_dir() {
        eprintln!("skipped: no real maps in {} (set GLINT_DATA)", folder.display());
        return None;
    }
    Some(folder)
}

/// Bytes of a pack without its uniform buffers.
fn chosen_bytes(pack: &[u8]) -> u64 {
    let read = Pack::from_bytes(pack.to_vec(), &Limits::default()).unwrap();
    let uniforms = read.sections().iter().filter(|entry| entry.kind.0.ends_with(b"UB"));
    pack.len() as u64 - uniforms.map(|entry| entry.stored_len).sum::<u64>()
}

/// A bake's flags, and its input in the data folder.
type Accurate<'a> = (&'a [&'a str], &'a str);

/// A close-up, a background, and both at once: each pack keeps its error at places that the plan did not see, and
/// together they are at most a quarter of what everything takes at its most accurate. Uniform buffers, which have the same size
/// whatever a plan chooses, are left out on both sides.
#[test]
fn three_scenes_take_a_quarter_and_keep_their_error() {
    let Some(data) = data() else { return };
    let glints = ["ndf-maps", "--preset", "accurate", "--roughness", "0.05"];
    let highlights = ["area-light", "--anisotropic"];
    // Texels are what counts here: an error that is asked loosely takes less time and as many bytes.
    let sky = ["environment", "--filter-error", "0.2", "--measure", "0"];
    let map = |name: &str, rest: &str| {
        let path = data.join(name);
        let title = path.file_stem().unwrap().to_str().unwrap().to_owned();
        format!("[materials.{title}]\ninput = '{}'\nassume-linear = true\n{rest}", path.display())
    };
    let tiny = |name: &str, rest: &str| map(&format!("tiny/{name}.png"), &format!("roughness = 0.05\n{rest}"));
    let hero = "field-of-view = 30\nlights = ['point', 'rectangle', 'environment']\nerror = 0.12\n".to_owned()
        + &tiny("scratches_32x32", "distance = [0.1, 0.5]\ntexels-per-metre = 4000\n")
        + &format!(
            "[environments.city]\ninput = '{}'\nalpha = [0.35, 0.6]\n",
            data.join("hdri/city_pmndrs_512_zip.exr").display()
        );
    let far = "field-of-view = 50\nlights = ['point']\nerror = 0.12\n".to_owned()
        + &tiny("flakes_8x8", "distance = [5, 50]\ntexels-per-metre = 4000\n")
        + &tiny("brushed_16x16", "distance = [20, 200]\ntexels-per-metre = 2000\n");
    let mixed = "field-of-view = 40\nlights = ['point', 'rectangle']\nerror = 0.3\n".to_owned()
        + &tiny("brushed_16x16", "method = 'ndf-maps'\ndistance = [0.5, 10]\ntexels-per-metre = 2000\n")
        + &map(
            "normals/technical_fabric_sheencloth_256_rgba.png",
            "method = 'area-light'\nbase-roughness = 0.2\ndistance = [2, 12]\ntexels-per-metre = 2500\n",
        );
    let scenes: [(&str, String, Vec<Accurate<'_>>); 3] = [
        (
            "hero",
            hero,
            vec![
                (&glints, "tiny/scratches_32x32.png"),
                (&highlights, "tiny/scratches_32x32.png"),
                (&sky, "hdri/city_pmndrs_512_zip.exr"),
            ],
        ),
        ("far", far, vec![(&glints, "tiny/flakes_8x8.png"), (&glints, "tiny/brushed_16x16.png")]),
        (
            "mixed",
            mixed,
            vec![
                (&glints, "tiny/brushed_16x16.png"),
                (&highlights, "normals/technical_fabric_sheencloth_256_rgba.png"),
            ],
        ),
    ];
    for (name, text, everything) in scenes {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("glint.toml"), format!("[scene]\n{text}")).unwrap();
        let built = bake(folder.path(), &["build"]).ok().stderr;
        let planned: u64 = packs(folder.path()).values().map(|bytes| chosen_bytes(bytes)).sum();
        let mut accurate = 0;
        for (args, input) in everything {
            let input = data.join(input);
            let linear = if args[0] == "environment" { &[][..] } else { &["--assume-linear"][..] };
            let all = [args, linear, &[input.to_str().unwrap(), "-o", "all.glintpack"]].concat();
            bake(folder.path(), &all).ok();
            accurate += chosen_bytes(&fs::read(folder.path().join("all.glintpack")).unwrap());
        }
        assert!(4 * planned <= accurate, "{name}: {planned} bytes of {accurate}\n{built}");
        let measured = bake(folder.path(), &["plan", "--measure"]);
        eprintln!("{name}: {planned} bytes, {accurate} at the most accurate\n{}", measured.stdout);
        assert_eq!(measured.code, 0, "{name}\n{}{built}", measured.stdout);
    }
}
