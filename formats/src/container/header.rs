//! The first 40 bytes: magic, version, counts, and a checksum over header and section table.

use super::entry::ENTRY_BYTES;
use super::limits::Limits;
use crate::bytes::{u16_at, u32_at, u64_at};
use crate::issue::{Issue, IssueCode};
use xxhash_rust::xxh3::Xxh3;

/// First bytes of a pack. As in PNG and KTX2: a byte above 127 shows 7-bit damage, CR LF and LF show changed line
/// ends, and 1A stops a listing in some shells.
pub const MAGIC: [u8; 12] = *b"\xABGLINTP\xBB\r\n\x1A\n";
/// Version that is written: (major, minor).
pub const VERSION: (u16, u16) = (1, 0);
/// Bytes of the header.
pub const HEADER_BYTES: u64 = 40;

/// Where the header checksum lies.
const CHECKSUM: std::ops::Range<usize> = 32..40;

/// What the header says once it is checked.
pub(super) struct Header {
    pub version: (u16, u16),
    pub section_count: u32,
}

/// End of the section table, which follows the header.
pub(super) fn table_end(section_count: u32) -> u64 {
    HEADER_BYTES + u64::from(section_count) * ENTRY_BYTES
}

/// Header of a pack; the checksum is written by [`seal`].
pub(super) fn write(section_count: u32, file_len: u64) -> Vec<u8> {
    let mut out = Vec::with_capacity(HEADER_BYTES as usize);
    out.extend_from_slice(&MAGIC);
    out.extend_from_slice(&VERSION.0.to_le_bytes());
    out.extend_from_slice(&VERSION.1.to_le_bytes());
    out.extend_from_slice(&section_count.to_le_bytes());
    out.extend_from_slice(&0u32.to_le_bytes());
    out.extend_from_slice(&file_len.to_le_bytes());
    out.extend_from_slice(&0u64.to_le_bytes());
    out
}

/// Writes the checksum into the header; `head` is header and table.
pub(super) fn seal(head: &mut [u8]) {
    let checksum = checksum_of(head);
    head[CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
}

/// XXH3-64 of header and table with zeros in place of the checksum itself.
fn checksum_of(head: &[u8]) -> u64 {
    let mut hasher = Xxh3::new();
    hasher.update(&head[..CHECKSUM.start]);
    hasher.update(&[0; CHECKSUM.end - CHECKSUM.start]);
    hasher.update(&head[CHECKSUM.end..]);
    hasher.digest()
}

/// Checks the header against the file and the limits. The version is judged before the rest, since another major
/// version may lay out the rest in another way; the checksum before what it covers is used.
pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Header, Issue> {
    let found_len = bytes.len() as u64;
    if found_len < HEADER_BYTES {
        let message = format!(
            "expected at least {HEADER_BYTES} bytes, found {found_len}; the file is cut short or is not a glintpack"
        );
        return Err(Issue::error(IssueCode::FileTooShort, message));
    }
    if bytes[..12] != MAGIC {
        return Err(Issue::error(IssueCode::BadMagic, magic_message(&bytes[..12])).at(0));
    }
    let version = (u16_at(bytes, 12), u16_at(bytes, 14));
    if version.0 != VERSION.0 {
        let message = format!(
            "this program reads major version {}, the file has {}.{}; use a program that reads it, or bake again",
            VERSION.0, version.0, version.1
        );
        return Err(Issue::error(IssueCode::UnsupportedMajor, message).at(12));
    }
    let section_count = u32_at(bytes, 16);
    let flags = u32_at(bytes, 20);
    let stated_len = u64_at(bytes, 24);
    let largest = found_len.max(stated_len);
    if largest > limits.max_file_bytes {
        let message = format!(
            "at most {} bytes are read, the file has or states {largest}; raise the limit if you trust the file",
            limits.max_file_bytes
        );
        return Err(Issue::error(IssueCode::FileTooLarge, message).at(24));
    }
    if stated_len != found_len {
        let message = format!(
            "the header states {stated_len} bytes, the file has {found_len}; it was cut short, extended or damaged"
        );
        return Err(Issue::error(IssueCode::FileLength, message).at(24));
    }
    if section_count > limits.max_sections {
        let message = format!(
            "at most {} sections are read, the header states {section_count}; raise the limit if you trust the file",
            limits.max_sections
        );
        return Err(Issue::error(IssueCode::TooManySections, message).at(16));
    }
    let table_end = table_end(section_count);
    if table_end > found_len {
        let message = format!(
            "a table of {section_count} sections ends at byte {table_end}, the file at byte {found_len}; it is damaged"
        );
        return Err(Issue::error(IssueCode::TableOutOfFile, message).at(16));
    }
    let expected = u64_at(bytes, CHECKSUM.start);
    // The table end is at most the length of `bytes`, so it fits a usize.
    let found = checksum_of(&bytes[..table_end as usize]);
    if expected != found {
        let message = format!(
            "the header states {expected:016x}, header and table have {found:016x}; the file is damaged, get it again"
        );
        return Err(Issue::error(IssueCode::HeaderChecksum, message).at(CHECKSUM.start as u64));
    }
    if flags != 0 {
        let message = format!("expected 0, found {flags:#010x}; the file needs a newer reader");
        return Err(Issue::error(IssueCode::UnknownFlags, message).at(20));
    }
    Ok(Header { version, section_count })
}

fn magic_message(found: &[u8]) -> String {
    let hint = if found[1..7] == MAGIC[1..7] {
        "the file was changed on its way, for instance by a transfer in text mode; get it again in binary mode"
    } else {
        "this is not a glintpack"
    };
    format!("expected {}, found {}; {hint}", MAGIC.escape_ascii(), found.escape_ascii())
}
