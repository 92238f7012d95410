//! `glint-bake lobes --synthesize`: what it writes, says, refuses, and leaves alone; what `glint-info` says of it.

use crate::support::Case;
use glint_bake::input::synthetic;

fn case_of(args: &'static [&'static str]) -> Case {
    let folder = tempfile::tempdir().unwrap();
    synthetic::scratches(64, 64, 1).save(folder.path().join("hide.png")).unwrap();
    Case { folder, args }
}

/// A surface of 200 × 100 texels.
fn case() -> Case {
    case_of(&["lobes", "hide.png", "-o", "out.glintpack", "--synthesize", "200x100", "--patch", "32"])
}

#[test]
fn a_surface_becomes_a_pack_that_verifies_and_is_described() {
    let case = case();
    let done = case.bake(&["--write-normal-map", "all.png"]).ok();
    assert!(done.stderr.contains("hide: surface 200 × 100 texels, lookup"), "{}", done.stderr);
    case.verify();
    let report = case.report();
    assert_eq!(report["lobes"], serde_json::json!([]));
    let surface = &report["surfaces"][0];
    assert_eq!((&surface["name"], &surface["patches"], &surface["patch"]), (&"hide".into(), &28.into(), &32.into()));
    assert_eq!(surface["size"], serde_json::json!([200, 100]));
    // 64 cells of 8 texels, 16 of 16 and of 32 each, and the whole.
    assert_eq!(surface["sample"]["lobe_bytes"], (64 + 16 + 16 + 4) * 32 * 16);
    let options = report["provenance"][0]["options"].as_array().unwrap();
    assert!(options.contains(&serde_json::json!(["synthesize", "200x100"])), "{options:?}");
    let text = case.info(&[]).ok().stdout;
    for part in ["surface \"hide\"", "200 × 100 texels, patches of 32 texels that overlap by 8", "28 patches"] {
        assert!(text.contains(part), "{part} is missing from:\n{text}");
    }
    let map = image::open(case.path("all.png")).unwrap();
    assert_eq!((map.width(), map.height(), map.color()), (200, 100, image::ColorType::Rgb8));
    // Every texel of it is one of the map's, to rounding.
    let known: std::collections::BTreeSet<[u8; 3]> =
        image::open(case.path("hide.png")).unwrap().to_rgb8().pixels().map(|p| p.0).collect();
    let near = |p: [u8; 3]| known.iter().any(|k| (0..3).all(|c| k[c].abs_diff(p[c]) <= 1));
    assert!(map.to_rgb8().pixels().step_by(97).all(|p| near(p.0)));
}

#[test]
fn patches_and_the_whole_ndf_are_plotted() {
    let case = case();
    case.bake(&[]).ok();
    case.info(&["--plot", "plots", "-q"]).ok();
    let picture = |name: &str| image::open(case.path("plots").join(name)).unwrap().to_rgb8();
    let (patches, ndf) = (picture("0-hide-patches.png"), picture("0-hide-ndf.png"));
    assert_eq!((patches.dimensions(), ndf.dimensions()), ((512, 512), (512, 512)));
    // 7 × 4 patches.
    let colours: std::collections::BTreeSet<[u8; 3]> = patches.pixels().map(|pixel| pixel.0).collect();
    assert!((20..=28).contains(&colours.len()), "{}", colours.len());
    // Most facets of a scratched plate look up, and none lies outside the disk.
    assert!(ndf.get_pixel(256, 256) != ndf.get_pixel(256, 20) && ndf.get_pixel(2, 2).0 == [0; 3]);
}

#[test]
fn the_same_flags_give_the_same_bytes_on_any_number_of_threads() {
    let case = case();
    let one = case.same_on_any_threads();
    assert!(one != case.pack(&["--seed", "9"]) && one != case.pack(&["--overlap", "4"]));
}

#[test]
fn every_flag_is_taken() {
    let case = case_of(&["lobes", "hide.png", "-o", "out.glintpack", "--synthesize", "unbounded", "--patch", "48"]);
    let flags = ["--overlap", "5", "--alpha", "0.5", "--error-tolerance", "1", "--colours", "2", "--variants", "1"];
    let more = ["--write-normal-map", "part.png", "--normal-map-size", "90x70", "--cell", "16", "--k", "8"];
    case.bake(&[&flags[..], &more].concat()).ok();
    let report = case.report();
    let surface = &report["surfaces"][0];
    assert_eq!(surface["tiles"], serde_json::json!([2, 1]));
    assert_eq!((&surface["size"], &surface["overlap"]), (&serde_json::Value::Null, &5.into()));
    assert_eq!(surface["sample"]["cell_texels"], 16);
    assert_eq!(image::image_dimensions(case.path("part.png")).unwrap(), (90, 70));
}

#[test]
fn what_cannot_work_is_refused_by_the_name_of_its_flag() {
    let case = case();
    for (flags, code, named) in [
        (&["--overlap", "17"][..], 2, "--overlap"),
        (&["--alpha", "1.5"], 2, "--alpha"),
        (&["--error-tolerance=-1"], 2, "--error-tolerance"),
        (&["--colours", "2"], 2, "--colours"),
        (&["--variants", "2"], 2, "--variants"),
        (&["--cell", "32"], 2, "--cell"),
        (&["--max-memory", "1K"], 6, "--max-memory"),
        (&["--max-error", "0.000001"], 6, "--max-error"),
        (&["--normal-map-size", "10x10"], 2, "--write-normal-map"),
        (&["--write-normal-map", "hide.png"], 2, "hide.png"),
        (&["--write-normal-map", "none/all.png"], 3, "none"),
    ] {
        case.refuses(flags, code, named);
    }
    assert_eq!(case.names(), ["hide.png"]);
    let base = case_of(&["lobes", "hide.png", "-o", "out.glintpack"]);
    for (flags, code, named) in [
        (&["--synthesize", "9"][..], 2, "--synthesize"),
        (&["--synthesize", "0x9"], 2, "--synthesize"),
        (&["--synthesize", "1000000x1000000"], 6, "--synthesize"),
        (&["--patch", "32"], 2, "--synthesize"),
        (&["--synthesize", "200x100", "--patch", "40"], 2, "--patch"),
        (&["--synthesize", "200x100", "--patch", "0"], 2, "--patch"),
        (&["--synthesize", "200x100", "--patch", "128"], 4, "a smaller patch"),
        (&["--synthesize", "unbounded", "--patch", "48", "--write-normal-map", "a.png"], 2, "--normal-map-size"),
    ] {
        base.refuses(flags, code, named);
    }
    assert_eq!(base.names(), ["hide.png"]);
}

#[test]
fn a_dry_run_checks_all_and_writes_nothing() {
    let case = case();
    let done = case.bake(&["-n", "--write-normal-map", "all.png"]).ok();
    assert!(done.stderr.contains("surface of 200 × 100 texels"), "{}", done.stderr);
    assert!(done.stderr.contains("dry run, nothing was written"), "{}", done.stderr);
    assert_eq!(case.names(), ["hide.png"]);
}
