//! Typed sections of the tiny-example method: multi-scale NDF maps, the example's normals, and where examples lie.
//!
//! One material is one group of sections that share a name. `PARAMS`, `TILES`, `DENSITY` and `NORMALS` are
//! always there; `PLACEMENT`, `PALETTE`, `NOISE` and `CLASSES` say how a surface is covered with examples.
//! Method: Xing et al. 2024, sections 5 and 6; what we store differs from the paper as `docs/methods/ndf-maps.md` says.

pub(crate) mod check;

use crate::container::{FourCc, KnownKind};
use crate::wrap::Wrap;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Parameters of one example's NDF maps: [`NdfMapsParams`], bincode.
pub const PARAMS: FourCc = FourCc(*b"NMPP");
/// Tile records: buffer of [`TileRecord`], stride 32, ordered by level, then row, then column.
pub const TILES: FourCc = FourCc(*b"NMTI");
/// Density texels of all tiles, row-major, tile after tile; stride by [`DensityStorage`].
pub const DENSITY: FourCc = FourCc(*b"NMDE");
/// The example's projected normals (n_x, n_y): texture R16G16_SNORM, width × height texels.
pub const NORMALS: FourCc = FourCc(*b"NMNO");
/// Parameters of a placement: [`PlacementParams`], bincode.
pub const PLACEMENT: FourCc = FourCc(*b"PLPP");
/// Transforms that placed examples may use: buffer of [`TransformRecord`], stride 32.
pub const PALETTE: FourCc = FourCc(*b"PLPL");
/// Noise map of a stochastic placement: texture R32G32B32A32_UINT, one texel a cell, see [`NoiseTexel`].
pub const NOISE: FourCc = FourCc(*b"PLNO");
/// Share of each palette entry in each block of cells: texture R8G8B8A8_UNORM, layers = palette / 4, full mip chain.
pub const CLASSES: FourCc = FourCc(*b"PLCL");
/// Two-layer material: [`LayeredMaterial`], bincode.
pub const LAYERS: FourCc = FourCc(*b"LAYR");

/// The kinds of sections of this method.
pub(crate) const KINDS: &[KnownKind] = &[
    KnownKind::first(PARAMS, "NDF map parameters"),
    KnownKind::first(TILES, "NDF map tiles"),
    KnownKind::first(DENSITY, "NDF map density"),
    KnownKind::first(NORMALS, "example normals"),
    KnownKind::first(PLACEMENT, "placement parameters"),
    KnownKind::first(PALETTE, "placement palette"),
    KnownKind::first(NOISE, "placement noise map"),
    KnownKind::first(CLASSES, "placement class map"),
    KnownKind::first(LAYERS, "layered material"),
];

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

/// One tile: where its box lies in the projected-normal disk and where its texels are.
///
/// The density at s is scale · Σ v(i, j) · B(p_x − i) · B(p_y − j) with p = (s − origin) · inv_spacing. B is the quadratic
/// B-spline (¾ − t² for |t| ≤ ½, ½ (3/2 − |t|)² for |t| ≤ 3/2, else 0), so nine texels reach a point; for
/// [`DensityStorage::PaperF32`] it is the tent 1 − |t| of bilinear filtering. Densities below 0 do not occur; texels outside 0 ≤ i < width, 0 ≤ j < height are zero. Texel v(i, j) is element texel_offset + j · width + i.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TileRecord {
    /// Projected normal at texel (0, 0).
    pub origin: [f32; 2],
    /// 1 / distance of neighbouring texels along s_x and s_y.
    pub inv_spacing: [f32; 2],
    /// Density that a stored 1.0 stands for.
    pub scale: f32,
    /// First texel, in texels from the start of the density section.
    pub texel_offset: u32,
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
        /// Rows of cells, a power of two.
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
    /// Entries of the palette.
    pub palette_len: u32,
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

/// One cell of the noise map.
///
/// The cell is divided in four sub-regions of equal size; each shows the example, of the 3 × 3 cells around, whose
/// centre lies nearest to the sub-region's centre (Xing et al. 2024, section 6.3).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct NoiseTexel {
    /// Centre in the cell, unorm16 of the cell's edge: x | y << 16.
    pub centre: u32,
    /// Point of the example that lies at the centre, unorm16 of the example's width and height: x | y << 16.
    pub offset: u32,
    /// Palette index (bits 0–7) and, from bit 16, four owners of 4 bits: neighbour (dy + 1) · 3 + dx + 1 that the
    /// sub-region shows, sub-regions ordered (0,0), (1,0), (0,1), (1,1).
    pub class_and_owners: u32,
    /// Zero.
    pub reserved: u32,
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
