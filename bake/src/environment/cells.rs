//! Random words of a place on a surface, f32, as in WGSL: what a pixel's draw reads, so that glints stay put when the
//! camera moves.
//!
//! Paper: Kneiphof and Klein 2025, section 3.3, which takes the grids of Deliot and Belcour 2023: facets are shared among
//! the corners of a grid over places and footprints, each corner draws, and the counts are interpolated. Deviations:
//! - One draw a pixel instead of one a corner. What is interpolated is its random word: each corner has an exponential
//!   number E of rate 1, and the least E / w under weights w that add up to 1 is an exponential number of rate 1
//!   again. So the word of any place is uniform and counts have the distribution of the pixel's facets at every place: neither
//!   mean nor contrast shows the grid. Interpolated counts vary less between corners than at them.
//! - The word is a continuous function of place and footprint; that a rare facet is lit depends on a single
//!   corner, around which its glint is a spot of about a pixel. The spot's rim is sharp.
//! - Corners are those of a triangle grid (simplices, as in the paper) at two levels around the pixel's size. Orientation and
//!   ratio of the footprint have no grid: where a pixel is long on the surface, its words are those of a square pixel of the
//!   same area.

use crate::counting::normal::unit_from_bits;
use crate::counting::pow1m::{Native, one_minus_exp};
use crate::dictionary::hash::{CellState, cell_state, draw_bits, mix_bits};
use glam::Vec2;
use glint_formats::environment::MAX_LEVELS;

/// Corners that a place lies between: three at either level.
pub const CORNERS: usize = 6;
/// Largest |level|; the edge of a cell is 2^level surface units.
pub const MAX_LEVEL: f32 = 24.0;
/// Most facets of a draw.
pub const MAX_FACETS: f32 = 1e16;
/// (√3 − 1) / 2, which makes the triangles of a skewed square grid equilateral.
const SKEW: f32 = 0.366_025_4;
/// Least weight of a corner: a place on an edge would divide by zero.
const LEAST_WEIGHT: f32 = 1e-12;
/// Longest derivative that counts, so that areas are finite.
const LONGEST: f32 = 1e15;
/// Cells beyond this are clamped.
const FARTHEST: f32 = 1e9;

/// The corners around a place, as their random states, and one over the weight of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCells {
    /// Random states.
    pub states: [CellState; CORNERS],
    /// 1 / weight; the weights add up to 1.
    pub inverse_weights: [f32; CORNERS],
}

/// Area of a pixel whose place changes by `d_dx` and `d_dy` along the screen's axes, in square surface units.
pub fn footprint_area(d_dx: Vec2, d_dy: Vec2) -> f32 {
    let limit = Vec2::splat(LONGEST);
    let (dx, dy) = (d_dx.clamp(-limit, limit), d_dy.clamp(-limit, limit));
    (dx.x * dy.y - dx.y * dy.x).abs()
}

/// Level at which cells have the pixel's area, ½ log₂ `area`.
pub fn surface_lod(area: f32) -> f32 {
    (0.5 * area.max(1e-20).log2()).clamp(-MAX_LEVEL, MAX_LEVEL - 1.0)
}

/// Facets under a pixel of `area` at `density` facets a unit.
pub fn footprint_facets(area: f32, density: f32) -> f32 {
    (area * density).clamp(0.0, MAX_FACETS)
}

/// Sets the three corners of one level from `first` on; `share` is the level's weight.
fn set_level(cells: &mut SurfaceCells, first: usize, position: Vec2, level: i32, share: f32, seed: u32) {
    // 2^-level, exactly.
    let scale = f32::from_bits(((127 - level) as u32) << 23);
    let p = (position * scale).clamp(Vec2::splat(-FARTHEST), Vec2::splat(FARTHEST));
    let q = p + Vec2::splat((p.x + p.y) * SKEW);
    let base = q.floor();
    let f = q - base;
    let (x, y) = (base.x as i32 as u32, base.y as i32 as u32);
    let below = f.x > f.y;
    let (high, low) = if below { (f.x, f.y) } else { (f.y, f.x) };
    let (dx, dy) = if below { (1, 0) } else { (0, 1) };
    let seed = seed ^ mix_bits(level as u32);
    let corners = [(0, 0, 1.0 - high), (dx, dy, high - low), (1, 1, low)];
    for (i, (dx, dy, weight)) in corners.into_iter().enumerate() {
        cells.states[first + i] = cell_state(x.wrapping_add(dx), y.wrapping_add(dy), seed);
        cells.inverse_weights[first + i] = 1.0 / (weight * share).max(LEAST_WEIGHT);
    }
}

/// The corners around `position` (surface units) for a pixel of level `lod` ([`surface_lod`]).
pub fn surface_cells(position: Vec2, lod: f32, seed: u32) -> SurfaceCells {
    let fine = lod.floor();
    let blend = lod - fine;
    let mut cells = SurfaceCells { states: [CellState { a: 0, b: 0 }; CORNERS], inverse_weights: [1.0; CORNERS] };
    set_level(&mut cells, 0, position, fine as i32, 1.0 - blend, seed);
    set_level(&mut cells, 3, position, fine as i32 + 1, blend, seed);
    cells
}

/// −ln(1 − h) for h in (0, 1), off by 1e-6 of itself: small h keep their digits, which a shader's log would not.
pub fn exponential(h: f32) -> f32 {
    if h > 0.5 {
        return -(1.0 - h).ln();
    }
    let high = 0.187_202_24 + h * (0.524_013_5 + h * (-0.640_168_6 + h * 0.992_075_7));
    h * (1.000_001 + h * (0.499_815_08 + h * (0.338_949_9 + h * high)))
}

/// Word `index` of a place: uniform, and small where a corner has a rare number.
pub fn surface_word(cells: &SurfaceCells, index: u32) -> u32 {
    let mut least = f32::MAX;
    for (state, inverse) in cells.states.iter().zip(cells.inverse_weights) {
        least = least.min(exponential(unit_from_bits(draw_bits(*state, index))) * inverse);
    }
    let u = one_minus_exp(&Native, least);
    // The largest f32 below 2³², so that the conversion cannot overflow.
    (u * 4_294_967_296.0).min(4_294_967_040.0) as u32
}

/// The words that [`multinomial`](crate::counting::multinomial()) reads for `leaves` leaves of its tree.
///
/// Its words are small where the facet of a fraction is there, and large where the brighter branch of a node, the right
/// one, gets more: so rare bright facets are the spots.
pub fn surface_words(cells: &SurfaceCells, leaves: usize) -> [u32; MAX_LEVELS] {
    let mut words = [0; MAX_LEVELS];
    for (index, word) in words.iter_mut().enumerate().take(leaves) {
        let small = surface_word(cells, index as u32);
        *word = if index == 0 { small } else { !small };
    }
    words
}
