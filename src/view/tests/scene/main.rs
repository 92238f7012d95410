//! Meshes: shapes by formula, and files that are in order, damaged, or cut anywhere.

mod files;
mod hostile;
mod obj;
mod shapes;
mod support;
mod uv;
