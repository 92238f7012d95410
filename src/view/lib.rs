//! The viewer of glint packs: what a pack holds goes to the GPU, is rendered by the WGSL of `glint-shaders`, and is compared.
//!
//! No flags and no files but meshes: the program around it is `src/bin/glint-view.rs`.

pub mod bench;
pub mod gpu;
pub mod methods;
pub mod render;
pub mod scene;
pub mod settings;
pub mod subjects;
pub mod window;
