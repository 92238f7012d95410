//! Triangles with a tangent frame, as `view_surface.wgsl` reads them, and where they come from: shapes by formula, OBJ and
//! glTF files.

use super::assemble::{Fault, Part};
use super::{glb, obj};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::path::{Path, PathBuf};

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
    /// What the user should know: what the file lacked and was made up for.
    pub notes: Vec<String>,
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

/// Why a mesh file gives no mesh. Each message names the file, what is wrong and what to do.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The file, or one that it refers to, can't be read.
    #[error("{path}: {source}; check the name and the permissions")]
    Io {
        /// File that can't be read.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is damaged or contradicts itself.
    #[error("{path}: {what}; export it anew as GLB or OBJ")]
    Bad {
        /// File.
        path: PathBuf,
        /// What was found, and where.
        what: String,
    },
    /// The file is in order, but asks for something that is not read.
    #[error("{path}: {what}")]
    Unsupported {
        /// File.
        path: PathBuf,
        /// What is asked for, and what to do instead.
        what: String,
    },
    /// More than the limits allow.
    #[error("{path}: {what}; decimate the mesh")]
    TooLarge {
        /// File.
        path: PathBuf,
        /// What there is too much of, and how much is allowed.
        what: String,
    },
}

impl MeshError {
    pub(super) fn new(path: &Path, fault: Fault) -> MeshError {
        let path = path.to_owned();
        match fault {
            Fault::Bad(what) => MeshError::Bad { path, what },
            Fault::Unsupported(what) => MeshError::Unsupported { path, what },
            Fault::TooLarge(what) => MeshError::TooLarge { path, what },
            Fault::Io(file, source) => MeshError::Io { path: file, source },
        }
    }
}

impl Mesh {
    /// The mesh of a file: `.glb` and `.gltf` (the triangles of the default scene, with the transforms of its nodes) or `.obj`.
    ///
    /// Tangents that are missing or unusable are those of MikkTSpace. Missing normals are those of the triangles in glTF, as
    /// its specification asks, and means over the triangles around a position in OBJ. Missing uv are a box projection: the
    /// mesh's longest side is one unit of uv. [`Mesh::notes`] tells of all three.
    pub fn load(path: &Path) -> Result<Mesh, MeshError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let parts = match extension.as_str() {
            "glb" | "gltf" => read_capped(path).and_then(|bytes| glb::read(&bytes, path.parent())),
            "obj" => read_capped(path).and_then(|bytes| obj::read(&bytes)),
            _ => Err(Fault::Unsupported(
                "a mesh is a .glb, .gltf or .obj file by its name; convert it to one of them".to_owned(),
            )),
        };
        parts.and_then(Mesh::of_parts).map_err(|fault| MeshError::new(path, fault))
    }

    pub(super) fn of_parts(parts: Vec<Part>) -> Result<Mesh, Fault> {
        let mut mesh = Mesh::default();
        let triangles: usize = parts.iter().map(Part::triangles).sum();
        if triangles == 0 {
            return Err(Fault::Bad("there are no triangles in it".to_owned()));
        }
        if triangles > MAX_TRIANGLES {
            return Err(Fault::TooLarge(format!("it has {triangles} triangles, {MAX_TRIANGLES} are the limit")));
        }
        let whole = Bounds::of(parts.iter().flat_map(Part::positions));
        for part in parts {
            part.append_to(&mut mesh, whole)?;
            if mesh.vertices.len() > MAX_VERTICES {
                return Err(Fault::TooLarge(format!("it has more than {MAX_VERTICES} vertices, which are the limit")));
            }
        }
        mesh.notes.sort();
        mesh.notes.dedup();
        Ok(mesh)
    }

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

fn read_capped(path: &Path) -> Result<Vec<u8>, Fault> {
    read_file(path, MAX_FILE_BYTES)
}

/// The bytes of a regular file of at most `limit` bytes.
pub(super) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, Fault> {
    let io = |source| Fault::Io(path.to_owned(), source);
    let data = std::fs::metadata(path).map_err(io)?;
    if !data.is_file() {
        // A pipe or a device may never end.
        return Err(io(std::io::Error::new(std::io::ErrorKind::InvalidInput, "not a regular file")));
    }
    if data.len() > limit {
        return Err(Fault::TooLarge(format!("{} has {} bytes, {limit} are the limit", path.display(), data.len())));
    }
    std::fs::read(path).map_err(io)
}
