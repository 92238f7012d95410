//! What a synthesis is asked to be.

use crate::error::{BakeError, Result};
use crate::normal_map::NormalMap;
use glint_formats::Wrap;
use glint_formats::synthesis::{
    Layout, MAX_COLOURS, MAX_OVERLAP, MAX_PATCHES, MAX_SAMPLE_SIZE, MAX_SEAM_BYTES, MAX_VARIANTS, MeasuredError,
    PATCH_RANGE, PathShape, SynthesisParams,
};

/// Most offsets among which patches are chosen.
pub const MAX_CANDIDATES: u32 = 4096;

/// Bytes of a texel's features.
const FEATURE_BYTES: u64 = 12;

/// Most bytes that the tables of a bake may take.
const MAX_TABLE_BYTES: u64 = 400 << 20;

/// The surface that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A surface of this size in texels. It repeats without a seam after whole patches.
    Patches {
        /// Width in texels.
        width: u32,
        /// Height in texels.
        height: u32,
    },
    /// A surface without end and without period, of corner tiles.
    Unbounded {
        /// Corner colours C; there are C⁴ tiles.
        colours: u32,
        /// Tiles for the same four colours.
        variants: u32,
    },
}

/// Options of a synthesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SynthesisOptions {
    /// The surface that is asked for.
    pub target: Target,
    /// Edge of a patch, or of a tile, in texels.
    pub patch: u32,
    /// Texels over which patches overlap.
    pub overlap: u32,
    /// Weight α of normals against Jacobians in Eq. 7, 0 to 1.
    pub alpha: f64,
    /// Mean Eq. 7 distance along the cuts up to which a patch is as good as any (of corner tiles: over the overlaps), in units
    /// of the mean distance of neighbouring texels of the sample.
    pub error_tolerance: f64,
    /// Offsets are multiples of this; it divides the patch. Blocks of this edge then fall on blocks of the sample.
    pub alignment: u32,
    /// Most offsets to choose among; where there are more, a seeded choice of them.
    pub max_candidates: u32,
    /// Seed of the choice of patches.
    pub seed: u64,
}

impl Default for SynthesisOptions {
    fn default() -> SynthesisOptions {
        SynthesisOptions {
            target: Target::Patches { width: 4096, height: 4096 },
            patch: 64,
            overlap: 8,
            alpha: 0.9,
            error_tolerance: 0.02,
            alignment: 8,
            max_candidates: 1024,
            seed: 0,
        }
    }
}

fn bad<T>(message: String) -> Result<T> {
    Err(BakeError::BadOption(message))
}

fn in_range(option: &str, (low, high): (u32, u32), found: u32) -> Result<()> {
    if (low..=high).contains(&found) {
        return Ok(());
    }
    bad(format!("{option}: expected {low} to {high}, found {found}"))
}

impl SynthesisOptions {
    /// Texels between the edge of a corner tile and its middle patch: as many as make the middle begin, past its
    /// overlap, at a multiple of 8.
    pub fn margin(&self) -> u32 {
        let margin = (8 - self.overlap % 8) % 8;
        if margin < 2 { margin + 8 } else { margin }
    }

    /// Checks the options by themselves.
    ///
    /// # Errors
    /// `BadOption` names the option, what was expected and what was found; `LimitExceeded` a surface of too many patches.
    pub fn validate(&self) -> Result<()> {
        in_range("patch", PATCH_RANGE, self.patch)?;
        in_range("overlap", (0, MAX_OVERLAP.min(self.patch / 2)), self.overlap)?;
        if self.alignment == 0 || !self.patch.is_multiple_of(self.alignment) {
            let (patch, found) = (self.patch, self.alignment);
            return bad(format!("alignment: expected a divisor of the patch of {patch}, found {found}"));
        }
        if !(0.0..=1.0).contains(&self.alpha) {
            return bad(format!("alpha: expected 0 to 1, found {}", self.alpha));
        }
        if !(self.error_tolerance >= 0.0 && self.error_tolerance <= 1e6) {
            return bad(format!("error_tolerance: expected 0 to 1e6, found {}", self.error_tolerance));
        }
        in_range("max_candidates", (1, MAX_CANDIDATES), self.max_candidates)?;
        match self.target {
            Target::Patches { width, height } => self.validate_size(width, height),
            Target::Unbounded { colours, variants } => self.validate_tiles(colours, variants),
        }
    }

    fn validate_size(&self, width: u32, height: u32) -> Result<()> {
        if width == 0 || height == 0 {
            return bad(format!("synthesize: expected one texel or more, found {width}x{height}"));
        }
        let patches = u64::from(width.div_ceil(self.patch)) * u64::from(height.div_ceil(self.patch));
        if patches > MAX_PATCHES {
            return Err(BakeError::LimitExceeded(format!(
                "synthesize: {width}x{height} texels are {patches} patches of {} texels, at most {MAX_PATCHES}; ask for a smaller \
                 surface, larger patches, or an unbounded surface",
                self.patch
            )));
        }
        let bytes = 4 * self.most_records().1;
        if bytes > MAX_SEAM_BYTES {
            return Err(BakeError::LimitExceeded(format!(
                "synthesize: {width}x{height} texels take {bytes} bytes of seams, at most {MAX_SEAM_BYTES}; ask for a smaller \
                 surface, a smaller overlap, or an unbounded surface"
            )));
        }
        Ok(())
    }

    fn validate_tiles(&self, colours: u32, variants: u32) -> Result<()> {
        in_range("colours", (1, MAX_COLOURS), colours)?;
        in_range("variants", (1, MAX_VARIANTS), variants)?;
        let needed = 2 * (self.margin() + 2 * self.overlap);
        if !self.patch.is_multiple_of(2) || self.patch < needed {
            let (overlap, found) = (self.overlap, self.patch);
            return bad(format!(
                "patch: corner tiles with an overlap of {overlap} need an even edge of {needed} or more, found {found}"
            ));
        }
        Ok(())
    }

    /// Checks the options against the sample.
    ///
    /// # Errors
    /// `BadInput` for a sample that is too small for a patch, or too large; `LimitExceeded` for tables too large.
    pub fn validate_for(&self, sample: &NormalMap) -> Result<()> {
        self.validate()?;
        let (width, height) = (sample.width, sample.height);
        let (needed, why) = match sample.wrap {
            Wrap::Repeat => (self.patch, "a patch"),
            Wrap::Clamp => (self.first_offset() + self.patch, "a patch and its overlap, as it does not repeat"),
        };
        if width.min(height) < needed {
            return Err(BakeError::BadInput(format!(
                "the sample has {width}×{height} texels, and needs {needed} a side to hold {why}; give a smaller patch \
                 or a larger sample"
            )));
        }
        if width.max(height) > MAX_SAMPLE_SIZE {
            return Err(BakeError::LimitExceeded(format!(
                "the sample has {width}×{height} texels, at most {MAX_SAMPLE_SIZE} a side can be; crop it"
            )));
        }
        let bytes = self.table_bytes(sample);
        if bytes > MAX_TABLE_BYTES {
            return Err(BakeError::LimitExceeded(format!(
                "a sample of {width}×{height} texels and up to {} candidates, with a patch of {} and an overlap of {}, take \
                 {bytes} bytes to compare, at most {MAX_TABLE_BYTES}; crop the sample, or ask for a smaller patch or \
                 overlap",
                self.max_candidates, self.patch, self.overlap
            )));
        }
        Ok(())
    }

    /// The smallest offset of a patch in a sample that does not repeat: its overlap must lie in the sample.
    pub fn first_offset(&self) -> u32 {
        self.overlap.next_multiple_of(self.alignment)
    }

    /// Bytes of the sections of offsets and seams, at most; exact for a grid of patches.
    pub fn most_bytes(&self) -> u64 {
        let (offsets, seams) = self.most_records();
        // Buffers are a multiple of 16 bytes, and not empty.
        4 * (offsets.next_multiple_of(4) + seams.max(1).next_multiple_of(4))
    }

    /// Offsets and words of seams, at most; exact for a grid of patches.
    fn most_records(&self) -> (u64, u64) {
        let words = |entries: u32| u64::from(PathShape::new(entries, self.overlap).words);
        match self.target {
            Target::Patches { width, height } => {
                let patches = u64::from(width.div_ceil(self.patch)) * u64::from(height.div_ceil(self.patch));
                (patches, patches * 2 * words(self.patch + self.overlap))
            }
            Target::Unbounded { colours, variants } => {
                let tiles = u64::from(colours).pow(4) * u64::from(variants);
                let pairs = u64::from(colours).pow(2) * 2 * words(2 * (self.margin() + self.overlap));
                (u64::from(colours) + tiles, pairs + tiles * 4 * words(self.patch))
            }
        }
    }

    /// Parameters of a surface of a sample of this size with this layout, not yet measured.
    pub(super) fn params(&self, (width, height): (u32, u32), wrap: Wrap, layout: Layout) -> SynthesisParams {
        SynthesisParams {
            sample_width: width,
            sample_height: height,
            wrap,
            patch: self.patch,
            overlap: self.overlap,
            alignment: self.alignment,
            alpha: self.alpha as f32,
            error_tolerance: self.error_tolerance as f32,
            seed: self.seed,
            layout,
            measured: MeasuredError::default(),
        }
    }

    /// First and last offset along an axis of the sample of this length.
    pub fn offset_range(&self, side: u32, wrap: Wrap) -> (u32, u32) {
        match wrap {
            Wrap::Repeat => (0, side - 1),
            Wrap::Clamp => (self.first_offset(), side - self.patch),
        }
    }

    /// Bytes of the features, the strips and the errors of every pair, at most.
    fn table_bytes(&self, sample: &NormalMap) -> u64 {
        let along = |side: u32| {
            let (first, last) = self.offset_range(side, sample.wrap);
            u64::from((last - first) / self.alignment + 1)
        };
        let candidates = u64::from(self.max_candidates).min(along(sample.width) * along(sample.height));
        let strip = u64::from(self.overlap) * u64::from(self.patch + self.overlap) * FEATURE_BYTES;
        let features = u64::from(sample.width) * u64::from(sample.height) * FEATURE_BYTES;
        // Strips of a candidate that are held at a time: of a grid its own and a neighbour's; a tile has four sides.
        let strips = match self.target {
            Target::Patches { .. } => 2,
            Target::Unbounded { .. } => 4,
        };
        // A pair has two errors, two sums along cuts and a likeness.
        features + candidates * strip * strips + candidates * candidates * 17
    }
}
