//! Header, table and layout of a pack, checked: what can be known without reading payloads.

use super::entry::{ENTRY_BYTES, SectionEntry};
use super::header::{self, HEADER_BYTES};
use super::index::Index;
use super::layout;
use super::limits::Limits;
use crate::issue::{Issue, IssueCode, Severity};

/// A pack whose header, table, layout and padding are right.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    pub version: (u16, u16),
    pub entries: Vec<SectionEntry>,
    pub index: Index,
    pub warnings: Vec<Issue>,
}

impl Structure {
    /// Reads the structure of `bytes`, or says what is wrong with it. `kind_issue` says what a reader that knows the kinds of
    /// sections finds wrong with one.
    pub fn read(
        bytes: &[u8],
        limits: &Limits,
        kind_issue: impl Fn(&SectionEntry) -> Option<Issue>,
    ) -> Result<Structure, Vec<Issue>> {
        let header = header::read(bytes, limits).map_err(|issue| vec![issue])?;
        let table_end = header::table_end(header.section_count);
        let mut entries = Vec::new();
        let mut issues = Vec::new();
        // The header has shown that the table lies in the file.
        let table = &bytes[HEADER_BYTES as usize..table_end as usize];
        for (i, entry) in table.chunks_exact(ENTRY_BYTES as usize).enumerate() {
            match SectionEntry::read(entry, HEADER_BYTES + i as u64 * ENTRY_BYTES) {
                Ok(entry) => entries.push(entry),
                Err(issue) => issues.push(issue),
            }
        }
        if !issues.is_empty() {
            return Err(issues);
        }
        let index = Index::new(&entries);
        for duplicate in index.duplicates(&entries) {
            let message = "a pack has each kind once for each name";
            issues.push(Issue::error(IssueCode::DuplicateSection, message).of(entries[duplicate].label()));
        }
        issues.extend(layout::check(bytes, table_end, &entries).err());
        issues.extend(check_raw_total(&entries, limits).err());
        issues.extend(entries.iter().filter_map(kind_issue));
        if issues.iter().any(|issue| issue.severity == Severity::Error) {
            return Err(issues);
        }
        Ok(Structure { version: header.version, entries, index, warnings: issues })
    }
}

fn check_raw_total(entries: &[SectionEntry], limits: &Limits) -> Result<(), Issue> {
    let mut total = 0u64;
    for entry in entries {
        total = total.saturating_add(entry.raw_len);
    }
    if total > limits.max_raw_bytes {
        let message = format!(
            "at most {} bytes are decompressed, the sections state {total}; raise the limit if you trust the file",
            limits.max_raw_bytes
        );
        return Err(Issue::error(IssueCode::RawTooLarge, message));
    }
    Ok(())
}
