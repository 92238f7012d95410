//! A sample and what it is to become → patches, and levels of cells that any patch can use.
//!
//! Where the lobes of a map lie side by side, cells here overlap: a patch lies anywhere in the sample at a multiple of the
//! alignment, and a block of it is a cell of the sample if cells of its edge begin there too. They are still made of four
//! cells of half the edge each, so that a level costs as many reductions as it has cells.

use super::{Surface, quality, whole};
use crate::error::{BakeError, Result};
use crate::lobes::bake as levels;
use crate::lobes::gaussian::Gaussian4;
use crate::lobes::options::TEXEL_BYTES;
use crate::lobes::{BakedLobes, LobesOptions};
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use crate::synthesis::{self, SynthesisOptions};
use glint_formats::Wrap;
use glint_formats::lobes::{BEYOND_RIM, LobeLevel, LobesUniform, MAX_LAST_CELLS};
use rayon::prelude::*;
use std::borrow::Cow;

/// What patches are aligned to by default, and in how many texels cells begin: at 8, there would be four times as many
/// cells; at 32, few places to cut patches from.
pub const ALIGNMENT: u32 = 16;

/// Bakes a surface of patches of `map`. A map that repeats, but not after a multiple of the alignment, is used as one that
/// does not.
///
/// # Errors
/// `BadOption` for options without a meaning, `BadInput` for a map too small for a patch, `LimitExceeded` for a map or
/// surface too large.
pub fn bake(
    map: &NormalMap,
    lobes: &LobesOptions,
    synthesis: &SynthesisOptions,
    progress: &dyn Progress,
) -> Result<Surface> {
    check(map, lobes, synthesis)?;
    let sample = sample_of(map, synthesis.alignment);
    let synthesis = synthesis::bake(&sample, synthesis, progress)?;
    let mut baked = levels::without_levels(&sample, lobes);
    baked.params.step_texels = synthesis.params.alignment;
    build_levels(&sample, lobes, &synthesis, &mut baked, progress);
    baked.params.rim_roughness = baked.rim_roughness(BEYOND_RIM);
    let mut surface = Surface { lobes: baked, synthesis };
    let roughness = levels::measured_roughness(&surface.lobes, lobes);
    surface.lobes.params.measured_roughness = roughness as f32;
    surface.lobes.params.measured = quality::measure(&surface, &sample, roughness, lobes, progress);
    Ok(surface)
}

/// Whether the options make sense together, and for this map.
///
/// # Errors
/// As [`bake`].
pub fn check(map: &NormalMap, lobes: &LobesOptions, synthesis: &SynthesisOptions) -> Result<()> {
    lobes.check(map)?;
    synthesis.validate_for(&sample_of(map, synthesis.alignment))?;
    if !synthesis.alignment.is_power_of_two() {
        let found = synthesis.alignment;
        return Err(BakeError::BadOption(format!("--alignment: expected a power of two, found {found}")));
    }
    if lobes.cell_texels > synthesis.alignment {
        return Err(BakeError::BadOption(format!(
            "--cell: a surface of patches needs finest cells of {} texels at most, found {}",
            synthesis.alignment, lobes.cell_texels
        )));
    }
    Ok(())
}

/// Bytes of lobes, normals, offsets and seams at most, for a map of this size.
pub fn most_bytes(width: u32, height: u32, lobes: &LobesOptions, synthesis: &SynthesisOptions) -> u64 {
    let stored = |cell: u32| {
        let step = cell.min(synthesis.alignment);
        width.div_ceil(step) as u64 * height.div_ceil(step) as u64
    };
    let cells: u64 = edges(lobes.cell_texels, synthesis.patch).map(stored).sum();
    let texels = width as u64 * height as u64 * TEXEL_BYTES;
    size_of::<LobesUniform>() as u64
        + (cells + MAX_LAST_CELLS as u64) * lobes.lobes_per_cell as u64 * lobes.storage.stride() as u64
        + texels
        + synthesis.most_bytes()
}

/// The map as patches are cut from it.
pub fn sample_of(map: &NormalMap, alignment: u32) -> Cow<'_, NormalMap> {
    let whole = map.width.is_multiple_of(alignment) && map.height.is_multiple_of(alignment);
    if map.wrap == Wrap::Repeat && !whole {
        Cow::Owned(NormalMap { wrap: Wrap::Clamp, ..map.clone() })
    } else {
        Cow::Borrowed(map)
    }
}

/// Edges of stored cells: doubling as long as they divide the patch.
fn edges(first: u32, patch: u32) -> impl Iterator<Item = u32> {
    std::iter::successors(Some(first), |edge| edge.checked_mul(2)).take_while(move |edge| patch.is_multiple_of(*edge))
}

fn build_levels(
    sample: &NormalMap,
    options: &LobesOptions,
    synthesis: &synthesis::Synthesis,
    baked: &mut BakedLobes,
    progress: &dyn Progress,
) {
    let grids: Vec<LobeLevel> = edges(options.cell_texels, synthesis.params.patch)
        .map(|edge| {
            let (cells_x, cells_y) = baked.params.grid(edge);
            LobeLevel { cells_x, cells_y, ..levels::grid(sample, edge) }
        })
        .collect();
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
    let lobes = whole::reduce(synthesis, first, baked.params.step(first.cell_texels), &finest, options);
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
