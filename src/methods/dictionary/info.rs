//! One slope dictionary, as numbers.

use crate::methods::contents::{Item, decode_all};
use crate::quantities::kib;
use glint_formats::dictionary::{DictionaryParams, MeasuredError, PARAMS, TABLE};
use glint_formats::{Pack, SectionEntry};
use serde::Serialize;
use std::fmt::Write;

/// One slope dictionary.
#[derive(Debug, Serialize)]
pub struct DictionaryInfo {
    /// Name in the pack.
    pub name: String,
    /// Marginals a level.
    pub marginals: u32,
    /// Levels.
    pub levels: u32,
    /// Entries of a marginal.
    pub entries: u32,
    /// Roughness α of the tables' target.
    pub alpha_dict: f64,
    /// Standard deviation of a lobe, in slope.
    pub lobe_std: f64,
    /// Slope at which the tables end.
    pub domain: f64,
    /// Seed of the lobe means.
    pub seed: u64,
    /// Bytes of the table once decompressed.
    pub table_bytes: u64,
    /// Error as the bake measured it.
    pub measured: MeasuredError,
}

impl DictionaryInfo {
    /// Describes every dictionary of a sound pack.
    pub fn all_of(pack: &Pack) -> Vec<DictionaryInfo> {
        let describe = |(entry, params): (&SectionEntry, DictionaryParams)| DictionaryInfo {
            name: entry.name.clone(),
            marginals: params.marginals,
            levels: params.levels,
            entries: params.entries,
            alpha_dict: params.alpha_dict,
            lobe_std: params.lobe_std,
            domain: params.domain,
            seed: params.seed,
            table_bytes: pack.find(TABLE, &entry.name).map_or(0, |table| table.raw_len),
            measured: params.measured,
        };
        decode_all(pack, PARAMS).into_iter().map(describe).collect()
    }

    /// Size on one line, that of the table as a GPU holds it.
    pub fn size_line(marginals: u32, levels: u32, entries: u32) -> String {
        let bytes = 4 * u64::from(marginals) * u64::from(levels) * u64::from(entries);
        format!("{marginals} marginals × {levels} levels × {entries} entries, {}", kib(bytes))
    }

    /// Size and error on one line.
    fn size_and_error(&self) -> String {
        let MeasuredError { normalisation, mean_l1_first_level, ks_last_level } = self.measured;
        format!(
            "{}, normalisation error {normalisation:.1e}, L1 of the mean at level 0 {mean_l1_first_level:.4}, KS at \
             level {} {ks_last_level:.5}",
            DictionaryInfo::size_line(self.marginals, self.levels, self.entries),
            self.levels - 1
        )
    }
}

impl Item for DictionaryInfo {
    fn name(&self) -> &str {
        &self.name
    }

    fn accuracy_line(&self) -> Option<String> {
        Some(self.size_and_error())
    }

    fn to_text(&self) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(out, "dictionary \"{}\"", self.name);
        let size = DictionaryInfo::size_line(self.marginals, self.levels, self.entries);
        let _ = writeln!(out, "  tables       {size}");
        let lobes = 1u64 << self.levels.min(63);
        let _ = writeln!(out, "  lobes        2 to {lobes} a marginal, standard deviation {} in slope", self.lobe_std);
        let _ = writeln!(out, "  target       α {}, tables end at slope {:.4}", self.alpha_dict, self.domain);
        let _ = writeln!(out, "  integral     {:.1e} at most from 1", self.measured.normalisation);
        let _ = writeln!(out, "  level 0      L1 of the mean to the target {:.4}", self.measured.mean_l1_first_level);
        let _ = writeln!(
            out,
            "  level {:<6} KS to the target {:.5}, mean over marginals",
            self.levels - 1,
            self.measured.ks_last_level
        );
        let _ = writeln!(out, "  seed         {}", self.seed);
        out
    }
}
