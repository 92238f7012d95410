//! One entry of the section table: 136 bytes, every one of them checked.

use super::four_cc::FourCc;
use super::resource::Resource;
use super::section::{Codec, MAX_NAME_BYTES, check_name, label};
use crate::bytes::{u16_at, u32_at, u64_at};
use crate::issue::{Issue, IssueCode};
use serde::{Serialize, Serializer};

/// Bytes of an entry.
pub const ENTRY_BYTES: u64 = 136;

// Where fields lie in an entry.
const REQUIRED: usize = 6;
const CODEC: usize = 7;
const RAW_LEN: usize = 24;
const RESOURCE: usize = 40;
const RESOURCE_END: usize = 72;
const NAME: usize = 73;

const RESOURCE_PARAMETERS: u32 = 0;
const RESOURCE_BUFFER: u32 = 1;
const RESOURCE_TEXTURE: u32 = 2;

/// One section of a pack that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SectionEntry {
    /// What the section is.
    pub kind: FourCc,
    /// Material the section belongs to; empty for a section of the whole pack.
    pub name: String,
    /// Version of the section's own layout.
    pub version: u16,
    /// Whether a reader that does not know the kind must refuse the pack.
    pub required: bool,
    /// How the payload is stored.
    pub codec: Codec,
    /// What the payload holds.
    pub resource: Resource,
    /// Where the stored payload starts in the file.
    pub offset: u64,
    /// Bytes of the payload in the file.
    pub stored_len: u64,
    /// Bytes of the payload once it is decompressed.
    pub raw_len: u64,
    /// XXH3-64 of the stored bytes. In JSON 16 hex digits, since JSON readers round large numbers.
    #[serde(serialize_with = "as_hex")]
    pub checksum: u64,
}

fn as_hex<S: Serializer>(checksum: &u64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&format_args!("{checksum:016x}"))
}

impl SectionEntry {
    /// How messages name the section: `NMPP "rock"`.
    pub fn label(&self) -> String {
        label(self.kind, &self.name)
    }

    /// Appends the entry to a table.
    pub(super) fn write(&self, out: &mut Vec<u8>) {
        let start = out.len();
        out.extend_from_slice(&self.kind.0);
        out.extend_from_slice(&self.version.to_le_bytes());
        out.push(u8::from(self.required));
        out.push(match self.codec {
            Codec::None => 0,
            Codec::Zstd => 1,
        });
        for value in [self.offset, self.stored_len, self.raw_len, self.checksum] {
            out.extend_from_slice(&value.to_le_bytes());
        }
        for word in resource_words(&self.resource) {
            out.extend_from_slice(&word.to_le_bytes());
        }
        // The builder has checked that the length fits.
        out.push(self.name.len() as u8);
        out.extend_from_slice(self.name.as_bytes());
        out.resize(start + ENTRY_BYTES as usize, 0);
    }

    /// Reads the entry whose [`ENTRY_BYTES`] bytes start at byte `at` of the file.
    pub(super) fn read(bytes: &[u8], at: u64) -> Result<SectionEntry, Issue> {
        let kind = FourCc([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let name = read_name(&bytes[NAME - 1..])
            .map_err(|why| Issue::error(IssueCode::BadName, why).at(at + NAME as u64).of(kind.to_string()))?;
        let fail =
            |code, offset: usize, message| Issue::error(code, message).at(at + offset as u64).of(label(kind, &name));
        let required = match bytes[REQUIRED] {
            0 => false,
            1 => true,
            found => {
                let message = format!("expected 0 (optional) or 1 (required), found {found}");
                return Err(fail(IssueCode::BadRequiredFlag, REQUIRED, message));
            }
        };
        let codec = match bytes[CODEC] {
            0 => Codec::None,
            1 => Codec::Zstd,
            found => {
                let message = format!("expected 0 (none) or 1 (zstd), found {found}; the file needs a newer reader");
                return Err(fail(IssueCode::UnknownCodec, CODEC, message));
            }
        };
        let resource =
            read_resource(&bytes[RESOURCE..RESOURCE_END]).map_err(|(code, why)| fail(code, RESOURCE, why))?;
        let stored_len = u64_at(bytes, 16);
        let raw_len = u64_at(bytes, RAW_LEN);
        let implied = resource.byte_len().map_err(|why| fail(IssueCode::BadResource, RESOURCE, why))?;
        if let Some(expected) = implied
            && expected != raw_len
        {
            let message = format!("the resource descriptor gives {expected} bytes, the entry states {raw_len}");
            return Err(fail(IssueCode::RawLength, RAW_LEN, message));
        }
        if codec == Codec::None && stored_len != raw_len {
            let message = format!("stored and raw length are equal without a codec, found {stored_len} and {raw_len}");
            return Err(fail(IssueCode::StoredLength, 16, message));
        }
        let version = u16_at(bytes, 4);
        let offset = u64_at(bytes, 8);
        let checksum = u64_at(bytes, 32);
        Ok(SectionEntry { kind, version, required, codec, resource, offset, stored_len, raw_len, checksum, name })
    }
}

/// The eight words of a resource descriptor; those that a type does not use are zero.
fn resource_words(resource: &Resource) -> [u32; 8] {
    match *resource {
        Resource::Parameters => [RESOURCE_PARAMETERS, 0, 0, 0, 0, 0, 0, 0],
        Resource::Buffer { stride, count } => [RESOURCE_BUFFER, stride, count as u32, (count >> 32) as u32, 0, 0, 0, 0],
        Resource::Texture { vk_format, width, height, layers, faces, mips } => {
            [RESOURCE_TEXTURE, vk_format, width, height, layers, faces, mips, 0]
        }
    }
}

fn read_resource(bytes: &[u8]) -> Result<Resource, (IssueCode, String)> {
    let mut words = [0u32; 8];
    for (i, word) in words.iter_mut().enumerate() {
        *word = u32_at(bytes, 4 * i);
    }
    let resource = match words[0] {
        RESOURCE_PARAMETERS => Resource::Parameters,
        RESOURCE_BUFFER => {
            Resource::Buffer { stride: words[1], count: u64::from(words[2]) | u64::from(words[3]) << 32 }
        }
        RESOURCE_TEXTURE => Resource::Texture {
            vk_format: words[1],
            width: words[2],
            height: words[3],
            layers: words[4],
            faces: words[5],
            mips: words[6],
        },
        found => {
            let message = format!(
                "expected 0 (parameters), 1 (buffer) or 2 (texture), found {found}; the file needs a newer reader"
            );
            return Err((IssueCode::UnknownResource, message));
        }
    };
    if words != resource_words(&resource) {
        return Err((IssueCode::UnusedBytes, String::from("words that the resource type does not use are not zero")));
    }
    Ok(resource)
}

/// Reads a length byte and the field of 63 bytes after it.
fn read_name(field: &[u8]) -> Result<String, String> {
    let len = usize::from(field[0]);
    if len > MAX_NAME_BYTES {
        return Err(format!("a name has at most {MAX_NAME_BYTES} bytes, the entry states {len}"));
    }
    let (name, rest) = field[1..=MAX_NAME_BYTES].split_at(len);
    if rest.iter().any(|&byte| byte != 0) {
        return Err(String::from("bytes after the name are not zero"));
    }
    let name = std::str::from_utf8(name).map_err(|_| String::from("the name is not UTF-8"))?;
    check_name(name)?;
    Ok(name.to_owned())
}
