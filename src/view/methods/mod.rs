//! From the sections of a pack to what the WGSL of each method binds.

pub mod dictionary;
pub mod lobes;
