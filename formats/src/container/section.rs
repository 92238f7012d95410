//! One section as it is handed to the writer.

use super::four_cc::FourCc;
use super::resource::Resource;
use crate::params;
use bytemuck::NoUninit;
use serde::Serialize;

/// Longest name in bytes.
pub const MAX_NAME_BYTES: usize = 63;

/// How a payload is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Codec {
    /// As it is.
    None,
    /// One Zstandard frame.
    Zstd,
}

/// One section as it is handed to the writer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// What the section is.
    pub kind: FourCc,
    /// Material the section belongs to; empty for a section of the whole pack. UTF-8, at most 63 bytes.
    pub name: String,
    /// Version of the section's own layout.
    pub version: u16,
    /// Whether a reader that does not know the kind must refuse the pack.
    pub required: bool,
    /// How the payload is to be stored.
    pub codec: Codec,
    /// What the payload holds.
    pub resource: Resource,
    /// The bytes before compression.
    pub payload: Vec<u8>,
}

impl Section {
    /// A required, uncompressed parameter section of version 1.
    pub fn parameters<T: Serialize>(kind: FourCc, name: &str, value: &T) -> Section {
        Section {
            kind,
            name: name.to_owned(),
            version: 1,
            required: true,
            codec: Codec::None,
            resource: Resource::Parameters,
            payload: params::encode(value),
        }
    }

    /// A required, uncompressed buffer section of version 1 with one record for each element.
    pub fn buffer<T: NoUninit>(kind: FourCc, name: &str, records: &[T]) -> Section {
        Section {
            kind,
            name: name.to_owned(),
            version: 1,
            required: true,
            codec: Codec::None,
            resource: Resource::Buffer { stride: size_of::<T>() as u32, count: records.len() as u64 },
            payload: bytemuck::cast_slice(records).to_vec(),
        }
    }

    /// A required, uncompressed texture section of version 1.
    pub fn texture(kind: FourCc, name: &str, resource: Resource, payload: Vec<u8>) -> Section {
        Section { kind, name: name.to_owned(), version: 1, required: true, codec: Codec::None, resource, payload }
    }

    /// The same section, stored as a Zstandard frame.
    pub fn compressed(self) -> Section {
        Section { codec: Codec::Zstd, ..self }
    }

    /// The same section, which readers that do not know its kind may skip.
    pub fn optional(self) -> Section {
        Section { required: false, ..self }
    }
}

/// Says why a name is not allowed. Control characters are refused because names are printed.
pub(super) fn check_name(name: &str) -> Result<(), String> {
    if name.len() > MAX_NAME_BYTES {
        return Err(format!("a name has at most {MAX_NAME_BYTES} bytes, found {}", name.len()));
    }
    if name.chars().any(char::is_control) {
        return Err(String::from("a name has no control characters"));
    }
    Ok(())
}

/// How messages name a section: its kind, then its name in quotes unless the section is the whole pack's.
pub(crate) fn label(kind: FourCc, name: &str) -> String {
    if name.is_empty() { kind.to_string() } else { format!("{kind} \"{name}\"") }
}
