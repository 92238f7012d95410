//! The surface as one set of lobes over normals, for footprints that see more patches than can be read one by one.
//!
//! Every block of the surface is a cell of the sample, but for seams; cells count as often as the surface shows them.

use crate::lobes::LobesOptions;
use crate::lobes::gaussian::Gaussian4;
use crate::lobes::merge::{self, MergeSettings};
use crate::rng::{ItemRng, Purpose};
use crate::synthesis::Synthesis;
use glam::{DMat2, DVec2};
use glint_formats::lobes::{LobeLevel, MAX_LAST_CELLS};
use glint_formats::synthesis::Layout;
use rayon::prelude::*;

/// Most columns and rows of patches that are counted; what they show stands for the rest.
const MOST_PATCHES: u32 = 64;
/// Cells whose lobes are reduced at a time.
const GROUP: usize = 4;

/// Lobes of the whole surface, at most those of [`MAX_LAST_CELLS`] cells, from the cells of the finest stored level, which begin at multiples of `step`.
pub(super) fn reduce(
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
        // Positions do not matter any more: all alike, slopes become a part of the spread of normals.
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
