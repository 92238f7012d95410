//! Sections of the tiny-example method: NDF maps prefiltered by windows, the example's normals, and where examples lie.
//!
//! One material is one group of sections that share a name. Two parameter sections, [`PARAMS`] and [`PLACEMENT`], say what it is;
//! the others are what shaders bind, byte for byte: [`BINDINGS`]. Method: Xing et al. 2024, sections 5 and 6; what is stored differs
//! from the paper as `docs/methods/ndf-maps.md` says.

pub(crate) mod check;

use crate::binding::{Binding, TABLE_WIDTH, View};
use crate::container::{FourCc, KnownKind, Resource, full_mip_count};
use crate::vk_format;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of one example's NDF maps: [`NdfMapsParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"NMPP");
/// Uniform bytes: buffer of one element of [`UNIFORM_BYTES`], a [`MaterialUniform`] and [`RECORDS`] records of four u32. Records are
/// the levels, the palette and the reach mask; the rest is zero.
pub const UNIFORM: FourCc = FourCc(*b"NMUB");
/// Nodes of all levels, level after level, row by row: table of R32G32B32A32_UINT, an element a [`NodeRecord`]; after them, from element
/// [`MaterialUniform::moments`] on, their [`MomentsRecord`]s, two an element.
pub const NODES: FourCc = FourCc(*b"NMND");
/// Atlas of the nodes' tables: texture R8_UNORM, a texel the square root of a density over that of its node's [`NodeRecord::scale`].
/// Texels that belong to no table are zero, one at least around each.
pub const DENSITY: FourCc = FourCc(*b"NMDE");
/// The example's projected normals in patches between texel centres: texture R32G32B32A32_UINT, width × height texels. Texel (i, j) has
/// the normals of the example's texels (i − 1, j − 1), (i, j − 1), (i − 1, j), (i, j), those before the first being the last: n_x in the
/// low and n_y in the high half of a number, snorm16.
pub const NORMALS: FourCc = FourCc(*b"NMNO");
/// Parameters of a placement: [`PlacementParams`], bincode.
pub const PLACEMENT: FourCc = FourCc(*b"PLPP");
/// Owners of a stochastic placement: texture R32G32B32A32_UINT, one texel a sub-region, see [`NoiseTexel`].
pub const NOISE: FourCc = FourCc(*b"PLNO");
/// Shares of the palette's entries under Gaussian windows around sub-regions: texture R32G32B32A32_UINT, a byte an entry, full mip chain.
pub const CLASSES: FourCc = FourCc(*b"PLCL");
/// Two-layer material: [`LayeredMaterial`], bincode.
pub const LAYERS: FourCc = FourCc(*b"LAYR");
/// What shaders bind of a two-layer material: buffer of one [`LayersUniform`].
pub const LAYERS_UNIFORM: FourCc = FourCc(*b"LAUB");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "NDF map parameters"),
    KnownKind::first(UNIFORM, "NDF map uniform"),
    KnownKind::first(NODES, "NDF map nodes"),
    KnownKind::first(DENSITY, "NDF map density"),
    KnownKind::first(NORMALS, "example normals"),
    KnownKind::first(PLACEMENT, "placement parameters"),
    KnownKind::first(NOISE, "placement noise map"),
    KnownKind::first(CLASSES, "placement class map"),
    KnownKind::first(LAYERS, "layered material"),
    KnownKind::first(LAYERS_UNIFORM, "layered material uniform"),
];

/// How a material is bound: of a two-layer material the base, of any other the whole.
pub const BINDINGS: &[Binding] = &[
    Binding::Uniform(UNIFORM),
    Binding::Texture(NODES, View::Uint2d),
    Binding::Texture(DENSITY, View::Float2d),
    Binding::Texture(NORMALS, View::Uint2d),
    Binding::Texture(NOISE, View::Uint2d),
    Binding::Texture(CLASSES, View::Uint2d),
];

/// How the coat of a two-layer material is bound, after the base; zeros where there is no coat. Its uniform bytes are a storage
/// buffer, so that zeros may be shorter.
pub const COAT_BINDINGS: &[Binding] = &[
    Binding::Storage(UNIFORM),
    Binding::Texture(NODES, View::Uint2d),
    Binding::Texture(DENSITY, View::Float2d),
    Binding::Texture(NORMALS, View::Uint2d),
    Binding::Texture(NOISE, View::Uint2d),
    Binding::Texture(CLASSES, View::Uint2d),
];

/// What is bound last: how the layers lie on each other, zeros where there is one, and the sampler of both atlases.
pub const LAYERS_BINDINGS: &[Binding] = &[Binding::Storage(LAYERS_UNIFORM), Binding::ClampSampler];

/// Bytes of section [`UNIFORM`].
pub const UNIFORM_BYTES: usize = 4160;
/// Records of four u32 that follow the [`MaterialUniform`].
pub const RECORDS: usize = (UNIFORM_BYTES - size_of::<MaterialUniform>()) / 16;
/// Rows of the reach mask, and bits of each: cells of [−1, 1]² of projected normals.
pub const REACH_CELLS: usize = 128;
/// Steps of origins and spacings of the tables in σ_r: a third.
pub const STEPS_PER_ROUGHNESS: f32 = 3.0;
/// Levels of a material at most.
pub const MAX_LEVELS: usize = 64;
/// Texels along an edge of an example at most, as of any texture.
pub const MAX_EDGE: u32 = 8192;
/// Entries of a palette at most: the run time keeps a share of each.
pub const MAX_PALETTE: u32 = 16;

/// What shaders know of a material, the first bytes of section [`UNIFORM`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct MaterialUniform {
    /// Width and height of the example in texels.
    pub size: [u32; 2],
    /// First element of the nodes' moments in the table of nodes: the number of nodes.
    pub moments: u32,
    /// Levels; their records come first: nodes_x, nodes_y, first_node, 0.
    pub levels: u32,
    /// Intrinsic roughness σ_r.
    pub intrinsic_roughness: f32,
    /// Steps a unit of the disk, [`STEPS_PER_ROUGHNESS`] / σ_r.
    pub steps: f32,
    /// Variance of the finest level's windows in texels²; each level has twice that of the one before.
    pub finest_variance: f32,
    /// Entries of the palette.
    pub palette: u32,
    /// Cells of a stochastic placement along an axis, a power of two; 0 for tiled examples.
    pub cells: u32,
    /// Edge of a cell in surface texels; 0 for tiled examples.
    pub cell_texels: f32,
    /// First record of the palette, two an entry: see [`TransformRecord`].
    pub palette_records: u32,
    /// First record of the reach mask, one a row of [`REACH_CELLS`] bits, the lowest first.
    pub reach_records: u32,
    /// 1 / width and 1 / height of the atlas.
    pub inv_atlas: [f32; 2],
    /// 0; a program of two materials keeps here which of them this is.
    pub layer: u32,
    /// Example texels a surface texel, by area, under the transform of the palette that has most.
    pub most_texels: f32,
}

impl MaterialUniform {
    /// That of a material whose atlas has `atlas` texels, and whose palette has `most_texels` at most. Counts are not checked.
    pub fn new(
        maps: &NdfMapsParams,
        placement: &PlacementParams,
        atlas: [u32; 2],
        most_texels: f32,
    ) -> MaterialUniform {
        let (cells, cell_texels) = match placement.kind {
            PlacementKind::Tiled => (0, 0.0),
            PlacementKind::Stochastic { cells_x, cell_texels, .. } => (cells_x, cell_texels),
        };
        let levels = maps.levels.len() as u32;
        MaterialUniform {
            size: [maps.width, maps.height],
            moments: maps.node_count() as u32,
            levels,
            intrinsic_roughness: maps.intrinsic_roughness,
            steps: STEPS_PER_ROUGHNESS / maps.intrinsic_roughness,
            finest_variance: maps.finest_variance,
            palette: placement.palette_len,
            cells,
            cell_texels,
            palette_records: levels,
            reach_records: levels + 2 * placement.palette_len,
            inv_atlas: atlas.map(|edge| 1.0 / edge as f32),
            layer: 0,
            most_texels,
        }
    }
}

/// Descriptor of a table of `elements`.
pub fn table(vk_format: u32, elements: u64) -> Resource {
    let height = elements.div_ceil(u64::from(TABLE_WIDTH)).max(1) as u32;
    Resource::Texture { vk_format, width: TABLE_WIDTH, height, layers: 1, faces: 1, mips: 1 }
}

/// What shaders know of a two-layer material.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct LayersUniform {
    /// Reflectance of the coat at normal incidence.
    pub coat_f0: f32,
    /// Layers: 2.
    pub count: u32,
    /// Zero.
    pub unused: [u32; 2],
}

impl LayersUniform {
    /// That of a two-layer material.
    pub fn of(layers: &LayeredMaterial) -> LayersUniform {
        LayersUniform { coat_f0: layers.coat_f0, count: 2, unused: [0; 2] }
    }
}

/// One level of the NDF maps: a grid of nodes that repeats with the example. Node (i, j) lies at ((i + j/2) / nodes_x,
/// j / nodes_y) of the example's width and height, at (i / nodes_x, 0) where there is one row, and holds the NDF under a Gaussian window
/// around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Level {
    /// Columns of nodes.
    pub nodes_x: u32,
    /// Rows of nodes: 1, or an even number, as every second one is shifted by half a column.
    pub nodes_y: u32,
    /// Index of the level's first node.
    pub first_node: u32,
}

impl Level {
    /// Nodes of the level.
    pub fn nodes(&self) -> u64 {
        u64::from(self.nodes_x) * u64::from(self.nodes_y)
    }
}

/// Error of decoded nodes against what they stand for, E₁ = ∫|D̂−D| / ∫D over the unit disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// Mean over the nodes of a level, mean over levels.
    pub mean: f64,
    /// 95th percentile over nodes.
    pub p95: f64,
    /// Worst node.
    pub worst: f64,
    /// Largest |∫D̂ − 1| of a node.
    pub energy: f64,
}

/// Error of a pixel as a shader reads it, E₁ against the exact NDF of round footprints on copies of the example side by side: means over
/// places of one size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PixelError {
    /// Mean over sizes.
    pub mean: f64,
    /// Worst size.
    pub worst: f64,
    /// Standard deviation of the footprints of that size in texels.
    pub worst_sigma_texels: f64,
}

/// Parameters of one example's NDF maps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NdfMapsParams {
    /// Example width in texels.
    pub width: u32,
    /// Example height in texels.
    pub height: u32,
    /// Intrinsic roughness σ_r: standard deviation, in the projected-normal disk, of the lobe each normal carries.
    pub intrinsic_roughness: f32,
    /// Variance of the finest level's windows in texels², with what interpolation between nodes adds; each level has twice that of
    /// the one before.
    pub finest_variance: f32,
    /// Levels, finest first; the last has one node, whose window is the whole example.
    pub levels: Vec<Level>,
    /// E₁ that was asked of nodes on average.
    pub max_error: f32,
    /// Error of nodes as the bake measured it.
    pub measured: MeasuredError,
    /// Error of pixels as the bake measured it.
    pub pixel: PixelError,
    /// E₁ of each node as the bake measured it.
    pub node_errors: Vec<f32>,
}

impl NdfMapsParams {
    /// Nodes of all levels.
    pub fn node_count(&self) -> u64 {
        self.levels.iter().fold(0, |sum, level| sum.saturating_add(level.nodes()))
    }

    /// Elements of the table [`NODES`]: nodes, then their moments.
    pub fn node_elements(&self) -> u64 {
        let count = self.node_count();
        count.saturating_add(count.div_ceil(2))
    }

    /// Descriptor of [`NORMALS`].
    pub fn normals_resource(&self) -> Resource {
        let (width, height) = (self.width, self.height);
        Resource::Texture { vk_format: vk_format::R32G32B32A32_UINT, width, height, layers: 1, faces: 1, mips: 1 }
    }
}

/// One node: where its table lies in the disk of projected normals, and where in the atlas.
///
/// A step is σ_r / [`STEPS_PER_ROUGHNESS`]. Texel (i, j) of the table stands at s = (origin + (i, j) · spacing) steps − 1. With
/// p = ((s + 1) / step − origin) / spacing, the root r(p) is bilinear between texels, those outside the table zero, and the density
/// is scale · r².
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct NodeRecord {
    /// Steps from s = (−1, −1) to texel (0, 0): x | y << 16.
    pub origin: u32,
    /// Texel of the atlas that is texel (0, 0): x | y << 16.
    pub place: u32,
    /// width | height << 8 in texels, spacing_x << 16 | spacing_y << 24 in steps.
    pub shape: u32,
    /// Density where the root is 1.
    pub scale: f32,
}

impl NodeRecord {
    /// Steps from s = (−1, −1) to texel (0, 0).
    pub fn origin(&self) -> [u32; 2] {
        [self.origin & 0xffff, self.origin >> 16]
    }
    /// Texel of the atlas that is texel (0, 0).
    pub fn place(&self) -> [u32; 2] {
        [self.place & 0xffff, self.place >> 16]
    }
    /// Width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        [self.shape & 0xff, self.shape >> 8 & 0xff]
    }
    /// Distance of texels in steps.
    pub fn spacing(&self) -> [u32; 2] {
        [self.shape >> 16 & 0xff, self.shape >> 24]
    }
}

/// Mean and covariance of a node's density over the disk of projected normals: what light from all around sees of it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct MomentsRecord {
    /// Mean, snorm16: x | y << 16.
    pub mean: u32,
    /// Square roots of the standard deviations along x (bits 0–10) and y (bits 11–21), unorm; correlation (bits 22–31), 0 is −1 and 1023
    /// is 1.
    pub spread: u32,
}

impl MomentsRecord {
    /// The record of a mean and the covariance xx, xy, yy. Standard deviations above 1 count as 1.
    pub fn new(mean: [f64; 2], [xx, xy, yy]: [f64; 3]) -> MomentsRecord {
        let snorm = |v: f64| u32::from(((v.clamp(-1.0, 1.0) * 32767.0).round() as i16).cast_unsigned());
        let deviations = [xx, yy].map(|variance| variance.max(0.0).sqrt());
        let [x, y] = deviations.map(|deviation| (deviation.min(1.0).sqrt() * 2047.0).round() as u32);
        let product = deviations[0] * deviations[1];
        let correlation = if product > 0.0 { (xy / product).clamp(-1.0, 1.0) } else { 0.0 };
        let correlation = ((0.5 * correlation + 0.5) * 1023.0).round() as u32;
        MomentsRecord { mean: snorm(mean[0]) | snorm(mean[1]) << 16, spread: x | y << 11 | correlation << 22 }
    }

    /// Mean of projected normals.
    pub fn mean(self) -> [f32; 2] {
        [self.mean & 0xffff, self.mean >> 16].map(|bits| (f32::from((bits as u16).cast_signed()) / 32767.0).max(-1.0))
    }

    /// Covariance xx, xy, yy of projected normals.
    pub fn covariance(self) -> [f32; 3] {
        let deviation = |bits: u32| {
            let root = (bits & 0x7ff) as f32 / 2047.0;
            root * root
        };
        let (x, y) = (deviation(self.spread), deviation(self.spread >> 11));
        let correlation = (self.spread >> 22) as f32 * (2.0 / 1023.0) - 1.0;
        [x * x, correlation * x * y, y * y]
    }
}

/// Descriptor of [`DENSITY`] of an atlas of `size` texels.
pub fn atlas_resource([width, height]: [u32; 2]) -> Resource {
    Resource::Texture { vk_format: vk_format::R8_UNORM, width, height, layers: 1, faces: 1, mips: 1 }
}

/// How a surface is covered with examples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum PlacementKind {
    /// Examples side by side, all under palette entry 0.
    Tiled,
    /// Examples around random centres, one a cell of a grid that repeats.
    Stochastic {
        /// Columns of cells, a power of two.
        cells_x: u32,
        /// Rows of cells, as many as columns.
        cells_y: u32,
        /// Edge of a cell in surface texels.
        cell_texels: f32,
        /// Seed the centres, offsets and palette indices were drawn with.
        seed: u64,
    },
}

/// Parameters of a placement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacementParams {
    /// Tiled or stochastic.
    pub kind: PlacementKind,
    /// Entries of the palette, 1 to [`MAX_PALETTE`].
    pub palette_len: u32,
}

/// Descriptor of [`NOISE`] of a grid of `cells` × `cells`.
pub fn noise_resource(cells: u32) -> Resource {
    let (width, height) = (2 * cells, 2 * cells);
    Resource::Texture { vk_format: vk_format::R32G32B32A32_UINT, width, height, layers: 1, faces: 1, mips: 1 }
}

/// Descriptor of [`CLASSES`] of a grid of `cells` × `cells`: a byte an entry of the palette, [`MAX_PALETTE`] of them.
pub fn classes_resource(cells: u32) -> Resource {
    Resource::Texture {
        vk_format: vk_format::R32G32B32A32_UINT,
        width: 2 * cells,
        height: 2 * cells,
        layers: 1,
        faces: 1,
        mips: full_mip_count(2 * cells, 2 * cells),
    }
}

/// One transform of the palette. Surface texels and example texels are the same size when the first matrix is the
/// identity. Matrices are row-major: (m00, m01, m10, m11).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TransformRecord {
    /// Surface offset from the example's centre, in texels → example offset, in texels.
    pub position_to_local: [f32; 4],
    /// Projected normal on the surface → projected normal in the example; densities are multiplied by |det|.
    pub normal_to_local: [f32; 4],
}

/// One sub-region of a stochastic placement: the example that it shows.
///
/// A cell is divided in four sub-regions of equal size; each shows the example, of the 3 × 3 cells around, whose centre lies nearest
/// to the sub-region's centre (Xing et al. 2024, section 6.3).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct NoiseTexel {
    /// The example's centre in its cell, unorm16 of the cell's edge: x | y << 16.
    pub centre: u32,
    /// Point of the example that lies at the centre, unorm16 of the example's width and height: x | y << 16.
    pub offset: u32,
    /// Palette index (bits 0–7) and, from bit 16, which cell the example belongs to: neighbour (dy + 1) · 3 + dx + 1 of the
    /// sub-region's own.
    pub class_and_neighbour: u32,
    /// Zero.
    pub reserved: u32,
}

impl NoiseTexel {
    /// Palette index of the example.
    pub fn class(self) -> u32 {
        self.class_and_neighbour & 0xff
    }

    /// Which of the 3 × 3 cells around the example belongs to, as steps from the sub-region's own: −1 to 1 along x and y.
    pub fn neighbour(self) -> [i32; 2] {
        let neighbour = (self.class_and_neighbour >> 16) as i32;
        [neighbour % 3 - 1, neighbour / 3 - 1]
    }
}

/// Two-layer material: f = f_base · (1 − F_coat) + f_coat (Xing et al. 2024, Eq. 3).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayeredMaterial {
    /// Name of the material in this pack whose NDF the clear coat has.
    pub coat: String,
    /// Name of the material in this pack whose NDF the base has.
    pub base: String,
    /// Reflectance of the coat at normal incidence.
    pub coat_f0: f32,
    /// Reflectance of the base at normal incidence, linear RGB.
    pub base_f0: [f32; 3],
}
