//! One material of the tiny-example method, as numbers.

use crate::methods::contents::{Item, decode_all};
use crate::quantities::{kib, percent};
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::sections;
use glint_formats::ndf_maps::{
    CLASSES, DENSITY, LAYERS, LayeredMaterial, Level, MeasuredError, NODES, NOISE, NORMALS, PixelError, PlacementKind,
    UNIFORM,
};
use glint_formats::{FourCc, Pack};
use serde::Serialize;

/// Bytes of one tile in the paper's layout: 128 × 128 floats (Xing et al. 2024, section 5.2).
const PAPER_TILE_BYTES: u64 = 128 * 128 * 4;

/// One material of the tiny-example method.
#[derive(Debug, Serialize)]
pub struct MaterialInfo {
    /// Name in the pack.
    pub name: String,
    /// Example width in texels.
    pub width: u32,
    /// Example height in texels.
    pub height: u32,
    /// σ_r.
    pub intrinsic_roughness: f32,
    /// Levels, finest first.
    pub levels: Vec<LevelInfo>,
    /// Bytes of each part on a GPU.
    pub bytes: PartBytes,
    /// E₁ that was asked of nodes on average.
    pub max_error: f32,
    /// Error as the bake measured it.
    pub measured: MeasuredError,
    /// Error of pixels as the bake measured it.
    pub pixel: PixelError,
    /// How a surface is covered.
    pub placement: PlacementInfo,
}

/// One level.
#[derive(Debug, Serialize)]
pub struct LevelInfo {
    /// Standard deviation of its windows in example texels.
    pub window: f64,
    /// Columns.
    pub nodes_x: u32,
    /// Rows.
    pub nodes_y: u32,
    /// Texels of the atlas that its nodes' tables take.
    pub atlas_texels: u64,
    /// Mean E₁ of its nodes.
    pub mean_error: f64,
    /// Worst E₁ of its nodes.
    pub worst_error: f64,
}

/// Bytes of each part on a GPU.
#[derive(Debug, Serialize)]
pub struct PartBytes {
    /// Uniform (levels, palette, reach mask) and the table of nodes.
    pub nodes: u64,
    /// Density, the atlas.
    pub density: u64,
    /// Example normals.
    pub normals: u64,
    /// Placement: noise map, class map.
    pub placement: u64,
    /// All of the above: what a GPU holds.
    pub total: u64,
    /// What the paper's tiles of this example take in its layout.
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
        let (nodes, placement) = (raw(UNIFORM) + raw(NODES), raw(NOISE) + raw(CLASSES));
        let bytes = PartBytes {
            nodes,
            density: raw(DENSITY),
            normals: raw(NORMALS),
            placement,
            total: nodes + raw(DENSITY) + raw(NORMALS) + placement,
            paper: paper_tiles(params.width, params.height) * PAPER_TILE_BYTES,
        };
        MaterialInfo {
            name: name.to_owned(),
            width: params.width,
            height: params.height,
            intrinsic_roughness: params.intrinsic_roughness,
            levels: levels(material),
            bytes,
            max_error: params.max_error,
            measured: params.measured,
            pixel: params.pixel,
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

    /// Number of nodes.
    fn node_count(&self) -> u64 {
        self.levels.iter().map(|level| u64::from(level.nodes_x) * u64::from(level.nodes_y)).sum()
    }

    /// Bytes of nodes, density and normals: what stands against the paper's layout.
    pub fn map_bytes(&self) -> u64 {
        self.bytes.nodes + self.bytes.density + self.bytes.normals
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
            "{} nodes, {} (paper's layout {}, {factor:.0}×), E₁ mean {}, p95 {}, worst {}",
            self.node_count(),
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
        Some(format!("{}; a pixel {}", self.size_and_error(), pixel_text(&self.pixel)))
    }

    fn to_text(&self) -> String {
        let bytes = &self.bytes;
        let mut out = String::new();
        let mut line = |text: String| {
            out.push_str(&text);
            out.push('\n');
        };
        line(format!("material \"{}\"", self.name));
        line(format!("  example      {} × {} texels", self.width, self.height));
        line(format!("  σ_r          {}", self.intrinsic_roughness));
        line(format!("  asked        E₁ {} on average", percent(f64::from(self.max_error))));
        line("  levels     window      nodes     atlas texels   E₁ mean     worst".into());
        for level in &self.levels {
            let grid = format!("{} × {}", level.nodes_x, level.nodes_y);
            let (mean, worst) = (percent(level.mean_error), percent(level.worst_error));
            line(format!(
                "           {:>8.3} {grid:>10} {:>16} {mean:>9} {worst:>9}",
                level.window, level.atlas_texels
            ));
        }
        line(format!("  accuracy     {}", self.size_and_error()));
        line(format!("  a pixel      E₁ {}", pixel_text(&self.pixel)));
        line(format!("  energy       {:.1e} at most from 1", self.measured.energy));
        line(format!(
            "  bytes        nodes {}, density {}, normals {}, placement {}",
            bytes.nodes, bytes.density, bytes.normals, bytes.placement
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

/// Error of pixels of the example side by side.
pub fn pixel_text(pixel: &PixelError) -> String {
    let PixelError { mean, worst, worst_sigma_texels } = *pixel;
    format!("mean {}, worst {} at footprints of {worst_sigma_texels:.2} texels", percent(mean), percent(worst))
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
    let maps = &material.maps;
    let mut variance = f64::from(maps.params.finest_variance);
    let mut describe = |level: &Level| {
        let nodes = level.first_node as usize..level.first_node as usize + level.nodes() as usize;
        let errors = maps.params.node_errors[nodes.clone()].iter().map(|error| f64::from(*error));
        let texels = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
        let window = variance.sqrt();
        variance *= 2.0;
        LevelInfo {
            window,
            nodes_x: level.nodes_x,
            nodes_y: level.nodes_y,
            atlas_texels: maps.nodes[nodes].iter().map(|node| texels(node.size())).sum(),
            mean_error: errors.clone().sum::<f64>() / level.nodes() as f64,
            worst_error: errors.fold(0.0, f64::max),
        }
    };
    maps.params.levels.iter().map(&mut describe).collect()
}

/// Tiles that the paper bakes for an example: of 2, 4, 8, … texels, up to one that covers it (Xing et al. 2024, section 5.2).
fn paper_tiles(width: u32, height: u32) -> u64 {
    let mut edge = 2;
    let mut tiles = 0;
    loop {
        let of_level = u64::from(width.div_ceil(edge)) * u64::from(height.div_ceil(edge));
        tiles += of_level;
        if of_level == 1 {
            return tiles;
        }
        edge *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::paper_tiles;

    #[test]
    fn the_paper_s_tiles_are_those_of_all_levels() {
        assert_eq!(paper_tiles(1, 1), 1);
        assert_eq!(paper_tiles(16, 16), 64 + 16 + 4 + 1);
        assert_eq!(paper_tiles(5, 3), 3 * 2 + 2 + 1);
    }
}
