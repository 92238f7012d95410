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

#[test]
fn view_reflectance_and_exposure_change_the_picture() {
    let folder = maps();
    bake(folder.path(), &["ndf-maps", "flakes.png", "-o", "out.glintpack", "--placement", "stochastic"]).ok();
    let shot = |flags: &[&str]| {
        let args = ["preview", "out.glintpack", "-o", "shot.png", "--size", "48x48", "--light", "0,0.5,1"];
        bake(folder.path(), &[&args[..], flags].concat()).ok();
        image::open(folder.path().join("shot.png")).unwrap().to_rgb8()
    };
    let sum = |picture: &image::RgbImage, channel: usize| picture.pixels().map(|p| u64::from(p[channel])).sum::<u64>();
    let plain = shot(&[]);
    assert!(shot(&["--view", "0,0.35,1"]) == plain, "the default, spelt out");
    assert!(shot(&["--view", "1,0,0.5"]) != plain);
    let red = shot(&["--f0", "0.56,0,0"]);
    assert!(sum(&red, 0) > 2 * sum(&red, 2) && sum(&plain, 2) > 0, "{} {}", sum(&red, 0), sum(&red, 2));
    let bright = shot(&["--exposure", "4"]);
    assert!(sum(&bright, 1) > sum(&plain, 1));
}
