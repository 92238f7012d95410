//! Parameter sections: serde values as bytes. The only module that names bincode.
//!
//! Integers have their fixed width and are little-endian; lengths are u64, enum variants u32, options one byte.

use crate::error::FormatError;
use bincode::config::{Configuration, Fixint, Limit, LittleEndian};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Largest parameter section.
pub const MAX_BYTES: usize = 16 << 20;

const CONFIG: Configuration<LittleEndian, Fixint, Limit<MAX_BYTES>> =
    bincode::config::standard().with_little_endian().with_fixed_int_encoding().with_limit::<MAX_BYTES>();

/// Bytes of a value.
///
/// # Panics
///
/// When the value cannot be encoded at all: a sequence that does not know its length, or a `Serialize` written by
/// hand that fails. Derived types of numbers, strings, vectors and enums never do.
pub fn encode<T: Serialize>(value: &T) -> Vec<u8> {
    bincode::serde::encode_to_vec(value, CONFIG).expect("parameter types encode")
}

/// The value that all of `bytes` encode.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, FormatError> {
    if bytes.len() > MAX_BYTES {
        return Err(FormatError::ParametersTooLarge { most: MAX_BYTES, found: bytes.len() });
    }
    let (value, used) = bincode::serde::decode_from_slice(bytes, CONFIG)
        .map_err(|error| FormatError::Parameters { reason: error.to_string() })?;
    if used != bytes.len() {
        return Err(FormatError::ParametersTrailing { used, found: bytes.len() });
    }
    Ok(value)
}
