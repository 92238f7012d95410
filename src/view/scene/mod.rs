//! What is looked at and from where: meshes, made or loaded, and the camera that orbits them.

mod accessor;
mod assemble;
mod camera;
mod document;
mod fault;
mod glb;
mod load;
mod mesh;
mod mikktspace;
mod obj;
mod polygon;
mod shapes;
mod tangents;
mod texture;
mod uri;

pub use camera::{CameraTextError, Orbit, Placement};
pub use load::MeshError;
pub use mesh::{Bounds, Look, MAX_FILE_BYTES, MAX_TRIANGLES, MAX_VERTICES, Mesh, MeshPart, Vertex};
