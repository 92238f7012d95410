//! `glint-bake textures --normal-alpha`: what lies in alpha of a normal map is kept, read as roughness, or left out and said.

use crate::gltf_file::{Gltf, glb, levels, quad_parts};
use crate::support::{Outcome, bake, json};
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use image::{ImageFormat, Rgba, RgbaImage};
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// Alpha from column to column.
fn alpha(i: u32) -> u8 {
    60 + 20 * i as u8
}

/// Normals that lean to both sides, and [`alpha`].
fn map() -> RgbaImage {
    RgbaImage::from_fn(8, 4, |i, _| Rgba([if i % 2 == 0 { 176 } else { 80 }, 150, 244, alpha(i)]))
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    map().save(folder.path().join("n.png")).unwrap();
    image::DynamicImage::ImageRgba8(map()).to_rgb8().save(folder.path().join("rgb.png")).unwrap();
    folder
}

fn textures(folder: &Path, flags: &[&str]) -> Outcome {
    bake(folder, &[&["textures", "n.png", "-o", "out"], flags].concat())
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join("out").join(name)).unwrap()
}

/// Alpha of every texel of every mip, as averages of the map's columns have it.
fn expected() -> Vec<Vec<f32>> {
    let finest: Vec<f32> = (0..32).map(|k| f32::from(alpha(k % 8))).collect();
    let column = |width: u32, i: u32| {
        let share = 8 / width;
        (i * share..(i + 1) * share).map(|i| f32::from(alpha(i))).sum::<f32>() / share as f32
    };
    let level = |(width, height): (u32, u32)| (0..width * height).map(|k| column(width, k % width)).collect();
    [vec![finest], [(4, 2), (2, 1), (1, 1)].into_iter().map(level).collect()].concat()
}

fn check(found: &[Vec<f32>], what: &str) {
    let expected = expected();
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(found.len(), expected.len(), "{what}");
        let near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= 0.6);
        assert!(near, "{what}: {found:?}, {expected:?}");
    }
}

#[test]
fn kept_alpha_is_averaged_in_every_format_that_holds_it() {
    let folder = folder();
    let at = folder.path();
    let keep = |flags: &[&str]| textures(at, &[&["--normal-alpha", "keep"], flags].concat()).ok();
    keep(&[]);
    let ktx2: Vec<Vec<f32>> = levels(&read(at, "n_normal.ktx2"))
        .iter()
        .map(|level| level.iter().map(|texel| f32::from(texel[3])).collect())
        .collect();
    check(&ktx2, "KTX2");
    // Beside it the normals are as they are without it.
    let colours = |file: Vec<u8>| levels(&file).concat().iter().map(|t| [t[0], t[1], t[2]]).collect::<Vec<_>>();
    let with = colours(read(at, "n_normal.ktx2"));
    textures(at, &["--normal-alpha", "drop"]).ok();
    assert!(with == colours(read(at, "n_normal.ktx2")));
    assert!(levels(&read(at, "n_normal.ktx2")).concat().iter().all(|texel| texel[3] == 255));

    keep(&["--format", "dds"]);
    let dds = ddsfile::Dds::read(&*read(at, "n_normal.dds")).unwrap();
    let texels = dds.get_data(0).unwrap();
    let flat: Vec<f32> = texels.chunks_exact(4).map(|texel| f32::from(texel[3])).collect();
    let expected_flat = expected().concat();
    assert!(flat.iter().zip(&expected_flat).all(|(a, b)| (a - b).abs() <= 0.6) && flat.len() == expected_flat.len());

    keep(&["--format", "png", "--bits", "16"]);
    let png = |mip: u32| image::load_from_memory(&read(at, &format!("n_normal.mip{mip}.png"))).unwrap();
    let mip = |mip| png(mip).to_rgba16().pixels().map(|texel| f32::from(texel.0[3]) / 257.0).collect();
    check(&(0..4).map(mip).collect::<Vec<_>>(), "PNG");
    // What has no alpha stays without one.
    assert!(png(0).color().has_alpha());
    assert!(!image::load_from_memory(&read(at, "n_orm.mip0.png")).unwrap().color().has_alpha());

    keep(&["--format", "exr"]);
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let image = reader.all_attributes().from_file(at.join("out/n_normal.exr")).unwrap();
    let of_part = |part: &exr::prelude::Layer<exr::prelude::AnyChannels<FlatSamples>>| {
        let channel = part.channel_data.list.iter().find(|channel| channel.name.eq("A")).unwrap();
        let FlatSamples::F16(values) = &channel.sample_data else { panic!() };
        values.iter().map(|value| 255.0 * value.to_f32()).collect()
    };
    check(&image.layer_data.iter().map(of_part).collect::<Vec<_>>(), "EXR");

    // And is read of it.
    exr::prelude::write_rgba_file(at.join("e.exr"), 8, 4, |i, _| (0.6_f32, 0.5_f32, 0.98_f32, 0.125_f32 * i as f32))
        .unwrap();
    let said = bake(at, &["textures", "e.exr", "-o", "out"]).ok().stderr;
    assert!(said.contains("the alpha channel holds data"), "{said}");
    bake(at, &["textures", "e.exr", "--normal-alpha", "keep", "-o", "out"]).ok();
    assert_eq!(levels(&read(at, "e_normal.ktx2"))[0][..3].iter().map(|t| t[3]).collect::<Vec<_>>(), [0, 32, 64]);
    bake(at, &["textures", "n.png", "--roughness-map", "e.exr", "--roughness-channel", "a", "-o", "out"]).ok();
    assert_eq!(levels(&read(at, "n_orm.ktx2"))[0][..3].iter().map(|t| t[1]).collect::<Vec<_>>(), [0, 32, 64]);

    // BC5 has no alpha: BC7, which is said.
    for format in ["ktx2", "dds"] {
        let said = keep(&["--blocks", "--format", format]).stderr;
        assert!(said.contains("normals with alpha are in BC7 instead of BC5"), "{said}");
    }
    let file = read(at, "n_normal.ktx2");
    assert_eq!(ktx2::Reader::new(&file).unwrap().header().format, Some(ktx2::Format::BC7_UNORM_BLOCK));
    let dds = ddsfile::Dds::read(&*read(at, "n_normal.dds")).unwrap();
    assert_eq!(dds.get_dxgi_format(), Some(ddsfile::DxgiFormat::BC7_UNorm));

    // A part of the map has its part of alpha.
    keep(&["--crop", "2x2+4+1"]);
    assert_eq!(levels(&read(at, "n_normal.ktx2"))[0].iter().map(|t| t[3]).collect::<Vec<_>>(), [140, 160, 140, 160]);
}

#[test]
fn roughness_in_alpha_is_the_material_s() {
    let folder = folder();
    let at = folder.path();
    let both = || ["n_normal.ktx2", "n_orm.ktx2"].map(|name| read(at, name));
    for more in [&[][..], &["--roughness-is", "smoothness"], &["--roughness-is", "alpha", "--crop", "5x3+1+1"]] {
        textures(at, &[&["--normal-alpha", "roughness"], more].concat()).ok();
        let of_alpha = both();
        textures(at, &[&["--roughness-map", "n.png", "--roughness-channel", "a"], more].concat()).ok();
        assert!(of_alpha == both(), "{more:?}");
    }
    textures(at, &["--normal-alpha", "roughness"]).ok();
    let [normal, orm] = both().map(|file| levels(&file));
    let green: Vec<u8> = orm[0].iter().take(8).map(|texel| texel[1]).collect();
    assert_eq!(green, (0..8).map(alpha).collect::<Vec<_>>());
    assert!(normal.concat().iter().all(|texel| texel[3] == 255));
    // A map that is read once is enough.
    let output = assert_cmd::Command::cargo_bin("glint-bake")
        .unwrap()
        .args(["textures", "-", "--normal-alpha", "roughness", "--name", "n", "-o", "piped"])
        .current_dir(at)
        .write_stdin(fs::read(at.join("n.png")).unwrap())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(fs::read(at.join("piped/n_orm.ktx2")).unwrap() == read(at, "n_orm.ktx2"));
}

#[test]
fn alpha_is_left_out_only_where_that_is_said() {
    let folder = folder();
    let at = folder.path();
    let what =
        "the alpha channel holds data (often roughness or height); ignored, unless --normal-alpha says what it is";
    let said = textures(at, &["--json"]).ok();
    assert!(said.stderr.contains(what), "{}", said.stderr);
    let list = json(&said.stdout);
    assert!(list["notes"].to_string().contains("--normal-alpha") && list["options"].get("normal-alpha").is_none());
    let files = || ["n_normal.ktx2", "n_orm.ktx2"].map(|name| read(at, name));
    let left_out = files();
    for (choice, roughness) in [("drop", true), ("keep", true), ("roughness", false)] {
        let said = textures(at, &["--normal-alpha", choice, "--json"]).ok();
        assert!(!said.stderr.contains("alpha channel"), "{choice}: {}", said.stderr);
        let options = &json(&said.stdout)["options"];
        assert_eq!(options["normal-alpha"], choice);
        assert_eq!(options.get("roughness").is_some(), roughness, "{choice}");
        assert_eq!(files() == left_out, choice == "drop", "{choice}");
    }
    // Heights have alpha too.
    let grey = image::GrayAlphaImage::from_fn(8, 4, |i, j| image::LumaA([(10 * (i + j)) as u8, alpha(i)]));
    grey.save(at.join("h.png")).unwrap();
    let said = bake(at, &["textures", "h.png", "--height", "2", "-o", "out"]).ok().stderr;
    assert!(said.contains(what), "{said}");
    bake(at, &["textures", "h.png", "--height", "2", "-o", "out", "--normal-alpha", "keep"]).ok();
    assert_eq!(levels(&read(at, "h_normal.ktx2"))[0][3][3], alpha(3));
}

#[test]
fn alpha_that_is_not_there_or_is_taken_is_refused() {
    let folder = folder();
    let at = folder.path();
    exr::prelude::write_rgba_file(at.join("wide.exr"), 8, 4, |i, _| (0.6_f32, 0.5_f32, 0.98_f32, 0.25_f32 * i as f32))
        .unwrap();
    for (map, flags, code, part) in [
        (
            "rgb.png",
            &["--normal-alpha", "keep"][..],
            4,
            "rgb.png: --normal-alpha asks for alpha, and the image has none",
        ),
        ("rgb.png", &["--normal-alpha", "roughness"], 4, "asks for alpha"),
        ("wide.exr", &["--normal-alpha", "roughness"], 4, "wide.exr: alpha of texel (5, 0) is 1.25; expected 0 to 1"),
        ("n.png", &["--normal-alpha", "opacity"], 2, "--normal-alpha"),
        (
            "n.png",
            &["--normal-alpha", "keep", "--two-channel"],
            2,
            "--normal-alpha keep: --two-channel leaves no alpha",
        ),
        ("n.png", &["--normal-alpha", "keep", "--channels", "ag"], 2, "--channels says that alpha is x or y"),
        ("n.png", &["--normal-alpha", "roughness", "--channels", "ra"], 2, "--channels says that alpha is x or y"),
        (
            "n.png",
            &["--normal-alpha", "roughness", "--roughness", "0.4"],
            2,
            "leave out --roughness and --roughness-map",
        ),
        ("n.png", &["--normal-alpha", "roughness", "--roughness-map", "rgb.png"], 2, "is the roughness already"),
    ] {
        let refused = bake(at, &[&["textures", map, "-o", "none"], flags].concat());
        assert_eq!(refused.code, code, "{flags:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(part), "{flags:?}: {}", refused.stderr);
    }
    assert!(!at.join("none").exists());
}

/// Of two normal images one has alpha; the specification has loaders ignore it, programs that know it may not.
#[test]
fn alpha_of_a_gltf_file_s_normals_is_kept_where_it_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (text, mut binary) =
        quad_parts(r#"[{"normalTexture": {"index": 0, "scale": 0.5}}, {"normalTexture": {"index": 1}}]"#);
    let mut image = Cursor::new(Vec::new());
    map().write_to(&mut image, ImageFormat::Png).unwrap();
    let view = format!("{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}}}", binary.len(), image.get_ref().len());
    let old = binary.len();
    binary.extend(image.into_inner());
    // Texture 1 gets an image of its own, without a change of the others.
    let text = text
        .replace("\"bufferViews\": [", &format!("\"bufferViews\": [{view}, "))
        .replace(&format!("\"byteLength\": {old}"), &format!("\"byteLength\": {}", binary.len()));
    let shifted = (0..8).rev().fold(text, |text, view| {
        let (from, to) = (format!("\"bufferView\": {view}"), format!("\"bufferView\": {}", view + 1));
        text.replace(&from, &to)
    });
    let text = shifted
        .replace("\"mimeType\": \"image/png\", \"bufferView\": 4", "\"mimeType\": \"image/png\", \"bufferView\": 0");
    fs::write(at.join("in.glb"), glb(&text, &binary)).unwrap();
    let rewrite = |flags: &[&str]| bake(at, &[&["textures", "--gltf", "in.glb", "-o", "out.glb"], flags].concat());
    let said = rewrite(&[]).ok().stderr;
    let what = "image 1: the alpha channel holds data (often roughness or height); ignored, unless --normal-alpha says";
    assert!(said.contains(what) && said.matches("alpha channel").count() == 1, "{said}");
    let alphas = |material| {
        let file = Gltf::read(&at.join("out.glb"));
        let mips = levels(file.basisu(material, "/normalTexture"));
        mips.iter().map(|mip| mip.iter().map(|texel| f32::from(texel[3])).collect()).collect::<Vec<Vec<f32>>>()
    };
    assert!(alphas(1).concat().iter().all(|alpha| *alpha == 255.0));
    for (choice, flags) in [("drop", &[][..]), ("keep", &[])] {
        let said = rewrite(&[&["--normal-alpha", choice], flags].concat()).ok().stderr;
        assert!(!said.contains("alpha"), "{said}");
        assert!(alphas(0).concat().iter().all(|alpha| *alpha == 255.0), "{choice}");
    }
    check(&alphas(1), "glTF");
    // As PNG too.
    rewrite(&["--normal-alpha", "keep", "--gltf-images", "png", "--max-size", "4"]).ok();
    let file = Gltf::read(&at.join("out.glb"));
    let source = file.texture(1, "/normalTexture")["source"].as_u64().unwrap() as usize;
    let small = image::load_from_memory(file.image(source)).unwrap().to_rgba8();
    assert_eq!(small.dimensions(), (4, 2));
    assert!(
        small.pixels().zip(&expected()[1]).all(|(found, expected)| (f32::from(found.0[3]) - expected).abs() <= 0.6)
    );
    let refused = rewrite(&["--normal-alpha", "roughness"]);
    assert!(
        refused.code == 2 && refused.stderr.contains("materials of a glTF file have roughness"),
        "{}",
        refused.stderr
    );
}
