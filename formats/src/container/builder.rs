//! Builds the bytes of a pack. Equal sections in equal order give equal bytes.

use super::entry::SectionEntry;
use super::four_cc::FourCc;
use super::limits::Limits;
use super::resource::Resource;
use super::section::{Codec, Section, check_name, label};
use super::{header, layout};
use crate::error::FormatError;
use crate::params;
use std::borrow::Cow;
use std::collections::HashSet;
use xxhash_rust::xxh3::xxh3_64;

/// Zstandard level: close to the best ratio at a cost that baking does not notice.
const ZSTD_LEVEL: i32 = 12;

/// Builds the bytes of a pack.
#[derive(Clone, Debug, Default)]
pub struct PackBuilder {
    sections: Vec<Section>,
    seen: HashSet<(FourCc, String)>,
}

impl PackBuilder {
    /// A pack without sections.
    pub fn new() -> PackBuilder {
        PackBuilder::default()
    }

    /// Adds a section after those already there. Refuses what a reader would refuse.
    pub fn push(&mut self, section: Section) -> Result<(), FormatError> {
        let label = label(section.kind, &section.name);
        check_name(&section.name).map_err(|reason| FormatError::Name { section: label.clone(), reason })?;
        check_payload(&section, &label)?;
        let most = Limits::default().max_sections;
        if self.sections.len() as u64 >= u64::from(most) {
            return Err(FormatError::TooManySections { most });
        }
        if !self.seen.insert((section.kind, section.name.clone())) {
            return Err(FormatError::Duplicate { section: label });
        }
        self.sections.push(section);
        Ok(())
    }

    /// The bytes of the pack.
    pub fn finish(&self) -> Result<Vec<u8>, FormatError> {
        // `push` keeps the number of sections below the default limit.
        let count = self.sections.len() as u32;
        let mut end = header::table_end(count);
        let mut entries = Vec::new();
        let mut payloads = Vec::new();
        for section in &self.sections {
            let stored = compress(section)?;
            let too_large = || FormatError::Resource {
                section: label(section.kind, &section.name),
                reason: String::from("the pack would be larger than 2^64 bytes"),
            };
            let offset = layout::align(end).ok_or_else(too_large)?;
            end = offset.checked_add(stored.len() as u64).ok_or_else(too_large)?;
            entries.push(SectionEntry {
                kind: section.kind,
                name: section.name.clone(),
                version: section.version,
                required: section.required,
                codec: section.codec,
                resource: section.resource,
                offset,
                stored_len: stored.len() as u64,
                raw_len: section.payload.len() as u64,
                checksum: xxh3_64(&stored),
            });
            payloads.push(stored);
        }
        let mut out = header::write(count, end);
        for entry in &entries {
            entry.write(&mut out);
        }
        header::seal(&mut out);
        out.reserve_exact((end as usize).saturating_sub(out.len()));
        for (entry, payload) in entries.iter().zip(&payloads) {
            out.resize(entry.offset as usize, 0);
            out.extend_from_slice(payload);
        }
        Ok(out)
    }
}

/// Payload length and descriptor agree.
fn check_payload(section: &Section, label: &str) -> Result<(), FormatError> {
    let found = section.payload.len() as u64;
    let refuse = |reason: String| FormatError::Resource { section: label.to_owned(), reason };
    match section.resource.byte_len().map_err(refuse)? {
        Some(expected) if expected != found => {
            Err(FormatError::PayloadLength { section: label.to_owned(), expected, found })
        }
        Some(_) => Ok(()),
        None if section.resource != Resource::Parameters => {
            Err(refuse(String::from("the texture format is not one this version writes")))
        }
        None if found > params::MAX_BYTES as u64 => {
            Err(refuse(format!("parameters have at most {} bytes, found {found}", params::MAX_BYTES)))
        }
        None => Ok(()),
    }
}

fn compress(section: &Section) -> Result<Cow<'_, [u8]>, FormatError> {
    match section.codec {
        Codec::None => Ok(Cow::Borrowed(&section.payload)),
        Codec::Zstd => zstd::bulk::compress(&section.payload, ZSTD_LEVEL).map(Cow::Owned).map_err(|error| {
            FormatError::Compress { section: label(section.kind, &section.name), reason: error.to_string() }
        }),
    }
}
