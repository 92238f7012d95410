//! Meshes: shapes by formula, and files that are in order, damaged, or cut anywhere.

mod files;
mod shapes;
mod support;
