//! From the corners of triangles, as files have them, to vertices with all that a viewer needs.

use super::mesh::{Bounds, Look, Mesh, MeshPart, Vertex};
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
    /// Number of the position, as the file counts: corners that share it are around one point.
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

/// A list of triangles.
#[derive(Debug)]
pub(super) struct Part {
    /// Corners, those that are the same once.
    pub corners: Vec<Corner>,
    /// Numbers of corners, three a triangle.
    pub order: Vec<u32>,
    pub missing: MissingNormals,
    pub look: Look,
}

/// What a file holds: lists of triangles, and what the user should know about how they were read.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub parts: Vec<Part>,
    pub notes: Vec<String>,
}

impl Part {
    pub fn triangles(&self) -> usize {
        self.order.len() / 3
    }

    pub fn positions(&self) -> impl Iterator<Item = Vec3> + Clone {
        self.in_order().map(|corner| corner.position)
    }

    fn in_order(&self) -> impl Iterator<Item = &Corner> + Clone {
        self.order.iter().map(|&corner| &self.corners[corner as usize])
    }

    fn each_triangle(&self) -> impl Iterator<Item = [&Corner; 3]> {
        self.order.chunks_exact(3).map(|of| [of[0], of[1], of[2]].map(|corner| &self.corners[corner as usize]))
    }

    /// Whether some triangle has an area.
    pub fn has_area(&self) -> bool {
        self.each_triangle().any(|triangle| own_normal(triangle).is_some())
    }

    /// Completes normals, uv and tangents, and adds the vertices, each once, to `mesh`. `whole` is the box around the mesh.
    pub fn append_to(self, mesh: &mut Mesh, whole: Bounds) {
        let normals = self.normals(&mut mesh.notes);
        let uv = self.uv(whole, &mut mesh.notes);
        let tangents = self.tangents(&normals, &uv, &mut mesh.notes);
        let (first, count) = (mesh.indices.len() as u32, self.order.len() as u32);
        match mesh.parts.last_mut().filter(|last| last.look == self.look) {
            Some(last) => last.count += count,
            None => mesh.parts.push(MeshPart { first, count, look: self.look }),
        }
        let first = mesh.vertices.len() as u32;
        let mut known: HashMap<[u32; 12], u32> = HashMap::with_capacity(self.corners.len());
        for (i, corner) in self.in_order().enumerate() {
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
    }

    /// Unit normals, in order.
    fn normals(&self, notes: &mut Vec<String>) -> Vec<Vec3> {
        let given = |corner: &Corner| corner.normal.and_then(Vec3::try_normalize);
        if self.in_order().all(|corner| given(corner).is_some()) {
            return self.in_order().filter_map(given).collect();
        }
        let faces: Vec<Vec3> = self.each_triangle().map(face_normal).collect();
        let around = match self.missing {
            MissingNormals::Flat => HashMap::new(),
            MissingNormals::Smooth => means_around(self.each_triangle().zip(&faces)),
        };
        notes.push(match self.missing {
            MissingNormals::Flat => "normals are missing or zero: those of the triangles are taken".to_owned(),
            MissingNormals::Smooth => "normals are missing or zero: means of the triangles around are taken".to_owned(),
        });
        let made = |i: usize, corner: &Corner| {
            around.get(&corner.point).and_then(|sum| sum.try_normalize()).unwrap_or(faces[i / 3])
        };
        self.in_order().enumerate().map(|(i, corner)| given(corner).unwrap_or_else(|| made(i, corner))).collect()
    }

    /// uv, in order; of all three corners of a triangle by box projection if one has none.
    fn uv(&self, whole: Bounds, notes: &mut Vec<String>) -> Vec<Vec2> {
        let side = (whole.max - whole.min).max_element().max(f32::MIN_POSITIVE);
        let mut uv = Vec::with_capacity(self.order.len());
        let mut projected = false;
        for triangle in self.each_triangle() {
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
        let usable: Option<Vec<Vec4>> = self.in_order().zip(normals).map(|(c, n)| given(c, n)).collect();
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

impl Corner {
    /// Whether position and uv are numbers of a sane size; else what is wrong.
    pub fn check(&self) -> Result<(), String> {
        let fine = |values: &[f32]| values.iter().all(|v| v.abs() <= MAX_COORDINATE);
        let point = self.point;
        if !fine(&self.position.to_array()) {
            let found = self.position;
            return Err(format!("position {point} is {found}: not finite, or larger than {MAX_COORDINATE:e}"));
        }
        match self.uv.filter(|uv| !fine(&uv.to_array())) {
            Some(uv) => Err(format!("the uv at position {point} are {uv}: not finite, or too large")),
            None => Ok(()),
        }
    }
}

/// Unit normal of a triangle with area.
fn own_normal([a, b, c]: [&Corner; 3]) -> Option<Vec3> {
    // Edges in units of the longest: squares of tiny ones would be zero.
    let (e, f) = (b.position - a.position, c.position - a.position);
    let scale = e.abs().max(f.abs()).max_element().max(f32::MIN_POSITIVE);
    (e / scale).cross(f / scale).try_normalize()
}

/// Unit normal of a triangle, +Y for one without area.
fn face_normal(triangle: [&Corner; 3]) -> Vec3 {
    own_normal(triangle).unwrap_or(Vec3::Y)
}

/// Sums of the normals of the triangles around each point, weighted by angle.
fn means_around<'a>(faces: impl Iterator<Item = ([&'a Corner; 3], &'a Vec3)>) -> HashMap<u32, Vec3> {
    let mut around: HashMap<u32, Vec3> = HashMap::new();
    for (triangle, normal) in faces {
        for k in 0..3 {
            let here = triangle[k].position;
            let to = |other: usize| (triangle[(k + other) % 3].position - here).normalize_or_zero();
            let angle = to(1).dot(to(2)).clamp(-1.0, 1.0).acos();
            *around.entry(triangle[k].point).or_insert(Vec3::ZERO) += angle * *normal;
        }
    }
    around
}
