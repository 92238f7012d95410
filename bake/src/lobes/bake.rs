//! A normal map → MIP-mapped lobes: seeds, bottom-up reduction by cells, packed levels.
//!
//! Tan et al. 2022, section 5.1.2. Where the paper clusters every level from the texels, a level here reduces the lobes of
//! the level below: cheaper, and closer to the map, since a good lobe is made once.

use super::gaussian::Gaussian4;
use super::merge::{self, MergeSettings};
use super::options::{LobesOptions, NormalsChoice, ROUNDING};
use super::quality::{self, Measured};
use super::quantise::{self, Lobe, Scales};
use super::query::QuerySettings;
use super::reference::Reference;
use super::seeds;
use crate::error::Result;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use crate::quality::sweep;
use crate::rng::{ItemRng, Purpose};
use crate::wrap::wrapped;
use glam::{DVec2, Vec2};
use glint_formats::lobes::{FootprintError, LobeLevel, LobeStorage, LobesParams, MAX_LAST_CELLS, NormalsStorage};
use rayon::prelude::*;

/// Cells that are reduced from seeds, one a texel, in texels; half that for four seeds a texel. Finer than the stored levels:
/// the cost of a reduction grows with the square of the parts of a cell.
const SEED_CELL: u32 = 8;
/// Footprint that cells of an edge are read with, over that edge: differences of position below it do not show.
const BLUR_OF_CELL: f64 = 0.6;
/// Sizes of footprints that the bake measures its error over, in texels, as far as the map goes.
pub(crate) const MEASURED_SIGMAS: [f64; 5] = [2.0, 4.0, 8.0, 16.0, 32.0];

/// Sizes above this are measured over half the footprints.
const LARGE_SIGMA: f64 = 4.0;
/// Range of normals over the roughness that the error is measured at, at most: the exact NDF of a rougher map takes minutes.
const MEASURED_RANGE: f64 = 100.0;

/// Pieces of the reference that the bake measures against are this much coarser than they could be, which changes E₁ by less
/// than half a point on steep maps.
pub(crate) const MEASURED_REFINEMENT: f64 = 0.6;

/// MIP-mapped lobes of one map, ready for a pack.
#[derive(Clone, Debug, PartialEq)]
pub struct BakedLobes {
    /// Parameters.
    pub params: LobesParams,
    /// Records of all lobes.
    pub lobes: Vec<u8>,
    /// Texels of the normals.
    pub normals: Vec<u8>,
}

impl BakedLobes {
    /// Bytes that a renderer keeps.
    pub fn gpu_bytes(&self) -> usize {
        self.lobes.len() + self.normals.len()
    }

    /// A lobe by its index among all; `scales` are those of its level.
    pub fn lobe(&self, index: u32, scales: &Scales) -> Lobe {
        let stride = self.params.storage.stride() as usize;
        let bytes = &self.lobes[index as usize * stride..][..stride];
        match self.params.storage {
            LobeStorage::Packed => quantise::decode_packed(&bytemuck::pod_read_unaligned(bytes), &self.params, scales),
            LobeStorage::Half => quantise::decode_half(&bytemuck::pod_read_unaligned(bytes), &self.params, scales),
        }
    }

    /// Projected normal of texel (i, j), wrapped or clamped.
    pub fn texel(&self, i: i32, j: i32) -> Vec2 {
        let (w, h) = (self.params.width as i32, self.params.height as i32);
        let (i, j) = (wrapped(i, w, self.params.wrap), wrapped(j, h, self.params.wrap));
        let at = (j * w + i) as usize * self.params.normals.texel_bytes();
        let b = &self.normals[at..at + self.params.normals.texel_bytes()];
        match self.params.normals {
            NormalsStorage::Snorm16 => {
                let snorm = |k: usize| i16::from_le_bytes([b[k], b[k + 1]]) as f32 / 32767.0;
                Vec2::new(snorm(0), snorm(2))
            }
            NormalsStorage::Unorm8 => Vec2::new(b[0] as f32, b[1] as f32) / 255.0 * 2.0 - 1.0,
        }
    }
}

/// Bakes one map. Errors: an option out of range, or a map that is too large.
pub fn bake(map: &NormalMap, options: &LobesOptions, progress: &dyn Progress) -> Result<BakedLobes> {
    options.check(map)?;
    let mut baked = without_levels(map, options);
    build_levels(map, options, &mut baked, progress);
    measure(map, options, &mut baked, progress);
    Ok(baked)
}

/// A map's normals and parameters; lobes are to follow.
pub(crate) fn without_levels(map: &NormalMap, options: &LobesOptions) -> BakedLobes {
    let (storage, normals) = store_normals(map, options);
    let [low, high] = normal_range(map);
    BakedLobes {
        params: LobesParams {
            width: map.width,
            height: map.height,
            wrap: map.wrap,
            filter: options.filter,
            intrinsic_roughness: options.roughness as f32,
            storage: options.storage,
            normals: storage,
            merge: options.merge,
            seeds: options.seeds,
            lobes_per_cell: options.lobes_per_cell,
            step_texels: 0,
            normal_low: low.to_array(),
            normal_extent: (high - low).to_array(),
            levels: Vec::new(),
            measured_roughness: options.roughness as f32,
            measured: Vec::new(),
        },
        lobes: Vec::new(),
        normals,
    }
}

/// Levels of cells of doubling edge, up to so few cells that all of them are read for the whole map: one cell's lobes would
/// be too few for it.
fn grids(map: &NormalMap, options: &LobesOptions) -> Vec<LobeLevel> {
    let mut cell = options.cell_texels;
    let mut grids = Vec::new();
    loop {
        grids.push(grid(map, cell));
        let LobeLevel { cells_x, cells_y, .. } = grids[grids.len() - 1];
        if cells_x.max(cells_y) <= MAX_LAST_CELLS {
            return grids;
        }
        cell *= 2;
    }
}

/// A level's grid, without lobes yet.
pub(crate) fn grid(map: &NormalMap, cell_texels: u32) -> LobeLevel {
    LobeLevel {
        cell_texels,
        cells_x: map.width.div_ceil(cell_texels),
        cells_y: map.height.div_ceil(cell_texels),
        first_lobe: 0,
        weight_scale: 1.0,
        position_sigma: [1.0; 2],
        residual_sigma: [1.0; 2],
        jacobian_scale: 0.0,
    }
}

fn build_levels(map: &NormalMap, options: &LobesOptions, baked: &mut BakedLobes, progress: &dyn Progress) {
    let grids = grids(map, options);
    let count = |grid: &LobeLevel| grid.cells_x as usize * grid.cells_y as usize;
    // Cells of the first level hold finer ones that are not kept, so that they cost several times as much.
    let steps = |at: usize| if at == 0 { 4 } else { 1 };
    progress.begin("lobes", grids.iter().enumerate().map(|(at, grid)| steps(at) * count(grid) as u64).sum());
    let mut finer: Option<(LobeLevel, Vec<Vec<Gaussian4>>)> = None;
    for (at, grid) in grids.iter().enumerate() {
        let cells: Vec<Vec<Gaussian4>> = (0..count(grid))
            .into_par_iter()
            .map(|cell| {
                let (x, y) = (cell as u32 % grid.cells_x, cell as u32 / grid.cells_x);
                let parts = match &finer {
                    None => finest_parts(map, options, grid, x, y),
                    Some((below, cells)) => children(below, cells, x, y),
                };
                let lobes = reduce(options, grid, x, y, &parts);
                progress.advance(steps(at));
                lobes
            })
            .collect();
        store(grid, &cells, baked);
        finer = Some((*grid, cells));
    }
    progress.end();
}

pub(crate) fn reduce(options: &LobesOptions, grid: &LobeLevel, x: u32, y: u32, parts: &[Gaussian4]) -> Vec<Gaussian4> {
    let settings = MergeSettings {
        merge: options.merge,
        lobes: options.lobes_per_cell as usize,
        blur: [BLUR_OF_CELL * grid.cell_texels as f64, options.roughness],
    };
    let mut rng = ItemRng::new(options.seed, Purpose::LobeCells(grid.cell_texels), y * grid.cells_x + x);
    merge::reduce(parts, &settings, &mut rng)
}

/// What a cell of the first level is reduced from: seeds, or cells of half its edge that are not kept.
pub(crate) fn finest_parts(
    map: &NormalMap,
    options: &LobesOptions,
    cell: &LobeLevel,
    x: u32,
    y: u32,
) -> Vec<Gaussian4> {
    let seed_cell = if options.seeds == 4 { SEED_CELL / 2 } else { SEED_CELL };
    if cell.cell_texels <= seed_cell {
        return cell_seeds(map, options, cell, x, y);
    }
    let below = grid(map, cell.cell_texels / 2);
    let mut parts = Vec::new();
    for j in 2 * y..(2 * y + 2).min(below.cells_y) {
        for i in 2 * x..(2 * x + 2).min(below.cells_x) {
            parts.extend(reduce(options, &below, i, j, &finest_parts(map, options, &below, i, j)));
        }
    }
    parts
}

fn cell_seeds(map: &NormalMap, options: &LobesOptions, grid: &LobeLevel, x: u32, y: u32) -> Vec<Gaussian4> {
    let segments = |cell: u32, size: u32| {
        let (from, to) = (cell * grid.cell_texels, ((cell + 1) * grid.cell_texels).min(size));
        seeds::segments(from, to, size, map.wrap, options.filter, options.seeds == 4)
    };
    let (columns, rows) = (segments(x, map.width), segments(y, map.height));
    rows.iter().flat_map(|row| columns.iter().map(|column| seeds::seed(map, column, row))).collect()
}

fn children(below: &LobeLevel, cells: &[Vec<Gaussian4>], x: u32, y: u32) -> Vec<Gaussian4> {
    let mut parts = Vec::new();
    for j in 2 * y..(2 * y + 2).min(below.cells_y) {
        for i in 2 * x..(2 * x + 2).min(below.cells_x) {
            parts.extend_from_slice(&cells[(j * below.cells_x + i) as usize]);
        }
    }
    parts
}

/// Appends a level's records.
pub(crate) fn store(grid: &LobeLevel, cells: &[Vec<Gaussian4>], baked: &mut BakedLobes) {
    let stride = baked.params.storage.stride() as usize;
    let level = LobeLevel {
        first_lobe: (baked.lobes.len() / stride) as u32,
        ..quantise::ranges(cells.iter().flatten(), *grid)
    };
    for (cell, lobes) in cells.iter().enumerate() {
        let at = DVec2::new((cell as u32 % grid.cells_x) as f64, (cell as u32 / grid.cells_x) as f64);
        let corner = at * baked.params.step(grid.cell_texels) as f64;
        for k in 0..baked.params.lobes_per_cell as usize {
            quantise::encode(lobes.get(k), corner, &baked.params, &level, &mut baked.lobes);
        }
    }
    baked.params.levels.push(level);
}

fn normal_range(map: &NormalMap) -> [Vec2; 2] {
    let texels = map.projected.iter().map(|s| Vec2::from(*s));
    let (low, high) = texels.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(lo, hi), s| (lo.min(s), hi.max(s)));
    [low, high]
}

fn store_normals(map: &NormalMap, options: &LobesOptions) -> (NormalsStorage, Vec<u8>) {
    let unorm = |v: f32| ((v + 1.0) * 127.5).round().clamp(0.0, 255.0);
    let error: f64 = map.projected.iter().flatten().map(|v| ((unorm(*v) / 127.5 - 1.0 - v) as f64).powi(2)).sum();
    let rms = (error / (2 * map.projected.len()) as f64).sqrt();
    let small = match options.normals {
        NormalsChoice::Auto => rms <= ROUNDING * options.roughness,
        NormalsChoice::Unorm8 => true,
        NormalsChoice::Snorm16 => false,
    };
    let values = map.projected.iter().flatten();
    if small {
        (NormalsStorage::Unorm8, values.map(|v| unorm(*v) as u8).collect())
    } else {
        let snorm = |v: &f32| ((v.clamp(-1.0, 1.0) * 32767.0).round() as i16).to_le_bytes();
        (NormalsStorage::Snorm16, values.flat_map(snorm).collect())
    }
}

/// Error over a few footprints a size, as the evaluator chooses levels.
fn measure(map: &NormalMap, options: &LobesOptions, baked: &mut BakedLobes, progress: &dyn Progress) {
    if options.footprints == 0 {
        return;
    }
    const SEED: u64 = 11;
    let extent = DVec2::new(map.width as f64, map.height as f64);
    let sizes = MEASURED_SIGMAS.iter().filter(|sigma| **sigma <= 0.25 * extent.max_element().max(8.0));
    progress.begin("error", sizes.clone().count() as u64);
    let roughness = measured_roughness(baked, options);
    baked.params.measured_roughness = roughness as f32;
    let reference = Reference::new(map, options.filter, roughness).refined(MEASURED_REFINEMENT);
    let mut rows = Vec::new();
    for &sigma in sizes {
        let count = measured_footprints(sigma, options);
        let footprints = sweep::footprints(sigma, 1.0, extent, count, SEED);
        let chosen = [(&*baked, Measured::Chosen(QuerySettings::default()))];
        let errors = quality::footprint_errors(&reference, &chosen, &footprints, 3 * quality::STRIDE);
        rows.push(FootprintError {
            sigma_texels: sigma as f32,
            mean: errors[0].e1.mean as f32,
            worst: errors[0].e1.worst as f32,
        });
        progress.advance(1);
    }
    progress.end();
    baked.params.measured = rows;
}

/// Roughness that errors are measured at: the bake's own, or what keeps the grid of normals small.
pub(crate) fn measured_roughness(baked: &BakedLobes, options: &LobesOptions) -> f64 {
    let range = Vec2::from(baked.params.normal_extent).max_element() as f64;
    options.roughness.max(range / MEASURED_RANGE)
}

/// Footprints of a size that errors are measured over. Large ones differ less from place to place, and cost more.
pub(crate) fn measured_footprints(sigma: f64, options: &LobesOptions) -> u32 {
    if sigma > LARGE_SIGMA { options.footprints.div_ceil(2) } else { options.footprints }
}
