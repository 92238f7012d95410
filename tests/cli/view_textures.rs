//! Materials of glTF files in `glint-view`: what is drawn of them, that what `glint-bake textures --gltf` writes is calmer from afar and
//! the same near by, and what is refused.

use crate::gltf_file::{Gltf, glb, png as png_of, quad, quad_parts, quad_with};
use crate::support::{Outcome, bake};
use crate::view::{difference, folder, png, view};
use glint_bake::input::synthetic;
use image::RgbImage;
use std::fs;
use std::path::Path;

/// The quad from straight ahead, in light that it mirrors to the camera here and there.
const AHEAD: [&str; 6] = ["--size", "96x96", "--sun", "0.15,0.1,1", "--tone", "linear"];

/// Draws a mesh alone; the pixels.
fn draw(folder: &Path, mesh: &str, flags: &[&str]) -> Vec<u8> {
    let out = folder.join("shot.png");
    let args = ["--mesh", mesh, "--headless", out.to_str().unwrap(), "-q"];
    view(folder, &[&args[..], &AHEAD, flags].concat()).ok();
    png(&out).2
}

/// The camera at a distance from the middle of the quad.
fn at(distance: f64) -> String {
    format!("0,0,{distance},0.5,0.5,0")
}

/// A map of 128 × 128 texels eight times over the quad, which is metal of this roughness, as in.glb.
fn metal(folder: &Path, map: &RgbImage, roughness: f32) {
    let white = png_of(&RgbImage::from_pixel(1, 1, image::Rgb([255; 3])));
    let transform = r#"{"KHR_texture_transform": {"scale": [8, 8]}}"#;
    let material = format!(
        r#"[{{"normalTexture": {{"index": 0, "extensions": {transform}}}, "pbrMetallicRoughness": {{"roughnessFactor": {roughness}}}}}]"#
    );
    let (text, binary) = quad_with(&material, [png_of(map), white.clone(), white]);
    fs::write(folder.join("in.glb"), glb(&text, &binary)).unwrap();
}

/// From afar a pixel spans five and sixteen texels; near by, a texel is seven pixels wide.
#[test]
fn filtered_textures_are_calmer_from_afar_and_the_same_near_by() {
    if folder().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let exposure = ["--exposure", "-3"];
    for (name, map) in [("leather", synthetic::leather(128, 128, 1)), ("flakes", synthetic::flakes(128, 128, 1))] {
        metal(folder, &map, 0.4);
        bake(folder, &["textures", "--gltf", "in.glb", "--zstd", "-o", "out.glb"]).ok();
        let shot = |mesh: &str, distance: f64, flags: &[&str]| {
            draw(folder, mesh, &[&["--camera", &at(distance)], &exposure[..], flags].concat())
        };
        let same = difference(&shot("in.glb", 0.02, &[]), &shot("out.glb", 0.02, &[]));
        println!("{name}, near by: {same:.3} apart");
        assert!(same < 0.5, "{name}: near by they are {same} apart");
        for far in [0.8, 2.5] {
            let zoomed = |mesh, flags: &[&str]| [far, 1.01 * far].map(|distance| shot(mesh, distance, flags));
            let truth = zoomed("in.glb", &["--reference", "--samples", "256"]);
            let [before, after] = ["in.glb", "out.glb"].map(|mesh| zoomed(mesh, &[]));
            let errors = [&before, &after].map(|shots| difference(&shots[0], &truth[0]));
            let changes = [&before, &after, &truth].map(|shots| difference(&shots[0], &shots[1]));
            println!("{name}, distance {far}: error {errors:.2?}, change under 1 % of zoom {changes:.2?}");
            assert!(errors[1] < 0.7 * errors[0], "{name}, distance {far}: {errors:?}");
            assert!(changes[1] < changes[0], "{name}, distance {far}: {changes:?}");
        }
    }
}

/// Each material changes the picture by what it says.
#[test]
fn materials_are_drawn_as_they_are() {
    if folder().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let shot = |material: &str, flags: &[&str]| {
        fs::write(folder.join("quad.glb"), quad(&format!("[{material}]"))).unwrap();
        draw(folder, "quad.glb", &[&["--camera", &at(2.0), "--exposure"], flags].concat())
    };
    let plain = shot("{}", &["-2"]);
    let mut pictures = vec![plain.clone()];
    for material in [
        r#"{"normalTexture": {"index": 0}}"#,
        r#"{"normalTexture": {"index": 0, "scale": 0.5}}"#,
        r#"{"normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [0.4, 0.4]}}}}"#,
        r#"{"pbrMetallicRoughness": {"roughnessFactor": 0.5}}"#,
        r#"{"pbrMetallicRoughness": {"metallicFactor": 0}}"#,
        r#"{"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.5, 0.1, 1]}}"#,
        r#"{"pbrMetallicRoughness": {"baseColorTexture": {"index": 2}}}"#,
        r#"{"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 1}}}"#,
        r#"{"emissiveFactor": [0, 0.5, 0]}"#,
        r#"{"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 2}}"#,
    ] {
        let picture = shot(material, &["-2"]);
        for other in &pictures {
            assert!(difference(other, &picture) > 0.05, "{material} changes nothing");
        }
        pictures.push(picture);
    }
    // Occlusion takes what comes from around, and nothing of the sun's light.
    let occluded = r#"{"occlusionTexture": {"index": 1}}"#;
    let mean = |pixels: &[u8]| pixels.iter().map(|&value| f64::from(value)).sum::<f64>() / pixels.len() as f64;
    let (without, with) = (shot("{}", &["2"]), shot(occluded, &["2"]));
    assert!(mean(&with) < mean(&without), "{} and {}", mean(&with), mean(&without));
}

/// The bytes of a file with four bytes of the header of every KTX2 in it changed.
fn with_header(bytes: &[u8], at: usize, value: u32) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let starts: Vec<usize> = (0..bytes.len() - 12).filter(|&i| bytes[i..].starts_with(b"\xabKTX 20\xbb")).collect();
    assert!(!starts.is_empty());
    for start in starts {
        bytes[start + at..][..4].copy_from_slice(&value.to_le_bytes());
    }
    bytes
}

#[test]
fn what_cannot_be_drawn_is_refused_or_said() {
    if folder().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let list = |name: &str, flags: &[&str]| view(folder, &[&["--mesh", name, "--list"], flags].concat());
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).unwrap();
    let refuses = |outcome: Outcome, code: i32, part: &str| {
        assert_eq!(outcome.code, code, "{part}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(part), "{}", outcome.stderr);
    };
    let normal = r#"[{"name": "worn", "normalTexture": {"index": 0}}]"#;
    write("quad.glb", &quad(normal));
    let listed = list("quad.glb", &[]).ok().stdout;
    assert!(listed.contains("textures:quad  ") && listed.contains("plain-textures:quad  "), "{listed}");

    // Images that are none, or not there, or too many.
    write("index.glb", &quad(r#"[{"normalTexture": {"index": 7}}]"#));
    refuses(list("index.glb", &[]), 4, "material 0, normalTexture: it asks for texture 7, 3 are there");
    write("factor.glb", &quad(r#"[{"pbrMetallicRoughness": {"roughnessFactor": 2}}]"#));
    refuses(list("factor.glb", &[]), 4, "material 0: expected a roughnessFactor of 0 to 1, found 2");
    let (text, binary) =
        quad_with(normal, [b"no image".to_vec(), png_of(&RgbImage::new(1, 1)), png_of(&RgbImage::new(1, 1))]);
    write("none.glb", &glb(&text, &binary));
    refuses(list("none.glb", &[]), 4, "none.glb: image 0: the content is no image");
    metal(folder, &synthetic::flakes(128, 128, 1), 0.3);
    refuses(list("in.glb", &["--max-memory", "128K"]), 6, "in.glb: image 0: the image is 128×128 and needs");
    let (text, binary) = quad_parts(normal);
    let beside = text.replacen(r#""bufferView": 1, "mimeType": "image/png""#, r#""uri": "gone.png""#, 1);
    write("beside.glb", &glb(&beside, &binary));
    refuses(list("beside.glb", &[]), 3, "gone.png");
    // With a pack there is something to show without it.
    let packs = crate::support::packs().0;
    fs::copy(folder.join("none.glb"), packs.path().join("none.glb")).unwrap();
    let shown = view(packs.path(), &["dictionary.glintpack", "--mesh", "none.glb", "--list"]).ok();
    assert!(
        shown.stderr.contains("its materials are left out") && !shown.stdout.contains("textures"),
        "{}",
        shown.stderr
    );

    // KTX2 of other kinds.
    bake(folder, &["textures", "--gltf", "quad.glb", "-o", "only.glb", "--gltf-images", "ktx2-only"]).ok();
    let only = fs::read(folder.join("only.glb")).unwrap();
    for (at, value, code, part) in [
        (12, 0, 5, "a format of Basis Universal (UASTC), which is not read; write it as plain"),
        (12, 97, 5, "the format R16G16B16A16_SFLOAT, which is not read"),
        (44, 1, 5, "compressed by Basis Universal, which is not read"),
        (44, 3, 5, "compressed by ZLIB, which is not read"),
        (28, 4, 5, "is no image: 8 × 4 × 4 texels"),
        (36, 6, 5, "6 faces"),
        (20, 9, 4, "level 0 of its KTX2 is damaged"),
        (20, 1 << 20, 6, "raise --max-memory"),
    ] {
        write("odd.glb", &with_header(&only, at, value));
        refuses(list("odd.glb", &["--max-memory", "4M"]), code, part);
    }
    // The image for other loaders is drawn in place of one that is not read, and that is said.
    bake(folder, &["textures", "--gltf", "quad.glb", "-o", "both.glb"]).ok();
    let both = fs::read(folder.join("both.glb")).unwrap();
    write("basis.glb", &with_header(&both, 44, 1));
    let said = list("basis.glb", &[]).ok().stderr;
    assert!(said.contains("material 0 'worn', normalTexture: its other image is drawn, since"), "{said}");
    assert_eq!(Gltf::read(&folder.join("basis.glb")).json["textures"][0]["source"], 0);
    let [png, basis] = ["quad.glb", "basis.glb"].map(|mesh| draw(folder, mesh, &["--camera", &at(2.0)]));
    assert!(difference(&png, &basis) < 0.5);

    // What is left out.
    let other = r#"[{"alphaMode": "BLEND", "extensions": {"KHR_materials_sheen": {}}, "emissiveTexture": {"index": 2, "texCoord": 1}}]"#;
    write("other.glb", &quad(other));
    let said = list("other.glb", &[]).ok().stderr;
    for part in [
        "material 0 is drawn opaque, its alphaMode is BLEND",
        "material 0 is drawn without KHR_materials_sheen",
        "material 0 is drawn without its emissiveTexture",
    ] {
        assert!(said.contains(part), "{said}");
    }
}

/// What `glint-bake textures` writes is the same material, for whatever engine it was packed.
#[test]
fn lists_of_textures_are_shown_however_they_are_packed() {
    if folder().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    synthetic::flakes(64, 64, 1).save(folder.join("flakes.png")).unwrap();
    let out = folder.join("shot.png");
    let shot = |name: &str, flags: &[&str]| {
        let list = format!("{name}/flakes.json");
        let args = [&list, "--shape", "sphere", "--size", "96x64", "--headless", out.to_str().unwrap(), "-q"];
        view(folder, &[&args[..], flags].concat()).ok();
        png(&out).2
    };
    let write = |name: &str, flags: &[&str]| {
        bake(folder, &[&["textures", "flakes.png", "--roughness", "0.2", "-o", name, "-q"], flags].concat()).ok();
    };
    write("gltf", &[]);
    let listed = view(folder, &["gltf/flakes.json", "--list"]).ok().stdout;
    assert!(listed.contains("\ntextures:flakes  ") && listed.contains("\nplain-textures:flakes  "), "{listed}");
    let plain = shot("gltf", &[]);
    for (name, flags) in [
        ("unreal", &["--target", "unreal"][..]),
        ("unity", &["--target", "unity"]),
        ("generic", &["--target", "generic"]),
        ("alpha", &["--store", "alpha", "--bits", "16"]),
        ("two", &["--two-channel", "--zstd"]),
        ("fine", &["--bits", "16", "--zstd"]),
    ] {
        write(name, flags);
        let apart = difference(&plain, &shot(name, &[]));
        println!("{name}: {apart:.3} apart");
        assert!(apart < 0.5, "{name}: {apart}");
    }
    let baseline = shot("gltf", &["--method", "plain-textures"]);
    assert!(difference(&plain, &baseline) > 0.5);
    assert!(shot("gltf", &["--against", "baseline"]) == shot("gltf", &["--against", "plain-textures"]));
    for flags in [
        &["--f0", "0.9,0.3,0.2"][..],
        &["--texels-per-unit", "16"],
        &["--uv-scale", "3"],
        &["--light", "points"],
        &["--light", "rect"],
    ] {
        assert!(difference(&plain, &shot("gltf", flags)) > 0.05, "{flags:?} change nothing");
    }
    // Nearer to the reference than plain mips are.
    let far = |flags: &[&str]| {
        shot("gltf", &[&["--texels-per-unit", "2000", "--tone", "linear", "--exposure", "-2"], flags].concat())
    };
    let truth = far(&["--reference", "--samples", "256"]);
    let [error, plain_error] =
        ["textures", "plain-textures"].map(|method| difference(&far(&["--method", method, "--samples", "16"]), &truth));
    println!("list: error {error:.2}, of plain mips {plain_error:.2}");
    assert!(error < plain_error, "{error} and {plain_error}");

    let refuses = |list: &str, code: i32, part: &str| {
        let refused = view(folder, &[list, "--list"]);
        assert_eq!(refused.code, code, "{list}: {}", refused.stderr);
        assert!(refused.stderr.contains(part), "{list}: {}", refused.stderr);
    };
    write("dds", &["--format", "dds"]);
    refuses(
        "dds/flakes.json",
        5,
        "flakes_normal.dds: only KTX2 is drawn; write them with glint-bake textures --format ktx2",
    );
    write("blocks", &["--blocks"]);
    refuses("blocks/flakes.json", 5, "BC5_UNORM_BLOCK, which is not read; write it as plain R, RG or RGBA");
    fs::write(folder.join("other.json"), "{\"files\": []}").unwrap();
    refuses("other.json", 4, "other.json: it is no list of glint-bake textures");
    refuses("gone.json", 3, "gone.json");
    fs::remove_file(folder.join("two/flakes_orm.ktx2")).unwrap();
    refuses("two/flakes.json", 3, "flakes_orm.ktx2");
    fs::copy(folder.join("fine/flakes_orm.ktx2"), folder.join("alpha/flakes_orm.ktx2")).unwrap();
    refuses("alpha/flakes.json", 4, "flakes_orm.ktx2: it was changed after the list was written");
    let text = fs::read_to_string(folder.join("gltf/flakes.json")).unwrap();
    fs::write(folder.join("gltf/away.json"), text.replace("flakes_normal.ktx2", "../fine/flakes_normal.ktx2")).unwrap();
    refuses("gltf/away.json", 4, "it is no name of a file beside the list");
    let dry = view(
        folder,
        &["gltf/flakes.json", "--method", "plain-textures", "--against", "baseline", "--headless", "b.png"],
    );
    assert!(dry.code == 2 && dry.stderr.contains("plain-textures has none"), "{}", dry.stderr);
    write("stretched", &["--anisotropy", "surface"]);
    let said = view(folder, &["stretched/flakes.json", "--list"]).ok().stderr;
    assert!(said.contains("flakes_anisotropy.ktx2 is not drawn: highlights are round"), "{said}");
}

/// A real mesh with a real normal map.
#[test]
fn a_real_file_is_calmer_after_it_was_rewritten() {
    let data = std::env::var_os("GLINT_DATA").map_or_else(|| crate::support::root().join("../shared/data"), Into::into);
    let mesh = data.join("mesh/clearcoat_carpaint_sphere.glb");
    if folder().is_none() || !mesh.exists() {
        eprintln!("skipped: GLINT_DATA has no {}", mesh.display());
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::copy(mesh, folder.join("in.glb")).unwrap();
    bake(folder, &["textures", "--gltf", "in.glb", "--zstd", "-o", "out.glb"]).ok();
    let camera = ["--camera", "20,10,12"];
    let truth = draw(folder, "in.glb", &[&camera[..], &["--reference", "--samples", "128"]].concat());
    let errors = ["in.glb", "out.glb"].map(|mesh| difference(&draw(folder, mesh, &camera), &truth));
    println!("car paint: error {errors:.3?}");
    assert!(errors[1] < errors[0], "{errors:?}");
}
