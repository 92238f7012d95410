//! What a glintpack is: container, typed sections, validation. No maths, no command line, no GPU.
//!
//! Write with [`PackBuilder`] and [`write_atomic`]; read with [`Pack`]; check bytes of any origin with [`validate`].
//! The bytes are described in `docs/FORMAT.md`.
#![deny(unsafe_code)]

// Buffers hold little-endian records that are read in place.
#[cfg(target_endian = "big")]
compile_error!("glint-formats reads little-endian records in place and is not written for big-endian machines");

pub mod area_light;
mod area_light_check;
pub mod container;
pub mod dictionary;
mod dictionary_check;
pub mod environment;
mod environment_check;
mod error;
pub mod export;
mod issue;
pub mod kinds;
pub mod lobes;
mod lobes_check;
pub mod ndf_maps;
mod ndf_maps_check;
pub mod params;
mod placement_check;
pub mod provenance;
mod sections;
mod surface_check;
pub mod synthesis;
mod synthesis_check;
mod verify;
pub mod vk_format;

pub use container::{
    Codec, FourCc, Limits, Pack, PackBuilder, Resource, Section, SectionEntry, WriteOutcome, write_atomic,
};
pub use error::{FormatError, OpenError};
pub use issue::{Issue, IssueCode, Severity};
pub use verify::validate;
