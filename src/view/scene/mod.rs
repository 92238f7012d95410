//! What is looked at and from where: meshes, made or loaded, and the camera that orbits them.

mod accessor;
mod assemble;
mod camera;
mod glb;
mod mesh;
mod obj;
mod shapes;
mod tangents;

pub use camera::{CameraTextError, Orbit, Placement};
pub use mesh::{Bounds, MAX_FILE_BYTES, MAX_TRIANGLES, MAX_VERTICES, Mesh, MeshError, Vertex};
