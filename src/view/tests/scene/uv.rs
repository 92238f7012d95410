//! uv of glTF files as the normal texture has them: sets, transforms, integers.

use crate::support::{assert_sound, container, data, glb, load, share_of_true_frames};
use glam::Vec2;
use glint_view::scene::{Look, Mesh};
use serde_json::json;

/// What a primitive is made of; numbers are floats in the file.
struct Spec {
    attributes: Vec<(&'static str, usize, Vec<f32>)>,
    material: usize,
}

/// Positions and uv of a triangle.
fn triangle(sets: &[(&'static str, [f32; 6])], material: usize) -> Spec {
    let mut attributes = vec![("POSITION", 3, vec![0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0])];
    attributes.extend(sets.iter().map(|(name, uv)| (*name, 2, uv.to_vec())));
    Spec { attributes, material }
}

/// A GLB of one mesh of these primitives with these materials.
fn file(primitives: &[Spec], materials: serde_json::Value) -> Vec<u8> {
    let (mut bin, mut views, mut accessors, mut list) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for primitive in primitives {
        let mut attributes = serde_json::Map::new();
        for (name, size, numbers) in &primitive.attributes {
            views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": 4 * numbers.len()}));
            let count = numbers.len() / size;
            let kind = format!("VEC{size}");
            accessors.push(json!({"bufferView": views.len() - 1, "componentType": 5126, "count": count, "type": kind}));
            attributes.insert((*name).to_owned(), json!(accessors.len() - 1));
            bin.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        }
        list.push(json!({"attributes": attributes, "material": primitive.material}));
    }
    let document = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"name": "Sign", "primitives": list}], "materials": materials,
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": bin.len()}],
    });
    container(document.to_string().as_bytes(), Some(&bin))
}

fn transformed(texture: serde_json::Value, transform: serde_json::Value) -> serde_json::Value {
    let mut texture = texture;
    texture["index"] = json!(0);
    texture["extensions"] = json!({"KHR_texture_transform": transform});
    texture
}

#[track_caller]
fn assert_uv(mesh: &Mesh, expected: &[[f32; 2]]) {
    assert_sound(mesh);
    let found: Vec<[f32; 2]> = mesh.indices.iter().map(|&i| mesh.vertices[i as usize].uv).collect();
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-5), "{found:?} for {expected:?}");
    }
    assert_eq!(share_of_true_frames(mesh), 1.0);
}

const UV: [f32; 6] = [0.0, 1.0, 1.0, 1.0, 0.0, 0.0];

#[test]
fn transforms_of_the_normal_texture() {
    let half_turn = std::f32::consts::PI;
    for (transform, expected) in [
        (json!({"scale": [16, 8]}), [[0.0, 8.0], [16.0, 8.0], [0.0, 0.0]]),
        (json!({"offset": [3, -1]}), [[3.0, 0.0], [4.0, 0.0], [3.0, -1.0]]),
        (json!({"rotation": half_turn / 2.0}), [[1.0, 0.0], [1.0, -1.0], [0.0, 0.0]]),
        (json!({"rotation": half_turn, "scale": [2, 3], "offset": [5, 5]}), [[5.0, 2.0], [3.0, 2.0], [5.0, 5.0]]),
        (json!({"scale": [-1, 1], "offset": [1, 0]}), [[1.0, 1.0], [0.0, 1.0], [1.0, 0.0]]),
        (json!({}), [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]),
    ] {
        let materials = json!([{"normalTexture": transformed(json!({}), transform.clone())}]);
        let mesh = load("a.glb", &file(&[triangle(&[("TEXCOORD_0", UV)], 0)], materials)).unwrap();
        assert_uv(&mesh, &expected);
        assert_eq!(mesh.notes.len(), 1, "only that normals are made: {:?}", mesh.notes);
    }
}

#[test]
fn each_primitive_has_its_own_set_and_transform() {
    let other = [0.0, 0.5, 0.5, 0.5, 0.0, 0.0];
    let sets = [("TEXCOORD_0", UV), ("TEXCOORD_1", other)];
    let materials = json!([
        {"normalTexture": {"index": 0, "texCoord": 1}},
        {"normalTexture": transformed(json!({"texCoord": 1}), json!({"texCoord": 0, "scale": [3, 3]}))},
        {"normalTexture": transformed(json!({"texCoord": 1}), json!({"scale": [4, 4]}))},
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
    ]);
    let primitives: Vec<Spec> = (0..4).map(|material| triangle(&sets, material)).collect();
    let mesh = load("a.glb", &file(&primitives, materials)).unwrap();
    let scaled = |uv: [f32; 6], by: f32| [[uv[0] * by, uv[1] * by], [uv[2] * by, uv[3] * by], [uv[4] * by, uv[5] * by]];
    assert_uv(&mesh, &[scaled(other, 1.0), scaled(UV, 3.0), scaled(other, 4.0), scaled(UV, 1.0)].concat());
}

/// Parts follow materials and places of textures, and say what uv were made of.
#[test]
fn parts_have_their_materials() {
    let scaled = transformed(json!({"texCoord": 1}), json!({"scale": [2, 4], "offset": [0.5, 0]}));
    let materials = json!([{}, {"normalTexture": scaled}]);
    let sets: &[(&'static str, [f32; 6])] = &[("TEXCOORD_0", UV), ("TEXCOORD_1", UV)];
    let primitives = [0, 0, 1].map(|material| triangle(sets, material));
    let mesh = load("a.glb", &file(&primitives, materials)).unwrap();
    let ranges: Vec<(u32, u32)> = mesh.parts.iter().map(|part| (part.first, part.count)).collect();
    assert_eq!(ranges, [(0, 6), (6, 3)], "neighbours that look alike are one part");
    let [plain, other] = [mesh.parts[0].look, mesh.parts[1].look];
    assert_eq!(plain, Look { material: Some(0), ..Look::default() });
    assert_eq!((other.material, other.uv_set), (Some(1), 1));
    let made = other.uv.transform_point2(Vec2::new(1.0, 1.0));
    assert!(made.distance(Vec2::new(2.5, 4.0)) < 1e-6, "{made}");
    let glb = load("b.glb", &glb(|json| json)).unwrap();
    assert_eq!(glb.parts[0].look.material, None);
    assert!(Mesh::sphere(2).parts.is_empty());
}

#[test]
fn what_is_made_up_is_said() {
    let missing = json!([{"normalTexture": {"index": 0, "texCoord": 2}}]);
    let mesh = load("a.glb", &file(&[triangle(&[("TEXCOORD_0", UV)], 0)], missing)).unwrap();
    let said = |mesh: &Mesh, part: &str| assert!(mesh.notes.iter().any(|note| note.contains(part)), "{:?}", mesh.notes);
    said(&mesh, "mesh 0 'Sign', primitive 0: its texture asks for TEXCOORD_2, which is missing");
    said(&mesh, "a box projection is taken");
    let colour = json!([{"name": "Red", "emissiveTexture": transformed(json!({}), json!({"scale": [4, 4]}))}]);
    let mesh = load("a.glb", &file(&[triangle(&[("TEXCOORD_0", UV)], 0)], colour)).unwrap();
    said(&mesh, "material 'Red' has no normal texture: uv are TEXCOORD_0 as it is");
    assert_uv(&mesh, &[[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]);
}

#[test]
fn notes_have_an_end() {
    let primitives: Vec<Spec> = (0..50).map(|material| triangle(&[("TEXCOORD_0", UV)], material)).collect();
    let materials: Vec<_> =
        (0..50).map(|i| json!({"name": format!("M{i}"), "emissiveTexture": {"index": 0, "texCoord": 1}})).collect();
    let mesh = load("a.glb", &file(&primitives, json!(materials))).unwrap();
    assert_eq!(mesh.notes.len(), 21);
    assert_eq!(mesh.notes[20], "and 31 more of such notes");
}

/// Tangents of a file point along its uv: a larger scale keeps them, a turn does not.
#[test]
fn tangents_go_with_a_turned_texture() {
    let primitive = || {
        let mut primitive = triangle(&[("TEXCOORD_0", UV)], 0);
        primitive.attributes.push(("NORMAL", 3, [0.0, 0.0, 1.0].repeat(3)));
        primitive.attributes.push(("TANGENT", 4, [0.96, 0.28, 0.0, 1.0].repeat(3)));
        primitive
    };
    let with = |transform: serde_json::Value| {
        let materials = json!([{"normalTexture": transformed(json!({}), transform)}]);
        load("a.glb", &file(&[primitive()], materials)).unwrap()
    };
    let scaled = with(json!({"scale": [4, 4]}));
    assert!(scaled.vertices.iter().all(|v| (v.tangent[0] - 0.96).abs() < 1e-6) && scaled.notes.is_empty());
    let turned = with(json!({"rotation": std::f32::consts::PI}));
    assert!(turned.vertices.iter().all(|v| (v.tangent[0] + 1.0).abs() < 1e-6), "{:?}", turned.vertices);
    assert!(turned.notes == ["a texture transform turns uv: tangents are computed"], "{:?}", turned.notes);
    let mirrored = with(json!({"scale": [-1, 1]}));
    assert!(mirrored.vertices.iter().all(|v| v.tangent == [-1.0, 0.0, 0.0, -1.0]));
}

/// KHR_mesh_quantization: integers as they are, and as fractions of the largest; the transform gives them their size.
#[test]
fn uv_of_integers() {
    let uv = [[0u16, 4096], [4096, 4096], [0, 0]];
    for (normalised, scale) in [(true, 65_535.0 / 4096.0), (false, 1.0 / 4096.0)] {
        for texture in ["normalTexture", "emissiveTexture"] {
            let file = glb(|json| {
                let from = r#"{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}"#;
                assert!(json.contains(from));
                let to = format!(
                    r#"{{"bufferView":1,"componentType":5123,"normalized":{normalised},"count":3,"type":"VEC2"}}"#
                );
                let material = transformed(json!({}), json!({"scale": [scale, scale]}));
                json.replace(from, &to)
                    .replace(r#""indices":2"#, r#""indices":2,"material":0"#)
                    .replacen('{', &format!(r#"{{"materials":[{}],"#, json!({ texture: material })), 1)
                    .replacen('{', r#"{"extensionsRequired":["KHR_mesh_quantization","KHR_texture_transform"],"#, 1)
            });
            // The uv are the twelve bytes after the positions.
            let words: Vec<u8> = uv.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
            let at = file
                .windows(24)
                .position(|w| w[4..8] == 1.0f32.to_le_bytes() && w[..4] == [0; 4] && w[8..12] == w[4..8]);
            let at = at.unwrap();
            let changed = [&file[..at], &words, &file[at + 12..]].concat();
            let mesh = load("a.glb", &changed).unwrap();
            assert_uv(&mesh, &[[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]);
            let said = mesh.notes.iter().any(|note| note.contains("uv are those of its other textures"));
            assert_eq!(said, texture == "emissiveTexture", "{:?}", mesh.notes);
        }
    }
}

#[test]
fn the_file_of_a_packer_is_the_plain_one() {
    let (Some(packed), Some(plain)) = (data("cases/uv_gltfpack.glb"), data("cases/uv_plain.glb")) else {
        eprintln!("skipped: GLINT_DATA has no cases");
        return;
    };
    let (packed, plain) = (Mesh::load(&packed).unwrap(), Mesh::load(&plain).unwrap());
    assert_eq!(packed.indices, plain.indices);
    for (a, b) in packed.vertices.iter().zip(&plain.vertices) {
        assert!(a.position == b.position && (0..2).all(|k| (a.uv[k] - b.uv[k]).abs() < 1e-3), "{a:?} for {b:?}");
    }
}

#[test]
fn attributes_of_other_lengths_and_materials_that_are_not_there() {
    let mut short = triangle(&[], 0);
    short.attributes.push(("TEXCOORD_0", 2, vec![0.0; 4]));
    let message = load("a.glb", &file(&[short], json!([{}]))).unwrap_err().to_string();
    assert!(message.contains("mesh 0 'Sign', primitive 0: TEXCOORD_0 has 2 elements, POSITION has 3"), "{message}");
    let message = load("a.glb", &file(&[triangle(&[], 3)], json!([{}]))).unwrap_err().to_string();
    assert!(message.contains("it asks for material 3, 1 are there"), "{message}");
}
