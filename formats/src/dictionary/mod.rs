//! Typed sections of the slope dictionary: parameters, and uniforms, and one table with all marginals of all levels.
//!
//! Method: Chermain et al. 2020, sections 4 and 7.3; what we store differs from the paper as `docs/methods/dictionary.md` says.
//! A dictionary is independent of roughness, density and surface: one serves a whole scene.

pub(crate) mod check;

use crate::binding::Binding;
use crate::container::{FourCc, KnownKind};
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of a dictionary: [`DictionaryParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"SDPP");
/// What a shader binds as uniforms: buffer of one [`DictionaryUniform`].
pub const UNIFORM: FourCc = FourCc(*b"SDUB");
/// All marginals: buffer of `u32` words, `levels` · `marginals` rows of `entries`, then zeros up to a multiple of four words.
///
/// Word b of row `level · marginals + marginal` holds two half floats: in its lower half P(x) at the slope
/// x = (b + ½) · domain / entries, in its upper half that of word b + 1, or its own where b is the last. One load is all that
/// linear filtering with clamp to edge needs, for x from 0 to `domain`. P is even, and zero beyond `domain`.
pub const TABLE: FourCc = FourCc(*b"SDTB");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "dictionary parameters"),
    KnownKind::first(UNIFORM, "dictionary uniforms"),
    KnownKind::first(TABLE, "dictionary table"),
];
/// How a dictionary is bound. The colours of glints belong to the material, which a host sets; the next binding is theirs.
pub const BINDINGS: &[Binding] = &[Binding::Uniform(UNIFORM), Binding::Storage(TABLE)];
/// Largest number of rows, and of entries of a row.
pub const MAX_TABLE_SIDE: u32 = 8192;
/// Largest number of words of the table, of 128 MiB: what every WebGPU device binds.
pub const MAX_TABLE_WORDS: u64 = 1 << 25;
/// Largest |2 ∫ P − 1| of a row, the integral from 0 to the end of the domain as linear filtering takes it. Half floats
/// of few entries cannot do better; a larger dictionary is nearer by orders, see [`MeasuredError::normalisation`].
pub const ROW_TOLERANCE: f64 = 1e-3;

/// What a shader binds as uniforms: `GlintDictionaryTables` of `dictionary::eval`, 32 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct DictionaryUniform {
    /// Number of marginals N.
    pub marginals: u32,
    /// Number of levels.
    pub levels: u32,
    /// Entries of a row.
    pub entries: u32,
    /// Roughness α of the Beckmann target of the tables.
    pub alpha_dict: f32,
    /// Slope at which the tables end.
    pub domain: f32,
    /// `entries / domain`.
    pub inv_spacing: f32,
    /// Slope area that a two-dimensional lobe fills, 4π · lobe_std².
    pub lobe_area: f32,
    /// 0.
    pub unused: u32,
}

/// Error of the stored half floats, read as linear filtering reads them, against the target and against exact lobes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// Largest |2 ∫ P − 1| over marginals and levels.
    pub normalisation: f64,
    /// ∫ |mean over marginals − target| at level 0.
    pub mean_l1_first_level: f64,
    /// Kolmogorov–Smirnov distance to the target at the last level, mean over marginals.
    pub ks_last_level: f64,
}

/// Parameters of a dictionary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DictionaryParams {
    /// Number of marginals N.
    pub marginals: u32,
    /// Number of levels; level l has 2^(l+1) lobes, and level `levels` is the smooth target itself.
    pub levels: u32,
    /// Entries of one marginal at one level.
    pub entries: u32,
    /// Roughness α of the Beckmann target of the tables.
    pub alpha_dict: f64,
    /// Standard deviation of one lobe, in slope.
    pub lobe_std: f64,
    /// Slope at which the tables end.
    pub domain: f64,
    /// Seed of the lobe means.
    pub seed: u64,
    /// Error as the bake measured it.
    pub measured: MeasuredError,
}

impl DictionaryParams {
    /// The uniforms that go with these parameters.
    pub fn uniform(&self) -> DictionaryUniform {
        let (alpha_dict, domain) = (self.alpha_dict as f32, self.domain as f32);
        DictionaryUniform {
            marginals: self.marginals,
            levels: self.levels,
            entries: self.entries,
            alpha_dict,
            domain,
            inv_spacing: self.entries as f32 / domain,
            lobe_area: (4.0 * std::f64::consts::PI * self.lobe_std * self.lobe_std) as f32,
            unused: 0,
        }
    }

    /// Entries of all rows; the table has as many words, and zeros up to a multiple of four.
    pub fn table_entries(&self) -> u64 {
        u64::from(self.marginals) * u64::from(self.levels) * u64::from(self.entries)
    }
}
