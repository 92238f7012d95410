//! Where a material's density may be other than zero, whatever the footprint: the mask of `glint_ndf_reaches`.
//!
//! A node's density at s is zero but where one of the four texels around s is not, a patch's but near its normals. Conservative: a cell
//! is set if any of its points may be reached.

use super::baked::{BakedNdfMaps, Material};
use super::eval::matrix;
use crate::windows::patch::{CUT, bilinear};
use glam::{Mat2, UVec2, Vec2};
use glint_formats::ndf_maps::{NodeRecord, REACH_CELLS, STEPS_PER_ROUGHNESS};

/// Cells along an axis in which the example's own reach is found first.
const LOCAL_CELLS: usize = 512;
/// Squares along an edge of a patch whose normals are told apart.
const PARTS: u32 = 4;

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
        // Reaches are rectangles: +1 and −1 at their corners, summed up along both axes.
        let side = LOCAL_CELLS + 1;
        let mut marks = vec![0i32; side * side];
        let mut mark = |low: Vec2, high: Vec2| {
            let ([x0, y0], [x1, y1]) = ([cell(low.x), cell(low.y)], [cell(high.x) + 1, cell(high.y) + 1]);
            marks[y0 * side + x0] += 1;
            marks[y0 * side + x1] -= 1;
            marks[y1 * side + x0] -= 1;
            marks[y1 * side + x1] += 1;
        };
        let step = maps.params.intrinsic_roughness / STEPS_PER_ROUGHNESS;
        for node in &maps.nodes {
            let spacing = Vec2::from(node.spacing().map(|v| v as f32)) * step;
            let first = Vec2::from(node.origin().map(|v| v as f32)) * step - 1.0;
            for [i, j] in texels_over_nothing(maps, node) {
                let middle = first + Vec2::new(i as f32, j as f32) * spacing;
                mark(middle - spacing, middle + spacing);
            }
        }
        let margin = Vec2::splat(CUT * maps.params.intrinsic_roughness);
        for k in 0..maps.params.width * maps.params.height {
            let corners = maps.patch(UVec2::new(k % maps.params.width, k / maps.params.width).as_ivec2());
            for part in 0..PARTS * PARTS {
                let corner = |dx: u32, dy: u32| {
                    bilinear(corners, UVec2::new(part % PARTS + dx, part / PARTS + dy).as_vec2() / PARTS as f32)
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
                mark(a.min(b).min(c.min(d)) - margin, a.max(b).max(c.max(d)) + margin);
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

/// Column and row of the texels of a node that are more than nothing.
fn texels_over_nothing(maps: &BakedNdfMaps, node: &NodeRecord) -> Vec<[u32; 2]> {
    let ([x, y], [width, height]) = (node.place(), node.size());
    let over = (0..width * height).map(|k| [k % width, k / width]);
    over.filter(|[i, j]| maps.atlas[((y + j) * maps.atlas_size[0] + x + i) as usize] > 0).collect()
}
