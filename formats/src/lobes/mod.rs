//! Typed sections of MIP-mapped position-normal lobes: parameters, lobes of every level, and the map's normals.
//!
//! Method: Tan et al. 2022, section 5.1.2; what we store differs from the paper as `docs/methods/lobes.md` says. A lobe is a
//! 4D Gaussian over position u (texels) and projected normal s. Its normal part leaves the intrinsic roughness σ_r out,
//! which the evaluator adds. The finest level has no lobes: its lobes follow from the normals at run time.

pub(crate) mod check;

use crate::container::{FourCc, KnownKind, Resource};
use crate::vk_format;
use crate::wrap::Wrap;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of one map's lobes: [`LobesParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"LOPP");
/// Lobes of all levels: buffer of [`PackedLobe`] (stride 16) or [`HalfLobe`] (stride 32), `lobes_per_cell` a cell, by
/// level, then row of cells, then column. A lobe of weight 0 is none.
pub const LOBES: FourCc = FourCc(*b"LOBE");
/// The map's projected normals (n_x, n_y): texture of the format of [`NormalsStorage`], width × height texels.
pub const NORMALS: FourCc = FourCc(*b"LONM");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "lobe parameters"),
    KnownKind::first(LOBES, "lobes"),
    KnownKind::first(NORMALS, "lobe normals"),
];
/// Largest width or height of a map.
pub const MAX_TEXTURE_SIZE: u32 = 16_384;
/// Most lobes a cell.
pub const MAX_LOBES_PER_CELL: u32 = 256;
/// Most columns and rows of cells of the last level, whose lobes together stand for the whole.
pub const MAX_LAST_CELLS: u32 = 4;
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

/// How the map's normals are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NormalsStorage {
    /// R16G16_SNORM, 4 bytes a texel.
    Snorm16,
    /// R8G8_UNORM, 2 bytes a texel: n = 2 c − 1.
    Unorm8,
}

impl NormalsStorage {
    /// VkFormat of the texture.
    pub fn vk_format(self) -> u32 {
        match self {
            NormalsStorage::Snorm16 => vk_format::R16G16_SNORM,
            NormalsStorage::Unorm8 => vk_format::R8G8_UNORM,
        }
    }

    /// Bytes of a texel.
    pub fn texel_bytes(self) -> usize {
        match self {
            NormalsStorage::Snorm16 => 4,
            NormalsStorage::Unorm8 => 2,
        }
    }
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
    /// Levels, cells of doubling edge; the last has at most [`MAX_LAST_CELLS`] columns and rows.
    pub levels: Vec<LobeLevel>,
    /// Roughness that the error was measured at: the intrinsic one, or larger where normals range too far to resolve it.
    pub measured_roughness: f32,
    /// Error as the bake measured it, a row a footprint size.
    pub measured: Vec<FootprintError>,
}

impl LobesParams {
    /// What [`NORMALS`] is.
    pub fn normals_resource(&self) -> Resource {
        Resource::Texture {
            vk_format: self.normals.vk_format(),
            width: self.width,
            height: self.height,
            layers: 1,
            faces: 1,
            mips: 1,
        }
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
