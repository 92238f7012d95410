//! A baked dictionary: half floats, their parameters, and the tables as the run time reads them.
//!
//! Row `level · marginals + marginal` is a table of `entries` half floats, the marginals of one level together. The paper uses
//! 1 024 layers of a 1D array, which is beyond WebGPU's default limit of 256.

use super::options::DictionaryOptions;
use glint_formats::dictionary::{DictionaryParams, DictionaryUniform, MeasuredError};
use half::f16;

/// A baked dictionary.
#[derive(Clone, Debug, PartialEq)]
pub struct Dictionary {
    /// What it was baked with.
    pub options: DictionaryOptions,
    /// Bits of the half floats: row `level · marginals + marginal`, `entries` in a row.
    pub bits: Vec<u16>,
}

impl Dictionary {
    /// What a shader binds as the table: each entry, in the lower half of a word, with the next of its row, the last with
    /// itself; zeros up to a multiple of four words.
    pub fn pairs(&self) -> Vec<u32> {
        let mut words = Vec::with_capacity(self.bits.len().next_multiple_of(4));
        for row in self.bits.chunks_exact(self.options.entries as usize) {
            let next = row.iter().skip(1).chain(row.last());
            words.extend(row.iter().zip(next).map(|(&own, &next)| u32::from(own) | u32::from(next) << 16));
        }
        words.resize(words.len().next_multiple_of(4), 0);
        words
    }

    /// Parameters of the section, with `measured` as [`super::quality::measure`] gives it.
    pub fn params(&self, measured: MeasuredError) -> DictionaryParams {
        DictionaryParams {
            marginals: self.options.marginals,
            levels: self.options.levels,
            entries: self.options.entries,
            alpha_dict: self.options.alpha_dict,
            lobe_std: self.options.lobe_std,
            domain: self.options.domain(),
            seed: self.options.seed,
            measured,
        }
    }

    /// Entries of one table in f64, for measuring.
    pub fn entries(&self, level: u32, marginal: u32) -> Vec<f64> {
        let entries = self.options.entries as usize;
        let row = (level * self.options.marginals + marginal) as usize;
        let mut values = Vec::with_capacity(entries);
        for b in 0..entries {
            values.push(f16::from_bits(self.bits[row * entries + b]).to_f64());
        }
        values
    }

    /// The tables as the run time reads them.
    pub fn tables(&self) -> Tables {
        let DictionaryUniform { marginals, levels, entries, alpha_dict, domain, inv_spacing, lobe_area, .. } =
            self.params(MeasuredError::default()).uniform();
        let texels = self.bits.iter().map(|bits| f16::from_bits(*bits).to_f32()).collect();
        Tables { marginals, levels, entries, alpha_dict, domain, inv_spacing, lobe_area, texels }
    }
}

/// The uniforms and the table, as floats.
#[derive(Clone, Debug, PartialEq)]
pub struct Tables {
    /// Number of marginals.
    pub marginals: u32,
    /// Number of levels in the table; this level itself is the smooth target.
    pub levels: u32,
    /// Entries of one table.
    pub entries: u32,
    /// Roughness of the target of the tables.
    pub alpha_dict: f32,
    /// Slope at which the tables end.
    pub domain: f32,
    /// entries / domain.
    pub inv_spacing: f32,
    /// Slope area that a two-dimensional lobe fills, 4π · lobe_std²: 1 / ∫ lobe².
    pub lobe_area: f32,
    /// Entries, row `level · marginals + marginal`.
    texels: Vec<f32>,
}

impl Tables {
    /// Row `row` at `place` texels from the centre of its first one, from 0 to `entries` − 1, linearly filtered.
    #[inline]
    pub(super) fn filtered(&self, row: u32, place: f32) -> f32 {
        let low = place.floor();
        let b0 = low as u32;
        let b1 = (b0 + 1).min(self.entries - 1);
        let v0 = self.texels[(row * self.entries + b0) as usize];
        let v1 = self.texels[(row * self.entries + b1) as usize];
        v0 + (v1 - v0) * (place - low)
    }
}
