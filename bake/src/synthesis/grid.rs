//! Patches on a grid that repeats: one of the two arrangements. Tan et al. 2022, section 5.1.1. Integer twin of `grid.wgsl`.

use super::baked::Synthesis;
use super::paths::{Place, floor_div, path_entry};

/// Where the left (`which` 0) or upper (1) cut of a patch lies at its row (column) `along`: its first own texel.
fn cut(synthesis: &Synthesis, patch_index: u32, which: u32, along: i32) -> i32 {
    let overlap = synthesis.uniform.overlap as i32;
    let first = (2 * patch_index + which) * synthesis.uniform.path_words;
    path_entry(synthesis, first, (along + overlap) as u32) - overlap
}

/// The patch that shows a texel of the grid. Its block's own patch does, unless a neighbour right or below claims it; of
/// several the last in raster order.
pub(super) fn place(synthesis: &Synthesis, x: i32, y: i32) -> Place {
    let uniform = &synthesis.uniform;
    let edge = uniform.patch_texels as i32;
    let near = edge - uniform.overlap as i32;
    let (columns, rows) = (uniform.columns as i32, uniform.rows as i32);
    let (in_x, in_y) = (floor_div(x, edge), floor_div(y, edge));
    let bx = floor_div(in_x.0, columns).1;
    let by = floor_div(in_y.0, rows).1;
    let near_right = in_x.1 >= near;
    let near_below = in_y.1 >= near;
    let neighbour = |right: bool, below: bool| {
        let column = if right { (bx + 1) % columns } else { bx };
        let row = if below { (by + 1) % rows } else { by };
        let lx = in_x.1 - if right { edge } else { 0 };
        let ly = in_y.1 - if below { edge } else { 0 };
        Place { patch_index: (row * columns + column) as u32, x: lx, y: ly }
    };
    let right_of = |place: &Place| place.x >= cut(synthesis, place.patch_index, 0, place.y);
    let below = |place: &Place| place.y >= cut(synthesis, place.patch_index, 1, place.x);
    if near_right && near_below {
        let diagonal = neighbour(true, true);
        if right_of(&diagonal) && below(&diagonal) {
            return diagonal;
        }
    }
    if near_below {
        let lower = neighbour(false, true);
        if below(&lower) {
            return lower;
        }
    }
    if near_right {
        let beside = neighbour(true, false);
        if right_of(&beside) {
            return beside;
        }
    }
    neighbour(false, false)
}
