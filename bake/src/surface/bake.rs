//! A sample and what it is to become → patches, and levels of cells that any patch can use.
//!
//! Where the lobes of a map lie side by side, cells here overlap: a patch lies anywhere in the sample at a multiple of the
//! alignment, and a block of it is a cell of the sample if cells of its edge begin there too. They are still made of four
//! cells of half the edge each, so that a level costs as many reductions as it has cells.

use super::baked::Surface;
use super::options::SurfaceOptions;
use super::quality;
use crate::error::Result;
use crate::lobes::bake as levels;
use crate::lobes::gaussian::Gaussian4;
use crate::lobes::merge::{self, MergeSettings};
use crate::lobes::{BakedLobes, LobesOptions};
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use crate::rng::{ItemRng, Purpose};
use crate::synthesis::{self, Synthesis};
use glam::{DMat2, DVec2};
use glint_formats::lobes::{BEYOND_RIM, LobeLevel, MAX_LAST_CELLS};
use glint_formats::synthesis::Layout;
use rayon::prelude::*;

/// Most columns and rows of patches that are counted for the surface as a whole; what they show stands for the rest.
const MOST_PATCHES: u32 = 64;
/// Cells whose lobes are reduced at a time for the surface as a whole.
const GROUP: usize = 4;

/// Bakes a surface of patches of `map`. A map that repeats, but not after a multiple of the alignment, is used as one that
/// does not.
///
/// # Errors
/// `BadOption` for options without a meaning, `BadInput` for a map too small for a patch, `LimitExceeded` for a map or
/// surface too large.
pub fn bake(map: &NormalMap, options: &SurfaceOptions, progress: &dyn Progress) -> Result<Surface> {
    options.check(map)?;
    let sample = options.sample_of(map);
    let lobes = &options.lobes;
    let synthesis = synthesis::bake(&sample, &options.synthesis, progress)?;
    let mut baked = levels::without_levels(&sample, lobes);
    baked.params.step_texels = synthesis.params.alignment;
    build_levels(&sample, options, &synthesis, &mut baked, progress);
    baked.params.rim_roughness = baked.rim_roughness(BEYOND_RIM);
    let mut surface = Surface { lobes: baked, synthesis };
    let roughness = levels::measured_roughness(&surface.lobes, lobes);
    surface.lobes.params.measured_roughness = roughness as f32;
    surface.lobes.params.measured = quality::measure(&surface, &sample, roughness, lobes, progress);
    Ok(surface)
}

fn build_levels(
    sample: &NormalMap,
    options: &SurfaceOptions,
    synthesis: &Synthesis,
    baked: &mut BakedLobes,
    progress: &dyn Progress,
) {
    let grids: Vec<LobeLevel> = options
        .edges()
        .map(|edge| {
            let (cells_x, cells_y) = baked.params.grid(edge);
            LobeLevel { cells_x, cells_y, ..levels::grid(sample, edge) }
        })
        .collect();
    let options = &options.lobes;
    let count = |grid: &LobeLevel| grid.cells_x as usize * grid.cells_y as usize;
    // Cells of the first level hold finer ones that are not kept, so that they cost several times as much.
    let steps = |at: usize| if at == 0 { 4 } else { 1 };
    progress.begin("lobes", grids.iter().enumerate().map(|(at, grid)| steps(at) * count(grid) as u64).sum());
    let mut finest = Vec::new();
    let mut finer: Option<(LobeLevel, Vec<Vec<Gaussian4>>)> = None;
    for (at, grid) in grids.iter().enumerate() {
        let cells: Vec<Vec<Gaussian4>> = (0..count(grid))
            .into_par_iter()
            .map(|cell| {
                let (x, y) = (cell as u32 % grid.cells_x, cell as u32 / grid.cells_x);
                let parts = match &finer {
                    None => levels::finest_parts(sample, options, grid, x, y),
                    Some((below, cells)) => quarters(baked, below, cells, x, y),
                };
                let lobes = levels::reduce(options, grid, x, y, &parts);
                progress.advance(steps(at));
                lobes
            })
            .collect();
        levels::store(grid, &cells, baked);
        if at == 0 {
            finest = cells.clone();
        }
        finer = Some((*grid, cells));
    }
    progress.end();
    let Some(first) = grids.first() else { return };
    let lobes = reduce_whole(synthesis, first, baked.params.step(first.cell_texels), &finest, options);
    let edge = 2 * grids[grids.len() - 1].cell_texels;
    let cells: Vec<Vec<Gaussian4>> = lobes.chunks(options.lobes_per_cell as usize).map(<[Gaussian4]>::to_vec).collect();
    let last = LobeLevel { cells_x: cells.len() as u32, cells_y: 1, ..levels::grid(sample, edge) };
    levels::store(&last, &cells, baked);
}

/// The four cells of `below` that make up cell (x, y) of the level above; across the sample's edge they are moved there.
fn quarters(baked: &BakedLobes, below: &LobeLevel, cells: &[Vec<Gaussian4>], x: u32, y: u32) -> Vec<Gaussian4> {
    let params = &baked.params;
    let half = below.cell_texels;
    let (step, finer_step) = (params.step(2 * half), params.step(half));
    let place = |at: u32, second: u32, count: u32, side: u32| {
        let index = (at * step + second * half) / finer_step;
        if index < count { (index, 0.0) } else { (index - count, side as f64) }
    };
    let mut parts = Vec::new();
    for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let (column, right) = place(x, a, below.cells_x, params.width);
        let (row, down) = place(y, b, below.cells_y, params.height);
        parts.extend(cells[(row * below.cells_x + column) as usize].iter().map(|lobe| {
            let mut moved = *lobe;
            moved.mean[0] += right;
            moved.mean[1] += down;
            moved
        }));
    }
    parts
}

/// The surface as one set of lobes over normals, for footprints that see more patches than can be read one by one: at most those of
/// [`MAX_LAST_CELLS`] cells, from the cells of the finest stored level, which begin at multiples of `step`. Every block of the
/// surface is a cell of the sample, but for seams; cells count as often as the surface shows them.
fn reduce_whole(
    surface: &Synthesis,
    grid: &LobeLevel,
    step: u32,
    cells: &[Vec<Gaussian4>],
    options: &LobesOptions,
) -> Vec<Gaussian4> {
    let mut counts = counts(surface, grid, step);
    if counts.iter().all(|count| *count == 0) {
        counts.fill(1);
    }
    let middle = DVec2::splat(0.5 * grid.cell_texels as f64);
    let seen = |(lobes, &count): (&Vec<Gaussian4>, &u32)| -> Vec<Gaussian4> {
        // Positions do not matter any more: all alike, slopes become a part of the covariance of normals.
        lobes
            .iter()
            .map(|lobe| {
                let weight = lobe.weight * f64::from(count);
                Gaussian4::of_surface(
                    weight,
                    middle,
                    DMat2::IDENTITY,
                    lobe.normal(),
                    DMat2::ZERO,
                    lobe.normal_covariance(),
                )
            })
            .collect()
    };
    let mut sets: Vec<Vec<Gaussian4>> = cells.iter().zip(&counts).filter(|(_, count)| **count > 0).map(seen).collect();
    let most = MAX_LAST_CELLS * options.lobes_per_cell;
    let settings = MergeSettings { merge: options.merge, lobes: most as usize, blur: [1.0, options.roughness] };
    let mut round = 0;
    while sets.len() > 1 {
        sets = sets
            .par_chunks(GROUP)
            .enumerate()
            .map(|(at, group)| {
                let mut rng = ItemRng::new(options.seed, Purpose::SurfaceLobes(round), at as u32);
                merge::reduce(&group.concat(), &settings, &mut rng)
            })
            .collect();
        round += 1;
    }
    sets.pop().unwrap_or_default()
}

/// How many blocks of the surface show each cell.
fn counts(surface: &Synthesis, grid: &LobeLevel, step: u32) -> Vec<u32> {
    let params = &surface.params;
    let (columns, rows) = match params.layout {
        Layout::Patches { columns, rows, .. } => (columns.min(MOST_PATCHES), rows.min(MOST_PATCHES)),
        Layout::CornerTiles { .. } => (MOST_PATCHES, MOST_PATCHES),
    };
    let edge = grid.cell_texels as i32;
    let blocks = |patches: u32| (patches * params.patch) as i32 / edge;
    let mut counts = vec![0; grid.cells_x as usize * grid.cells_y as usize];
    for by in 0..blocks(rows) {
        for bx in 0..blocks(columns) {
            if let Some((x, y)) = surface.nominal_block(bx * edge, by * edge, edge, step) {
                counts[(y / step * grid.cells_x + x / step) as usize] += 1;
            }
        }
    }
    counts
}
