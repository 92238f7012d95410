//! What is looked at and from where: meshes, made or loaded, and the camera that orbits them.

mod accessor;
mod assemble;
mod camera;
mod fault;
mod glb;
mod load;
mod mesh;
mod obj;
mod shapes;
mod tangents;

pub use camera::{CameraTextError, Orbit, Placement};
pub use load::MeshError;
pub use mesh::{Bounds, MAX_FILE_BYTES, MAX_TRIANGLES, MAX_VERTICES, Mesh, Vertex};
