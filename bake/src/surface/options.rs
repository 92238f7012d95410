//! What a surface of patches is asked to be.

use crate::error::{BakeError, Result};
use crate::lobes::LobesOptions;
use crate::lobes::options::TEXEL_BYTES;
use crate::normal_map::NormalMap;
use crate::synthesis::SynthesisOptions;
use glint_formats::Wrap;
use glint_formats::lobes::{LobesUniform, MAX_LAST_CELLS};
use std::borrow::Cow;

/// What patches are aligned to by default, and in how many texels cells begin: at 8, there would be four times as many
/// cells; at 32, few places to cut patches from.
pub const ALIGNMENT: u32 = 16;

/// Options of a surface and of the lobes of its sample.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Lobes of the sample.
    pub lobes: LobesOptions,
    /// Patches of the surface. The alignment is a power of two.
    pub synthesis: SynthesisOptions,
}

impl SurfaceOptions {
    /// Whether the options make sense together, and for this map.
    ///
    /// # Errors
    /// `BadOption` for options without a meaning, `BadInput` for a map too small for a patch, `LimitExceeded` for a map or
    /// surface too large.
    pub fn check(&self, map: &NormalMap) -> Result<()> {
        let (lobes, synthesis) = (&self.lobes, &self.synthesis);
        lobes.check(map)?;
        synthesis.validate_for(&self.sample_of(map))?;
        if !synthesis.alignment.is_power_of_two() {
            let found = synthesis.alignment;
            return Err(BakeError::BadOption(format!("alignment: expected a power of two, found {found}")));
        }
        if lobes.cell_texels > synthesis.alignment {
            return Err(BakeError::BadOption(format!(
                "cell: expected finest cells of {} texels at most for a surface of patches, found {}",
                synthesis.alignment, lobes.cell_texels
            )));
        }
        Ok(())
    }

    /// Bytes of the sections that a GPU holds, at most, for a map of this size.
    pub fn most_bytes(&self, width: u32, height: u32) -> u64 {
        let (lobes, synthesis) = (&self.lobes, &self.synthesis);
        let stored = |cell: u32| {
            let step = cell.min(synthesis.alignment);
            u64::from(width.div_ceil(step)) * u64::from(height.div_ceil(step))
        };
        let cells: u64 = self.edges().map(stored).sum();
        let texels = u64::from(width) * u64::from(height) * TEXEL_BYTES;
        let records = (cells + u64::from(MAX_LAST_CELLS)) * u64::from(lobes.lobes_per_cell);
        size_of::<LobesUniform>() as u64 + records * u64::from(lobes.storage.stride()) + texels + synthesis.most_bytes()
    }

    /// The map as patches are cut from it: one that repeats, but not after a multiple of the alignment, is used as one that
    /// does not.
    pub(super) fn sample_of<'a>(&self, map: &'a NormalMap) -> Cow<'a, NormalMap> {
        let alignment = self.synthesis.alignment;
        let whole = map.width.is_multiple_of(alignment) && map.height.is_multiple_of(alignment);
        if map.wrap == Wrap::Repeat && !whole {
            Cow::Owned(NormalMap { wrap: Wrap::Clamp, ..map.clone() })
        } else {
            Cow::Borrowed(map)
        }
    }

    /// Edges of stored cells in texels: doubling as long as they divide the patch.
    pub(super) fn edges(&self) -> impl Iterator<Item = u32> {
        let patch = self.synthesis.patch;
        let first = self.lobes.cell_texels;
        std::iter::successors(Some(first), |edge| edge.checked_mul(2))
            .take_while(move |edge| patch.is_multiple_of(*edge))
    }
}
