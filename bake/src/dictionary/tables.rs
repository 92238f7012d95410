//! A baked dictionary: the half floats that ship, their section parameters, and the tables as a shader reads them.
//!
//! Layout: one 2D texture of `entries` × (`levels` · `marginals`) texels, a row a table, the marginals of one level
//! together. The paper uses 1 024 layers of a 1D array, which is beyond WebGPU's default limit of 256.

use super::options::DictionaryOptions;
use super::quality;
use glint_formats::dictionary::{DictionaryParams, MeasuredError};
use half::f16;

/// A baked dictionary.
#[derive(Clone, Debug, PartialEq)]
pub struct Dictionary {
    /// What it was baked with.
    pub options: DictionaryOptions,
    /// Bits of the half floats: row `level · marginals + marginal`, `entries` in a row.
    pub bits: Vec<u16>,
}

/// Shape of the table texture: format R16_SFLOAT, one layer, one mip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableShape {
    /// VkFormat code.
    pub vk_format: u32,
    /// Texels in a row: the entries.
    pub width: u32,
    /// Rows: levels · marginals.
    pub height: u32,
}

impl Dictionary {
    /// Bytes of the table section: little-endian half floats, row after row, without padding.
    pub fn payload(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.bits.len() * 2);
        for value in &self.bits {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
        bytes
    }

    /// Shape of the table section.
    pub fn shape(&self) -> TableShape {
        TableShape {
            vk_format: glint_formats::dictionary::TABLE_VK_FORMAT,
            width: self.options.entries,
            height: self.options.levels * self.options.marginals,
        }
    }

    /// Parameters of the section, with `measured` as [`quality::measure`] gives it.
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

    /// Parameters with the error measured now (a few milliseconds for the default dictionary).
    pub fn measured_params(&self) -> DictionaryParams {
        self.params(quality::measure(self))
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
        let mut texels = Vec::with_capacity(self.bits.len());
        for value in &self.bits {
            texels.push(f16::from_bits(*value).to_f32());
        }
        let (alpha_dict, domain) = (self.options.alpha_dict as f32, self.options.domain() as f32);
        Tables {
            marginals: self.options.marginals,
            levels: self.options.levels,
            entries: self.options.entries,
            alpha_dict,
            domain,
            inv_spacing: self.options.entries as f32 / domain,
            lobe_area: (4.0 * std::f64::consts::PI * self.options.lobe_std.powi(2)) as f32,
            texels,
        }
    }
}

/// What a shader binds: uniforms and the table texture.
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
    /// Texels, row `level · marginals + marginal`.
    pub texels: Vec<f32>,
}
