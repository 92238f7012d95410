//! Typed sections of the slope dictionary: parameters, and one texture with all marginals of all levels.
//!
//! Method: Chermain et al. 2020, sections 4 and 7.3; what we store differs from the paper as `docs/methods/dictionary.md` says.
//! A dictionary is independent of roughness, density and surface: one serves a whole scene.

pub(crate) mod check;

use crate::container::{FourCc, KnownKind};
use crate::vk_format;
use serde::{Deserialize, Serialize};

/// Parameters of a dictionary: [`DictionaryParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"SDPP");
/// All marginals: texture of [`TABLE_VK_FORMAT`], `entries` × (`levels` · `marginals`) texels, one mip, one layer.
///
/// Row `level · marginals + marginal` is P(x) at slopes x = (b + ½) · domain / entries for texel b, to be read with
/// linear filtering and clamp to edge at u = x / domain, for x from 0 to `domain`. P is even, and zero beyond `domain`.
pub const TABLE: FourCc = FourCc(*b"SDTB");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] =
    &[KnownKind::first(PARAMS, "dictionary parameters"), KnownKind::first(TABLE, "dictionary table")];
/// VkFormat of the table: R16_SFLOAT.
pub const TABLE_VK_FORMAT: u32 = vk_format::R16_SFLOAT;
/// Largest width or height of the table: what every WebGPU device offers.
pub const MAX_TEXTURE_SIZE: u32 = 8192;
/// Largest |2 ∫ P − 1| of a row, the integral from 0 to the end of the domain as linear filtering takes it. Half floats
/// of few entries cannot do better; a larger dictionary is nearer by orders, see [`MeasuredError::normalisation`].
pub const ROW_TOLERANCE: f64 = 1e-3;

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
