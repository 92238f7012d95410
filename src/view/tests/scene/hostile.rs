//! glTF files that ask for much, or for what is not theirs.

use crate::support::{assert_sound, container, data, glb, load};
use glint_view::scene::{Mesh, MeshError};
use std::time::{Duration, Instant};

/// A mesh or an error, and soon.
#[track_caller]
fn soon(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let start = Instant::now();
    let result = load("a.glb", bytes);
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    result
}

/// A GLB of three corners and `count` indices of one byte, three in a row a triangle.
fn indices(count: usize, index: impl Fn(usize) -> u8) -> Vec<u8> {
    let mut bin: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    bin.extend((0..count).map(index));
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"componentType":5126,"count":3,"type":"VEC3","bufferView":0}},
        {{"componentType":5121,"count":{count},"type":"SCALAR","bufferView":1}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":{count}}}],
        "buffers":[{{"byteLength":{}}}]}}"#,
        bin.len()
    );
    container(json.as_bytes(), Some(&bin))
}

/// The square of so many triangles at one edge would be an hour.
#[test]
fn one_triangle_again_and_again() {
    let count = 600_000;
    let again = soon(&indices(count, |i| (i % 3) as u8)).unwrap();
    assert_eq!((again.vertices.len(), again.indices.len()), (3, count));
    let both_sides = soon(&indices(count, |i| if i % 2 == 0 { (i % 3) as u8 } else { (2 - i % 3) as u8 })).unwrap();
    assert_sound(&both_sides);
    if let Some(path) = data("hostile/idx96000.glb") {
        let mesh = soon(&std::fs::read(path).unwrap()).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.indices.len()), (3, 96_000));
    } else {
        eprintln!("skipped: GLINT_DATA has no hostile");
    }
    // More than the limit, of twelve megabytes.
    let error = soon(&indices(12_000_003, |i| (i % 3) as u8)).unwrap_err();
    assert!(matches!(error, MeshError::TooLarge { .. }), "{error}");
}

/// Numbers that cost nothing to write.
#[test]
fn counts_that_lie_cost_nothing() {
    let many = |primitive: &str, count: usize| vec![primitive; count].join(",");
    let primitives = |list: String| {
        glb(move |json| json.replace(r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}"#, &list))
    };
    // Twelve million positions that are nowhere, of which three are used, a hundred thousand times.
    let list = many(r#"{"attributes":{"POSITION":0},"indices":2}"#, 20_000);
    let nowhere = glb(|json| {
        json.replace(r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}"#, &list).replace(
            r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","#,
            r#"{"componentType":5126,"count":12000000,"type":"VEC3","#,
        )
    });
    assert!(soon(&nowhere).unwrap_err().to_string().contains("no triangle with an area"));
    // The same triangle in twenty thousand primitives is just that.
    assert_eq!(soon(&primitives(list)).unwrap().indices.len(), 60_000);
    // Sparse data that are looked at again and again.
    let sparse = glb(|json| {
        let twice = many(r#"{"attributes":{"POSITION":0},"indices":2}"#, 20_000);
        json.replace(r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}"#, &twice).replace(
            r#""count":3,"type":"VEC3""#,
            r#""count":12000000,"type":"VEC3","sparse":{"count":5000,"indices":{"bufferView":9,"componentType":5125},
            "values":{"bufferView":9}}"#,
        )
    });
    assert!(soon(&sparse).is_err());
    let huge = glb(|json| json.replace(r#""count":3,"type":"SCALAR""#, r#""count":4000000000,"type":"SCALAR""#));
    let message = soon(&huge).unwrap_err().to_string();
    assert!(
        message.contains("mesh 0, primitive 0: accessor 2 has 4000000000 elements, 12000000 are the limit"),
        "{message}"
    );
}

#[test]
fn trees_that_are_deep_or_none() {
    let deep = |last: &str| {
        let count = 200_000;
        let mut nodes: Vec<String> = (1..count).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
        nodes.push(last.to_owned());
        let nodes = nodes.join(",");
        glb(|json| json.replace(r#"{"mesh":0}"#, &nodes))
    };
    assert_eq!(soon(&deep(r#"{"mesh":0}"#)).unwrap().indices.len(), 3);
    let message = soon(&deep(r#"{"mesh":0,"children":[77]}"#)).unwrap_err().to_string();
    assert!(message.contains("node 77 is in the scene twice"), "{message}");
    // Nested deeper than a stack, in what is passed over and in what is not.
    let nested = glb(|json| json.replacen('{', &format!(r#"{{"extras":{}{},"#, "[".repeat(9999), "]".repeat(9999)), 1));
    assert_eq!(soon(&nested).unwrap().indices.len(), 3);
    let nested = glb(|json| json.replacen(r#""nodes":[0]"#, &format!(r#""nodes":{}"#, "[".repeat(9999)), 1));
    assert!(soon(&nested).unwrap_err().to_string().contains("its JSON is not that of glTF"));
}

#[test]
fn files_of_other_folders_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    std::fs::create_dir_all(inner.join("below")).unwrap();
    let bytes: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    for name in ["secret.bin", "inner/a.bin", "inner/below/b.bin", "inner/%2e%2e"] {
        std::fs::write(folder.path().join(name), &bytes).unwrap();
    }
    let path = inner.join("a.gltf");
    let with = |uri: &str| {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#
        );
        std::fs::write(&path, json).unwrap();
        Mesh::load(&path)
    };
    for uri in ["a.bin", "./a.bin", "below/b.bin", "below%2Fb.bin", "%61.bin", "%252e%252e"] {
        assert_eq!(with(uri).unwrap().indices.len(), 3, "{uri}");
    }
    let absolute = folder.path().join("secret.bin");
    let absolute = absolute.to_str().unwrap();
    for uri in [
        "../secret.bin",
        "below/../../secret.bin",
        "%2e%2e/secret.bin",
        "..%2Fsecret.bin",
        "%2E./secret.bin",
        absolute,
        &absolute.replace('/', "%2f"),
        &format!("file://{absolute}"),
        "http://example.org/a.bin",
        "//example.org/a.bin",
        "C%3a/secret.bin",
    ] {
        let error = with(uri).unwrap_err();
        let said = format!("buffer 0: it lies at '{uri}'; only files beside or below");
        assert!(matches!(&error, MeshError::Unsupported { what, .. } if what.contains(&said)), "{error}");
    }
    for (uri, found) in [
        ("data:application/octet-stream;base64,AA*A", "buffer 0: its data URI is not base64: character 3"),
        ("data:application/octet-stream;base64,AAAAA", "not base64: character 5"),
        ("data:application/octet-stream,AAAA", "buffer 0: its data URI is not base64"),
        ("data:;base64,", "buffer 0 has 0 bytes where 36 are declared"),
    ] {
        let error = with(uri).unwrap_err();
        assert!(matches!(&error, MeshError::Bad { what, .. } if what.contains(found)), "{error}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/dev/zero", inner.join("zero.bin")).unwrap();
        let error = with("zero.bin").unwrap_err();
        assert!(matches!(error, MeshError::Io { .. }) && error.to_string().contains("not a regular file"), "{error}");
    }
}

#[test]
fn compressed_data_are_named() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let file = glb(|json| json.replacen('{', &format!(r#"{{"extensionsRequired":["{name}"],"#), 1));
        let error = load("a.glb", &file).unwrap_err();
        assert!(matches!(&error, MeshError::Unsupported { what, .. } if what.contains(name)), "{error}");
    }
    // Not said to be required, but there is nothing else; and with plain data beside.
    let draco =
        r#""extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}},"attributes""#;
    let plain = |json: String| json.replace(r#""attributes""#, draco);
    assert!(load("a.glb", &glb(plain)).is_ok());
    let alone =
        |json: String| plain(json).replacen(r#"{"bufferView":0,"componentType":5126"#, r#"{"componentType":5126"#, 1);
    let error = load("a.glb", &glb(alone)).unwrap_err();
    let found = "mesh 0, primitive 0: its data are compressed by KHR_draco_mesh_compression";
    assert!(matches!(&error, MeshError::Unsupported { what, .. } if what.contains(found)), "{error}");
}

#[test]
fn what_is_no_surface_is_named() {
    let with = |from: &str, to: &str| {
        let from = from.to_owned();
        load("a.glb", &glb(|json| json.replace(&from, to))).unwrap_err().to_string()
    };
    let primitive = r#"{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}"#;
    for (to, found) in [
        (r#"{"attributes":{"POSITION":0},"mode":0}"#, "no triangles in it: mesh 0, primitive 0: it has points"),
        (r#"{"attributes":{"POSITION":0},"mode":3}"#, "no triangles in it: mesh 0, primitive 0: it has lines"),
        (r#"{"attributes":{"NORMAL":0}}"#, "no triangles in it: mesh 0, primitive 0: it has no POSITION"),
        (r#"{"attributes":{"POSITION":0},"mode":7}"#, "mesh 0, primitive 0: its mode is 7, 0 to 6 are known"),
    ] {
        let message = with(primitive, to);
        assert!(message.contains(found), "{message}");
    }
    let flat = with(r#"{"mesh":0}"#, r#"{"mesh":0,"scale":[1,0,1]}"#);
    assert!(flat.contains("it has no triangle with an area, only 1 without"), "{flat}");
    let mut file = glb(|json| json);
    let at = file.windows(4).position(|four| four == 2.0f32.to_le_bytes()).unwrap();
    file[at..at + 4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let message = load("a.glb", &file).unwrap_err().to_string();
    assert!(message.contains("mesh 0, primitive 0: position 1 is [inf, "), "{message}");
}
