//! Files that are read: normal maps, environments, and maps that are made by formula.

mod colour_tag;
pub mod environment;
mod error;
mod exr_file;
mod format;
mod guard;
mod icc;
mod guard;
