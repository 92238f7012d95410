//! Sections of the tiny-example method: multi-scale NDF maps, the example's normals, and where examples lie.
//!
//! One material is one group of sections that share a name. Two parameter sections, [`PARAMS`] and [`PLACEMENT`], say what it is;
//! the others are what shaders bind, byte for byte: [`BINDINGS`]. Method: Xing et al. 2024, sections 5 and 6; what is stored differs
//! from the paper as `docs/methods/ndf-maps.md` says.

pub(crate) mod check;

use crate::binding::{Binding, TABLE_WIDTH, View};
use crate::container::{FourCc, KnownKind, Resource, full_mip_count};
use crate::vk_format;
use crate::wrap::Wrap;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of one example's NDF maps: [`NdfMapsParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"NMPP");
/// Uniform bytes: buffer of one element of [`UNIFORM_BYTES`], a [`MaterialUniform`] and [`RECORDS`] records of four u32. Records are
/// the levels, the palette, the reach mask, and the tiles where they fit ([`few_tiles`]); the rest is zero.
pub const UNIFORM: FourCc = FourCc(*b"NMUB");
/// Tiles that do not fit among the records: table of R32G32B32A32_UINT, two elements a [`TileRecord`].
pub const TILES: FourCc = FourCc(*b"NMTI");
/// Density of all tiles, tile after tile: table of R32G32B32A32_UINT, a block an element, or of R32_UINT, whose words are texels of
/// [`DensityStorage::texel_bytes`] one after the other.
pub const DENSITY: FourCc = FourCc(*b"NMDE");
/// The example's projected normals: texture R32_UINT, width × height texels, n_x in the low and n_y in the high half, snorm16.
pub const NORMALS: FourCc = FourCc(*b"NMNO");
/// Parameters of a placement: [`PlacementParams`], bincode.
pub const PLACEMENT: FourCc = FourCc(*b"PLPP");
/// Owners of a stochastic placement: texture R32G32B32A32_UINT, one texel a sub-region, see [`NoiseTexel`].
pub const NOISE: FourCc = FourCc(*b"PLNO");
/// Share of each palette entry in each block of cells: texture R8G8B8A8_UNORM, layers = palette / 4, full mip chain.
pub const CLASSES: FourCc = FourCc(*b"PLCL");
/// Two-layer material: [`LayeredMaterial`], bincode.
pub const LAYERS: FourCc = FourCc(*b"LAYR");
/// What shaders bind of a two-layer material: buffer of one [`LayersUniform`].
pub const LAYERS_UNIFORM: FourCc = FourCc(*b"LAUB");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "NDF map parameters"),
    KnownKind::first(UNIFORM, "NDF map uniform"),
    KnownKind::first(TILES, "NDF map tiles"),
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
    Binding::Texture(TILES, View::Uint2d),
    Binding::Texture(DENSITY, View::Uint2d),
    Binding::Texture(NORMALS, View::Uint2d),
    Binding::Texture(NOISE, View::Uint2d),
    Binding::Texture(CLASSES, View::Float2dArray),
];

/// How the coat of a two-layer material is bound, after the base; zeros where there is no coat. Its uniform bytes are a storage
/// buffer, so that zeros may be shorter.
pub const COAT_BINDINGS: &[Binding] = &[
    Binding::Storage(UNIFORM),
    Binding::Texture(TILES, View::Uint2d),
    Binding::Texture(DENSITY, View::Uint2d),
    Binding::Texture(NORMALS, View::Uint2d),
    Binding::Texture(NOISE, View::Uint2d),
    Binding::Texture(CLASSES, View::Float2dArray),
];

/// What is bound last: how the layers lie on each other; zeros where there is one.
pub const LAYERS_BINDINGS: &[Binding] = &[Binding::Storage(LAYERS_UNIFORM)];

/// Bytes of section [`UNIFORM`]: the most that every GPU binds as a uniform.
pub const UNIFORM_BYTES: usize = 65536;
/// Records of four u32 that follow the [`MaterialUniform`].
pub const RECORDS: usize = (UNIFORM_BYTES - size_of::<MaterialUniform>()) / 16;
/// Rows of the reach mask, and bits of each: cells of [−1, 1]² of projected normals.
pub const REACH_CELLS: usize = 128;
/// Blocks of a material at most, 32 MiB; the density of larger ones is words.
pub const MAX_BLOCKS: u64 = 1 << 21;
/// Texels along an edge of an example at most, as of any texture.
pub const MAX_EDGE: u32 = 8192;
/// Entries of a palette at most: the run time keeps a share of each.
pub const MAX_PALETTE: u32 = 32;

/// What shaders know of a material, the first bytes of section [`UNIFORM`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct MaterialUniform {
    /// Width and height of the example in texels.
    pub size: [u32; 2],
    /// What lies beyond the example's edge: 0 repeat, 1 clamp.
    pub wrap: u32,
    /// [`DensityStorage`]: 0 `SqrtU8`, 1 `F16`, 2 `PaperF32`.
    pub storage: u32,
    /// Intrinsic roughness σ_r.
    pub intrinsic_roughness: f32,
    /// Levels; their records come first: tile_texels, tiles_x, tiles_y, first_tile.
    pub levels: u32,
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
    /// First record of the tiles, two each: see [`TileRecord`]; 0 where they have a table.
    pub tile_records: u32,
    /// 1 where [`DENSITY`] holds blocks, 0 where it holds words.
    pub blocks: u32,
    /// 1 where the tiles are among the records, 0 where they have a table.
    pub few_tiles: u32,
    /// Example texels a surface texel, by area, under the transform of the palette that has most.
    pub most_texels: f32,
    /// 0; a program of two materials keeps here which of them this is.
    pub layer: u32,
}

impl MaterialUniform {
    /// That of a material whose density is in blocks or not, and whose palette has `most_texels` at most. Counts are not checked.
    pub fn new(maps: &NdfMapsParams, placement: &PlacementParams, blocks: bool, most_texels: f32) -> MaterialUniform {
        let (cells, cell_texels) = match placement.kind {
            PlacementKind::Tiled => (0, 0.0),
            PlacementKind::Stochastic { cells_x, cell_texels, .. } => (cells_x, cell_texels),
        };
        let levels = maps.levels.len() as u32;
        let reach_records = levels + 2 * placement.palette_len;
        let few_tiles = few_tiles(maps, placement);
        MaterialUniform {
            size: [maps.width, maps.height],
            wrap: match maps.wrap {
                Wrap::Repeat => 0,
                Wrap::Clamp => 1,
            },
            storage: match maps.storage {
                DensityStorage::SqrtU8 => 0,
                DensityStorage::F16 => 1,
                DensityStorage::PaperF32 => 2,
            },
            intrinsic_roughness: maps.intrinsic_roughness,
            levels,
            palette: placement.palette_len,
            cells,
            cell_texels,
            palette_records: levels,
            reach_records,
            tile_records: if few_tiles { reach_records + REACH_CELLS as u32 } else { 0 },
            blocks: u32::from(blocks),
            few_tiles: u32::from(few_tiles),
            most_texels,
            layer: 0,
        }
    }
}

/// Whether the tiles of a material fit among the records of its [`UNIFORM`].
pub fn few_tiles(maps: &NdfMapsParams, placement: &PlacementParams) -> bool {
    let before = maps.levels.len() as u64 + 2 * u64::from(placement.palette_len) + REACH_CELLS as u64;
    before + 2 * maps.tile_count() <= RECORDS as u64
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

/// How density texels are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DensityStorage {
    /// 8 bits of √(density / scale), decoded as scale · (q / 255)². One box a tile.
    SqrtU8,
    /// Half floats of density / scale. One box a tile.
    F16,
    /// The paper's layout: 128 × 128 floats a tile over [−1, 1]², scale 1.
    PaperF32,
}

impl DensityStorage {
    /// Bytes of one density texel.
    pub fn texel_bytes(self) -> u32 {
        match self {
            DensityStorage::SqrtU8 => 1,
            DensityStorage::F16 => 2,
            DensityStorage::PaperF32 => 4,
        }
    }
}

/// One level of the multi-scale NDF maps: a grid of square tiles that covers the example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Level {
    /// Edge of a tile in example texels (a power of two); tiles at the right and lower edge may be cut.
    pub tile_texels: u32,
    /// Columns of tiles: ⌈width / tile_texels⌉.
    pub tiles_x: u32,
    /// Rows of tiles: ⌈height / tile_texels⌉.
    pub tiles_y: u32,
    /// Index of the level's first tile record.
    pub first_tile: u32,
}

/// Error of decoded tiles against what they stand for, E₁ = ∫|D̂−D| / ∫D over the unit disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// Mean over tiles.
    pub mean: f64,
    /// 95th percentile over tiles.
    pub p95: f64,
    /// Worst tile.
    pub worst: f64,
    /// Largest |∫D̂ − 1| of a tile.
    pub energy: f64,
}

/// Parameters of one example's NDF maps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NdfMapsParams {
    /// Example width in texels.
    pub width: u32,
    /// Example height in texels.
    pub height: u32,
    /// What lies beyond the example's edge.
    pub wrap: Wrap,
    /// Intrinsic roughness σ_r: standard deviation, in the projected-normal disk, of the lobe each normal carries.
    pub intrinsic_roughness: f32,
    /// How density texels are stored.
    pub storage: DensityStorage,
    /// Levels, finest first; the last has one tile. Tiles begin at 2 texels unless finer ones were left out.
    pub levels: Vec<Level>,
    /// E₁ that was asked of tiles on average.
    pub max_error: f32,
    /// Error as the bake measured it.
    pub measured: MeasuredError,
}

impl NdfMapsParams {
    /// Tiles of all levels.
    pub fn tile_count(&self) -> u64 {
        let count = |level: &Level| u64::from(level.tiles_x) * u64::from(level.tiles_y);
        self.levels.iter().fold(0, |sum, level| sum.saturating_add(count(level)))
    }

    /// Descriptor of [`NORMALS`].
    pub fn normals_resource(&self) -> Resource {
        let (width, height) = (self.width, self.height);
        Resource::Texture { vk_format: vk_format::R32_UINT, width, height, layers: 1, faces: 1, mips: 1 }
    }
}

/// One tile: where its box lies in the projected-normal disk and where its texels are.
///
/// The density at s is scale · Σ v(i, j) · B(p_x − i) · B(p_y − j) with p = (s − origin) · inv_spacing. B is the quadratic
/// B-spline (¾ − t² for |t| ≤ ½, ½ (3/2 − |t|)² for |t| ≤ 3/2, else 0), so nine texels reach a point; for
/// [`DensityStorage::PaperF32`] it is the tent 1 − |t| of bilinear filtering. Densities below 0 do not occur; texels outside
/// 0 ≤ i < width, 0 ≤ j < height are zero. In words, texel v(i, j) is texel first + j · width + i. In blocks, the tile has
/// (width + 2) · (height + 2) of them from `first` on, by rows, and block (i, j) holds the three by three texels from (i − 2, j − 2) on:
/// a row in each of its first three components, 8 bits a texel, the lowest first.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TileRecord {
    /// Projected normal at texel (0, 0).
    pub origin: [f32; 2],
    /// 1 / distance of neighbouring texels along s_x and s_y.
    pub inv_spacing: [f32; 2],
    /// Density that a stored 1.0 stands for.
    pub scale: f32,
    /// First texel or block, counted from the start of the density section.
    pub first: u32,
    /// width | height << 16, in texels.
    pub size: u32,
    /// E₁ of this tile as the bake measured it.
    pub error: f32,
}

impl TileRecord {
    /// Texels in a row.
    pub fn width(&self) -> u32 {
        self.size & 0xffff
    }
    /// Rows of texels.
    pub fn height(&self) -> u32 {
        self.size >> 16
    }
    /// Whether the density at `s` may be other than zero: `s` is within the reach of a spline of the tile.
    pub fn holds(&self, s: impl Into<[f32; 2]>) -> bool {
        let s = s.into();
        let inside = |axis: usize, texels: u32| {
            let p = (s[axis] - self.origin[axis]) * self.inv_spacing[axis];
            (-1.5..=texels as f32 + 0.5).contains(&p)
        };
        inside(0, self.width()) && inside(1, self.height())
    }
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

/// Descriptor of [`CLASSES`] of a grid of `cells` × `cells` and a palette of `palette_len`.
pub fn classes_resource(cells: u32, palette_len: u32) -> Resource {
    Resource::Texture {
        vk_format: vk_format::R8G8B8A8_UNORM,
        width: cells,
        height: cells,
        layers: palette_len.div_ceil(4),
        faces: 1,
        mips: full_mip_count(cells, cells),
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
