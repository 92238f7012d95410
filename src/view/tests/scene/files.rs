//! Mesh files.

use crate::support::{assert_sound, container, data, faces_outwards, glb, load, share_of_true_frames};
use glam::Vec3;
use glint_view::scene::{Mesh, MeshError};

const OBJ: &str =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";

#[test]
fn an_obj_square() {
    let mesh = load("a.obj", OBJ.as_bytes()).unwrap();
    assert_sound(&mesh);
    assert_eq!((mesh.vertices.len(), mesh.indices.len()), (4, 6));
    assert_eq!(share_of_true_frames(&mesh), 1.0);
    assert!(faces_outwards(&mesh) && mesh.notes.is_empty());
    // v is down here: the corner at y = 0 is the image's lower edge.
    assert!(mesh.vertices.iter().all(|v| v.uv[1] == 1.0 - v.position[1]));
    assert!(mesh.vertices.iter().all(|v| v.tangent == [1.0, 0.0, 0.0, 1.0]));
}

#[test]
fn mirrored_uv_have_w_minus_one() {
    let text = OBJ.replace("vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1", "vt 1 0\nvt 0 0\nvt 0 1\nvt 1 1");
    let mesh = load("a.obj", text.as_bytes()).unwrap();
    assert_eq!(share_of_true_frames(&mesh), 1.0);
    assert!(mesh.vertices.iter().all(|v| v.tangent == [-1.0, 0.0, 0.0, -1.0]));
}

#[test]
fn an_obj_without_uv_and_normals_is_completed_and_says_so() {
    let text = "v 0 0 0\nv 4 0 0\nv 0 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf -3 -2 -1\n";
    let mesh = load("a.obj", text.as_bytes()).unwrap();
    assert_sound(&mesh);
    assert_eq!(mesh.notes.len(), 2, "{:?}", mesh.notes);
    assert!(faces_outwards(&mesh));
    assert_eq!(share_of_true_frames(&mesh), 1.0);
    // The longest side is one unit of uv.
    let us: Vec<f32> = mesh.vertices.iter().map(|v| v.uv[0]).collect();
    assert!(
        (us.iter().copied().fold(f32::MIN, f32::max) - us.iter().copied().fold(f32::MAX, f32::min) - 1.0).abs() < 1e-6
    );
    // Three sides meet at the origin, with the same angle: their mean normal.
    let expected = -Vec3::splat(3.0f32.sqrt().recip());
    let mut corners = mesh.vertices.iter().filter(|v| v.position == [0.0; 3]);
    assert!(corners.all(|v| (Vec3::from(v.normal) - expected).length() < 1e-5));
}

#[test]
fn lines_of_an_obj_that_go_on_and_words_that_are_passed_over() {
    let text = "mtllib x.mtl\no thing\ns off\nv 0 0 \\\n0 1.0\nv 1 0 0 0.5 0.5 0.5\r\nv 0 1 0\nl 1 2\np 1\nf 1// 2 3\n";
    assert_eq!(load("a.OBJ", text.as_bytes()).unwrap().indices.len(), 3);
}

#[test]
fn a_bad_obj_names_the_line() {
    for (text, found) in [
        ("v 0 0\n", "line 1: 3 numbers are needed, 2 are there"),
        ("v 0 0 x\n", "line 1: 'x' is not a number"),
        ("v 0 0 0\nf 1 1\n", "line 2: a face has 2 corners"),
        ("v 0 0 0\nf 1 2 1\n", "line 2: a face asks for position 2, 1 are there so far"),
        ("v 0 0 0\nf 0 1 1\n", "line 2: a face asks for position 0"),
        ("v 0 0 0\nf -2 1 1\n", "line 2: a face asks for position -2"),
        ("v 0 0 0\nf 1/1 1 1\n", "line 2: a face asks for uv 1, 0 are there so far"),
        ("v 0 0 0\nf a 1 1\n", "line 2: 'a' is not a corner"),
        ("v 0 0 0\nf 99999999999999999999 1 1\n", "is not a corner"),
        ("v NaN 0 0\nf 1 1 1\n", "line 2: position 1 is [NaN, 0, 0]"),
        ("v 1e30 0 0\nf 1 1 1\n", "larger than"),
        ("v 0 0 0\nvt inf 0\nf 1/1 1/1 1/1\n", "line 3: the uv at position 1"),
        ("v 0 0 0\n", "no triangles"),
        ("", "no triangles"),
    ] {
        let error = load("bad.obj", text.as_bytes()).unwrap_err();
        let message = error.to_string();
        assert!(matches!(error, MeshError::Bad { .. }) && message.contains(found), "{text:?}: {message}");
        assert!(message.contains("bad.obj") && message.contains("export it anew"), "{message}");
    }
}

#[test]
fn a_glb_triangle() {
    let mesh = load("a.glb", &glb(|json| json)).unwrap();
    assert_sound(&mesh);
    assert_eq!(mesh.vertices.len(), 3);
    assert!(faces_outwards(&mesh));
    assert_eq!(share_of_true_frames(&mesh), 1.0);
    assert_eq!(mesh.notes, ["normals are missing or zero: those of the triangles are taken"]);
    assert_eq!(mesh.bounds().max, Vec3::new(2.0, 1.0, 0.0));
}

#[test]
fn nodes_move_turn_and_mirror() {
    let two = r#""nodes":[{"children":[1,2],"translation":[10,0,0]},
        {"mesh":0,"rotation":[0,0,0.70710678,0.70710678]},{"mesh":0,"scale":[-1,1,1]}]"#;
    let mesh = load("a.glb", &glb(|json| json.replace(r#""nodes":[{"mesh":0}]"#, two))).unwrap();
    assert_sound(&mesh);
    assert_eq!(mesh.indices.len(), 6);
    assert!(faces_outwards(&mesh));
    assert_eq!(share_of_true_frames(&mesh), 1.0);
    let bounds = mesh.bounds();
    assert!((bounds.min - Vec3::new(8.0, 0.0, 0.0)).length() < 1e-5, "{bounds:?}");
    assert!((bounds.max - Vec3::new(10.0, 2.0, 0.0)).length() < 1e-5, "{bounds:?}");
    assert!(mesh.vertices.iter().any(|v| v.tangent[3] == -1.0));
}

#[test]
fn strips_fans_points_and_files_without_indices_or_scenes() {
    for (mode, triangles) in [(4, 1), (5, 1), (6, 1)] {
        let edit = |json: String| json.replace(r#","indices":2"#, &format!(r#","mode":{mode}"#));
        assert_eq!(load("a.glb", &glb(edit)).unwrap().indices.len(), 3 * triangles);
    }
    let points = glb(|json| json.replace(r#""indices":2"#, r#""mode":0"#));
    assert!(load("a.glb", &points).unwrap_err().to_string().contains("no triangles"));
    let no_scene = glb(|json| json.replace(r#""scene":0,"scenes":[{"nodes":[0]}],"#, ""));
    assert_eq!(load("a.glb", &no_scene).unwrap().indices.len(), 3);
}

#[test]
fn buffers_inside_and_beside_json() {
    // Three positions: (0,0,0), (1,0,0), (0,1,0).
    let base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let json = |uri: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#
        )
    };
    let inside = load("a.gltf", json(&format!("data:application/octet-stream;base64,{base64}")).as_bytes()).unwrap();
    assert_eq!(inside.bounds().max, Vec3::new(1.0, 1.0, 0.0));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let bytes: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(folder.path().join("a b.bin"), &bytes).unwrap();
    std::fs::write(&path, json("a%20b.bin")).unwrap();
    assert_eq!(Mesh::load(&path).unwrap(), inside);
    for (uri, found) in [
        ("missing.bin", "missing.bin: "),
        ("/dev/zero", "only files beside"),
        ("http://example.org/x.bin", "only files beside"),
        ("data:application/octet-stream;base64,AA*A", "not base64"),
        ("data:,AAAA", "not base64"),
        ("data:;base64,AAAA", "has 3 bytes where 36 are declared"),
        (".", "not a regular file"),
        ("%ff%zz%", "check the name"),
    ] {
        std::fs::write(&path, json(uri)).unwrap();
        let message = Mesh::load(&path).unwrap_err().to_string();
        assert!(message.contains(found), "{uri}: {message}");
    }
}

#[test]
fn sparse_and_integer_accessors() {
    // Vertex 2 is what the sparse values say: bytes of vertices 0 and 1.
    let edit = |json: String| {
        json.replace(
            r#""count":3,"type":"VEC3""#,
            r#""count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":2,"byteOffset":4,"componentType":5123},
            "values":{"bufferView":0,"byteOffset":4}}"#,
        )
    };
    let mesh = load("a.glb", &glb(edit)).unwrap();
    assert_eq!(mesh.bounds().max, Vec3::new(2.0, 0.0, 2.0));
    // The upper halves of 2.0 and 1.0, 14 bytes apart.
    let quantised = |json: String| {
        json.replace(
            r#""componentType":5126,"count":3,"type":"VEC3""#,
            r#""componentType":5123,"normalized":true,"count":3,"type":"VEC3""#,
        )
        .replacen(r#""byteLength":36"#, r#""byteLength":36,"byteStride":14"#, 1)
    };
    let mesh = load("a.glb", &glb(quantised)).unwrap();
    assert_eq!(mesh.bounds().max, Vec3::new(16_384.0 / 65_535.0, 16_256.0 / 65_535.0, 0.0));
}

#[test]
fn a_bad_glb_says_what() {
    let cases: [(&str, &str, &str); 14] = [
        (r#""POSITION":0"#, r#""POSITION":99"#, "mesh 0, primitive 0: it asks for accessor 99, 3 are there"),
        (r#""indices":2"#, r#""indices":0"#, "holds no indices"),
        (r#""POSITION":0"#, r#""POSITION":1"#, "accessor 1: it is a VEC2, where a VEC3 is needed"),
        (r#""mesh":0"#, r#""mesh":7"#, "node 0 asks for mesh 7, 1 are there"),
        (r#"{"mesh":0}"#, r#"{"mesh":0,"children":[0]}"#, "node 0 is in the scene twice"),
        (r#"{"nodes":[0]}"#, r#"{"nodes":[5]}"#, "the scene asks for node 5, 1 are there"),
        (r#""count":3,"type":"VEC3""#, r#""count":4,"type":"VEC3""#, "end after buffer view 0 of 36 bytes"),
        (r#""count":3,"type":"VEC3""#, r#""count":18446744073709551615,"type":"VEC3""#, "are the limit"),
        (
            r#""byteLength":36}"#,
            r#""byteLength":36,"byteStride":18446744073709551615}"#,
            "end after buffer view 0 of 36 bytes",
        ),
        (
            r#""byteOffset":36,"#,
            r#""byteOffset":18446744073709551615,"#,
            "buffer view 1 has 24 bytes from byte 18446744073709551615 on",
        ),
        (
            r#""byteLength":36}"#,
            r#""byteLength":3600}"#,
            "buffer view 0 has 3600 bytes from byte 0 on, buffer 0 has 66",
        ),
        (r#"[{"byteLength":66}]"#, r#"[{"byteLength":660}]"#, "where 660 are declared"),
        (
            r#""bufferView":2,"componentType":5123"#,
            r#""bufferView":2,"byteOffset":1,"componentType":5121"#,
            "no triangles",
        ),
        (r#"{"mesh":0}"#, r#"{"mesh":0,"translation":[1e30,0,0]}"#, "position 0 is"),
    ];
    for (from, to, found) in cases {
        let file = glb(|json| {
            assert!(json.contains(from), "{from}");
            json.replacen(from, to, 1)
        });
        let message = load("bad.glb", &file).unwrap_err().to_string();
        assert!(message.contains(found) && message.contains("bad.glb"), "{to}: {message}");
    }
    for (file, found) in [
        (container(b"{}", None), "glTF version ''"),
        (container(b"[", None), "its JSON is not that of glTF"),
        (glb(|json| json.replace("2.0", "1.0")), "export it as version 2"),
        (
            glb(|j| j.replacen('{', r#"{"extensionsRequired":["KHR_draco_mesh_compression"],"#, 1)),
            "KHR_draco_mesh_compression",
        ),
        (b"glTF\x01\0\0\0".to_vec(), "GLB version 1"),
        (b"glTF\x02\0\0\0\0\0\0\0".to_vec(), "ends at byte 12"),
        (b"hello".to_vec(), "its JSON"),
    ] {
        let message = load("bad.glb", &file).unwrap_err().to_string();
        assert!(message.contains(found), "{message}");
    }
    let harmless = glb(|json| json.replacen('{', r#"{"extensionsRequired":["KHR_materials_clearcoat"],"#, 1));
    assert!(load("a.glb", &harmless).is_ok());
}

#[test]
fn other_names_and_files_that_are_not_there() {
    assert!(load("a.fbx", b"").unwrap_err().to_string().contains(".glb, .gltf or .obj"));
    let missing = Mesh::load(std::path::Path::new("no/such/file.glb")).unwrap_err();
    assert!(matches!(missing, MeshError::Io { .. }) && missing.to_string().contains("file.glb"), "{missing}");
    let folder = tempfile::tempdir().unwrap();
    let named = folder.path().join("x.obj");
    std::fs::create_dir(&named).unwrap();
    assert!(Mesh::load(&named).unwrap_err().to_string().contains("not a regular file"));
}

#[test]
fn files_cut_anywhere_give_errors_or_sound_meshes() {
    let file = glb(|json| json);
    for length in 0..file.len() {
        assert!(load("cut.glb", &file[..length]).is_err(), "cut at {length}");
    }
    for length in 0..OBJ.len() {
        if let Ok(mesh) = load("cut.obj", &OBJ.as_bytes()[..length]) {
            assert_sound(&mesh);
        }
    }
}

#[test]
fn files_with_any_byte_changed_give_errors_or_sound_meshes() {
    for (name, file) in [("a.glb", glb(|json| json)), ("a.obj", OBJ.as_bytes().to_vec())] {
        let mut read = 0;
        for at in 0..file.len() {
            for byte in [0, 9, b'-', b'9', b'[', 0x7f, 0x80, 0xff] {
                let mut changed = file.clone();
                changed[at] = byte;
                if let Ok(mesh) = load(name, &changed) {
                    assert_sound(&mesh);
                    read += 1;
                }
            }
        }
        assert!(read > 50, "{name}: some changes do no harm, {read}");
    }
}

#[test]
fn real_meshes() {
    for (name, triangles, true_frames) in [
        ("clearcoat_carpaint_sphere.glb", 3072, 0.999),
        ("suzanne_iridescence.glb", 11_808, 0.999),
        ("teapot_materialx.obj", 25_200, 0.999),
    ] {
        let Some(path) = data(&format!("mesh/{name}")) else {
            eprintln!("skipped: GLINT_DATA has no mesh/{name}");
            continue;
        };
        let mesh = Mesh::load(&path).unwrap();
        assert_sound(&mesh);
        let share = share_of_true_frames(&mesh);
        eprintln!(
            "{name}: {} vertices, {} triangles, bounds {:?}, frames {share:.4}, notes {:?}",
            mesh.vertices.len(),
            mesh.indices.len() / 3,
            mesh.bounds(),
            mesh.notes
        );
        assert_eq!(mesh.indices.len() / 3, triangles, "{name}");
        assert!(share > true_frames, "{name}: {share}");
        // Deterministic, too.
        assert_eq!(Mesh::load(&path).unwrap(), mesh);
    }
}
