//! Look-up in corner tiles: integer twin of the WGSL of the same names, see [`super::tiles`] for what they are.

use super::Synthesis;
use super::eval::Place;
use crate::hash::{cell_state, draw_bits};

/// Layout of corner tiles.
#[derive(Clone, Copy)]
pub(super) struct Tiles {
    pub colours: u32,
    pub variants: u32,
    pub margin: i32,
    pub hash_seed: u32,
}

/// Uniform in 0 … n − 1 (n ≤ 65536) from random bits.
fn below(bits: u32, n: u32) -> u32 {
    ((bits >> 16) * n) >> 16
}

/// Colour of the corner (i, j) of the lattice of tiles.
pub(super) fn corner_colour(i: i32, j: i32, tiles: Tiles) -> u32 {
    below(draw_bits(cell_state(i as u32, j as u32, tiles.hash_seed), 0), tiles.colours)
}

/// Number of a tile by its corners' colours and its variant; the first tile's is 0.
pub(super) fn tile_index(corners: [u32; 4], variant: u32, tiles: Tiles) -> u32 {
    let c = tiles.colours;
    (corners[0] + c * (corners[1] + c * (corners[2] + c * corners[3]))) * tiles.variants + variant
}

/// The patch that shows a texel, and where it lies in it.
pub(super) fn tile_source(surface: &Synthesis, tiles: Tiles, x: i32, y: i32) -> Place {
    let edge = surface.params.patch as i32;
    let (tx, ty) = (x.div_euclid(edge), y.div_euclid(edge));
    let (lx, ly) = (x.rem_euclid(edge), y.rem_euclid(edge));
    let corners = [
        corner_colour(tx, ty, tiles),
        corner_colour(tx.wrapping_add(1), ty, tiles),
        corner_colour(tx, ty.wrapping_add(1), tiles),
        corner_colour(tx.wrapping_add(1), ty.wrapping_add(1), tiles),
    ];
    let variant = below(draw_bits(cell_state(tx as u32, ty as u32, tiles.hash_seed), 1), tiles.variants);
    let tile = tile_index(corners, variant, tiles);
    if in_middle(surface, tiles, tile, lx, ly) {
        return Place { patch: tiles.colours + tile, x: lx, y: ly };
    }
    corner_place(surface, tiles, corners, lx, ly)
}

/// Whether the middle patch shows texel (x, y) of its tile.
fn in_middle(surface: &Synthesis, tiles: Tiles, tile: u32, x: i32, y: i32) -> bool {
    let shape = surface.params.middle_path(tiles.margin as u32);
    let (near, far) = (tiles.margin, surface.params.patch as i32 - tiles.margin);
    if x < near || y < near || x >= far || y >= far {
        return false;
    }
    let (overlap, words) = (surface.params.overlap as i32, shape.words);
    let pairs = surface.params.colour_path(tiles.margin as u32).words * 2 * tiles.colours * tiles.colours;
    let first = pairs + tile * 4 * words;
    // Texels from the border of the middle patch, and the cut there: left, upper, right, lower.
    let inside = |side: u32, depth: i32, along: i32| {
        depth >= overlap || depth >= surface.path_entry(first + side * words, shape, (along - near) as u32) as i32
    };
    inside(0, x - near, y) && inside(1, y - near, x) && inside(2, far - 1 - x, y) && inside(3, far - 1 - y, x)
}

/// The corner patch that shows texel (x, y) of a tile outside its middle. A corner patch has its middle at the corner.
fn corner_place(surface: &Synthesis, tiles: Tiles, corners: [u32; 4], x: i32, y: i32) -> Place {
    let half = surface.params.patch as i32 / 2;
    let row = u32::from(y >= half);
    let column = u32::from(x >= half);
    let (left, right) = (corners[2 * row as usize], corners[2 * row as usize + 1]);
    let (top, bottom) = (corners[column as usize], corners[column as usize + 2]);
    let column = if column == 0 && x - half >= pair_cut(surface, tiles, [left, right], 0, y) { 1 } else { column };
    let row = if row == 0 && y - half >= pair_cut(surface, tiles, [top, bottom], 1, x) { 1 } else { row };
    let local = |v: i32, second: u32| if second == 1 { v - half } else { v + half };
    Place { patch: corners[(2 * row + column) as usize], x: local(x, column), y: local(y, row) }
}

/// Where the second of two corner patches begins, from the middle of the tile's edge on, at the tile's row (column)
/// `along`; 0 away from the edge, where middle patches lie.
fn pair_cut(surface: &Synthesis, tiles: Tiles, pair: [u32; 2], which: u32, along: i32) -> i32 {
    let shape = surface.params.colour_path(tiles.margin as u32);
    let (edge, overlap) = (surface.params.patch as i32, surface.params.overlap as i32);
    let reach = tiles.margin + overlap;
    let k = if along < reach { along + reach } else { along + reach - edge };
    if along >= reach && along < edge - reach {
        return 0;
    }
    let first = ((pair[0] * tiles.colours + pair[1]) * 2 + which) * shape.words;
    surface.path_entry(first, shape, k as u32) as i32 - overlap
}
