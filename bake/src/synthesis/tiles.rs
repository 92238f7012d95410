//! Corner tiles, a surface without end: one of the two arrangements. Integer twin of `tiles.wgsl`; `corner_tiles.rs` says
//! what they are.

use super::baked::Synthesis;
use super::paths::{Place, floor_div, path_entry};
use crate::hash::{cell_state, draw_bits};

/// Uniform in 0 … n − 1 (n ≤ 65536) from random bits.
fn below(bits: u32, n: u32) -> u32 {
    ((bits >> 16) * n) >> 16
}

/// Colour of the corner (i, j) of the lattice of tiles.
fn corner_colour(synthesis: &Synthesis, i: i32, j: i32) -> u32 {
    let state = cell_state(i as u32, j as u32, synthesis.uniform.hash_seed);
    below(draw_bits(state, 0), synthesis.uniform.colours)
}

/// Whether the middle patch's path on one side of a tile leaves it a texel that lies `depth` texels inside.
fn inside(synthesis: &Synthesis, first: u32, depth: i32, along: i32) -> bool {
    if depth >= synthesis.uniform.overlap as i32 {
        return true;
    }
    depth >= path_entry(synthesis, first, (along - synthesis.uniform.margin as i32) as u32)
}

/// Whether the middle patch shows texel (x, y) of its tile.
fn in_middle(synthesis: &Synthesis, tile: u32, x: i32, y: i32) -> bool {
    let uniform = &synthesis.uniform;
    let near = uniform.margin as i32;
    let far = uniform.patch_texels as i32 - near;
    if x < near || y < near || x >= far || y >= far {
        return false;
    }
    let words = uniform.path_words;
    let pairs = uniform.colour_path_words * 2 * uniform.colours * uniform.colours;
    let first = pairs + tile * 4 * words;
    inside(synthesis, first, x - near, y)
        && inside(synthesis, first + words, y - near, x)
        && inside(synthesis, first + 2 * words, far - 1 - x, y)
        && inside(synthesis, first + 3 * words, far - 1 - y, x)
}

/// Where the second of two corner patches begins, from the middle of the tile's edge on, at the tile's row (column)
/// `along`; 0 away from the edge, where middle patches lie.
fn pair_cut(synthesis: &Synthesis, a: u32, b: u32, which: u32, along: i32) -> i32 {
    let uniform = &synthesis.uniform;
    let edge = uniform.patch_texels as i32;
    let reach = (uniform.margin + uniform.overlap) as i32;
    if along >= reach && along < edge - reach {
        return 0;
    }
    let k = if along < reach { along + reach } else { along + reach - edge };
    let first = ((a * uniform.colours + b) * 2 + which) * uniform.colour_path_words;
    path_entry(synthesis, first, k as u32) - uniform.overlap as i32
}

/// The corner patch that shows texel (x, y) of a tile outside its middle. A corner patch has its middle at the corner.
fn corner_place(synthesis: &Synthesis, corners: [u32; 4], x: i32, y: i32) -> Place {
    let half = synthesis.uniform.patch_texels as i32 / 2;
    let down = y >= half;
    let far = x >= half;
    let [upper_left, upper_right, lower_left, lower_right] = corners;
    let (mut column, mut row) = (far, down);
    if !far {
        let pair = if down { [lower_left, lower_right] } else { [upper_left, upper_right] };
        column = x - half >= pair_cut(synthesis, pair[0], pair[1], 0, y);
    }
    if !down {
        let pair = if far { [upper_right, lower_right] } else { [upper_left, lower_left] };
        row = y - half >= pair_cut(synthesis, pair[0], pair[1], 1, x);
    }
    let of_row = if row { [lower_left, lower_right] } else { [upper_left, upper_right] };
    Place {
        patch_index: of_row[usize::from(column)],
        x: if column { x - half } else { x + half },
        y: if row { y - half } else { y + half },
    }
}

/// The patch that shows a texel.
pub(super) fn place(synthesis: &Synthesis, x: i32, y: i32) -> Place {
    let uniform = &synthesis.uniform;
    let edge = uniform.patch_texels as i32;
    let (in_x, in_y) = (floor_div(x, edge), floor_div(y, edge));
    let (tx, ty) = (in_x.0, in_y.0);
    let corners = [
        corner_colour(synthesis, tx, ty),
        corner_colour(synthesis, tx.wrapping_add(1), ty),
        corner_colour(synthesis, tx, ty.wrapping_add(1)),
        corner_colour(synthesis, tx.wrapping_add(1), ty.wrapping_add(1)),
    ];
    let state = cell_state(tx as u32, ty as u32, uniform.hash_seed);
    let variant_index = below(draw_bits(state, 1), uniform.variants);
    let c = uniform.colours;
    let tile = (corners[0] + c * (corners[1] + c * (corners[2] + c * corners[3]))) * uniform.variants + variant_index;
    if in_middle(synthesis, tile, in_x.1, in_y.1) {
        return Place { patch_index: c + tile, x: in_x.1, y: in_y.1 };
    }
    corner_place(synthesis, corners, in_x.1, in_y.1)
}
