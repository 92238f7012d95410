//! Triangles with a tangent frame, as `view_surface.wgsl` reads them.

use bytemuck::{Pod, Zeroable};
use glam::{Affine2, Vec3};

/// Largest mesh file, and largest sum of the buffers of a glTF file.
pub const MAX_FILE_BYTES: u64 = 512 << 20;
/// Triangles of a mesh, at most.
pub const MAX_TRIANGLES: usize = 4_000_000;
/// Vertices of a mesh, at most: WebGPU's largest buffer of 256 MiB.
pub const MAX_VERTICES: usize = (256 << 20) / size_of::<Vertex>();

/// `ViewVertex` of view_surface.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    /// World position; +Y is up.
    pub position: [f32; 3],
    /// Unit normal.
    pub normal: [f32; 3],
    /// Unit direction of +u on the surface, perpendicular to the normal; w is -1 where uv is mirrored, else 1.
    /// cross(normal, tangent) · w points against +v.
    pub tangent: [f32; 4],
    /// Texture coordinates, u right and v down in the image.
    pub uv: [f32; 2],
}

/// Triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Three a triangle, counter-clockwise from outside.
    pub indices: Vec<u32>,
    /// Which indices are drawn with which of the file's materials, in order; none where all are without one.
    pub parts: Vec<MeshPart>,
    /// What the user should know: what the file lacked and was made up for.
    pub notes: Vec<String>,
}

/// Triangles that follow each other and look alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshPart {
    /// Number of the first index.
    pub first: u32,
    /// How many indices there are, three a triangle.
    pub count: u32,
    /// What is drawn on them.
    pub look: Look,
}

/// The material of a part, and where on its textures a vertex lies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// Number of the file's material; none where the file names none.
    pub material: Option<usize>,
    /// Set of the file's texture coordinates that [`Vertex::uv`] are made of.
    pub uv_set: u32,
    /// What they are made by: texture coordinates of that set to [`Vertex::uv`].
    pub uv: Affine2,
}

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
    /// Largest distance of a vertex from the middle.
    pub radius: f32,
}

impl Mesh {
    /// The box around all vertices.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.vertices.iter().map(|vertex| Vec3::from(vertex.position)))
    }
}

impl Bounds {
    /// Of these positions; all zero without any.
    pub(super) fn of(positions: impl Iterator<Item = Vec3> + Clone) -> Bounds {
        let Some(first) = positions.clone().next() else {
            return Bounds { min: Vec3::ZERO, max: Vec3::ZERO, radius: 0.0 };
        };
        let (min, max) = positions.clone().fold((first, first), |(min, max), p| (min.min(p), max.max(p)));
        let bounds = Bounds { min, max, radius: 0.0 };
        let centre = bounds.centre();
        Bounds { radius: positions.map(|p| p.distance(centre)).fold(0.0, f32::max), ..bounds }
    }

    /// The middle.
    pub fn centre(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }
}
