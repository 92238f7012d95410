//! Packs described: the whole of one, what differs between two, pictures.

pub mod diff;
mod parameters;
pub mod plot;
mod report;
mod text;

pub use parameters::ParametersInfo;
pub use report::{Report, SCHEMA};
