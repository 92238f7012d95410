//! `glint-bake preview`: pictures that are equal on any number of threads, that sparkle, and that have no holes.

use crate::support::{bake, info, maps};
use std::fs;

#[test]
fn equal_pictures_on_any_number_of_threads() {
    let folder = maps();
    let args = ["ndf-maps", "flakes.png", "scratches.png", "-o", "out.glintpack", "--layers", "scratches:flakes"];
    bake(folder.path(), &[&args[..], &["--placement", "stochastic"]].concat()).ok();
    for shape in ["sphere", "plane"] {
        let mut pictures = Vec::new();
        for threads in ["1", "2", "7"] {
            let args =
                ["preview", "out.glintpack", "-o", "shot.png", "--size", "64x48", "--shape", shape, "-j", threads];
            bake(folder.path(), &args).ok();
            pictures.push(fs::read(folder.path().join("shot.png")).unwrap());
        }
        assert!(pictures[0] == pictures[1] && pictures[0] == pictures[2], "{shape}");
    }
}

#[test]
fn flakes_sparkle() {
    let folder = maps();
    bake(folder.path(), &["ndf-maps", "flakes.png", "-o", "out.glintpack", "--placement", "stochastic"]).ok();
    let args =
        ["preview", "out.glintpack", "-o", "shot.png", "--size", "160x160", "--light", "0,0.5,1", "--uv-scale", "300"];
    bake(folder.path(), &args).ok();
    let picture = image::open(folder.path().join("shot.png")).unwrap().to_luma8();
    let bright = picture.pixels().filter(|p| p[0] > 200).count();
    assert!(bright > 30, "{bright} bright pixels");
    // Glints are small: next to a bright pixel there are often dark ones.
    let mut jumps = 0;
    for y in 0..160 {
        for x in 1..160 {
            jumps += usize::from(picture.get_pixel(x, y)[0].abs_diff(picture.get_pixel(x - 1, y)[0]) > 70);
        }
    }
    assert!(jumps > 60, "{jumps} jumps");
}

#[test]
fn wrong_requests_are_explained() {
    let folder = maps();
    bake(folder.path(), &["ndf-maps", "flakes.png", "-o", "out.glintpack"]).ok();
    for (args, code, cause) in [
        (&["out.glintpack", "-o", "shot.png", "--material", "gold"][..], 2, "flakes"),
        (&["out.glintpack", "-o", "shot.png", "--size", "0x4"], 2, "--size"),
        (&["out.glintpack", "-o", "shot.png", "--light", "0,0,0"], 2, "--light"),
        (&["none.glintpack", "-o", "shot.png"], 3, "none.glintpack"),
        (&["flakes.png", "-o", "shot.png"], 4, "G1002"),
        (&["out.glintpack", "-o", "out.glintpack"], 2, "an input as well"),
    ] {
        let done = bake(folder.path(), &[&["preview"], args].concat());
        assert_eq!(done.code, code, "{args:?}: {}", done.stderr);
        assert!(done.stderr.contains(cause), "{args:?}: {}", done.stderr);
    }
    info(folder.path(), &["out.glintpack", "--verify"]).ok();
}
