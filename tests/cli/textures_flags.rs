//! `glint-bake textures`: flags of how maps are read, anisotropy of brushed metal, and flags that do not go together.

use crate::gltf_file::{levels, quad};
use crate::support::{Outcome, bake, json};
use image::{GrayImage, Luma, Rgb, RgbImage};
use std::fs;
use std::path::Path;

fn textures(folder: &Path, flags: &[&str]) -> Outcome {
    bake(folder, &[&["textures", "n.png", "-o", "out"], flags].concat())
}

fn mips(folder: &Path, name: &str) -> Vec<Vec<[u8; 4]>> {
    levels(&fs::read(folder.join("out").join(name)).unwrap())
}

fn colour([x, y]: [f64; 2]) -> Rgb<u8> {
    Rgb([x, y, (1.0 - x * x - y * y).sqrt()].map(|v| (127.5 * v + 127.5).round() as u8))
}

/// A number without order, −1 to 1.
fn hash(i: u32, j: u32) -> f64 {
    let mut h = i.wrapping_mul(0x9e37_79b1) ^ j.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 15;
    h = h.wrapping_mul(0x2c1b_3c6d);
    f64::from(h ^ (h >> 12)) / f64::from(u32::MAX) * 2.0 - 1.0
}

/// Brushed across `degrees`, counted from +X to +Y: all normals lean along that, so that highlights are stretched along it.
fn brushed(degrees: f64, lean: f64) -> RgbImage {
    let (sin, cos) = degrees.to_radians().sin_cos();
    RgbImage::from_fn(32, 32, |i, j| {
        let along = 0.5 * hash(i, j);
        colour([along * cos, along * sin + lean])
    })
}

#[test]
fn brushed_metal_is_stretched_across_its_strokes_by_either_axes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (degrees, down) in [(30.0, false), (-60.0, false), (30.0, true)] {
        brushed(degrees, 0.0).save(at.join("n.png")).unwrap();
        for axes in ["surface", "normal"] {
            let mut flags = vec!["--anisotropy", axes, "--roughness", "0.5"];
            // Read the other way round, strokes are mirrored.
            let expected = if down { -degrees } else { degrees };
            flags.extend(down.then_some(["--normal-y", "down"]).into_iter().flatten());
            let said = textures(at, &flags).ok().stderr;
            // Under small texels mean normals lean, under large ones they do not.
            assert_eq!(said.contains("Mips 1, 2 are worse"), axes == "surface", "{said}");
            for name in ["n_normal", "n_orm", "n_anisotropy"] {
                assert_eq!(mips(at, &format!("{name}.ktx2")).len(), 6, "{name}");
            }
            // Coarse enough that each texel has normals of every kind.
            for texel in mips(at, "n_anisotropy.ktx2")[3..].concat() {
                let [x, y] = [texel[0], texel[1]].map(|v| f64::from(v) / 127.5 - 1.0);
                let off = (y.atan2(x).to_degrees() - expected).rem_euclid(180.0);
                assert!(off.min(180.0 - off) < 2.0, "{axes} {degrees} {down}: {texel:?} is off by {off}°");
                assert!((x.hypot(y) - 1.0).abs() < 0.02 && texel[2] > 60, "{axes}: {texel:?}");
            }
            // α_t of roughness and strength is as wide as the strokes are steep, α_b near to the material's own.
            let [orm, of] = ["n_orm.ktx2", "n_anisotropy.ktx2"].map(|name| mips(at, name)[5][0]);
            let (across, strength) = ((f64::from(orm[1]) / 255.0).powi(2), f64::from(of[2]) / 255.0);
            let along = across + (1.0 - across) * strength * strength;
            assert!((0.25..0.29).contains(&across) && (0.33..0.39).contains(&along), "{axes}: {along} {across}");
        }
    }
}

/// Where mean normals lean, engines with axes of the surface lose the highlight: no texture mends that, so it is said.
#[test]
fn axes_of_the_surface_are_warned_of_where_mean_normals_lean() {
    let folder = tempfile::tempdir().unwrap();
    brushed(30.0, 0.3).save(folder.path().join("n.png")).unwrap();
    let said = textures(folder.path(), &["--anisotropy", "surface", "--json"]).ok();
    let what = "--anisotropy surface: mean normals lean";
    assert!(said.stderr.contains(what) && said.stderr.contains("Mips 1, 2, 3, 4, 5 are worse"), "{}", said.stderr);
    assert!(json(&said.stdout)["notes"].to_string().contains(what));
    for flags in [&["--anisotropy", "normal"][..], &[]] {
        let said = textures(folder.path(), flags).ok().stderr;
        assert!(!said.contains("mean normals"), "{said}");
    }
}

#[test]
fn how_maps_are_read_is_as_the_flags_say() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let save = |name: &str, texel: &dyn Fn(u32, u32) -> Rgb<u8>| {
        RgbImage::from_fn(8, 8, texel).save(at.join(name)).unwrap();
    };
    let first = |flags: &[&str]| {
        textures(at, flags).ok();
        mips(at, "n_normal.ktx2")[0][0]
    };
    save("n.png", &|_, _| colour([0.4, 0.1]));
    let plain = first(&[]);
    assert!(plain[0].abs_diff(178) <= 1 && plain[1].abs_diff(140) <= 1, "{plain:?}");
    let swapped = first(&["--channels", "yx"]);
    assert_eq!((swapped[0], swapped[1]), (plain[1], plain[0]));
    // Texels beyond the edges count: a slope that the other edge does not go on with.
    save("n.png", &|i, _| colour([0.09 * f64::from(i) - 0.3, 0.0]));
    let edges = |wrap: &str| {
        textures(at, &["--wrap", wrap]).ok();
        [mips(at, "n_orm.ktx2")[1][0][1], mips(at, "n_orm.ktx2")[1][1][1]]
    };
    let (repeat, clamp) = (edges("repeat"), edges("clamp"));
    assert!(repeat[0] > clamp[0] && repeat[1] == clamp[1], "{repeat:?} {clamp:?}");
    // Stored by the curve of sRGB.
    let curve = |v: u8| {
        let linear = f64::from(v) / 255.0;
        (255.0 * (1.055 * linear.powf(1.0 / 2.4) - 0.055)).round() as u8
    };
    save("n.png", &|i, j| Rgb(colour([0.3 * hash(i, j), 0.3 * hash(j, i + 9)]).0.map(curve)));
    let linear = first(&["--colour-space", "linear"]);
    let decoded = first(&["--colour-space", "srgb"]);
    let expected = colour([0.3 * hash(0, 0), 0.3 * hash(0, 9)]);
    let near = |texel: [u8; 4]| texel.iter().zip(expected.0).all(|(a, b)| a.abs_diff(b) <= 3);
    assert!(near(decoded) && !near(linear), "{decoded:?} {linear:?} {expected:?}");
    let said = |flags: &[&str]| textures(at, flags).ok().stderr;
    assert!(said(&[]).contains("--colour-space srgb"), "it looks like sRGB, and is taken as it is");
    assert!(!said(&["--assume-linear"]).contains("--colour-space"));
    // -q says nothing, and threads are those that are asked for, at least one.
    assert!(said(&["-q"]).is_empty());
    assert_eq!(textures(at, &["-j", "0"]).code, 2);
}

#[test]
fn flags_that_do_not_go_together_and_bad_maps_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    RgbImage::from_fn(8, 4, |i, j| colour([0.2 * hash(i, j), 0.1])).save(at.join("n.png")).unwrap();
    GrayImage::from_pixel(3, 9, Luma([9])).save(at.join("grey.png")).unwrap();
    let write = |name: &str, value: f32| {
        let texel = move |i: usize, j: usize| if (i, j) == (3, 1) { (value, value, value) } else { (0.5, 0.5, 0.5) };
        exr::prelude::write_rgb_file(at.join(name), 8, 4, texel).unwrap();
    };
    write("rough.exr", 1.5);
    write("below.exr", -0.25);
    write("nan.exr", f32::NAN);
    for (flags, code, part) in [
        (&["--blocks", "--format", "exr"][..], 2, "--blocks: is for --format ktx2 and dds"),
        (&["--blocks", "--format", "png"], 2, "--blocks: is for --format ktx2 and dds"),
        (&["--zstd", "--format", "dds"], 2, "--zstd: is for --format ktx2"),
        (&["--zstd", "--format", "exr"], 2, "--zstd: is for --format ktx2"),
        (&["--crop", "0x4+0+0"], 2, "--crop"),
        (&["--crop", "9x4+0+0"], 4, "n.png: a crop of 9×4"),
        (&["--roughness", "-0.1"], 2, "--roughness"),
        (&["--roughness", "nan"], 2, "expected 0 to 1, found nan"),
        (&["--roughness-map", "rough.exr"], 4, "rough.exr: texel (3, 1) is 1.5; expected 0 to 1"),
        (&["--occlusion", "below.exr"], 4, "below.exr: texel (3, 1) is -0.25; expected 0 to 1"),
        (&["--metallic", "nan.exr"], 4, "nan.exr: texel (3, 1) is NaN; expected 0 to 1"),
        (&["--roughness-channel", "g"], 2, "--roughness-map"),
        (&["--occlusion-channel", "g"], 2, "--occlusion"),
        (&["--metallic-channel", "g"], 2, "--metallic"),
        (&["--only", "roughness"], 2, "--only: expected normal or orm, found roughness"),
        (&["--anisotropy", "surface", "--target", "godot"], 2, "--anisotropy: --target godot"),
        (&["--json", "-n"], 2, "--json"),
        (&["--name", ""], 2, "--name"),
        (&["--colour-space", "srgb", "--assume-linear"], 2, "--assume-linear"),
        (&["--output-y", "left"], 2, "--output-y"),
        (&["--store", "gloss"], 2, "--store"),
        (&["--format", "jpg"], 2, "--format"),
    ] {
        let refused = textures(at, flags);
        assert_eq!(refused.code, code, "{flags:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(part), "{flags:?}: {}", refused.stderr);
    }
    assert!(!at.join("out").exists());
    // No folder can be made there.
    for output in ["n.png/out", "/proc/out"] {
        let refused = bake(at, &["textures", "n.png", "-o", output]);
        assert!(refused.code == 3 && refused.stderr.contains(output), "{output}: {}", refused.stderr);
    }
    // Maps of other sizes are brought to that of the normals, which is said.
    let said = textures(at, &["--occlusion", "grey.png"]).ok().stderr;
    assert!(said.contains("grey.png: 3 × 9 texels, used at 8 × 4"), "{said}");
}

/// A glTF file says itself what its maps are and how they are stored.
#[test]
fn no_flag_of_maps_goes_with_a_gltf_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(at.join("in.glb"), quad(r#"[{"normalTexture": {"index": 0}}]"#)).unwrap();
    RgbImage::from_pixel(2, 2, Rgb([128, 128, 255])).save(at.join("n.png")).unwrap();
    for flags in [
        &["--name", "a"][..],
        &["--roughness-map", "n.png"],
        &["--roughness-is", "alpha"],
        &["--occlusion", "n.png"],
        &["--metallic", "n.png"],
        &["--format", "dds"],
        &["--bits", "16"],
        &["--only", "normal"],
        &["--two-channel"],
        &["--output-y", "down"],
        &["--store", "alpha"],
        &["--anisotropy", "normal"],
        &["--normal-y", "down"],
        &["--wrap", "clamp"],
        &["--channels", "xy"],
        &["--height", "1"],
        &["--json"],
    ] {
        let refused = bake(at, &[&["textures", "--gltf", "in.glb", "-o", "out.glb"], flags].concat());
        assert!(refused.code == 2 && refused.stderr.contains(flags[0]), "{flags:?}: {}", refused.stderr);
    }
    assert!(!at.join("out.glb").exists());
    bake(at, &["textures", "--gltf", "in.glb", "-o", "out.glb"]).ok();
}
