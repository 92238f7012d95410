//! Meshes of `glint-view` as they come: what they are drawn as, what is said, and which codes refusals have.

use crate::gltf_file::quad;
use crate::support::{Outcome, bake, packs, root};
use crate::view::folder;
use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Runs glint-view with a mesh; what it drew, if it did. No file takes longer than a minute.
fn draw(folder: &Path, mesh: &str) -> (Outcome, Vec<u8>) {
    let out = tempfile::tempdir().unwrap();
    let picture = out.path().join("a.png");
    let mut command = Command::cargo_bin("glint-view").unwrap();
    command.current_dir(folder).timeout(Duration::from_secs(60));
    command.args(["dictionary.glintpack", "--size", "96x64", "--mesh", mesh, "--headless"]).arg(&picture);
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let code = output.status.code().expect("it ends by itself");
    let outcome = Outcome { code, stdout: text(output.stdout), stderr: text(output.stderr) };
    (outcome, fs::read(picture).unwrap_or_default())
}

/// The folder of shared data, if it is there.
fn data(name: &str) -> Option<String> {
    let folder = std::env::var_os("GLINT_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
    let path = folder.join(name);
    if !path.exists() {
        eprintln!("skipped: GLINT_DATA has no {name}");
        return None;
    }
    Some(path.to_str().unwrap().to_owned())
}

/// A square of four corners with texture coordinates.
const SQUARE: &str = "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nvt 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 1 0\n";

#[test]
fn the_same_mesh_is_the_same_picture() {
    let Some(folder) = folder() else { return };
    let folder = folder.path();
    let obj = |name: &str, text: &str| {
        fs::write(folder.join(name), text).unwrap();
        name.to_owned()
    };
    let plain = format!("{SQUARE}f 1/1/1 2/2/1 3/3/1 4/4/1\n");
    let mut pairs = vec![
        (Some(obj("plain.obj", &plain)), Some(obj("marked.obj", &format!("\u{feff}{plain}")))),
        (Some("plain.obj".to_owned()), Some(obj("dos.obj", &plain.replace('\n', "\r\n")))),
        (Some("plain.obj".to_owned()), Some(obj("mac.obj", &plain.replace('\n', "\r")))),
    ];
    pairs.push((data("cases/nobom.obj"), data("cases/bom.obj")));
    for (a, b) in pairs {
        let (Some(a), Some(b)) = (a, b) else { continue };
        let [one, other] = [&a, &b].map(|mesh| {
            let (outcome, picture) = draw(folder, mesh);
            outcome.ok();
            picture
        });
        assert!(one == other && !one.is_empty(), "{a} and {b}");
    }
    // The packed file's uv are rounded to 1/4095 of their range, which a picture of eight bits shows here and there.
    if let (Some(plain), Some(packed)) = (data("cases/uv_plain.glb"), data("cases/uv_gltfpack.glb")) {
        let [one, other] = [plain, packed].map(|mesh| {
            let (outcome, picture) = draw(folder, &mesh);
            outcome.ok();
            image::load_from_memory(&picture).unwrap().to_rgb8().into_raw()
        });
        let difference: u64 = one.iter().zip(&other).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        assert!(difference < one.len() as u64, "{difference} of {} values", one.len());
    }
}

/// What `glint-bake textures --gltf` writes is the same mesh to methods of packs, which take of materials only where their textures lie.
#[test]
fn other_textures_leave_the_mesh_as_it_was() {
    let Some(folder) = folder() else { return };
    let folder = folder.path();
    let transform = r#"{"KHR_texture_transform": {"scale": [3, 3]}}"#;
    let material = format!(r#"[{{"normalTexture": {{"index": 0, "extensions": {transform}}}}}]"#);
    fs::write(folder.join("quad.glb"), quad(&material)).unwrap();
    for mesh in [Some("quad.glb".to_owned()), data("mesh/clearcoat_carpaint_sphere.glb")].into_iter().flatten() {
        bake(folder, &["textures", "--gltf", &mesh, "-o", "calm.glb", "--gltf-images", "ktx2-only"]).ok();
        let [one, other] = [&mesh, "calm.glb"].map(|mesh| {
            let (outcome, picture) = draw(folder, mesh);
            outcome.ok();
            picture
        });
        assert!(one == other && !one.is_empty(), "{mesh}");
    }
}

/// Whether two pictures differ by one step of 256 at most, in a thousandth of their numbers: places within a face are interpolated over its
/// triangles, whose order rounds them otherwise.
fn nearly_equal(one: &[u8], other: &[u8]) -> bool {
    let [one, other] = [one, other].map(|bytes| image::load_from_memory(bytes).unwrap().to_rgb8());
    let steps = || one.as_raw().iter().zip(other.as_raw()).map(|(a, b)| a.abs_diff(*b));
    let changed = steps().filter(|step| *step > 0).count();
    one.dimensions() == other.dimensions() && steps().all(|step| step <= 1) && changed * 1000 <= one.as_raw().len()
}

/// A concave face is drawn as the triangles that it is.
#[test]
fn concave_faces_are_their_triangles() {
    let Some(folder) = folder() else { return };
    let folder = folder.path();
    let corners = "v -2 0 -2\nv -2 0 2\nv 0 0 0\nv 2 0 2\nv 2 0 -2\nvn 0 1 0\n";
    let of = |name: &str, faces: &str| {
        fs::write(folder.join(name), format!("{corners}{faces}")).unwrap();
        let (outcome, picture) = draw(folder, name);
        (outcome.ok().stderr, picture)
    };
    let triangles = of("cut.obj", "f 1//1 2//1 3//1\nf 1//1 3//1 5//1\nf 3//1 4//1 5//1\n");
    for first in 0..5 {
        let words: Vec<String> = (0..5).map(|k| format!("{}//1", (first + k) % 5 + 1)).collect();
        let (said, picture) = of("face.obj", &format!("f {}\n", words.join(" ")));
        assert!(nearly_equal(&picture, &triangles.1), "from corner {first}");
        assert!(!said.contains("fan"), "{said}");
    }
    let (said, _) = of("crossed.obj", "f 1//1 4//1 2//1 5//1\n");
    assert!(said.contains("crossed.obj: line 7: a face has no area or crosses itself"), "{said}");
    if let Some(path) = data("cases/concave.obj") {
        let said = draw(folder, &path).0.ok().stderr;
        assert!(!said.contains("fan"), "{said}");
    }
}

#[test]
fn hostile_files_end_soon() {
    let Some(folder) = folder() else { return };
    if let Some(path) = data("hostile/idx96000.glb") {
        draw(folder.path(), &path).0.ok();
    }
    // The same in OBJ, and all triangles around one corner.
    let again = format!("v 0 0 0\nv 1 0 0\nv 0 0 1\n{}", "f 1 3 2\n".repeat(200_000));
    let around: String = (0..100_000u32)
        .map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 1e5).sin_cos();
            format!("v {cos} 0 {sin}\nf 1 -1 -2\n")
        })
        .collect();
    for (name, text) in [("again.obj", again), ("around.obj", format!("v 0 0 0\nv 1 0 -0.00001\n{around}"))] {
        fs::write(folder.path().join(name), text).unwrap();
        draw(folder.path(), name).0.ok();
    }
}

/// Exit codes, and what is named: no adapter is needed to refuse.
#[test]
fn refusals_name_file_and_place() {
    let folder = packs().0;
    let folder = folder.path();
    let gltf = |more: &str, uri: &str, positions: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},{more}"nodes":[{{"mesh":0}}],"meshes":[{{"name":"Lid","primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"{positions}"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#
        )
    };
    let inside = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let wide: Vec<u8> = "\u{feff}v 0 0 0\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(folder.join("secret.bin"), [0; 36]).unwrap();
    fs::create_dir(folder.join("in")).unwrap();
    let cases: [(&str, Vec<u8>, i32, &[&str]); 11] = [
        ("in/a.gltf", gltf("", "../secret.bin", "VEC3").into(), 5, &["buffer 0", "'../secret.bin'", "beside or below"]),
        ("in/b.gltf", gltf("", "file:///etc/hostname", "VEC3").into(), 5, &["buffer 0", "beside or below"]),
        ("in/c.gltf", gltf("", "missing.bin", "VEC3").into(), 3, &["missing.bin", "check the name"]),
        ("in/d.gltf", gltf("", "data:;base64,A*", "VEC3").into(), 4, &["buffer 0", "character 2"]),
        (
            "in/e.gltf",
            gltf("", inside, "VEC2").into(),
            4,
            &["mesh 0 'Lid', primitive 0", "accessor 0", "VEC3 is needed"],
        ),
        (
            "in/f.gltf",
            gltf(r#""extensionsRequired":["EXT_meshopt_compression"],"#, inside, "VEC3").into(),
            5,
            &["EXT_meshopt_compression", "export without it"],
        ),
        (
            "in/g.gltf",
            gltf("", inside, "VEC3").replace(r#""count":3"#, r#""count":99999999"#).into(),
            6,
            &["mesh 0 'Lid', primitive 0", "accessor 0 has 99999999 elements"],
        ),
        ("in/a.obj", format!("{SQUARE}f 1//0 2//0 3//0\n").into(), 4, &["line 10", "normal 0", "counted from 1"]),
        ("in/b.obj", format!("{SQUARE}f 1 2 7\n").into(), 4, &["line 10", "position 7, 4 are there so far"]),
        ("in/c.obj", wide, 4, &["UTF-16", "UTF-8"]),
        ("in/d.obj", format!("{SQUARE}l 1 2\n").into(), 4, &["no triangles"]),
    ];
    for (name, bytes, code, parts) in cases {
        fs::write(folder.join(name), bytes).unwrap();
        let (refused, picture) = draw(folder, name);
        assert_eq!(refused.code, code, "{name}: {}", refused.stderr);
        for part in [name].iter().chain(parts) {
            assert!(refused.stderr.contains(part), "{name}: {} has no {part}", refused.stderr);
        }
        assert!(picture.is_empty() && !refused.stderr.contains("report this"), "{name}: {}", refused.stderr);
    }
}
