//! Typed sections of patch synthesis: where each patch of a large surface lies in a small sample, and along which seams
//! patches meet.
//!
//! Method: Tan et al. 2022, section 5.1.1; what we store differs from the paper as `docs/methods/surface.md` says. Nothing here
//! depends on what a texel holds: normals, lobes and their MIP are read through the same look-up.

pub(crate) mod check;

use crate::container::{FourCc, KnownKind};
use crate::wrap::Wrap;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of a synthesis: [`SynthesisParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"SYPP");
/// Patch offsets: buffer of two u16 (x, y), stride 4: the sample texel at a patch's texel (0, 0). Zeros follow to a multiple of 16
/// bytes, so that every host binds the buffer whole: see [`SynthesisParams::stored_offsets`].
///
/// [`Layout::Patches`]: row by row. [`Layout::CornerTiles`]: first one a corner colour, then one a tile and variant.
pub const OFFSETS: FourCc = FourCc(*b"SYPO");
/// Seam paths: buffer of u32, stride 4, see [`SynthesisParams::seam_words`] and [`PathShape`]. Zeros follow to a multiple of 16 bytes,
/// 16 bytes at least: see [`SynthesisParams::stored_seam_words`].
pub const SEAMS: FourCc = FourCc(*b"SYSE");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "synthesis parameters"),
    KnownKind::first(OFFSETS, "synthesis patch offsets"),
    KnownKind::first(SEAMS, "synthesis seam paths"),
];

/// Largest width or height of the sample.
pub const MAX_SAMPLE_SIZE: u32 = 16_384;
/// Edge of a patch in texels, least and most.
pub const PATCH_RANGE: (u32, u32) = (4, 1024);
/// Widest overlap of two patches.
pub const MAX_OVERLAP: u32 = 64;
/// Most patches of a surface.
pub const MAX_PATCHES: u64 = 1 << 20;
/// Most bytes of seam paths: what a storage buffer may hold on every GPU.
pub const MAX_SEAM_BYTES: u64 = 128 << 20;
/// Most corner colours.
pub const MAX_COLOURS: u32 = 4;
/// Most variants of a tile.
pub const MAX_VARIANTS: u32 = 16;

/// How patches cover the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Layout {
    /// A grid of patches that repeats after `columns · patch` × `rows · patch` texels. A patch covers its block of the
    /// grid and `overlap` texels left of it and above it.
    Patches {
        /// Width that was asked for, in texels.
        width: u32,
        /// Height that was asked for, in texels.
        height: u32,
        /// Columns of patches: ⌈width / patch⌉.
        columns: u32,
        /// Rows of patches: ⌈height / patch⌉.
        rows: u32,
    },
    /// Square tiles without end. Each corner has one of `colours` colours by hash, and a tile is chosen by its four.
    CornerTiles {
        /// Number of corner colours C.
        colours: u32,
        /// Tiles for the same four colours, one of them chosen by hash.
        variants: u32,
        /// Texels between the edge of a tile and its middle patch.
        margin: u32,
        /// Seed of the hash.
        hash_seed: u32,
    },
}

/// Quality as the bake measured it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// Root mean square difference of projected normals across seams, over that of neighbours in the sample; 0 where
    /// there are no seams or the sample is flat.
    pub seam_ratio: f64,
    /// Offsets that differ.
    pub distinct_offsets: u32,
}

/// Parameters of a synthesis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SynthesisParams {
    /// Width of the sample in texels.
    pub sample_width: u32,
    /// Height of the sample in texels.
    pub sample_height: u32,
    /// Whether patches may cross the sample's edge (`Repeat`) or not (`Clamp`).
    pub wrap: Wrap,
    /// Edge of a patch (or tile) in texels.
    pub patch: u32,
    /// Texels over which patches overlap.
    pub overlap: u32,
    /// Offsets are multiples of this; it divides `patch`.
    pub alignment: u32,
    /// Weight α of normals against Jacobians in Eq. 7, 0 to 1.
    pub alpha: f32,
    /// Error tolerance of a patch, in units of the mean Eq. 7 distance of neighbours in the sample.
    pub error_tolerance: f32,
    /// Seed of the choice of patches.
    pub seed: u64,
    /// How patches cover the surface.
    pub layout: Layout,
    /// Quality as the bake measured it.
    pub measured: MeasuredError,
}

/// [`SynthesisUniform::arrangement`] of [`Layout::Patches`].
pub const PATCHES: u32 = 0;
/// [`SynthesisUniform::arrangement`] of [`Layout::CornerTiles`].
pub const CORNER_TILES: u32 = 1;

/// What the section [`crate::lobes::UNIFORM`] of the same name holds of a synthesis, `GlintSynthesis` of the shaders: all that a
/// look-up needs to know besides offsets and seams. 64 bytes.
/// Fields that the arrangement has no use for are 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct SynthesisUniform {
    /// Width of the sample in texels.
    pub sample_width: u32,
    /// Height of the sample in texels.
    pub sample_height: u32,
    /// 0: patches may cross the sample's edge; 1: they may not.
    pub wrap: u32,
    /// Edge of a patch (or tile) in texels.
    pub patch_texels: u32,
    /// Texels over which patches overlap.
    pub overlap: u32,
    /// [`PATCHES`] or [`CORNER_TILES`].
    pub arrangement: u32,
    /// Columns of patches after which the surface repeats, of a grid of patches.
    pub columns: u32,
    /// Rows of patches after which the surface repeats, of a grid of patches.
    pub rows: u32,
    /// Number of corner colours, of corner tiles.
    pub colours: u32,
    /// Tiles for the same four colours, of corner tiles.
    pub variants: u32,
    /// Texels between the edge of a tile and its middle patch, of corner tiles.
    pub margin: u32,
    /// Seed of the hash, of corner tiles.
    pub hash_seed: u32,
    /// Bits of a path's entry, 0 where there is no choice: [`PathShape::bits`].
    pub path_bits: u32,
    /// Entries in a word of a path, 0 where there is no choice: [`PathShape::per_word`].
    pub path_per_word: u32,
    /// Words of a path of a patch of the grid, or around the middle patch of a tile.
    pub path_words: u32,
    /// Words of a path between two corner colours, of corner tiles.
    pub colour_path_words: u32,
}

/// How a seam path is packed: `per_word` entries of `bits` bits in a u32, the first in the lowest bits.
///
/// An entry is the number of overlap texels of its row (or column) that the older patch keeps, 0 to overlap − 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathShape {
    /// Entries of the path.
    pub entries: u32,
    /// Bits of an entry: ⌈log₂ overlap⌉; 0 where there is no choice.
    pub bits: u32,
    /// Entries in a word; 0 where there is no choice.
    pub per_word: u32,
    /// Words of the path.
    pub words: u32,
}

impl PathShape {
    /// The shape of a path of `entries` entries across `overlap` texels.
    pub fn new(entries: u32, overlap: u32) -> PathShape {
        let bits = u32::BITS - overlap.saturating_sub(1).leading_zeros();
        let per_word = u32::BITS.checked_div(bits).unwrap_or(0);
        let words = if per_word == 0 { 0 } else { entries.div_ceil(per_word) };
        PathShape { entries, bits, per_word, words }
    }
}

impl SynthesisParams {
    /// What shaders read of these parameters.
    pub fn uniform(&self) -> SynthesisUniform {
        let shape = self.patch_path();
        let uniform = SynthesisUniform {
            sample_width: self.sample_width,
            sample_height: self.sample_height,
            wrap: match self.wrap {
                Wrap::Repeat => 0,
                Wrap::Clamp => 1,
            },
            patch_texels: self.patch,
            overlap: self.overlap,
            path_bits: shape.bits,
            path_per_word: shape.per_word,
            path_words: shape.words,
            ..SynthesisUniform::default()
        };
        match self.layout {
            Layout::Patches { columns, rows, .. } => {
                SynthesisUniform { arrangement: PATCHES, columns, rows, ..uniform }
            }
            Layout::CornerTiles { colours, variants, margin, hash_seed } => SynthesisUniform {
                arrangement: CORNER_TILES,
                colours,
                variants,
                margin,
                hash_seed,
                path_words: self.middle_path(margin).words,
                colour_path_words: self.colour_path(margin).words,
                ..uniform
            },
        }
    }

    /// Paths of a patch of the grid: left, then upper.
    pub fn patch_path(&self) -> PathShape {
        PathShape::new(self.patch + self.overlap, self.overlap)
    }

    /// Paths between two corner colours, across one edge of a tile: `margin + overlap` entries on either side of it.
    pub fn colour_path(&self, margin: u32) -> PathShape {
        PathShape::new(2 * (margin + self.overlap), self.overlap)
    }

    /// Paths around the middle patch of a tile: left, upper, right, lower.
    pub fn middle_path(&self, margin: u32) -> PathShape {
        PathShape::new(self.patch - 2 * margin, self.overlap)
    }

    /// Patches, each with an offset.
    pub fn offset_count(&self) -> u64 {
        match self.layout {
            Layout::Patches { columns, rows, .. } => u64::from(columns) * u64::from(rows),
            Layout::CornerTiles { colours, variants, .. } => {
                u64::from(colours) + u64::from(colours).pow(4) * u64::from(variants)
            }
        }
    }

    /// Records of [`OFFSETS`] as they are stored: with zeros to a multiple of 16 bytes.
    pub fn stored_offsets(&self) -> u64 {
        self.offset_count().next_multiple_of(4)
    }

    /// Records of [`SEAMS`] as they are stored: with zeros to a multiple of 16 bytes, and 16 bytes at least.
    pub fn stored_seam_words(&self) -> u64 {
        self.seam_words().max(1).next_multiple_of(4)
    }

    /// Words of seam paths. [`Layout::Patches`]: two paths a patch. [`Layout::CornerTiles`]: for each pair (a, b) of
    /// colours, at a · C + b, the path where b lies right of a and the one where b lies below a; then four paths a tile
    /// and variant.
    pub fn seam_words(&self) -> u64 {
        match self.layout {
            Layout::Patches { .. } => self.offset_count() * 2 * u64::from(self.patch_path().words),
            Layout::CornerTiles { colours, margin, .. } => {
                let pairs = u64::from(colours).pow(2);
                let tiles = self.offset_count() - u64::from(colours);
                pairs * 2 * u64::from(self.colour_path(margin).words)
                    + tiles * 4 * u64::from(self.middle_path(margin).words)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_take_the_bits_that_a_choice_needs() {
        for (overlap, bits, per_word) in
            [(0, 0, 0), (1, 0, 0), (2, 1, 32), (3, 2, 16), (4, 2, 16), (5, 3, 10), (64, 6, 5)]
        {
            let shape = PathShape::new(70, overlap);
            assert_eq!((shape.bits, shape.per_word), (bits, per_word), "{overlap}");
            assert_eq!(shape.words, if bits == 0 { 0 } else { 70u32.div_ceil(per_word) });
        }
    }
}
