//! One material of the tiny-example method, as numbers.

use super::args::Storage;
use crate::cli::values::name_of;
use crate::methods::contents::{Item, decode_all};
use crate::quantities::{kib, percent};
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::sections;
use glint_formats::ndf_maps::{
    CLASSES, DENSITY, LAYERS, LayeredMaterial, MeasuredError, NOISE, NORMALS, PlacementKind, TILES, UNIFORM,
};
use glint_formats::{FourCc, Pack, Wrap};
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
    pub storage: String,
    /// Levels, finest first.
    pub levels: Vec<LevelInfo>,
    /// Bytes of each part on a GPU.
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

/// Bytes of each part on a GPU.
#[derive(Debug, Serialize)]
pub struct PartBytes {
    /// Uniform: levels, palette, reach mask, tile records; and the table of tiles that are many.
    pub tiles: u64,
    /// Density, in blocks or words.
    pub density: u64,
    /// Example normals.
    pub normals: u64,
    /// Placement: noise map, class map.
    pub placement: u64,
    /// All of the above: what a GPU holds.
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
    fn of(name: &str, material: &Material, pack: &Pack) -> MaterialInfo {
        let params = &material.maps.params;
        let raw = |kind: FourCc| pack.find(kind, name).map_or(0, |entry| entry.raw_len);
        let (tiles, placement) = (raw(UNIFORM) + raw(TILES), raw(NOISE) + raw(CLASSES));
        let bytes = PartBytes {
            tiles,
            density: raw(DENSITY),
            normals: raw(NORMALS),
            placement,
            total: tiles + raw(DENSITY) + raw(NORMALS) + placement,
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
            storage: name_of(&Storage::from(params.storage)),
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

    /// Describes every material of a sound pack.
    pub fn all_of(pack: &Pack) -> Vec<MaterialInfo> {
        let describe = |name| Some(MaterialInfo::of(name, &sections::from_pack(pack, name).ok()?, pack));
        sections::materials(pack).into_iter().filter_map(describe).collect()
    }

    /// Size and error on one line.
    fn size_and_error(&self) -> String {
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

impl Item for MaterialInfo {
    fn name(&self) -> &str {
        &self.name
    }

    fn accuracy_line(&self) -> Option<String> {
        Some(self.size_and_error())
    }

    fn to_text(&self) -> String {
        let bytes = &self.bytes;
        let mut out = String::new();
        let mut line = |text: String| {
            out.push_str(&text);
            out.push('\n');
        };
        line(format!("material \"{}\"", self.name));
        line(format!("  example      {} × {} texels, {}", self.width, self.height, self.wrap));
        line(format!("  σ_r          {}", self.intrinsic_roughness));
        line(format!("  storage      {}, E₁ {} asked", self.storage, percent(f64::from(self.max_error))));
        line("  levels       tile      tiles   density texels   E₁ mean     worst".into());
        for level in &self.levels {
            let grid = format!("{} × {}", level.tiles_x, level.tiles_y);
            let (mean, worst) = (percent(level.mean_error), percent(level.worst_error));
            line(format!(
                "           {:>8} {grid:>10} {:>16} {mean:>9} {worst:>9}",
                level.tile_texels, level.density_texels
            ));
        }
        line(format!("  accuracy     {}", self.size_and_error()));
        line(format!("  energy       {:.1e} at most from 1", self.measured.energy));
        line(format!(
            "  bytes        tiles {}, density {}, normals {}, placement {}",
            bytes.tiles, bytes.density, bytes.normals, bytes.placement
        ));
        line(match self.placement {
            PlacementInfo::Tiled => "  placement    tiled".into(),
            PlacementInfo::Stochastic { cells_x, cells_y, cell_texels, seed, palette } => format!(
                "  placement    stochastic, {cells_x} × {cells_y} cells of {cell_texels} texels, {palette} transforms, seed {seed}"
            ),
        });
        out
    }
}

/// A two-layer material.
#[derive(Debug, Serialize)]
#[serde(transparent)]
pub struct LayersInfo(pub LayeredMaterial);

impl LayersInfo {
    /// Every two-layer material of a sound pack.
    pub fn all_of(pack: &Pack) -> Vec<LayersInfo> {
        decode_all(pack, LAYERS).into_iter().map(|(_, layers)| LayersInfo(layers)).collect()
    }
}

impl Item for LayersInfo {
    fn name(&self) -> &str {
        &self.0.coat
    }

    fn accuracy_line(&self) -> Option<String> {
        None
    }

    fn to_text(&self) -> String {
        let LayeredMaterial { coat, base, coat_f0, base_f0: [r, g, b] } = &self.0;
        format!(
            "two layers: \"{coat}\" over \"{base}\"\n  F0 of the coat  {coat_f0}\n  F0 of the base  {r}, {g}, {b}\n"
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
