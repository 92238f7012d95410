//! `glint-bake textures` with `<UDIM>` in the names of maps.

use crate::support::bake;
use image::{GrayImage, Luma, Rgb, RgbImage};
use std::fs;
use std::path::Path;

/// Tiles of two sizes, and names that are none.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (number, size) in [(1001, 8), (1002, 4), (1011, 8)] {
        // Slopes that the other edge does not go on with.
        let normal = |i: u32, _| {
            let x = 0.09 * (i % 8) as f32 - 0.2;
            Rgb([x, 0.0, (1.0 - x * x).sqrt()].map(|value| (127.5 * value + 127.5).round() as u8))
        };
        RgbImage::from_fn(size, size, normal).save(at(&format!("n.{number}.png"))).unwrap();
        let value = 20 + (number % 100) as u8;
        GrayImage::from_pixel(size, size, Luma([value])).save(at(&format!("r_{number}.png"))).unwrap();
    }
    for name in ["n.0999.png", "n.101.png", "n.10011.png", "n.abcd.png", "n.1003.tif"] {
        fs::write(at(name), b"none").unwrap();
    }
    GrayImage::from_pixel(4, 4, Luma([51])).save(at("grey.png")).unwrap();
    folder
}

const SET: [&str; 7] = ["textures", "n.<UDIM>.png", "--roughness-map", "r_<UDIM>.png", "--occlusion", "grey.png", "-q"];

#[test]
fn every_tile_is_filtered_at_its_size_with_clamped_edges() {
    let folder = folder();
    bake(folder.path(), &[&SET[..], &["-o", "out"]].concat()).ok();
    let mut names: Vec<String> = fs::read_dir(folder.path().join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let of = |number: u32| ["", "_normal", "_orm"].map(|kind| format!("n{kind}.{number}"));
    let mut expected: Vec<String> = [1001, 1002, 1011].into_iter().flat_map(of).collect();
    expected.iter_mut().for_each(|name| *name += if name.contains('_') { ".ktx2" } else { ".json" });
    expected.sort();
    assert_eq!(names, expected);
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let size = |name: &str| ktx2::Reader::new(read(name)).unwrap().header().pixel_width;
    assert_eq!((size("out/n_normal.1001.ktx2"), size("out/n_normal.1002.ktx2")), (8, 4));
    // A tile is what its map alone would be, not repeated.
    let alone =
        ["textures", "n.1011.png", "--roughness-map", "r_1011.png", "--occlusion", "grey.png", "--name", "x", "-q"];
    bake(folder.path(), &[&alone[..], &["-o", "one", "--wrap", "clamp"]].concat()).ok();
    bake(folder.path(), &[&alone[..], &["-o", "two"]].concat()).ok();
    for kind in ["normal", "orm"] {
        assert!(read(&format!("out/n_{kind}.1011.ktx2")) == read(&format!("one/x_{kind}.ktx2")), "{kind}");
    }
    assert!(read("one/x_orm.ktx2") != read("two/x_orm.ktx2"));
    // Named otherwise, and as PNG.
    bake(folder.path(), &[&SET[..], &["-o", "png", "--name", "bricks", "--format", "png"]].concat()).ok();
    assert!(folder.path().join("png/bricks_normal.1002.mip1.png").exists());
}

#[test]
fn sets_that_are_not_whole_are_refused_by_the_file_that_lacks() {
    let folder = folder();
    let refuses = |args: &[&str], code: i32, part: &str| {
        let refused = bake(folder.path(), &[&["textures", "-o", "out"], args].concat());
        assert_eq!(refused.code, code, "{args:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(part), "{args:?}: {}", refused.stderr);
    };
    refuses(&["none.<UDIM>.png"], 3, "there is no tile; expected files as none.1001.png");
    refuses(&["none/n.<UDIM>.png"], 3, "none");
    refuses(&["<UDIM>/n.png"], 2, "not of a folder");
    refuses(&["n.<UDIM>.<UDIM>.png"], 2, "once");
    refuses(
        &["n.1001.png", "--roughness-map", "r_<UDIM>.png"],
        2,
        "--roughness-map: has <UDIM>, and the normal map has not",
    );
    refuses(&["n.<UDIM>.png", "--json"], 2, "--json");
    refuses(&["n.<UDIM>.png", "--depfile", "d"], 2, "--depfile");
    refuses(&["n.<UDIM>.png", "--name", "a<UDIM>"], 2, "--name");
    fs::remove_file(folder.path().join("r_1011.png")).unwrap();
    refuses(&["n.<UDIM>.png", "--roughness-map", "r_<UDIM>.png"], 3, "r_1011.png: cannot be read");
    assert!(!folder.path().join("out").exists() && !Path::new("out").exists());
}
