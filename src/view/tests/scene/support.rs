//! Checks that hold for each mesh, and small files made here.

use glam::{Vec2, Vec3};
use glint_view::scene::{Mesh, MeshError};
use std::path::PathBuf;

/// What the vertex shader relies on, and that triangles face outwards as their normals do.
pub fn assert_sound(mesh: &Mesh) {
    assert!(!mesh.indices.is_empty() && mesh.indices.len().is_multiple_of(3));
    for vertex in &mesh.vertices {
        let (normal, tangent) = (Vec3::from(vertex.normal), Vec3::from_slice(&vertex.tangent));
        assert!(vertex.position.iter().chain(&vertex.uv).all(|x| x.is_finite()), "{vertex:?}");
        assert!((normal.length() - 1.0).abs() < 1e-4, "{vertex:?}");
        assert!((tangent.length() - 1.0).abs() < 1e-4 && tangent.dot(normal).abs() < 1e-3, "{vertex:?}");
        assert!(vertex.tangent[3].abs() == 1.0, "{vertex:?}");
    }
    assert!(mesh.indices.iter().all(|&index| (index as usize) < mesh.vertices.len()));
}

/// Share of the triangles whose tangents point along +u and whose bitangents point against +v, as their positions and uv
/// say; triangles without area in either are left out.
pub fn share_of_true_frames(mesh: &Mesh) -> f64 {
    let (mut good, mut all) = (0, 0);
    for triangle in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[triangle[k] as usize]);
        let edge = |v: glint_view::scene::Vertex| {
            (Vec3::from(v.position) - Vec3::from(a.position), Vec2::from(v.uv) - Vec2::from(a.uv))
        };
        let ((e, s), (f, t)) = (edge(b), edge(c));
        let area = s.perp_dot(t);
        if area.abs() < 1e-12 || e.cross(f).length() < 1e-12 {
            continue;
        }
        let (along_u, along_v) = ((e * t.y - f * s.y) / area, (f * s.x - e * t.x) / area);
        all += 1;
        let right = [a, b, c].iter().all(|v| {
            let (normal, tangent) = (Vec3::from(v.normal), Vec3::from_slice(&v.tangent));
            let bitangent = normal.cross(tangent) * v.tangent[3];
            tangent.dot(along_u) > 0.0 && bitangent.dot(along_v) < 0.0
        });
        good += usize::from(right);
    }
    f64::from(good as u32) / f64::from(all.max(1) as u32)
}

/// Whether the triangle's winding agrees with its normals, for all triangles with area.
pub fn faces_outwards(mesh: &Mesh) -> bool {
    mesh.indices.chunks_exact(3).all(|triangle| {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[triangle[k] as usize]);
        let normal =
            (Vec3::from(b.position) - Vec3::from(a.position)).cross(Vec3::from(c.position) - Vec3::from(a.position));
        normal.length() < 1e-12 || normal.dot(Vec3::from(a.normal) + Vec3::from(b.normal) + Vec3::from(c.normal)) > 0.0
    })
}

/// The mesh in a file of these bytes.
pub fn load(name: &str, bytes: &[u8]) -> Result<Mesh, MeshError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    Mesh::load(&path)
}

/// A GLB of one triangle with uv and indices; `edit` changes its JSON text.
pub fn glb(edit: impl FnOnce(String) -> String) -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let positions: [f32; 9] = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let uv: [f32; 6] = [0.0, 1.0, 1.0, 1.0, 0.0, 0.0];
    bin.extend(positions.iter().chain(&uv).flat_map(|x| x.to_le_bytes()));
    bin.extend([0u16, 1, 2, 0].iter().flat_map(|i| i.to_le_bytes()));
    let json = edit(
        r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,1,0]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},{"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},{"buffer":0,"byteOffset":60,"byteLength":6}],
"buffers":[{"byteLength":66}]}"#
            .to_owned(),
    );
    container(json.as_bytes(), Some(&bin))
}

/// A GLB of these chunks.
pub fn container(json: &[u8], bin: Option<&[u8]>) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), with);
        bytes
    };
    let mut body = Vec::new();
    let mut chunk = |kind: &[u8; 4], data: Vec<u8>| {
        body.extend((data.len() as u32).to_le_bytes());
        body.extend(kind);
        body.extend(data);
    };
    chunk(b"JSON", padded(json, b' '));
    if let Some(bin) = bin {
        chunk(b"BIN\0", padded(bin, 0));
    }
    let mut file = b"glTF".to_vec();
    file.extend(2u32.to_le_bytes());
    file.extend((12 + body.len() as u32).to_le_bytes());
    file.extend(body);
    file
}

/// The folder of shared real data, if it is there.
pub fn data(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("GLINT_DATA")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")), PathBuf::from);
    let path = folder.join(path);
    path.exists().then_some(path)
}
