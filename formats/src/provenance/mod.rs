//! Where a pack comes from: tool, options and inputs. Nothing that differs between equal bakes is recorded.

pub(crate) mod check;

use crate::container::{FourCc, KnownKind};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_128;

/// Provenance: [`Provenance`], bincode.
pub const PROVENANCE: FourCc = FourCc(*b"PROV");

/// The one kind of provenance.
pub(crate) const KINDS: &[KnownKind] = &[KnownKind::first(PROVENANCE, "provenance")];

/// Where a pack, or one material of it, comes from. No time stamps, host names or folders: equal inputs give equal
/// packs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of the tool.
    pub tool_version: String,
    /// Commit the tool was built from; empty when it is not known.
    pub git_hash: String,
    /// Method that baked it: `ndf-maps`.
    pub method: String,
    /// Options as (name, value), in the order of the tool's help.
    pub options: Vec<(String, String)>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Inputs in the order given.
    pub inputs: Vec<InputDigest>,
    /// Convention of the normal map that was read: `y-up` or `y-down`.
    pub normal_convention: String,
    /// Remarks for people.
    pub notes: Vec<String>,
}

/// One input file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputDigest {
    /// File name without folders.
    pub name: String,
    /// XXH3-128 of the file, 32 lower-case hex digits, most significant first.
    pub xxh3_128: String,
    /// Bytes of the file.
    pub bytes: u64,
}

impl InputDigest {
    /// Digest of an input's bytes. `name` is the file name without folders.
    pub fn of(name: &str, bytes: &[u8]) -> InputDigest {
        InputDigest { name: name.to_owned(), xxh3_128: format!("{:032x}", xxh3_128(bytes)), bytes: bytes.len() as u64 }
    }
}
