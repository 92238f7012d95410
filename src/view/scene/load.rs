//! A mesh from an OBJ or glTF file.

use super::assemble::{Part, Parts};
use super::fault::{Fault, read_file};
use super::mesh::{Bounds, MAX_FILE_BYTES, MAX_VERTICES, Mesh};
use super::{glb, obj};
use std::path::{Path, PathBuf};

/// Notes on a mesh, at most: a file may have any number of materials.
const MAX_NOTES: usize = 20;

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
            Fault::Io(file, source) if file == path => MeshError::Io { path, source },
            Fault::Io(file, source) => {
                let said = format!("a buffer of {}: {source}", path.display());
                MeshError::Io { path: file, source: std::io::Error::new(source.kind(), said) }
            }
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
        parts.and_then(of_parts).map_err(|fault| MeshError::new(path, fault))
    }
}

/// One mesh of the lists of triangles that a file holds.
fn of_parts(read: Parts) -> Result<Mesh, Fault> {
    let mut mesh = Mesh { notes: read.notes, ..Mesh::default() };
    let triangles: usize = read.parts.iter().map(Part::triangles).sum();
    if triangles == 0 {
        return Err(Fault::Bad("there are no triangles in it".to_owned()));
    }
    if read.parts.iter().all(|part| !part.has_area()) {
        return Err(Fault::Bad(format!("it has no triangle with an area, only {triangles} without")));
    }
    let whole = Bounds::of(read.parts.iter().flat_map(Part::positions));
    for part in read.parts {
        part.append_to(&mut mesh, whole);
        if mesh.vertices.len() > MAX_VERTICES {
            return Err(Fault::TooLarge(format!("it has more than {MAX_VERTICES} vertices, which are the limit")));
        }
    }
    mesh.notes.sort();
    mesh.notes.dedup();
    if mesh.notes.len() > MAX_NOTES {
        let more = mesh.notes.len() - MAX_NOTES;
        mesh.notes.truncate(MAX_NOTES);
        mesh.notes.push(format!("and {more} more of such notes"));
    }
    Ok(mesh)
}

fn read_capped(path: &Path) -> Result<Vec<u8>, Fault> {
    read_file(path, MAX_FILE_BYTES)
}
