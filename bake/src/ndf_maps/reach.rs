//! Where a material's density may be other than zero, whatever the footprint: the mask of `glint_ndf_reaches`.
//!
//! A tile's density at s is a mean of the texels around s, so it is zero but where one of them is not. Texels that 8 bits
//! would round to zero count as zero. Conservative: a cell is set if any of its points may be reached.

use super::baked::{BakedNdfMaps, Material};
use super::eval::matrix;
use glam::{Mat2, Vec2};
use glint_formats::ndf_maps::{DensityStorage, REACH_CELLS, TileRecord};
use half::f16;

/// Cells along an axis in which the example's own reach is found first.
const LOCAL_CELLS: usize = 512;
/// A texel of this part of the largest one of its tile is what √ in 8 bits rounds to zero.
const NOTHING: f32 = (0.5 / 255.0) * (0.5 / 255.0);

/// The mask: a row of cells a record, a bit a cell, from s = (−1, −1) on.
pub(super) fn mask(material: &Material) -> [[u32; 4]; REACH_CELLS] {
    let local = LocalReach::new(&material.maps);
    let transforms: Vec<Mat2> = material.placement.palette.iter().map(|entry| matrix(entry.normal_to_local)).collect();
    let mut rows = [[0; 4]; REACH_CELLS];
    let half = Vec2::splat(1.0 / REACH_CELLS as f32);
    for (y, row) in rows.iter_mut().enumerate() {
        for x in 0..REACH_CELLS {
            let middle = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * (2.0 * half) - 1.0;
            let reached = transforms.iter().any(|m| {
                let extent = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y;
                local.any(*m * middle - extent, *m * middle + extent)
            });
            row[x / 32] |= u32::from(reached) << (x % 32);
        }
    }
    rows
}

/// Sums of reached cells of the example's disk over the rectangles from the first one.
struct LocalReach {
    sums: Vec<i32>,
}

/// The cell that holds a coordinate, clamped to the grid.
fn cell(x: f32) -> usize {
    ((x + 1.0) * (0.5 * LOCAL_CELLS as f32)).clamp(0.0, LOCAL_CELLS as f32 - 1.0) as usize
}

impl LocalReach {
    fn new(maps: &BakedNdfMaps) -> LocalReach {
        // Each texel's reach is a rectangle: +1 and −1 at its corners, summed up along both axes.
        let side = LOCAL_CELLS + 1;
        let mut marks = vec![0i32; side * side];
        let reach = if maps.params.storage == DensityStorage::PaperF32 { 1.0 } else { 1.5 };
        for tile in &maps.tiles {
            let spacing = Vec2::ONE / Vec2::from(tile.inv_spacing);
            for [i, j] in texels_over_nothing(maps, tile) {
                let middle = Vec2::from(tile.origin) + Vec2::new(i as f32, j as f32) * spacing;
                let (low, high) = (middle - spacing * reach, middle + spacing * reach);
                let ([x0, y0], [x1, y1]) = ([cell(low.x), cell(low.y)], [cell(high.x) + 1, cell(high.y) + 1]);
                marks[y0 * side + x0] += 1;
                marks[y0 * side + x1] -= 1;
                marks[y1 * side + x0] -= 1;
                marks[y1 * side + x1] += 1;
            }
        }
        sum_up(&mut marks, side);
        let mut sums = vec![0i32; side * side];
        for j in 0..LOCAL_CELLS {
            for i in 0..LOCAL_CELLS {
                sums[(j + 1) * side + i + 1] = i32::from(marks[j * side + i] > 0);
            }
        }
        sum_up(&mut sums, side);
        LocalReach { sums }
    }

    /// Whether any point of a rectangle is reached.
    fn any(&self, low: Vec2, high: Vec2) -> bool {
        let at = |x: usize, y: usize| self.sums[y * (LOCAL_CELLS + 1) + x];
        let ([x0, y0], [x1, y1]) = ([cell(low.x), cell(low.y)], [cell(high.x) + 1, cell(high.y) + 1]);
        at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0) > 0
    }
}

/// Running sums along both axes.
fn sum_up(values: &mut [i32], side: usize) {
    let mut above = vec![0; side];
    for row in values.chunks_exact_mut(side) {
        let mut left = 0;
        for (value, above) in row.iter_mut().zip(&mut above) {
            left += *value;
            *above += left;
            *value = *above;
        }
    }
}

/// Column and row of the texels of a tile that are more than nothing.
fn texels_over_nothing(maps: &BakedNdfMaps, tile: &TileRecord) -> Vec<[u32; 2]> {
    let bytes = maps.params.storage.texel_bytes() as usize;
    let count = (tile.width() * tile.height()) as usize;
    let first = tile.first as usize * bytes;
    let values: Vec<f32> = maps.density[first..first + count * bytes]
        .chunks_exact(bytes)
        .map(|b| match maps.params.storage {
            DensityStorage::SqrtU8 => f32::from(b[0]),
            DensityStorage::F16 => f16::from_le_bytes([b[0], b[1]]).to_f32(),
            DensityStorage::PaperF32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        })
        .collect();
    let nothing = match maps.params.storage {
        DensityStorage::SqrtU8 => 0.0,
        _ => NOTHING * values.iter().copied().fold(0.0, f32::max),
    };
    let over = (0..count as u32).filter(|k| values[*k as usize] > nothing);
    over.map(|k| [k % tile.width(), k / tile.width()]).collect()
}
