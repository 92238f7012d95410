//! `glint-bake textures --gltf`: what changes in a file, what does not, what other programs say of it, and what is refused.

use crate::foreign::{node, npm_package};
use crate::gltf_file::{Gltf, glb, levels, png, quad, quad_parts};
use crate::support::{Outcome, bake};
use image::RgbImage;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// Two of the same, one without a map, one that is not filtered, one with other factors.
const MATERIALS: &str = r#"[
    {"name": "worn", "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 1}, "roughnessFactor": 0.60},
     "normalTexture": {"scale": 0.5, "index": 0}, "occlusionTexture": {"index": 1, "strength": 0.25}, "extras": {"kept": 1.0}},
    {"name": "plain", "pbrMetallicRoughness": {"roughnessFactor": 0.3, "metallicFactor": 0.2},
     "normalTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"scale": [ 3, 3 ]}}}},
    {"name": "flat", "pbrMetallicRoughness": {"baseColorTexture": {"index": 2}}},
    {"name": "twin", "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 1}, "roughnessFactor": 0.6},
     "normalTexture": {"index": 0, "scale": 0.5}},
    {"name": "full", "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 1}}, "normalTexture": {"index": 0}}
]"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.glb"), quad(MATERIALS)).unwrap();
    folder
}

/// Rewrites in.glb as a file.
fn rewritten(folder: &Path, output: &str, flags: &[&str]) -> Gltf {
    bake(folder, &[&["textures", "--gltf", "in.glb", "-o", output], flags].concat()).ok();
    Gltf::read(&folder.join(output))
}

#[test]
fn materials_get_filtered_textures_with_their_factors_in_the_texels() {
    let folder = folder();
    let new = rewritten(folder.path(), "out.glb", &[]);
    let roughness = "/pbrMetallicRoughness/metallicRoughnessTexture";
    // Factors are in the texels: 0.6 · 100, 0.3 · 255, 100.
    for (material, green, blue) in [(0, 60, [0, 255]), (1, 77, [255, 255]), (3, 60, [0, 255]), (4, 100, [0, 255])] {
        let factors = &new.json["materials"][material];
        assert!(factors["pbrMetallicRoughness"]["roughnessFactor"].as_f64().unwrap_or(1.0) == 1.0, "{factors}");
        assert!(factors["normalTexture"]["scale"].as_f64().unwrap_or(1.0) == 1.0, "{factors}");
        let mips = levels(new.basisu(material, roughness));
        assert_eq!(mips.len(), 4);
        assert_eq!((mips[0][0][1], mips[0][0][2], mips[0][7][2]), (green, blue[0], blue[1]), "{material}");
        // Normals that lean both ways are rougher from afar.
        assert!(mips[3][0][1] > green + 20 && mips[3][0][2].abs_diff(if blue[0] == 0 { 127 } else { 255 }) <= 1);
    }
    let red = |material| levels(new.basisu(material, roughness))[0][0][0];
    assert_eq!((red(0), red(1)), (200, 255));
    // A scale of a half: x of 0.38 against z of 0.93 becomes 0.2.
    let x = |material: usize| levels(new.basisu(material, "/normalTexture"))[0][0][0];
    assert!(x(0).abs_diff(153) <= 1 && x(1).abs_diff(176) <= 1, "{} {}", x(0), x(1));
    // One pair for what is the same, others for other factors.
    let textures = |material: usize| {
        let material = &new.json["materials"][material];
        [material.pointer(roughness).unwrap()["index"].clone(), material["normalTexture"]["index"].clone()]
    };
    assert_eq!(textures(0), textures(3));
    assert!(textures(0)[0] != textures(4)[0] && textures(0)[1] != textures(4)[1] && textures(1)[1] != textures(4)[1]);
    let worn = &new.json["materials"][0];
    assert_eq!(worn["occlusionTexture"], json!({"index": textures(0)[0], "strength": 0.25}));
    // The map that a material did not have lies as its normals do.
    let plain = new.json["materials"][1].pointer(roughness).unwrap();
    let transform = json!({"KHR_texture_transform": {"scale": [3, 3]}});
    assert_eq!((&plain["texCoord"], &plain["extensions"]), (&json!(0), &transform));
    // Mips are read: nearest stays nearest, and none becomes linear.
    let sampler = |texture: &Value| new.json["samplers"][texture["sampler"].as_u64().unwrap() as usize].clone();
    assert_eq!(sampler(new.texture(0, roughness)), json!({"magFilter": 9728, "minFilter": 9984, "wrapS": 33071}));
    assert_eq!(sampler(new.texture(0, "/normalTexture")), json!({"minFilter": 9987}));
    assert_eq!(new.json["extensionsUsed"], json!(["KHR_texture_transform", "ACME_unknown", "KHR_texture_basisu"]));
    assert_eq!(new.json.get("extensionsRequired"), None);
}

#[test]
fn everything_else_stays_as_it_is_written() {
    let folder = folder();
    let old = Gltf::read(&folder.path().join("in.glb"));
    for flags in [&[][..], &["--gltf-images", "ktx2-only"], &["--gltf-images", "png", "--max-size", "4"]] {
        let new = rewritten(folder.path(), "out.glb", flags);
        for part in [
            r#""odd": [1.50e0, -0.0, 1e2]"#,
            r#""extensions": {"ACME_unknown": {"z": 0.10, "a": "\u00e9", "list": [ 1 , 2 ]}},"#,
            r#"{"name": "flat", "pbrMetallicRoughness": {"baseColorTexture": {"index": 2}}},"#,
            r#""extras": {"kept": 1.0}"#,
            r#"{"bufferView": 5, "mimeType": "image/png", "extras": {"of": "ours"}}"#,
            r#"{"source": 2}"#,
        ] {
            assert!(old.text.contains(part) && new.text.contains(part), "{flags:?}: {part} in\n{}", new.text);
        }
        let keys = |gltf: &Gltf| {
            let lines = gltf.text.lines().filter_map(|line| line.strip_prefix("  \"")?.split('"').next());
            lines.map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(keys(&old)[..12], keys(&new)[..12], "{flags:?}");
        for view in [0, 2, 4, 5, 6, 7] {
            assert!(old.view(view) == new.view(view), "{flags:?}: view {view}");
            assert_eq!(new.json["bufferViews"][view]["byteOffset"].as_u64().unwrap() % 4, 0);
        }
        let length = new.json["buffers"][0]["byteLength"].as_u64().unwrap() as usize;
        assert!(length <= new.binary.len() && new.binary.len() < length + 4);
    }
    // Again, and with other threads, the same.
    let again = bake(folder.path(), &["textures", "--gltf", "in.glb", "-o", "out.glb", "-j", "1"]).ok();
    let first = fs::read(folder.path().join("out.glb")).unwrap();
    assert!(again.stderr.contains("written"));
    let again = bake(folder.path(), &["textures", "--gltf", "in.glb", "-o", "out.glb", "-j", "3"]).ok();
    assert!(again.stderr.contains("unchanged") && fs::read(folder.path().join("out.glb")).unwrap() == first);
}

#[test]
fn images_lie_in_the_file_as_it_was_asked() {
    let folder = folder();
    let old = Gltf::read(&folder.path().join("in.glb"));
    let source = |gltf: &Gltf, material: usize| gltf.texture(material, "/normalTexture")["source"].clone();
    // PNG of the finest level stays for loaders without the extension: the file's own where it is that level.
    let both = rewritten(folder.path(), "both.glb", &["--zstd"]);
    assert!(both.image(0) == old.image(0) && source(&both, 4) == 0 && source(&both, 0) != 0);
    let still = image::load_from_memory(both.image(source(&both, 0).as_u64().unwrap() as usize)).unwrap().to_rgb8();
    assert!(still.get_pixel(0, 0).0[0].abs_diff(153) <= 1);
    let file = both.basisu(4, "/normalTexture");
    let scheme = ktx2::Reader::new(file).unwrap().header().supercompression_scheme;
    assert_eq!(scheme, Some(ktx2::SupercompressionScheme::Zstandard));
    // Alone they take the places of the old ones.
    let alone = rewritten(folder.path(), "alone.glb", &["--gltf-images", "ktx2-only"]);
    assert_eq!(source(&alone, 0), Value::Null);
    assert_eq!(alone.json["extensionsRequired"], json!(["KHR_texture_basisu"]));
    assert!(alone.image(0).starts_with(b"\xabKTX 20") && alone.json["images"][0]["name"] == "normal");
    assert_eq!(alone.json["textures"][0]["name"], "bumps");
    // Bevy reads KTX2 where others have PNG, and does not know the extension.
    let bevy = rewritten(folder.path(), "bevy.glb", &["--target", "bevy"]);
    let texture = bevy.texture(0, "/normalTexture");
    assert_eq!(texture["source"], texture["extensions"]["KHR_texture_basisu"]["source"]);
    assert_eq!(bevy.json.get("extensionsRequired"), None);
    // PNG has one level: as it was, or a smaller one that has the roughness of what it lost.
    let said = bake(folder.path(), &["textures", "--gltf", "in.glb", "-o", "png.glb", "--gltf-images", "png"]).ok();
    assert!(said.stderr.contains("without --max-size the texels stay"), "{}", said.stderr);
    assert!(Gltf::read(&folder.path().join("png.glb")).json["extensionsUsed"].as_array().unwrap().len() == 2);
    let small = rewritten(folder.path(), "small.glb", &["--gltf-images", "png", "--max-size", "4"]);
    let place = "/pbrMetallicRoughness/metallicRoughnessTexture";
    let index = small.texture(4, place)["source"].as_u64().unwrap() as usize;
    let found = image::load_from_memory(small.image(index)).unwrap().to_rgb8();
    let whole = levels(alone.basisu(4, place));
    assert_eq!(found.dimensions(), (4, 2));
    assert!(found.pixels().zip(&whole[1]).all(|(a, b)| a.0 == b[..3]));
    assert!(found.get_pixel(1, 0).0[1] > 120);
}

#[test]
fn a_gltf_goes_with_the_files_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (text, binary) = quad_parts(MATERIALS);
    let old = glb(&text, &binary);
    fs::create_dir_all(at("in/sub folder")).unwrap();
    fs::create_dir(at("out")).unwrap();
    fs::write(at("in.glb"), &old).unwrap();
    let parts = Gltf::read(&at("in.glb"));
    fs::write(at("in/sub folder/normal é.png"), parts.image(0)).unwrap();
    fs::write(at("in/colour.png"), parts.image(2)).unwrap();
    fs::write(at("in/data.bin"), &binary).unwrap();
    let text = text
        .replace(
            r#"{"bufferView": 1, "mimeType": "image/png", "name""#,
            r#"{"uri": "sub%20folder/normal%20%C3%A9.png", "name""#,
        )
        .replace(r#"{"bufferView": 5, "mimeType": "image/png""#, r#"{"uri": "colour.png""#)
        .replace("\"buffers\": [{", "\"buffers\": [{\"uri\": \"data.bin\", ");
    fs::write(at("in/a.gltf"), &text).unwrap();
    let flags = ["--gltf-images", "ktx2-only", "--depfile", "d"];
    bake(folder.path(), &[&["textures", "--gltf", "in/a.gltf", "-o", "out/b c.gltf"], &flags[..]].concat()).ok();
    let mut names: Vec<String> =
        fs::read_dir(at("out")).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    // What nobody names any more does not come along.
    let mut expected = vec!["b c.gltf".to_owned(), "colour.png".to_owned(), "data.bin".to_owned()];
    for pair in 0..3 {
        expected.extend(["metallic-roughness", "normal"].map(|kind| format!("b c-{pair}-{kind}.ktx2")));
    }
    expected.sort();
    assert_eq!(names, expected);
    assert!(fs::read(at("out/data.bin")).unwrap() == binary);
    let new = Gltf::read(&at("out/b c.gltf"));
    let image = new.texture(0, "/normalTexture")["extensions"]["KHR_texture_basisu"]["source"].as_u64().unwrap();
    assert_eq!(new.json["images"][image as usize]["uri"], "b%20c-0-normal.ktx2");
    let rule = fs::read_to_string(at("d")).unwrap();
    assert!(rule.starts_with("out/b\\ c.gltf: \\\n  in/a.gltf \\\n  in/data.bin"), "{rule}");
    let embedded = {
        let folder = folder.path();
        bake(folder, &["textures", "--gltf", "in.glb", "-o", "out.glb", "--gltf-images", "ktx2-only"]).ok();
        Gltf::read(&at("out.glb"))
    };
    assert!(fs::read(at("out/b c-0-normal.ktx2")).unwrap() == embedded.basisu(0, "/normalTexture"));
    // In the folder itself, nothing is copied; on its own files, nothing is written.
    bake(folder.path(), &["textures", "--gltf", "in/a.gltf", "-o", "in/b.gltf", "-n"]).ok();
    assert!(!at("in/b.gltf").exists());
    bake(folder.path(), &["textures", "--gltf", "in/a.gltf", "-o", "in/b.gltf"]).ok();
    let refused = bake(folder.path(), &["textures", "--gltf", "in/b.gltf", "-o", "in/b.gltf"]);
    assert!(refused.code == 2 && refused.stderr.contains("is an input as well"), "{}", refused.stderr);
}

/// Issues of the validator by severity: error 0, warning 1.
fn issues(package: &Path, files: &[&Path], severity: u64) -> Vec<Vec<String>> {
    let found = node("gltf_validator.mjs", package, files);
    let of = |file: &Value| {
        let of_file = file.as_array().unwrap().iter().filter(|issue| issue["severity"] == severity);
        of_file.map(|issue| format!("{} {}", issue["code"].as_str().unwrap(), issue["pointer"])).collect()
    };
    found.as_array().unwrap().iter().map(of).collect()
}

#[test]
fn the_validator_finds_no_error_and_no_new_warning() {
    let Some(package) = npm_package("gltf-validator") else { return };
    let folder = folder();
    let mut files = vec![folder.path().join("in.glb")];
    for (output, flags) in [
        ("png.glb", &["--gltf-images", "png", "--max-size", "4"][..]),
        ("both.glb", &[]),
        ("alone.glb", &["--gltf-images", "ktx2-only", "--zstd"]),
    ] {
        rewritten(folder.path(), output, flags);
        files.push(folder.path().join(output));
    }
    let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let (errors, warnings) = (issues(&package, &paths, 0), issues(&package, &paths, 1));
    assert!(errors.iter().all(Vec::is_empty), "{errors:?}");
    assert!(warnings[..2].iter().all(Vec::is_empty), "{warnings:?}");
    // This version of the validator does not know KHR_texture_basisu, nor the kind of image that it is for.
    for warnings in &warnings[2..] {
        let unknown = ["VALUE_NOT_IN_LIST", "IMAGE_UNRECOGNIZED_FORMAT"];
        let others: Vec<&String> =
            warnings.iter().filter(|warning| !unknown.iter().any(|code| warning.starts_with(code))).collect();
        assert!(others.is_empty(), "{warnings:?}");
        assert!(!warnings.is_empty() && warnings.iter().all(|warning| warning.contains("/images/")), "{warnings:?}");
    }
}

#[test]
fn three_js_loads_every_mip() {
    let Some(package) = npm_package("three") else { return };
    let folder = folder();
    let mut files = Vec::new();
    for (output, flags) in [
        ("both.glb", &["--zstd"][..]),
        ("alone.glb", &["--gltf-images", "ktx2-only"]),
        ("bevy.glb", &["--target", "bevy"]),
    ] {
        rewritten(folder.path(), output, flags);
        files.push(folder.path().join(output));
    }
    let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let found = node("three_loader.mjs", &package, &paths);
    let sizes = json!([[8, 4, 128], [4, 2, 32], [2, 1, 8], [1, 1, 4]]);
    for (file, materials) in files.iter().zip(found.as_array().unwrap()) {
        for material in [0, 1, 3, 4] {
            let found = &materials[material];
            assert_eq!(found["normal"], sizes, "{}: {found}", file.display());
            assert_eq!(found["roughness"], sizes, "{}: {found}", file.display());
            assert_eq!((&found["factor"], &found["scale"]), (&json!(1), &json!(1)), "{}", file.display());
        }
        assert_eq!(materials[0]["occlusion"], sizes);
    }
}

/// Runs glint-bake on a file of these bytes.
fn on(folder: &Path, name: &str, bytes: &[u8], flags: &[&str]) -> Outcome {
    fs::write(folder.join(name), bytes).unwrap();
    let output = if name.ends_with(".glb") { "out.glb" } else { "out.gltf" };
    bake(folder, &[&["textures", "--gltf", name, "-o", output], flags].concat())
}

#[test]
fn damaged_and_strange_files_are_refused_by_what_is_wrong() {
    let folder = folder();
    let folder = folder.path();
    let (text, binary) = quad_parts(MATERIALS);
    let changed = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        glb(&text.replacen(from, to, 1), &binary)
    };
    let image = |uri: &str| changed(r#"{"bufferView": 1, "mimeType": "image/png""#, &format!(r#"{{"uri": "{uri}""#));
    let grey = png(&RgbImage::from_pixel(4, 4, image::Rgb([128, 128, 128])));
    let mut longer = glb(&text, &binary);
    longer[8] = longer[8].wrapping_add(4);
    for (bytes, code, part) in [
        (b"".to_vec(), 4, "its JSON is not that of glTF"),
        (b"glTF\x01\0\0\0\x0c\0\0\0".to_vec(), 5, "GLB version 1"),
        (longer, 4, "where its header says"),
        (changed("\"2.0\"", "\"1.0\""), 5, "glTF version '1.0'"),
        (changed("\"scene\": 0", "\"scene\" 0"), 4, "line 4"),
        (
            changed("\"materials\": [", &format!("\"deep\": {}{}, \"materials\": [", "[".repeat(300), "]".repeat(300))),
            4,
            "its JSON",
        ),
        (
            changed("\"scale\": 0.5, \"index\": 0", "\"scale\": 0.5, \"index\": 9"),
            4,
            "material 0 'worn': it asks for texture 9, 3 are there",
        ),
        (changed("\"source\": 0", "\"source\": -1"), 4, "its JSON is not that of glTF"),
        (changed("\"source\": 1", "\"source\": 5"), 4, "it asks for image 5, 3 are there"),
        (changed("\"sampler\": 0", "\"sampler\": 4"), 4, "it asks for sampler 4, 1 are there"),
        (
            changed("\"source\": 0", "\"extensions\": {\"KHR_texture_basisu\": {\"source\": 0}}"),
            5,
            "only: KHR_texture_basisu",
        ),
        (
            changed("\"roughnessFactor\": 0.60", "\"roughnessFactor\": 1.60"),
            4,
            "material 0 'worn': expected a roughnessFactor of 0 to 1, found 1.6",
        ),
        (changed("{\"bufferView\": 1,", "{\"bufferView\": 11,"), 4, "image 0: it asks for buffer view 11, 8 are there"),
        (changed("\"byteOffset\":48", "\"byteOffset\":18446744073709551615"), 4, "image 0: buffer view 1"),
        (changed("\"byteOffset\":48", "\"byteOffset\":40"), 4, "image 0"),
        (changed("\"byteLength\": ", "\"byteLength\": 9"), 4, "buffer 0 has"),
        (image("../secret.png"), 5, "it lies at '../secret.png'"),
        (image("https://example.org/a.png"), 5, "only files beside or below"),
        (image("none.png"), 3, "none.png cannot be read"),
        (image("data:image/png;base64,A*"), 4, "image 0: its data URI is not base64"),
        (image("data:image/png,abc"), 4, "its data URI is not base64"),
        (glb(&text.replace("normalTexture", "normalTextures"), &binary), 4, "no material has a normal texture"),
    ] {
        let found = on(folder, "case.glb", &bytes, &[]);
        assert_eq!(found.code, code, "{part}: {}", found.stderr);
        assert!(found.stderr.contains("case.glb: "), "{}", found.stderr);
        assert!(found.stderr.contains(part) && !found.stderr.contains("report this"), "{part}: {}", found.stderr);
    }
    fs::write(folder.join("grey.png"), grey).unwrap();
    let found = on(folder, "case.glb", &image("grey.png"), &[]);
    assert!(found.code == 4 && found.stderr.contains("case.glb: image 0: "), "{}", found.stderr);
    let outside = text.replace("\"buffers\": [{", "\"buffers\": [{\"uri\": \"b.bin\", ");
    fs::write(folder.join("b.bin"), &binary).unwrap();
    let found = on(folder, "case.glb", &glb(&outside, &[]), &[]);
    assert!(found.code == 5 && found.stderr.contains("embed all buffers first"), "{}", found.stderr);
    // Cut anywhere, and with any byte of the header or the JSON damaged, it ends by itself.
    let whole = glb(&text, &binary);
    for step in 0..24 {
        let mut bytes = whole[..whole.len() * step / 24].to_vec();
        let cut = on(folder, "case.glb", &bytes, &["-n"]);
        assert!((3..=6).contains(&cut.code), "{step}: {}", cut.stderr);
        bytes = whole.clone();
        bytes[step * 131] ^= 0x15;
        let damaged = on(folder, "case.glb", &bytes, &["-n"]);
        assert!(damaged.code <= 6 && damaged.code != 1, "{step}: {}", damaged.stderr);
    }
}

#[test]
fn flags_that_do_not_go_with_a_file_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("n.png"), b"none").unwrap();
    for (flags, code, part) in [
        (&["--gltf", "in.glb", "-o", "out.gltf"][..], 2, "expected a name that ends in .glb"),
        (&["--gltf", "in.glb", "-o", "in.glb"], 2, "is an input as well"),
        (&["--gltf", "in.glb", "-o", "-"], 2, "--gltf: expected files"),
        (&["--gltf", "none.glb", "-o", "out.glb"], 3, "none.glb"),
        (&["--gltf", "in.glb", "-o", "none/out.glb"], 3, "does not exist"),
        (
            &["--gltf", "in.glb", "-o", "out.glb", "--target", "unreal"],
            2,
            "--target: with --gltf expected gltf or bevy",
        ),
        (&["--gltf", "in.glb", "-o", "out.glb", "--blocks"], 2, "--blocks"),
        (&["--gltf", "in.glb", "-o", "out.glb", "--crop", "1x1+0+0"], 2, "--crop"),
        (&["--gltf", "in.glb", "-o", "out.glb", "--roughness", "0.4"], 2, "--roughness"),
        (&["--gltf", "in.glb", "n.png", "-o", "out.glb"], 2, "NORMAL_MAP"),
        (&["--gltf", "in.glb", "-o", "out.glb", "--max-memory", "2K"], 6, "--max-memory"),
        (&["--gltf", "in.glb", "-o", "out.glb", "--max-size", "0"], 2, "--max-size"),
        (&["n.png", "-o", "out", "--max-size", "8"], 2, "--gltf"),
        (&["n.png", "-o", "out", "--gltf-images", "png"], 2, "--gltf"),
        (&["-o", "out"], 2, "NORMAL_MAP"),
    ] {
        let refused = bake(folder.path(), &[&["textures"], flags].concat());
        assert_eq!(refused.code, code, "{flags:?}: {}", refused.stderr);
        assert!(refused.stderr.contains(part), "{flags:?}: {}", refused.stderr);
    }
    assert!(!folder.path().join("out.glb").exists());
    let said = bake(folder.path(), &["textures", "--gltf", "in.glb", "-o", "out.glb", "-n"]).ok();
    assert!(said.stderr.contains("would write out.glb") && !folder.path().join("out.glb").exists());
}
