//! From the corners of triangles, as files have them, to vertices with all that a viewer needs.

use super::fault::Fault;
use super::mesh::{Bounds, Mesh, Vertex};
use super::shapes::SIDES;
use super::tangents;
use glam::{Vec2, Vec3, Vec4};
use std::collections::HashMap;

/// Largest coordinate: squares and areas of anything smaller are far from the largest f32.
const MAX_COORDINATE: f32 = 1.0e15;

/// One corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub position: Vec3,
    /// Number of the position in the file: corners that share it are around one point.
    pub point: u32,
    pub normal: Option<Vec3>,
    pub uv: Option<Vec2>,
    pub tangent: Option<Vec4>,
}

/// How normals are made where there are none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MissingNormals {
    /// The triangle's own.
    Flat,
    /// The mean over the triangles around a point, weighted by their angle there.
    Smooth,
}

/// A list of triangles, three corners each.
#[derive(Debug)]
pub(super) struct Part {
    pub corners: Vec<Corner>,
    pub missing: MissingNormals,
}

impl Part {
    pub fn triangles(&self) -> usize {
        self.corners.len() / 3
    }

    pub fn positions(&self) -> impl Iterator<Item = Vec3> + Clone {
        self.corners.iter().map(|corner| corner.position)
    }

    /// Completes normals, uv and tangents, and adds the vertices, each once, to `mesh`. `whole` is the box around the mesh.
    pub fn append_to(mut self, mesh: &mut Mesh, whole: Bounds) -> Result<(), Fault> {
        for corner in &self.corners {
            check(corner)?;
        }
        let normals = self.normals(&mut mesh.notes);
        let uv = self.uv(whole, &mut mesh.notes);
        let tangents = self.tangents(&normals, &uv, &mut mesh.notes);
        let first = mesh.vertices.len() as u32;
        let mut known: HashMap<[u32; 12], u32> = HashMap::with_capacity(self.corners.len() / 3);
        for (i, corner) in self.corners.drain(..).enumerate() {
            let vertex = Vertex {
                position: corner.position.to_array(),
                normal: normals[i].to_array(),
                tangent: tangents[i].to_array(),
                uv: uv[i].to_array(),
            };
            let next = first + known.len() as u32;
            let index = *known.entry(bytemuck::cast(vertex)).or_insert(next);
            if index == next {
                mesh.vertices.push(vertex);
            }
            mesh.indices.push(index);
        }
        Ok(())
    }

    /// Unit normals of the corners.
    fn normals(&self, notes: &mut Vec<String>) -> Vec<Vec3> {
        let given = |corner: &Corner| corner.normal.and_then(Vec3::try_normalize);
        if self.corners.iter().all(|corner| given(corner).is_some()) {
            return self.corners.iter().filter_map(given).collect();
        }
        let faces: Vec<Vec3> = self.corners.chunks_exact(3).map(face_normal).collect();
        let around = match self.missing {
            MissingNormals::Flat => HashMap::new(),
            MissingNormals::Smooth => means_around(&self.corners, &faces),
        };
        notes.push(match self.missing {
            MissingNormals::Flat => "normals are missing: those of the triangles are taken".to_owned(),
            MissingNormals::Smooth => "normals are missing: means of the triangles around are taken".to_owned(),
        });
        let made = |i: usize, corner: &Corner| {
            around.get(&corner.point).and_then(|sum| sum.try_normalize()).unwrap_or(faces[i / 3])
        };
        self.corners.iter().enumerate().map(|(i, corner)| given(corner).unwrap_or_else(|| made(i, corner))).collect()
    }

    /// uv of the corners; of all three corners of a triangle by box projection if one has none.
    fn uv(&self, whole: Bounds, notes: &mut Vec<String>) -> Vec<Vec2> {
        let side = (whole.max - whole.min).max_element().max(f32::MIN_POSITIVE);
        let mut uv = Vec::with_capacity(self.corners.len());
        let mut projected = false;
        for triangle in self.corners.chunks_exact(3) {
            if triangle.iter().all(|corner| corner.uv.is_some()) {
                uv.extend(triangle.iter().filter_map(|corner| corner.uv));
                continue;
            }
            projected = true;
            let normal = face_normal(triangle);
            let [_, right, down] =
                SIDES.into_iter().max_by(|a, b| a[0].dot(normal).total_cmp(&b[0].dot(normal))).unwrap_or(SIDES[0]);
            uv.extend(triangle.iter().map(|corner| {
                let place = (corner.position - whole.centre()) / side;
                Vec2::new(place.dot(right), place.dot(down)) + 0.5
            }));
        }
        if projected {
            notes.push("uv are missing: a box projection is taken, the longest side is one unit of uv".to_owned());
        }
        uv
    }

    fn tangents(&self, normals: &[Vec3], uv: &[Vec2], notes: &mut Vec<String>) -> Vec<Vec4> {
        let given = |corner: &Corner, normal: &Vec3| {
            let tangent = corner.tangent?;
            let along = tangent.truncate().try_normalize()?;
            let across = (along - *normal * along.dot(*normal)).try_normalize()?;
            Some(across.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 }))
        };
        let usable: Option<Vec<Vec4>> = self.corners.iter().zip(normals).map(|(c, n)| given(c, n)).collect();
        if let Some(tangents) = usable {
            return tangents;
        }
        if self.corners.iter().any(|corner| corner.tangent.is_some()) {
            notes.push("some tangents are missing, zero or along the normal: all are computed".to_owned());
        }
        let positions: Vec<Vec3> = self.positions().collect();
        tangents::of_triangles(&positions, normals, uv)
    }
}

fn check(corner: &Corner) -> Result<(), Fault> {
    let fine = |values: &[f32]| values.iter().all(|v| v.abs() <= MAX_COORDINATE);
    let point = corner.point;
    if !fine(&corner.position.to_array()) {
        return Err(Fault::Bad(format!(
            "position {point} is {}: not finite, or larger than {MAX_COORDINATE:e}",
            corner.position
        )));
    }
    if let Some(uv) = corner.uv.filter(|uv| !fine(&uv.to_array())) {
        return Err(Fault::Bad(format!("the uv at position {point} are {uv}: not finite, or too large")));
    }
    Ok(())
}

/// Unit normal of a triangle, +Y for one without area.
fn face_normal(triangle: &[Corner]) -> Vec3 {
    let [a, b, c] = [triangle[0].position, triangle[1].position, triangle[2].position];
    // Edges in units of the longest: squares of tiny ones would be zero.
    let (e, f) = (b - a, c - a);
    let scale = e.abs().max(f.abs()).max_element().max(f32::MIN_POSITIVE);
    (e / scale).cross(f / scale).try_normalize().unwrap_or(Vec3::Y)
}

/// Sums of the normals of the triangles around each point, weighted by angle.
fn means_around(corners: &[Corner], faces: &[Vec3]) -> HashMap<u32, Vec3> {
    let mut around: HashMap<u32, Vec3> = HashMap::new();
    for (triangle, normal) in corners.chunks_exact(3).zip(faces) {
        for k in 0..3 {
            let here = triangle[k].position;
            let to = |other: usize| (triangle[(k + other) % 3].position - here).normalize_or_zero();
            let angle = to(1).dot(to(2)).clamp(-1.0, 1.0).acos();
            *around.entry(triangle[k].point).or_insert(Vec3::ZERO) += angle * *normal;
        }
    }
    around
}
