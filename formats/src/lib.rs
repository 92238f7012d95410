//! What a glintpack is: container, typed sections, validation. No maths, no command line, no GPU.
//!
//! Write with [`PackBuilder`] and [`write_atomic`]; read with [`Pack`]; check bytes of any origin with [`validate`].
//! The bytes are described in `docs/FORMAT.md`.
#![deny(unsafe_code)]

// Buffers hold little-endian records that are read in place.
#[cfg(target_endian = "big")]
compile_error!("glint-formats reads little-endian records in place and is not written for big-endian machines");

pub mod binding;
mod bytes;
pub mod container;
mod error;
pub mod export;
mod issue;
pub mod kinds;
mod methods;
mod pack;
pub mod params;
mod sections;
mod verify;
pub mod vk_format;
mod wrap;

pub use container::{
    Codec, FourCc, KnownKind, Limits, PackBuilder, Resource, Section, SectionEntry, WriteOutcome, write_atomic,
};
pub use error::{FormatError, OpenError};
pub use issue::{Issue, IssueCode, Severity};
pub use methods::*;
pub use pack::Pack;
pub use verify::validate;
pub use wrap::Wrap;
