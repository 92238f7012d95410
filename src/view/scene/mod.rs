//! Temporary.
use bytemuck::{Pod, Zeroable};
#[allow(missing_docs)]
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    pub tangent: [f32; 4],
    pub uv: [f32; 2],
}
#[allow(missing_docs)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
    pub notes: Vec<String>,
}
#[allow(missing_docs)]
impl Mesh {
    pub fn plane(half_edge: f32) -> Mesh {
        let mut m = Mesh::default();
        for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            m.vertices.push(Vertex {
                position: [x * half_edge, 0.0, z * half_edge],
                normal: [0.0, 1.0, 0.0],
                tangent: [1.0, 0.0, 0.0, 1.0],
                uv: [x * half_edge, z * half_edge],
            });
        }
        m.indices = vec![0, 2, 1, 0, 3, 2];
        m
    }
}
