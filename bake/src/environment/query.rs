//! Random words of a place on a surface, f32, as in `query.wgsl`: what a pixel's draw reads, so that glints stay put when the
//! camera moves.
//!
//! Paper: Kneiphof and Klein 2025, section 3.3, which takes the grids of Deliot and Belcour 2023: facets are shared among
//! the corners of a grid over places and footprints, each corner draws, and the counts are interpolated. Deviations:
//! - One draw a pixel instead of one a corner. What is interpolated is its random word: each corner has a uniform number h,
//!   and x is the least h / w under weights w that add up to 1. P(x > t) = ∏ (1 − w t), so 1 − ∏ (1 − w x) is a uniform number
//!   again. So the word of any place is uniform and counts have the distribution of the pixel's facets at every place: neither
//!   mean nor contrast shows the grid. Interpolated counts vary less between corners than at them.
//! - The word is a continuous function of place and footprint; that a rare facet is lit depends on a single
//!   corner, around which its glint is a spot of about a pixel. The spot's rim is sharp.
//! - Corners are those of a triangle grid at the two levels around the pixel's size, of which a place between the levels takes
//!   the four of a tetrahedron (simplices, as in the paper). Orientation and
//!   ratio of the footprint have no grid: where a pixel is long on the surface, its words are those of a square pixel of the
//!   same area.

use crate::hash::{CellState, mix_bits};
use glam::Vec2;
use glint_formats::environment::MAX_LEVELS;

/// Corners that a place lies between, on two levels.
const CORNERS: usize = 4;
/// Largest |level|; the edge of a cell is 2^level surface units.
const SURFACE_MAX_LEVEL: f32 = 24.0;
/// Most facets of a draw.
const MAX_FACETS: f32 = 1e16;
/// (√3 − 1) / 2, which makes the triangles of a skewed square grid equilateral.
const SKEW: f32 = 0.366_025_4;
/// Least weight of a corner: a place on an edge would divide by zero.
const LEAST_WEIGHT: f32 = 1e-12;
/// Longest derivative that counts, so that areas are finite.
const LONGEST: f32 = 1e15;
/// Cells beyond this are clamped.
const FARTHEST: f32 = 5e8;

/// The corners around a place, as their random states, and their weights, which add up to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCells {
    /// Random states.
    pub states: [CellState; CORNERS],
    /// 2⁻³² / weight.
    pub inverse_weights: [f32; CORNERS],
    /// Sums of the products of two, three and four weights.
    pub sums: [f32; 3],
}

/// Area of a pixel whose place changes by `d_dx` and `d_dy` along the screen's axes, in square surface units.
pub fn footprint_area(d_dx: Vec2, d_dy: Vec2) -> f32 {
    let limit = Vec2::splat(LONGEST);
    let (dx, dy) = (d_dx.clamp(-limit, limit), d_dy.clamp(-limit, limit));
    (dx.x * dy.y - dx.y * dy.x).abs()
}

/// Level at which cells have the pixel's area, ½ log₂ `area` from the bits of an f32: exact at powers of two and straight between them, at
/// most 0.05 less than the logarithm.
pub fn surface_lod(area: f32) -> f32 {
    let logarithm = area.max(1e-20).to_bits() as f32 * (1.0 / 8_388_608.0) - 127.0;
    (0.5 * logarithm).clamp(-SURFACE_MAX_LEVEL, SURFACE_MAX_LEVEL - 1.0)
}

/// Facets under a pixel of `area` at `density` facets a unit.
pub fn footprint_facets(area: f32, density: f32) -> f32 {
    (area * density).clamp(0.0, MAX_FACETS)
}

/// Mixes 32 bits in one round, a bijection: enough for the upper bits of sums of random numbers.
fn surface_mix(value: u32) -> u32 {
    let v = (value ^ (value >> 16)).wrapping_mul(0xbb67_ae85);
    v ^ (v >> 15)
}

/// Random state of the corner `offset` from `base` on the fine or the coarse grid: two Feistel rounds, a bijection of the
/// place. That of neighbours differs, and each draw mixes once more.
fn surface_corner(base: [i32; 2], offset: [i32; 2], coarse: bool, seeds: [u32; 2]) -> CellState {
    let scale = if coarse { 1 } else { 2 };
    let at = [0, 1].map(|i| base[i].wrapping_mul(scale).wrapping_add(offset[i]) as u32);
    let seed = if coarse { seeds[1] } else { seeds[0] };
    let a = at[0].wrapping_add(surface_mix(at[1].wrapping_add(seed)));
    CellState { a, b: at[1].wrapping_add(surface_mix(a ^ seed)) }
}

/// 32 random bits of a corner, draw `index`. Half a round is enough: what it leaves the lower bits unmixed with, the upper ones, is
/// mixed into these.
pub fn surface_bits(state: CellState, index: u32) -> u32 {
    let value = state.a.wrapping_add((state.b | 1).wrapping_mul(index.wrapping_add(1)));
    (value ^ (value >> 16)).wrapping_mul(0xbb67_ae85)
}

/// Seed of a level's grid. Surfaces are numbered one after the other: less mixed seeds showed as a shift of the mean over a thousand.
fn surface_seed(level: i32, seed: u32) -> u32 {
    mix_bits(seed.wrapping_add((level as u32).wrapping_mul(0x9e37_79b9)))
}

/// The corners around `position` (surface units) for a pixel of level `lod` ([`surface_lod`]).
///
/// A triangle ABC of the coarse grid is four of the fine one, cut at the middles D of AB, E of BC and F of CA. Between the
/// levels, with coarse corners A′, B′ and C′ above A, B and C, lie the tetrahedra ADFA′, BDEB′ and CEFC′, and an octahedron
/// that is cut into four around its diagonal DC′. Weights are linear in each, so they are continuous.
pub fn surface_cells(position: Vec2, lod: f32, seed: u32) -> SurfaceCells {
    let fine = lod.floor();
    let t = lod - fine;
    let level = fine as i32;
    // 2^-(level + 1), exactly.
    let scale = f32::from_bits(((126 - level) as u32) << 23);
    let p = (position * scale).clamp(Vec2::splat(-FARTHEST), Vec2::splat(FARTHEST));
    let q = p + Vec2::splat((p.x + p.y) * SKEW);
    let whole = q.floor();
    let f = q - whole;
    let base = [whole.x as i32, whole.y as i32];
    let along = if f.x > f.y { [1, 0] } else { [0, 1] };
    // Twice the barycentric coordinates in the coarse triangle, whose corner B is the nearer one of the square's other two.
    let c2 = 2.0 * f.x.min(f.y);
    let a2 = 2.0 - 2.0 * f.x.max(f.y);
    let b2 = 2.0 - a2 - c2;
    let rest = 1.0 - t;
    let (alpha, beta, gamma) = (a2 - rest, b2 - rest, c2 - rest);
    let (near_a, near_b, near_c) = (alpha >= 2.0 * t, beta >= 2.0 * t, gamma >= 2.0 * t);
    let (coarse_a, coarse_b) = (alpha >= 0.0, beta >= 0.0);
    // Weights of A′, B′, E and F in the octahedron.
    let (wa, wb) = ((0.5 * alpha).clamp(0.0, t), (0.5 * beta).clamp(0.0, t));
    let (we, wf) = ((-alpha).max(0.0), (-beta).max(0.0));
    let (beyond, twice) = ([1 + along[0], 1 + along[1]], [2 * along[0], 2 * along[1]]);
    let seeds = [surface_seed(level, seed), surface_seed(level + 1, seed)];
    // Offset, whether it is a coarse corner, weight: E or A′, F or B′, C′ or A or B, D or C.
    let corners = [
        if coarse_a {
            ([0, 0], true, wa)
        } else if near_b {
            (beyond, false, c2)
        } else if near_c {
            (beyond, false, b2)
        } else {
            (beyond, false, we)
        },
        if coarse_b {
            (along, true, wb)
        } else if near_a {
            ([1, 1], false, c2)
        } else if near_c {
            ([1, 1], false, a2)
        } else {
            ([1, 1], false, wf)
        },
        if near_b {
            (twice, false, beta - 2.0 * t)
        } else if near_a {
            ([0, 0], false, alpha - 2.0 * t)
        } else {
            ([1, 1], true, t - wa - wb)
        },
        if near_b {
            (along, false, a2)
        } else if near_a {
            (along, false, b2)
        } else if near_c {
            ([2, 2], false, gamma - 2.0 * t)
        } else {
            (along, false, rest - we - wf)
        },
    ];
    let weights = corners.map(|(_, _, weight)| weight.max(LEAST_WEIGHT));
    let pairs = [weights[0] + weights[1], weights[2] + weights[3]];
    let products = [weights[0] * weights[1], weights[2] * weights[3]];
    let inverse = products.map(|product| (1.0 / 4_294_967_296.0) / product);
    SurfaceCells {
        states: corners.map(|(offset, coarse, _)| surface_corner(base, offset, coarse, seeds)),
        inverse_weights: [
            weights[1] * inverse[0],
            weights[0] * inverse[0],
            weights[3] * inverse[1],
            weights[2] * inverse[1],
        ],
        sums: [
            products[0] + products[1] + pairs[0] * pairs[1],
            products[0] * pairs[1] + products[1] * pairs[0],
            products[0] * products[1],
        ],
    }
}

/// Word `index` of a place, from above 0 to 1: uniform, and small where a corner has a rare number.
pub fn surface_word(cells: &SurfaceCells, index: u32) -> f32 {
    let all = cells.states.iter().zip(cells.inverse_weights);
    let least = all.map(|(state, inverse)| surface_bits(*state, index) as f32 * inverse).fold(f32::INFINITY, f32::min);
    // Half a step of each corner's word: the least is a corner's as often as its weight says, and was divided by it.
    let x = least + 1.0 / 2_147_483_648.0;
    let [two, three, four] = cells.sums;
    // 1 − ∏ (1 − w x) by its terms, so that small ones keep their digits.
    x * (1.0 - x * (two - x * (three - x * four)))
}

/// The words that [`multinomial`](crate::counting::multinomial()) reads for `leaves` leaves of its tree: rare bright facets are where a
/// corner has a rare number.
pub fn surface_words(cells: &SurfaceCells, leaves: usize) -> [f32; MAX_LEVELS] {
    let mut words = [0.0; MAX_LEVELS];
    for (index, word) in words.iter_mut().enumerate().take(leaves) {
        *word = surface_word(cells, index as u32);
    }
    words
}
