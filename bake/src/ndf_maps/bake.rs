//! From an example to its NDF maps: nodes prefiltered by Gaussian windows, each with a table of its own.
//!
//! Xing et al. 2024, section 5.2, has square tiles of 2, 4, 8, … texels. Windows follow the footprints that read them: they overlap,
//! and grow by √2 from level to level.

use super::atlas;
use super::baked::{BakedNdfMaps, Material};
use super::fine_grid::{FineGrid, Plan, step_length};
use super::lobe_norm::LobeNorm;
use super::normal_bins::{NormalBins, Parts, parts_per_texel};
use super::options::{NdfMapsOptions, Options, WORST_OF_MEAN};
use super::pixel_errors::{self, SweptFootprint};
use super::placement;
use super::table_fit::{FittedTable, fit_node};
use super::windows::{Window, levels};
use crate::error::Result;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use crate::quality::metrics::Summary;
use glint_formats::Wrap;
use glint_formats::ndf_maps::{Level, MeasuredError, MomentsRecord, NdfMapsParams, NodeRecord, PixelError};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

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
/// An option out of range, an example that is too large, or tables that do not fit in a texture.
pub fn bake_maps(map: &NormalMap, options: &NdfMapsOptions, progress: &dyn Progress) -> Result<BakedNdfMaps> {
    options.check(map)?;
    let map = &repeating(map);
    let levels = levels(map.width, map.height, options.finest_window);
    let windows = windows(map, &levels, options.finest_window * options.finest_window);
    let footprints = SweptFootprint::all(map, options.finest_window);
    let measured_windows = footprints.iter().map(SweptFootprint::window);
    let all: Vec<Window> = windows.iter().copied().chain(measured_windows).collect();
    let grids = FineGrids::new(map, &all, options.roughness);
    progress.begin("NDF maps", windows.len() as u64);
    let (candidates, moments): (Vec<Vec<FittedTable>>, Vec<MomentsRecord>) = (0..windows.len())
        .into_par_iter()
        .map(|node| {
            let grid = grids.of_window(node);
            let tables = fit_node(&grid, options.max_error);
            progress.advance(1);
            let (mean, covariance) = grid.moments();
            (tables, MomentsRecord::new(mean, covariance))
        })
        .unzip();
    progress.end();
    let fitted = choose(&levels, candidates, USED * options.max_error);
    let atlas = atlas::pack(&fitted)?;
    let pair = |[x, y]: [u32; 2]| x | y << 16;
    let record = |(table, place): (&FittedTable, &[u32; 2])| NodeRecord {
        origin: pair(table.origin),
        place: pair(*place),
        shape: table.size[0] as u32 | (table.size[1] as u32) << 8 | table.spacing[0] << 16 | table.spacing[1] << 24,
        scale: table.scale,
    };
    let errors: Vec<f64> = fitted.iter().map(|table| table.error).collect();
    let summary = Summary::of(errors.clone());
    let measured = MeasuredError {
        mean: shares(&levels).zip(&errors).map(|(share, error)| share * error).sum(),
        p95: summary.p95,
        worst: summary.worst,
        energy: fitted.iter().fold(0.0f64, |a, table| a.max(table.energy)),
    };
    let snorm = |v: f32| (v.clamp(-1.0, 1.0) * 32767.0).round() as i16;
    let baked = BakedNdfMaps {
        params: NdfMapsParams {
            width: map.width,
            height: map.height,
            intrinsic_roughness: options.roughness as f32,
            finest_variance: (options.finest_window * options.finest_window) as f32,
            levels,
            max_error: options.max_error as f32,
            measured,
            pixel: PixelError::default(),
            node_errors: errors.iter().map(|error| *error as f32).collect(),
        },
        nodes: fitted.iter().zip(&atlas.places).map(record).collect(),
        moments,
        atlas_size: atlas.size,
        atlas: atlas.texels,
        normals: map.projected.iter().map(|s| s.map(snorm)).collect(),
    };
    pixel_errors::measured(map, baked, &footprints, |k| grids.of_window(windows.len() + k))
}

/// What fine grids under windows, of nodes and of footprints, are made of.
struct FineGrids {
    roughness: f64,
    /// Parts along a texel, and the plan of the fine grid, a window.
    plans: Vec<(u32, Plan)>,
    /// Bins by parts along a texel and steps between their points.
    bins: BTreeMap<(u32, u32), NormalBins>,
}

impl FineGrids {
    fn new(map: &NormalMap, windows: &[Window], roughness: f64) -> FineGrids {
        let sizes: BTreeSet<u32> = windows.iter().map(parts_per_texel).collect();
        let parts: BTreeMap<u32, Parts> = sizes.into_iter().map(|n| (n, Parts::new(map, n))).collect();
        let plan = |window: &Window| {
            let per_texel = parts_per_texel(window);
            (per_texel, Plan::new(&parts[&per_texel], window, roughness))
        };
        let plans: Vec<(u32, Plan)> = windows.par_iter().map(plan).collect();
        let wanted: BTreeSet<(u32, u32)> = plans.iter().map(|(per_texel, plan)| (*per_texel, plan.step)).collect();
        let norm = LobeNorm::new(roughness);
        let bins = |key: (u32, u32)| {
            let spacing = f64::from(key.1) * step_length(roughness);
            (key, NormalBins::new(&parts[&key.0], spacing, roughness, &norm))
        };
        FineGrids { roughness, plans, bins: wanted.into_iter().map(bins).collect() }
    }

    fn of_window(&self, window: usize) -> FineGrid {
        let (per_texel, plan) = &self.plans[window];
        FineGrid::new(plan, &self.bins[&(*per_texel, plan.step)], self.roughness)
    }
}

/// The map as copies of it lie on a surface, side by side: beyond its edge is the other one.
pub(super) fn repeating(map: &NormalMap) -> NormalMap {
    NormalMap { wrap: Wrap::Repeat, ..map.clone() }
}

/// The windows of all nodes, in their order.
pub(super) fn windows(map: &NormalMap, levels: &[Level], finest_variance: f64) -> Vec<Window> {
    let mut variance = finest_variance;
    let mut windows = Vec::new();
    for level in levels {
        let of_node = |k: u32| Window::new(map.width, map.height, level, variance, k);
        windows.extend((0..level.nodes_x * level.nodes_y).map(of_node));
        variance *= 2.0;
    }
    windows
}

/// What each node counts in the mean error: all levels alike.
fn shares(levels: &[Level]) -> impl Iterator<Item = f64> {
    let count = levels.len() as f64;
    levels.iter().flat_map(move |level| {
        let nodes = level.nodes();
        (0..nodes).map(move |_| 1.0 / (count * nodes as f64))
    })
}

/// One candidate a node: the fewest bytes whose mean error is at most `max_error`, no node over [`WORST_OF_MEAN`] times
/// that. Candidates are sorted by error. With a price λ on error, each node takes the cheapest bytes + λ · error · share; the
/// smallest λ that keeps the mean is found by bisection.
fn choose(levels: &[Level], candidates: Vec<Vec<FittedTable>>, max_error: f64) -> Vec<FittedTable> {
    let shares: Vec<f64> = shares(levels).collect();
    let pick = |tables: &[FittedTable], price: f64| {
        let cost = |t: &FittedTable| t.bytes() as f64 + price * t.error / max_error;
        let mut best = 0;
        for (k, table) in tables.iter().enumerate() {
            if table.error <= WORST_OF_MEAN * max_error && cost(table) < cost(&tables[best]) {
                best = k;
            }
        }
        best
    };
    let mean = |price: f64| {
        let error = |(tables, share): (&Vec<FittedTable>, &f64)| share * tables[pick(tables, price * share)].error;
        candidates.iter().zip(&shares).map(error).sum::<f64>()
    };
    // Prices in bytes for one `max_error` of error.
    let (mut low, mut high) = (0.0, 1e12);
    if mean(low) > max_error {
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if mean(middle) > max_error { low = middle } else { high = middle }
        }
    } else {
        high = 0.0;
    }
    let chosen = candidates.into_iter().zip(&shares);
    chosen.map(|(mut tables, share)| tables.swap_remove(pick(&tables, high * share))).collect()
}
