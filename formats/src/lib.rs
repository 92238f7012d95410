//! What a glintpack is: container, typed sections, validation. No maths, no command line, no GPU.

pub mod container;
pub mod dictionary;
pub mod ndf_maps;
