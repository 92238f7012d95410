//! What a dictionary is asked to be, and which askings cannot work.
//!
//! Paper: section 4.4 (lobe width, target roughness, levels, table size) and section 7.3 (domain of four standard
//! deviations of the target). Defaults are the paper's.

use crate::error::{BakeError, Result};
use glint_formats::dictionary::{MAX_TABLE_SIDE, MAX_TABLE_WORDS};

/// The domain of a marginal ends at this many standard deviations of the target marginal (paper, section 7.3).
pub const DOMAIN_STDS: f64 = 4.0;
/// Narrowest lobe that the table can carry, as a fraction of the distance of two entries. At this width the sum over
/// bin centres of one lobe varies by up to 18 % with where it falls, which normalisation takes out again; below it
/// a lobe can fall between two entries and its table would be empty.
pub const MIN_LOBE_SPACINGS: f64 = 0.35;
/// Narrowest lobe whose density, at most 0.48 over its standard deviation at a bin centre, fits a half float.
pub const MIN_LOBE_STD: f64 = 1e-5;
/// Largest number of levels: the last level of each marginal then has 2^19 independent lobes.
pub const MAX_LEVELS: u32 = 20;

/// Options of the dictionary bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DictionaryOptions {
    /// Number of marginals N, at least 1.
    pub marginals: u32,
    /// Number of levels, 1 to [`MAX_LEVELS`]; level l has 2^(l+1) lobes, half of them mirror images.
    pub levels: u32,
    /// Entries of one table, which covers slopes from 0 to [`DictionaryOptions::domain`].
    pub entries: u32,
    /// Roughness α of the target that the marginals converge to (Beckmann: ∝ exp(−x²/α²)).
    pub alpha_dict: f64,
    /// Standard deviation of one lobe, in slope.
    pub lobe_std: f64,
    /// Seed of the lobe means.
    pub seed: u64,
}

impl Default for DictionaryOptions {
    fn default() -> DictionaryOptions {
        DictionaryOptions { marginals: 192, levels: 16, entries: 64, alpha_dict: 0.5, lobe_std: 0.02, seed: 0 }
    }
}

impl DictionaryOptions {
    /// Standard deviation of the target marginal, in slope: α / √2.
    pub fn target_std(&self) -> f64 {
        self.alpha_dict * std::f64::consts::FRAC_1_SQRT_2
    }

    /// Largest slope a table holds.
    pub fn domain(&self) -> f64 {
        DOMAIN_STDS * self.target_std()
    }

    /// Slope between two neighbouring entries; entry b stands at (b + ½) · spacing.
    pub fn spacing(&self) -> f64 {
        self.domain() / f64::from(self.entries)
    }

    /// Variance of the lobe means. A lobe adds its own variance and linear interpolation adds spacing² / 6, so that
    /// all three together are the target's.
    pub fn mean_variance(&self) -> f64 {
        let (target, spacing) = (self.target_std(), self.spacing());
        target * target - self.lobe_std * self.lobe_std - spacing * spacing / 6.0
    }

    /// Number of tables, one a level and marginal.
    pub fn tables(&self) -> u64 {
        u64::from(self.marginals) * u64::from(self.levels)
    }

    /// Checks that a dictionary with these options exists.
    ///
    /// # Errors
    /// [`BakeError::BadOption`] names the option, what was found and what would work;
    /// [`BakeError::LimitExceeded`] if the table would be larger than a pack may have.
    pub fn validate(&self) -> Result<()> {
        for (name, value) in [("marginals", self.marginals), ("levels", self.levels), ("entries", self.entries)] {
            if value == 0 {
                return bad(format!("{name}: expected 1 or more, found 0, of which the dictionary would be empty"));
            }
        }
        if self.levels > MAX_LEVELS {
            return bad(format!("levels: expected 1 to {MAX_LEVELS}, found {}", self.levels));
        }
        if !(0.01..=10.0).contains(&self.alpha_dict) {
            return bad(format!(
                "alpha-dict: expected 0.01 to 10, so that densities fit half floats, found {}; it does not limit the \
                 roughness at run time",
                self.alpha_dict
            ));
        }
        if !(self.lobe_std.is_finite() && self.lobe_std >= MIN_LOBE_STD) {
            return bad(format!(
                "lobe-std: expected a slope of {MIN_LOBE_STD} or more, so that densities fit half floats, found {}",
                self.lobe_std
            ));
        }
        if self.lobe_std >= self.domain() {
            return bad(format!(
                "lobe-std: expected a slope below the domain of the tables, which ends at {:.4}, found {}",
                self.domain(),
                self.lobe_std
            ));
        }
        let narrowest = MIN_LOBE_SPACINGS * self.spacing();
        if self.lobe_std < narrowest {
            return bad(format!(
                "entries, lobe-std: expected a lobe of {narrowest:.5} or more for {} entries, {:.5} apart, or {} entries or more, found {}: a \
                 lobe can fall between two entries and leave its table empty",
                self.entries,
                self.spacing(),
                (MIN_LOBE_SPACINGS * self.domain() / self.lobe_std).ceil(),
                self.lobe_std
            ));
        }
        if self.mean_variance() <= 0.0 {
            return bad(format!(
                "lobe-std: expected lobes that are narrower than the target, whose standard deviation is {:.4}, as the \
                 sampler reads them with {} entries, found {}; narrower lobes or more entries would work",
                self.target_std(),
                self.entries,
                self.lobe_std
            ));
        }
        let (rows, entries) = (self.tables(), u64::from(self.entries));
        let most = u64::from(MAX_TABLE_SIDE);
        if entries > most || rows > most || rows * entries > MAX_TABLE_WORDS {
            return Err(BakeError::LimitExceeded(format!(
                "expected at most {most} tables, of {most} entries, and {MAX_TABLE_WORDS} entries in \
                 all, found {rows} tables ({} marginals × {} levels) of {entries} entries",
                self.marginals, self.levels
            )));
        }
        Ok(())
    }
}

fn bad(message: String) -> Result<()> {
    Err(BakeError::BadOption(message))
}
