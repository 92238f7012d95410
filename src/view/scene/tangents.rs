//! Tangents where a mesh has none: those of MikkTSpace, and some direction where it has no answer.

use super::mesh::Bounds;
use super::mikktspace;
use glam::{Vec2, Vec3, Vec4};

/// Tangents of the corners of triangles: unit, perpendicular to the (unit) normals, w -1 where uv is mirrored. Where uv has
/// no direction, some tangent that is perpendicular to the normal.
pub(super) fn of_triangles(positions: &[Vec3], normals: &[Vec3], uv: &[Vec2]) -> Vec<Vec4> {
    // Positions in units of the mesh's size, from its middle: tangents don't depend on either, but small triangles count as
    // degenerate by an absolute bound.
    let bounds = Bounds::of(positions.iter().copied());
    let (middle, scale) = (bounds.centre(), 1.0 / bounds.radius.max(1.0e-30));
    let placed: Vec<Vec3> = positions.iter().map(|&position| (position - middle) * scale).collect();
    // v points up there, and down here.
    let upwards: Vec<Vec2> = uv.iter().map(|uv| Vec2::new(uv.x, 1.0 - uv.y)).collect();
    let tangents = mikktspace::tangents(&placed, normals, &upwards);
    let complete = |(tangent, &normal): (Option<Vec4>, &Vec3)| {
        let tangent = tangent.unwrap_or(Vec4::W);
        let along = tangent.truncate();
        let across = (along - normal * along.dot(normal)).try_normalize();
        across.unwrap_or_else(|| normal.any_orthonormal_vector()).extend(if tangent.w < 0.0 { -1.0 } else { 1.0 })
    };
    tangents.into_iter().zip(normals).map(complete).collect()
}
