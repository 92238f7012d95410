//! The container: a header, a table of sections, and aligned payloads. Knows nothing of what the payloads mean.

mod atomic;
mod builder;
mod entry;
mod four_cc;
mod header;
mod index;
mod known_kind;
mod layout;
mod limits;
mod mmap;
mod payload;
mod resource;
mod section;
mod structure;

pub use atomic::{TEMPORARY_PREFIX, TEMPORARY_SUFFIX, WriteOutcome, write_atomic};
pub use builder::PackBuilder;
pub use entry::{ENTRY_BYTES, SectionEntry};
pub use four_cc::FourCc;
pub use header::{HEADER_BYTES, MAGIC, VERSION};
pub use known_kind::KnownKind;
pub use layout::PAYLOAD_ALIGNMENT;
pub use limits::Limits;
pub use resource::{Resource, full_mip_count};
pub use section::{Codec, MAX_NAME_BYTES, Section};

pub(crate) use index::Index;
pub(crate) use mmap::Bytes;
pub(crate) use structure::Structure;

/// Payload of one section of `bytes`; see [`Pack::payload`].
pub(crate) use payload::read as read_payload;
