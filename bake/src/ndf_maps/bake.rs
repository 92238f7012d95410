//! From an example to its multi-scale NDF maps: a pyramid of tiles, each with a box and a resolution of its own.
//!
//! Xing et al. 2024, section 5.2: level l divides the example in tiles of 2^(l+1) texels, down to one tile. Examples of
//! any size are allowed; tiles at the right and lower edge are cut.

use super::baked::{BakedNdfMaps, Material};
use super::fine_grid::LobeNorm;
use super::micro_normals::TexelRect;
use super::options::{FINEST_TILE, NdfMapsOptions, Options, WORST_OF_MEAN};
use super::placement;
use super::tile_fit::{self, FitSettings, FittedTile};
use crate::error::Result;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use crate::quality::metrics::Summary;
use glint_formats::ndf_maps::{Level, MeasuredError, NdfMapsParams, TileRecord};
use rayon::prelude::*;

/// Part of the error asked for that the bake uses up: its fine grid agrees with the exact integral to a few per cent of
/// the error that it measures.
const USED: f64 = 0.95;

/// Bakes a material: the maps of an example and its placement.
///
/// # Errors
/// An option out of range, transforms that would push normals over the horizon, or an example that is too large.
pub fn bake(map: &NormalMap, options: &Options, progress: &dyn Progress) -> Result<Material> {
    let placement = placement::place(map, options.maps.roughness, &options.placement)?;
    Ok(Material { maps: bake_maps(map, &options.maps, progress)?, placement })
}

/// Bakes the maps of one example.
///
/// # Errors
/// An option out of range, or an example that is too large.
pub fn bake_maps(map: &NormalMap, options: &NdfMapsOptions, progress: &dyn Progress) -> Result<BakedNdfMaps> {
    options.check(map)?;
    let levels = levels(map.width, map.height, options.min_tile);
    let rects: Vec<TexelRect> = levels.iter().flat_map(|level| tile_rects(map, level)).collect();
    let settings = FitSettings {
        roughness: options.roughness,
        max_error: options.max_error,
        storage: options.storage,
        norm: LobeNorm::new(options.roughness),
    };
    progress.begin("NDF maps", rects.len() as u64);
    let candidates: Vec<Vec<FittedTile>> = rects
        .par_iter()
        .map(|rect| {
            let tiles = tile_fit::fit_tile(map, *rect, &settings);
            progress.advance(1);
            tiles
        })
        .collect();
    progress.end();
    let fitted = choose(candidates, USED * options.max_error);

    let texel_bytes = options.storage.texel_bytes() as usize;
    let mut tiles = Vec::with_capacity(fitted.len());
    let mut density = Vec::new();
    for tile in &fitted {
        tiles.push(TileRecord {
            origin: tile.origin.map(|v| v as f32),
            inv_spacing: tile.spacing.map(|v| (1.0 / v) as f32),
            scale: tile.scale,
            first: (density.len() / texel_bytes) as u32,
            size: tile.width as u32 | (tile.height as u32) << 16,
            error: tile.error as f32,
        });
        density.extend_from_slice(&tile.bytes);
    }
    let errors = Summary::of(fitted.iter().map(|t| t.error).collect());
    let energy = fitted.iter().fold(0.0f64, |a, t| a.max(t.energy));
    let snorm = |v: f32| (v.clamp(-1.0, 1.0) * 32767.0).round() as i16;
    Ok(BakedNdfMaps {
        params: NdfMapsParams {
            width: map.width,
            height: map.height,
            wrap: map.wrap,
            intrinsic_roughness: options.roughness as f32,
            storage: options.storage,
            levels,
            max_error: options.max_error as f32,
            measured: MeasuredError { mean: errors.mean, p95: errors.p95, worst: errors.worst, energy },
        },
        tiles,
        density,
        normals: map.projected.iter().map(|s| s.map(snorm)).collect(),
    })
}

/// One candidate a tile: the fewest bytes whose mean error is at most `max_error`, no tile over [`WORST_OF_MEAN`] times
/// that. Candidates are sorted by error. With a price λ on error, each tile takes the cheapest bytes + λ · error; the
/// smallest λ that keeps the mean is found by bisection.
fn choose(candidates: Vec<Vec<FittedTile>>, max_error: f64) -> Vec<FittedTile> {
    let pick = |tiles: &[FittedTile], price: f64| {
        let cost = |t: &FittedTile| t.bytes.len() as f64 + price * t.error / max_error;
        let mut best = 0;
        for (k, tile) in tiles.iter().enumerate() {
            if tile.error <= WORST_OF_MEAN * max_error && cost(tile) < cost(&tiles[best]) {
                best = k;
            }
        }
        best
    };
    let mean = |price: f64| {
        let total: f64 = candidates.iter().map(|tiles| tiles[pick(tiles, price)].error).sum();
        total / candidates.len() as f64
    };
    // Prices in bytes for one `max_error` of error.
    let (mut low, mut high) = (0.0, 1e9);
    if mean(low) > max_error {
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if mean(middle) > max_error { low = middle } else { high = middle }
        }
    } else {
        high = 0.0;
    }
    candidates.into_iter().map(|mut tiles| tiles.swap_remove(pick(&tiles, high))).collect()
}

/// Levels of a `width` × `height` example: tiles of `min_tile` (a power of two), twice that, … texels, up to the one tile that
/// covers it, which is always the last level.
pub fn levels(width: u32, height: u32, min_tile: u32) -> Vec<Level> {
    let covering = width.max(height).next_power_of_two();
    let mut levels = Vec::new();
    let (mut tile_texels, mut first_tile) = (min_tile.min(covering).max(FINEST_TILE), 0);
    loop {
        let (tiles_x, tiles_y) = (width.div_ceil(tile_texels), height.div_ceil(tile_texels));
        levels.push(Level { tile_texels, tiles_x, tiles_y, first_tile });
        if tiles_x * tiles_y == 1 {
            return levels;
        }
        first_tile += tiles_x * tiles_y;
        tile_texels *= 2;
    }
}

/// The texels of each tile of a level, row by row.
pub(super) fn tile_rects(map: &NormalMap, level: &Level) -> Vec<TexelRect> {
    let mut rects = Vec::new();
    for y in 0..level.tiles_y {
        for x in 0..level.tiles_x {
            let min = [x * level.tile_texels, y * level.tile_texels];
            let max = [(min[0] + level.tile_texels).min(map.width), (min[1] + level.tile_texels).min(map.height)];
            rects.push(TexelRect { min, max });
        }
    }
    rects
}
