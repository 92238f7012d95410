//! Finds sections by kind and name without a scan of the table, which a hostile file could make long.

use super::entry::SectionEntry;
use super::four_cc::FourCc;

/// Positions of entries, ordered by kind and name.
#[derive(Clone, Debug)]
pub(crate) struct Index(Vec<u32>);

impl Index {
    /// Orders the entries; equal ones stay in the order of the table.
    pub fn new(entries: &[SectionEntry]) -> Index {
        let mut order: Vec<u32> = (0..entries.len() as u32).collect();
        order.sort_by(|&a, &b| key(&entries[a as usize]).cmp(&key(&entries[b as usize])));
        Index(order)
    }

    /// Position of the entry with this kind and name.
    pub fn find(&self, entries: &[SectionEntry], kind: FourCc, name: &str) -> Option<usize> {
        let place = self.0.binary_search_by(|&i| key(&entries[i as usize]).cmp(&(kind, name))).ok()?;
        Some(self.0[place] as usize)
    }

    /// Positions of entries that have the kind and name of another.
    pub fn duplicates(&self, entries: &[SectionEntry]) -> Vec<usize> {
        let mut found = Vec::new();
        for pair in self.0.windows(2) {
            if key(&entries[pair[0] as usize]) == key(&entries[pair[1] as usize]) {
                found.push(pair[1] as usize);
            }
        }
        found
    }
}

fn key(entry: &SectionEntry) -> (FourCc, &str) {
    (entry.kind, &entry.name)
}
