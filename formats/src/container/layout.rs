//! Where payloads lie: in table order, each at the next multiple of 256, zeros between, nothing after the last.
//!
//! One layout is allowed, so every byte of a file belongs to the header, the table, one payload or padding.

use super::entry::SectionEntry;
use crate::issue::{Issue, IssueCode};

/// Payloads start at multiples of this many bytes, as GPU row copies want it.
pub const PAYLOAD_ALIGNMENT: u64 = 256;

/// Next multiple of the alignment.
pub(super) fn align(at: u64) -> Option<u64> {
    at.checked_next_multiple_of(PAYLOAD_ALIGNMENT)
}

/// Checks that the payloads of `entries` fill `bytes` after `table_end` as the rule says. Stops at the first section
/// that lies wrong, since those after it depend on it.
pub(super) fn check(bytes: &[u8], table_end: u64, entries: &[SectionEntry]) -> Result<(), Issue> {
    let mut end = table_end;
    for (i, entry) in entries.iter().enumerate() {
        check_offset(entry, table_end, end, i == 0)?;
        let payload_end = entry.offset.checked_add(entry.stored_len).filter(|&end| end <= bytes.len() as u64);
        let Some(payload_end) = payload_end else {
            let message = format!(
                "{} bytes from byte {} on end after the file, which has {} bytes",
                entry.stored_len,
                entry.offset,
                bytes.len()
            );
            return Err(Issue::error(IssueCode::SectionOutOfFile, message).at(entry.offset).of(entry.label()));
        };
        check_padding(bytes, end, entry)?;
        end = payload_end;
    }
    if end != bytes.len() as u64 {
        let message = format!("the last section ends at byte {end}, the file at byte {}", bytes.len());
        return Err(Issue::error(IssueCode::TrailingBytes, message).at(end));
    }
    Ok(())
}

fn check_offset(entry: &SectionEntry, table_end: u64, end: u64, first: bool) -> Result<(), Issue> {
    let offset = entry.offset;
    let (code, message) = if offset < table_end {
        (IssueCode::OverlapsHeader, format!("header and table end at byte {table_end}, the section starts at {offset}"))
    } else if offset < end {
        (IssueCode::SectionsOverlap, format!("the section before ends at byte {end}, this one starts at {offset}"))
    } else if !offset.is_multiple_of(PAYLOAD_ALIGNMENT) {
        (IssueCode::Misaligned, format!("expected a multiple of {PAYLOAD_ALIGNMENT}, found {offset}"))
    } else if align(end) != Some(offset) {
        let before = if first { "the table" } else { "the section before" };
        (IssueCode::SectionGap, format!("{before} ends at byte {end}, the section starts only at {offset}"))
    } else {
        return Ok(());
    };
    Err(Issue::error(code, message).at(offset).of(entry.label()))
}

/// Bytes from `end` to the entry's offset are zero. The caller has checked that they lie in the file.
fn check_padding(bytes: &[u8], end: u64, entry: &SectionEntry) -> Result<(), Issue> {
    let padding = &bytes[end as usize..entry.offset as usize];
    match padding.iter().position(|&byte| byte != 0) {
        None => Ok(()),
        Some(place) => {
            let message = format!("expected 0, found {:#04x}; the file is damaged, get it again", padding[place]);
            Err(Issue::error(IssueCode::PaddingNotZero, message).at(end + place as u64).of(entry.label()))
        }
    }
}
