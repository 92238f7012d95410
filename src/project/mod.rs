//! A project: a TOML file that names materials and environments, each of which becomes a pack.
//!
//! [`file`] reads the tables, [`scene`] what the camera sees of them, [`arguments`] turns each into the bake that it stands
//! for. [`settled`] makes targets of what was planned for the scene. [`freshness`] says whether a pack is up to date, by the
//! [`record`] that the last build left, and [`ninja`] writes the project for another tool.

pub mod arguments;
pub mod entry;
pub mod file;
pub mod freshness;
mod model;
pub mod ninja;
pub mod record;
pub mod scene;
pub mod settled;
pub mod stamp;

pub use file::load;
pub use model::{CommandLine, PlannedTable, Project, Target, Work};
