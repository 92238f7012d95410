//! Shapes by formula: plane, wall and sphere.

use super::mesh::{Mesh, Vertex};
use glam::{Vec2, Vec3};

/// Outward normal, direction of +u and direction of +v of the six sides of a cube, u right and v down from outside, upright
/// on the four sides.
pub(super) const SIDES: [[Vec3; 3]; 6] = [
    [Vec3::X, Vec3::NEG_Z, Vec3::NEG_Y],
    [Vec3::NEG_X, Vec3::Z, Vec3::NEG_Y],
    [Vec3::Y, Vec3::X, Vec3::Z],
    [Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z],
    [Vec3::Z, Vec3::X, Vec3::NEG_Y],
    [Vec3::NEG_Z, Vec3::NEG_X, Vec3::NEG_Y],
];

impl Mesh {
    /// A horizontal square at y = 0 with sides of `size`, seen from above; uv is 0 to 1 over it, u along +x and v along +z.
    pub fn plane(size: f32) -> Mesh {
        quad(Vec3::X * size, Vec3::Z * size)
    }

    /// An upright rectangle at z = 0, seen from +z: what fills a picture. One unit of uv is `height`, so that a texel is a
    /// square.
    pub fn wall(width: f32, height: f32) -> Mesh {
        let mut mesh = quad(Vec3::X * width, Vec3::NEG_Y * height);
        for vertex in &mut mesh.vertices {
            vertex.uv[0] *= width / height;
        }
        mesh
    }

    /// A unit sphere of six sides of `segments` × `segments` squares (1 to 512). A side is 90° of angle each way and one
    /// unit of uv; there is no pole where uv is pinched, squares shrink to 0.71 of their width towards the corners. Sides
    /// lie side by side in uv, three by two, so that procedural glints differ.
    pub fn sphere(segments: u32) -> Mesh {
        let n = segments.clamp(1, 512);
        let mut mesh = Mesh::default();
        for (side, [normal, right, down]) in SIDES.into_iter().enumerate() {
            let first = mesh.vertices.len() as u32;
            for j in 0..=n {
                for i in 0..=n {
                    let uv = Vec2::new(i as f32, j as f32) / n as f32;
                    let angle = (uv - 0.5) * std::f32::consts::FRAC_PI_2;
                    let (x, y) = (angle.x.tan(), angle.y.tan());
                    let position = (normal + x * right + y * down).normalize();
                    let tangent = (right - position * right.dot(position)).normalize();
                    mesh.vertices.push(Vertex {
                        position: position.to_array(),
                        normal: position.to_array(),
                        tangent: tangent.extend(1.0).to_array(),
                        uv: [uv.x + (side % 3) as f32, uv.y + (side / 3) as f32],
                    });
                }
            }
            for j in 0..n {
                for i in 0..n {
                    let a = first + j * (n + 1) + i;
                    let c = a + n + 1;
                    mesh.indices.extend([a, c, a + 1, a + 1, c, c + 1]);
                }
            }
        }
        mesh
    }
}

/// A parallelogram around the origin with uv 0 to 1, u along `right` and v along `down`.
fn quad(right: Vec3, down: Vec3) -> Mesh {
    let normal = down.cross(right).normalize();
    let corner = |u: f32, v: f32| Vertex {
        position: (right * (u - 0.5) + down * (v - 0.5)).to_array(),
        normal: normal.to_array(),
        tangent: right.normalize().extend(1.0).to_array(),
        uv: [u, v],
    };
    Mesh {
        vertices: vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0)],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    }
}
