//! Tangents where a mesh has none: MikkTSpace, which bakers of normal maps agree on.
//! Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, through the bevy_mikktspace crate.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

struct Corners<'a> {
    positions: &'a [Vec3],
    normals: &'a [Vec3],
    uv: &'a [Vec2],
    /// Positions in units of the mesh's size, from its middle: tangents don't depend on either, but small triangles count
    /// as degenerate there by an absolute bound.
    middle: Vec3,
    scale: f32,
    tangents: Vec<Option<Vec4>>,
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.positions.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        ((self.positions[face * 3 + vert] - self.middle) * self.scale).to_array()
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        self.normals[face * 3 + vert].to_array()
    }

    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        // The bitangent there points along +v: upwards in the image here.
        let uv = self.uv[face * 3 + vert];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, vert: usize) {
        self.tangents[face * 3 + vert] = space.map(|space| Vec4::from_array(space.tangent_encoded()));
    }
}

/// Tangents of the corners of triangles: unit, perpendicular to the (unit) normals, w -1 where uv is mirrored. Where uv has
/// no direction, some tangent that is perpendicular to the normal.
pub(super) fn of_triangles(positions: &[Vec3], normals: &[Vec3], uv: &[Vec2]) -> Vec<Vec4> {
    let bounds = super::mesh::Bounds::of(positions.iter().copied());
    let mut corners = Corners {
        positions,
        normals,
        uv,
        middle: bounds.centre(),
        scale: 1.0 / bounds.radius.max(1.0e-30),
        tangents: vec![None; positions.len()],
    };
    // There is no way to fail in this version of the crate; corners without an answer are filled in below.
    generate_tangents(&mut corners).ok();
    corners
        .tangents
        .iter()
        .zip(normals)
        .map(|(tangent, &normal)| {
            let tangent = tangent.unwrap_or(Vec4::W);
            let along = tangent.truncate();
            let across = (along - normal * along.dot(normal)).try_normalize();
            across.unwrap_or_else(|| normal.any_orthonormal_vector()).extend(if tangent.w < 0.0 { -1.0 } else { 1.0 })
        })
        .collect()
}
