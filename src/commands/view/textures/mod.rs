//! Materials of glTF files, and lists of textures, as the viewer draws them: images to mips, and where each lies.

mod document;
mod gltf;
mod images;
mod ktx2_file;
mod list;
mod mips;

pub use gltf::materials_of;
pub use list::material_of;
