//! Typed sections of MIP-mapped position-normal lobes: parameters, what shaders read of them, lobes of every level, and the
//! map's normals.
//!
//! Method: Tan et al. 2022, section 5.1.2; what we store differs from the paper as `docs/methods/lobes.md` says. A lobe is a
//! 4D Gaussian over position u (texels) and projected normal s. Its normal part leaves the intrinsic roughness σ_r out,
//! which the evaluator adds. The finest level has no lobes: its lobes follow from the normals at run time.

pub(crate) mod check;

use crate::binding::{BUFFER_GRANULARITY, Binding};
use crate::container::{FourCc, KnownKind};
use crate::synthesis::{self, SynthesisUniform};
use crate::wrap::Wrap;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of one map's lobes: [`LobesParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"LOPP");
/// Lobes of all levels: buffer of [`PackedLobe`] (stride 16) or [`HalfLobe`] (stride 32), `lobes_per_cell` a cell, by
/// level, then row of cells, then column. A lobe of weight 0 is none.
pub const LOBES: FourCc = FourCc(*b"LOBE");
/// What shaders read of the parameters: buffer of one [`LobesUniform`] (stride 880).
pub const UNIFORM: FourCc = FourCc(*b"LOUB");
/// The map's projected normals (n_x, n_y): buffer of pairs of u32 (stride 8), one a texel, row by row. The first word is the
/// texel's normal as [`NormalsStorage`] says, the second that of the texel below it as the map is wrapped. A pair of zeros
/// follows where the number of texels is odd, so that the buffer is a multiple of 16 bytes.
pub const NORMALS: FourCc = FourCc(*b"LONM");

/// What a program of lobes, or of the surface synthesised from their map, binds: binding k is row k.
///
/// One uniform buffer serves lobes and synthesis. A scene's and a material's are before it, and Mesa 22.3's software adapter
/// crashes on branches on the fourth of a program, which one of the synthesis alone would be.
pub const BINDINGS: &[Binding] = &[
    Binding::Uniform(UNIFORM),
    Binding::Storage(LOBES),
    Binding::Storage(NORMALS),
    Binding::Storage(synthesis::OFFSETS),
    Binding::Storage(synthesis::SEAMS),
];

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "lobe parameters"),
    KnownKind::first(UNIFORM, "lobe uniform"),
    KnownKind::first(LOBES, "lobes"),
    KnownKind::first(NORMALS, "lobe normals"),
];
/// Largest width or height of a map.
pub const MAX_TEXTURE_SIZE: u32 = 16_384;
/// Most levels: cells of 4 texels doubled to the largest map, and the whole of a surface.
pub const MAX_LEVELS: usize = 16;
/// Most lobes a cell.
pub const MAX_LOBES_PER_CELL: u32 = 256;
/// Most columns and rows of cells of the last level, whose lobes together stand for the whole.
pub const MAX_LAST_CELLS: u32 = 4;
/// Share of a map beyond the rim of the disk of normals that may be left out of a picture: less than a step of 8 bits on the map's
/// average, more where its few steep normals are. See [`LobesParams::rim_roughness`].
pub const BEYOND_RIM: f32 = 1e-4;
/// Stored correlations are at most this, so that every covariance is positive definite.
pub const MAX_CORRELATION: f32 = 0.998;
/// Standard deviations are stored by their logarithm over this ratio of largest to smallest, at most.
pub const MAX_SIGMA_RATIO: f32 = 65_536.0;

/// How lobes are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LobeStorage {
    /// [`PackedLobe`], 16 bytes.
    Packed,
    /// [`HalfLobe`], 32 bytes.
    Half,
}

impl LobeStorage {
    /// Bytes of a lobe.
    pub fn stride(self) -> u32 {
        match self {
            LobeStorage::Packed => size_of::<PackedLobe>() as u32,
            LobeStorage::Half => size_of::<HalfLobe>() as u32,
        }
    }
}

/// How a normal is stored in a word of [`NORMALS`], x in the lower half.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NormalsStorage {
    /// Two i16: n = c / 32767.
    Snorm16,
    /// Two u16 of 0 to 255: n = 2 c / 255 − 1.
    Unorm8,
}

/// How the map is filtered between texel centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Filter {
    /// Bilinear.
    Linear,
    /// The nearest texel's normal: no Jacobian.
    Nearest,
}

/// How lobes of a cell were reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Merge {
    /// k-means with averaged parameters, the plain reading of the paper.
    KMeans,
    /// k-means, then clusters become lobes of the same mean and covariance.
    Moments,
    /// Runnalls' greedy merging, lobes of the same mean and covariance.
    Runnalls,
}

/// One level: a grid of square cells that covers the map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LobeLevel {
    /// Edge of a cell in texels; cells at the right and lower edge may be cut.
    pub cell_texels: u32,
    /// Columns of cells, see [`LobesParams::grid`].
    pub cells_x: u32,
    /// Rows of cells.
    pub cells_y: u32,
    /// Index of the level's first lobe.
    pub first_lobe: u32,
    /// Weight, in texels, that a stored 1.0 stands for.
    pub weight_scale: f32,
    /// Smallest and largest standard deviation of positions, in texels ([`LobeStorage::Packed`]).
    pub position_sigma: [f32; 2],
    /// Smallest and largest standard deviation of the normals' residual; below the smallest it is 0.
    pub residual_sigma: [f32; 2],
    /// |∂s/∂u| per texel that a stored 1.0 stands for.
    pub jacobian_scale: f32,
}

/// Error E₁ of footprints of one size, as the bake measured it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FootprintError {
    /// Standard deviation of the footprints in texels.
    pub sigma_texels: f32,
    /// Mean E₁.
    pub mean: f32,
    /// Worst E₁.
    pub worst: f32,
}

/// Parameters of one map's lobes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LobesParams {
    /// Width of the map in texels.
    pub width: u32,
    /// Height of the map in texels.
    pub height: u32,
    /// What lies beyond the map's edge. The surface repeats the map as a whole either way; this says what filtering sees.
    pub wrap: Wrap,
    /// How the map is filtered.
    pub filter: Filter,
    /// Intrinsic roughness σ_r that lobes were merged for. A default: nothing stored contains it.
    pub intrinsic_roughness: f32,
    /// How lobes are stored.
    pub storage: LobeStorage,
    /// How normals are stored.
    pub normals: NormalsStorage,
    /// How lobes were reduced.
    pub merge: Merge,
    /// Lobes a texel that the reduction began with: 1 or 4.
    pub seeds: u32,
    /// Lobes a cell.
    pub lobes_per_cell: u32,
    /// 0: a map's own lobes; cells of a level lie side by side. Else the map is the sample of a surface of patches (section
    /// [`crate::synthesis::PARAMS`] of the same name): cells larger than this begin at all its multiples, so that whole
    /// blocks of patches are cells; the last level is the whole surface, every place alike, its lobes dealt out to a few cells.
    pub step_texels: u32,
    /// Smallest projected normal of a lobe: what a stored 0 stands for.
    pub normal_low: [f32; 2],
    /// Range of projected normals of lobes.
    pub normal_extent: [f32; 2],
    /// Up to [`MAX_LEVELS`] levels, cells of doubling edge; the last has at most [`MAX_LAST_CELLS`] columns and rows.
    pub levels: Vec<LobeLevel>,
    /// Intrinsic roughness up to which renderers may leave out what Gaussians have beyond the rim of the disk of normals: at most
    /// [`BEYOND_RIM`] of the map. 0 where the map's steep normals never allow it.
    pub rim_roughness: f32,
    /// Roughness that the error was measured at: the intrinsic one, or larger where normals range too far to resolve it.
    pub measured_roughness: f32,
    /// Error as the bake measured it, a row a footprint size.
    pub measured: Vec<FootprintError>,
}

impl LobesParams {
    /// Pairs in [`NORMALS`].
    pub fn pair_count(&self) -> u64 {
        let texels = u64::from(self.width) * u64::from(self.height);
        texels.next_multiple_of((BUFFER_GRANULARITY / size_of::<[u32; 2]>()) as u64)
    }

    /// Row of texels whose normals are the second words of row `row`: the next one, and after the last the first of a repeated
    /// map or the last of a clamped one.
    pub fn row_below(&self, row: u32) -> u32 {
        match self.wrap {
            _ if row + 1 < self.height => row + 1,
            Wrap::Repeat => 0,
            Wrap::Clamp => row,
        }
    }

    /// What a stored position of 1 is, in texels from the cell's corner: the cell's edge, cut to the map.
    pub fn extent(&self, level: &LobeLevel) -> [f32; 2] {
        [self.width, self.height].map(|side| level.cell_texels.min(side) as f32)
    }

    /// What [`UNIFORM`] holds of a level.
    pub fn level_uniform(&self, level: &LobeLevel) -> LevelUniform {
        let log_ratio = |[low, high]: [f32; 2]| libm::log2f(high / low);
        LevelUniform {
            cell_texels: level.cell_texels,
            cells_x: level.cells_x,
            cells_y: level.cells_y,
            first_lobe: level.first_lobe,
            weight_scale: level.weight_scale,
            jacobian_scale: level.jacobian_scale,
            position_sigma: level.position_sigma[0],
            position_log_ratio: log_ratio(level.position_sigma),
            residual_sigma: level.residual_sigma[0],
            residual_log_ratio: log_ratio(level.residual_sigma),
            extent: self.extent(level),
        }
    }

    /// What [`UNIFORM`] holds of these parameters, of which the first [`MAX_LEVELS`] levels, and of the synthesis that the map
    /// is the sample of; zeros if there is none.
    pub fn uniform(&self, synthesis: SynthesisUniform) -> LobesUniform {
        let mut levels = [LevelUniform::default(); MAX_LEVELS];
        for (slot, level) in levels.iter_mut().zip(&self.levels) {
            *slot = self.level_uniform(level);
        }
        let map = MapUniform {
            width: self.width,
            height: self.height,
            wrap: u32::from(self.wrap == Wrap::Clamp),
            nearest: u32::from(self.filter == Filter::Nearest),
            normals: u32::from(self.normals == NormalsStorage::Unorm8),
            lobes_per_cell: self.lobes_per_cell,
            step_texels: self.step_texels,
            levels: self.levels.len() as u32,
            normal_low: self.normal_low,
            normal_extent: self.normal_extent,
        };
        LobesUniform { map, synthesis, levels }
    }

    /// Texels from one cell of `cell_texels` to the next.
    pub fn step(&self, cell_texels: u32) -> u32 {
        if self.step_texels == 0 { cell_texels } else { cell_texels.min(self.step_texels) }
    }

    /// Columns and rows of cells of `cell_texels`, of levels over the map. Side by side: those that cover it. In steps: all
    /// that lie in a clamped map, which must hold one; those of a repeated one go on across its edge.
    pub fn grid(&self, cell_texels: u32) -> (u32, u32) {
        // A cell of no texels, which no sound pack has, counts as one.
        let cell_texels = cell_texels.max(1);
        let step = self.step(cell_texels);
        let count = |side: u32| match self.wrap {
            _ if self.step_texels == 0 => side.div_ceil(cell_texels),
            Wrap::Repeat => side / step,
            Wrap::Clamp => side.checked_sub(cell_texels).map_or(0, |rest| rest / step + 1),
        };
        (count(self.width), count(self.height))
    }
}

/// A lobe in 16 bytes. Bytes and words are little-endian; `level` is the lobe's [`LobeLevel`].
///
/// log σ codes c stand for low · (high / low)^(c / 255), or ^((c − 1) / 254) where code 0 stands for 0; correlation codes
/// for c / 127 · [`MAX_CORRELATION`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct PackedLobe {
    /// Jacobian ∂s/∂u, (∂s_x/∂u, ∂s_y/∂u, ∂s_x/∂v, ∂s_y/∂v): scale · q |q|, q = c / 127.
    pub jacobian: [i8; 4],
    /// s_x (bits 0–11), s_y (12–23), both unorm over the range of normals, and weight (24–31): scale · (c / 255)².
    pub normal_weight: u32,
    /// Mean position, unorm over the cell's nominal edge.
    pub position: [u8; 2],
    /// Correlations of position and of the residual.
    pub correlation: [i8; 2],
    /// log σ codes of position.
    pub position_sigma: [u8; 2],
    /// log σ codes of the residual; 0 is 0.
    pub residual_sigma: [u8; 2],
}

/// A lobe in 32 bytes: half floats (as their bits) and integers.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct HalfLobe {
    /// Jacobian ∂s/∂u, as in [`PackedLobe`]; half floats.
    pub jacobian: [u16; 4],
    /// Mean normal, unorm16 over the range of normals.
    pub normal: [u16; 2],
    /// Mean position, unorm16 over the cell's nominal edge.
    pub position: [u16; 2],
    /// Standard deviations of position in texels; half floats.
    pub position_sigma: [u16; 2],
    /// Standard deviations of the residual; half floats.
    pub residual_sigma: [u16; 2],
    /// Correlations of position and of the residual: c / 32767 · [`MAX_CORRELATION`].
    pub correlation: [i16; 2],
    /// Weight: half float, times the level's scale.
    pub weight: u16,
    /// Zero.
    pub reserved: u16,
}

/// What [`UNIFORM`] holds of the map: `GlintLobesMap` of the shaders.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct MapUniform {
    /// Width of the map in texels.
    pub width: u32,
    /// Height of the map in texels.
    pub height: u32,
    /// What filtering sees beyond the map's edge: 0 the other side, 1 the edge.
    pub wrap: u32,
    /// 1: the nearest texel's normal; 0: bilinear.
    pub nearest: u32,
    /// How [`NORMALS`] are stored: 0 [`NormalsStorage::Snorm16`], 1 [`NormalsStorage::Unorm8`].
    pub normals: u32,
    /// Lobes a cell.
    pub lobes_per_cell: u32,
    /// [`LobesParams::step_texels`].
    pub step_texels: u32,
    /// Number of levels.
    pub levels: u32,
    /// Smallest projected normal of a lobe.
    pub normal_low: [f32; 2],
    /// Range of projected normals of lobes.
    pub normal_extent: [f32; 2],
}

/// What [`UNIFORM`] holds of a level: `GlintLobesLevel` of the shaders.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct LevelUniform {
    /// Edge of a cell in texels.
    pub cell_texels: u32,
    /// Columns of cells.
    pub cells_x: u32,
    /// Rows of cells.
    pub cells_y: u32,
    /// Index of the level's first lobe.
    pub first_lobe: u32,
    /// Weight, in texels, that a stored 1.0 stands for.
    pub weight_scale: f32,
    /// |∂s/∂u| per texel that a stored 1.0 stands for.
    pub jacobian_scale: f32,
    /// Smallest standard deviation of positions, in texels.
    pub position_sigma: f32,
    /// log₂ of the largest over the smallest standard deviation of positions.
    pub position_log_ratio: f32,
    /// Smallest standard deviation of the normals' residual.
    pub residual_sigma: f32,
    /// log₂ of the largest over the smallest standard deviation of the normals' residual.
    pub residual_log_ratio: f32,
    /// What a stored position of 1 is, in texels from the cell's corner.
    pub extent: [f32; 2],
}

/// What [`UNIFORM`] holds: `GlintLobesUniform` of the shaders.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct LobesUniform {
    /// The map.
    pub map: MapUniform,
    /// The synthesis of the surface that the map is the sample of; zeros if there is none.
    pub synthesis: SynthesisUniform,
    /// The levels, the finest first; zeros after the last.
    pub levels: [LevelUniform; MAX_LEVELS],
}
