//! Options of one map's bake.

use crate::error::{BakeError, Result};
use crate::normal_map::NormalMap;
use glint_formats::binding::MAX_BINDING_BYTES;
use glint_formats::lobes::{
    Filter, LobeStorage, LobesUniform, MAX_LAST_CELLS, MAX_LOBES_PER_CELL, MAX_TEXTURE_SIZE, Merge,
};

/// Smallest and largest intrinsic roughness σ_r.
pub const ROUGHNESS_RANGE: (f64, f64) = (1e-4, 1.0);
/// Smallest and largest edge of the finest cells, in texels.
pub(crate) const CELL_RANGE: (u32, u32) = (4, 64);
/// Most texels of a map: their normals fill the largest binding that every GPU has.
pub(crate) const MAX_TEXELS: u64 = 4096 * 4096;
/// Bytes of a texel's normal and that below it.
pub(crate) const TEXEL_BYTES: u64 = size_of::<[u32; 2]>() as u64;

/// How the map's normals are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalsChoice {
    /// 8 bits where they round by less than 0.03 σ_r (root mean square), else 16. A GPU holds both in words of 32 bits;
    /// compressed files are smaller with 8.
    Auto,
    /// 8 bits a channel.
    Unorm8,
    /// 16 bits a channel.
    Snorm16,
}

/// Edge of the finest cells that suits a map of this size: larger maps keep to fewer, larger cells, since below them the
/// evaluator reads the map itself.
pub fn default_cell(width: u32, height: u32) -> u32 {
    if width as u64 * height as u64 > 512 * 512 { 16 } else { 8 }
}

/// Rounding of 8-bit normals that is let pass, over σ_r, root mean square.
pub(crate) const ROUNDING: f64 = 0.03;

/// Options of one map's bake. Errors call them `roughness`, `k`, `cell` and `seeds`.
#[derive(Clone, Debug, PartialEq)]
pub struct LobesOptions {
    /// Intrinsic roughness σ_r that lobes are merged for, in [`ROUGHNESS_RANGE`]: a standard deviation in the projected-normal disk.
    pub roughness: f64,
    /// Lobes a cell, `k`: 1 to [`MAX_LOBES_PER_CELL`].
    pub lobes_per_cell: u32,
    /// Edge of the finest level's cells in texels, `cell`: a power of two from 4 to 64.
    pub cell_texels: u32,
    /// How lobes of a cell are reduced.
    pub merge: Merge,
    /// Lobes a texel that the reduction begins with: 1 or 4.
    pub seeds: u32,
    /// How the map is filtered.
    pub filter: Filter,
    /// How lobes are stored.
    pub storage: LobeStorage,
    /// How normals are stored.
    pub normals: NormalsChoice,
    /// Seed of random numbers (k-means).
    pub seed: u64,
    /// Footprints a size that the bake measures its error over, half as many above σ = 4 texels; 0 measures nothing.
    pub footprints: u32,
}

impl Default for LobesOptions {
    fn default() -> LobesOptions {
        LobesOptions {
            roughness: 0.02,
            lobes_per_cell: 32,
            cell_texels: 8,
            merge: Merge::Runnalls,
            seeds: 4,
            filter: Filter::Linear,
            storage: LobeStorage::Packed,
            normals: NormalsChoice::Auto,
            seed: 1,
            footprints: 8,
        }
    }
}

impl LobesOptions {
    /// Whether the options make sense, and for this map.
    ///
    /// # Errors
    /// `BadOption` when one is out of range, `LimitExceeded` when the map is too large, or its lobes are too many for a GPU.
    pub fn check(&self, map: &NormalMap) -> Result<()> {
        self.validate()?;
        let texels = map.width as u64 * map.height as u64;
        if texels > MAX_TEXELS || map.width.max(map.height) > MAX_TEXTURE_SIZE {
            return Err(BakeError::LimitExceeded(format!(
                "map: expected {MAX_TEXELS} texels at most, {MAX_TEXTURE_SIZE} along an edge, found {} × {}; give a part of it",
                map.width, map.height
            )));
        }
        let bytes = self.lobe_bytes(map.width, map.height);
        if bytes > MAX_BINDING_BYTES {
            return Err(BakeError::LimitExceeded(format!(
                "lobes: expected {MAX_BINDING_BYTES} bytes at most, what every GPU binds, found {bytes}; give larger cells, or \
                 fewer lobes a cell"
            )));
        }
        Ok(())
    }

    /// Bytes of the uniform, lobes and normals of a map of this size.
    pub fn most_bytes(&self, width: u32, height: u32) -> u64 {
        let texels = (width as u64 * height as u64).next_multiple_of(2) * TEXEL_BYTES;
        size_of::<LobesUniform>() as u64 + self.lobe_bytes(width, height) + texels
    }

    /// Bytes of the lobes of all levels of a map of this size.
    fn lobe_bytes(&self, width: u32, height: u32) -> u64 {
        let mut cell = self.cell_texels;
        let mut cells = 0;
        loop {
            let (columns, rows) = (width.div_ceil(cell), height.div_ceil(cell));
            cells += columns as u64 * rows as u64;
            if columns.max(rows) <= MAX_LAST_CELLS {
                break;
            }
            cell *= 2;
        }
        cells * self.lobes_per_cell as u64 * self.storage.stride() as u64
    }

    /// Whether the options make sense.
    ///
    /// # Errors
    /// `BadOption` when one is out of range.
    pub fn validate(&self) -> Result<()> {
        let bad = |message: String| Err(BakeError::BadOption(message));
        let (low, high) = ROUGHNESS_RANGE;
        if !(low..=high).contains(&self.roughness) {
            return bad(format!("roughness: expected {low} to {high}, found {}", self.roughness));
        }
        if !(1..=MAX_LOBES_PER_CELL).contains(&self.lobes_per_cell) {
            return bad(format!("k: expected 1 to {MAX_LOBES_PER_CELL} lobes, found {}", self.lobes_per_cell));
        }
        let (low, high) = CELL_RANGE;
        if !(low..=high).contains(&self.cell_texels) || !self.cell_texels.is_power_of_two() {
            return bad(format!("cell: expected a power of two from {low} to {high}, found {}", self.cell_texels));
        }
        if ![1, 4].contains(&self.seeds) {
            return bad(format!("seeds: expected 1 or 4, found {}", self.seeds));
        }
        Ok(())
    }
}
