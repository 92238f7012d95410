//! One material of the tiny-example method, as numbers.

use crate::quantities::{kib, percent};
use glint_bake_core::ndf_maps::eval::Material;
use glint_formats::Wrap;
use glint_formats::ndf_maps::{
    CLASSES, DENSITY, DensityStorage, MeasuredError, NOISE, NORMALS, PALETTE, PARAMS, PLACEMENT, PlacementKind, TILES,
};
use glint_formats::{FourCc, Pack};
use serde::Serialize;

/// Bytes of one tile in the paper's layout: 128 × 128 floats.
pub const PAPER_TILE_BYTES: u64 = 128 * 128 * 4;

/// One material of the tiny-example method.
#[derive(Debug, Serialize)]
pub struct MaterialInfo {
    /// Name in the pack.
    pub name: String,
    /// Example width in texels.
    pub width: u32,
    /// Example height in texels.
    pub height: u32,
    /// `repeat` or `clamp`.
    pub wrap: &'static str,
    /// σ_r.
    pub intrinsic_roughness: f32,
    /// `u8`, `f16` or `paper`.
    pub storage: &'static str,
    /// Levels, finest first.
    pub levels: Vec<LevelInfo>,
    /// Bytes of each part once decompressed.
    pub bytes: PartBytes,
    /// E₁ that was asked of every tile.
    pub max_error: f32,
    /// Error as the bake measured it.
    pub measured: MeasuredError,
    /// How a surface is covered.
    pub placement: PlacementInfo,
}

/// One level.
#[derive(Debug, Serialize)]
pub struct LevelInfo {
    /// Edge of a tile in example texels.
    pub tile_texels: u32,
    /// Columns.
    pub tiles_x: u32,
    /// Rows.
    pub tiles_y: u32,
    /// Density texels of all its tiles.
    pub density_texels: u64,
    /// Mean E₁ of its tiles.
    pub mean_error: f64,
    /// Worst E₁ of its tiles.
    pub worst_error: f64,
}

/// Bytes of each part once decompressed.
#[derive(Debug, Serialize)]
pub struct PartBytes {
    /// Tile records.
    pub tiles: u64,
    /// Density texels.
    pub density: u64,
    /// Example normals.
    pub normals: u64,
    /// Placement: palette, noise map, class map.
    pub placement: u64,
    /// All of the above and the parameters.
    pub total: u64,
    /// What the paper's layout takes for the tiles.
    pub paper: u64,
}

/// How a surface is covered.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[allow(missing_docs)] // The same as in `PlacementKind`.
pub enum PlacementInfo {
    /// Side by side.
    Tiled,
    /// Around random centres.
    Stochastic { cells_x: u32, cells_y: u32, cell_texels: f32, seed: u64, palette: u32 },
}

impl MaterialInfo {
    /// Describes a material of a sound pack.
    pub fn of(name: &str, material: &Material, pack: &Pack) -> MaterialInfo {
        let params = &material.maps.params;
        let raw = |kind: FourCc| pack.find(kind, name).map_or(0, |entry| entry.raw_len);
        let placement = raw(PALETTE) + raw(NOISE) + raw(CLASSES);
        let bytes = PartBytes {
            tiles: raw(TILES),
            density: raw(DENSITY),
            normals: raw(NORMALS),
            placement,
            total: raw(TILES) + raw(DENSITY) + raw(NORMALS) + placement + raw(PARAMS) + raw(PLACEMENT),
            paper: material.maps.tiles.len() as u64 * PAPER_TILE_BYTES,
        };
        MaterialInfo {
            name: name.to_owned(),
            width: params.width,
            height: params.height,
            wrap: match params.wrap {
                Wrap::Repeat => "repeat",
                Wrap::Clamp => "clamp",
            },
            intrinsic_roughness: params.intrinsic_roughness,
            storage: storage_name(params.storage),
            levels: levels(material),
            bytes,
            max_error: params.max_error,
            measured: params.measured,
            placement: match material.placement.params.kind {
                PlacementKind::Tiled => PlacementInfo::Tiled,
                PlacementKind::Stochastic { cells_x, cells_y, cell_texels, seed } => PlacementInfo::Stochastic {
                    cells_x,
                    cells_y,
                    cell_texels,
                    seed,
                    palette: material.placement.params.palette_len,
                },
            },
        }
    }

    /// Number of tiles.
    pub fn tile_count(&self) -> u64 {
        self.levels.iter().map(|level| u64::from(level.tiles_x) * u64::from(level.tiles_y)).sum()
    }

    /// Bytes of tiles, densities and normals: what stands against the paper's layout.
    pub fn map_bytes(&self) -> u64 {
        self.bytes.tiles + self.bytes.density + self.bytes.normals
    }

    /// Size and error on one line.
    pub fn accuracy_line(&self) -> String {
        let factor = self.bytes.paper as f64 / self.map_bytes().max(1) as f64;
        format!(
            "{} tiles, {} (paper's layout {}, {factor:.0}×), E₁ mean {}, p95 {}, worst {}",
            self.tile_count(),
            kib(self.map_bytes()),
            kib(self.bytes.paper),
            percent(self.measured.mean),
            percent(self.measured.p95),
            percent(self.measured.worst)
        )
    }
}

fn levels(material: &Material) -> Vec<LevelInfo> {
    let describe = |level: &glint_formats::ndf_maps::Level| {
        let first = level.first_tile as usize;
        let tiles = &material.maps.tiles[first..first + (level.tiles_x * level.tiles_y) as usize];
        let errors = tiles.iter().map(|tile| f64::from(tile.error));
        LevelInfo {
            tile_texels: level.tile_texels,
            tiles_x: level.tiles_x,
            tiles_y: level.tiles_y,
            density_texels: tiles.iter().map(|tile| u64::from(tile.width()) * u64::from(tile.height())).sum(),
            mean_error: errors.clone().sum::<f64>() / tiles.len() as f64,
            worst_error: errors.fold(0.0, f64::max),
        }
    };
    material.maps.params.levels.iter().map(describe).collect()
}

/// The flag's value for a storage.
pub fn storage_name(storage: DensityStorage) -> &'static str {
    match storage {
        DensityStorage::SqrtU8 => "u8",
        DensityStorage::F16 => "f16",
        DensityStorage::PaperF32 => "paper",
    }
}
