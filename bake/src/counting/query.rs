//! The facets that a pixel sees, as the random state of one cell of the surface: what its draws read, so that glints stay put when the
//! camera moves. f32; twin: `query.wgsl`.
//!
//! Paper: Kneiphof and Klein 2025, section 3.3, which takes the grids of Deliot and Belcour 2023: facets are shared among the corners of
//! grids over places, sizes, ratios and directions of footprints, each corner draws, and the counts are interpolated. Deviations:
//! - One cell and one draw a pixel. Every place has one cell, a box as large, as long and turned as the pixel's footprint there, so
//!   counts have exactly the distribution of the pixel's facets: neither mean nor contrast shows a grid, as interpolated counts do,
//!   which vary less between corners than at them.
//! - Sizes are powers of two, ratios too, directions a few by ratio ([`sectors`]). Which of two neighbours of the scale holds is decided
//!   by place, against a random threshold: for sizes box by box of the coarser one, four of the finer, so that grains of both lie mixed;
//!   for ratios and directions patch by patch, each many pixels wide ([`patch_state`]). So a zoom or a turn exchanges few cells at a
//!   time, here and there. Thresholds of sizes and directions lie between ¼ and ¾: a wider range blurs the box, a narrower one exchanges
//!   whole pictures.
//! - What a pixel keeps of its facets when it moves is what a box as long as its footprint keeps, at any ratio.
//! - Directions of light have cells, too ([`angle_state`]), with a random offset for each cell of the surface, so that facets come and
//!   go one by one when the light or the eye turns. The paper leaves them out.
//! - Surfaces without uv are seen along the axis that their normal is near to, decided patch by patch ([`facing_plane`]).

use super::eval::{MAX_LEVELS, unit_from_bits};
use crate::footprint::pixel_axes;
use crate::hash::{CellState, mix_bits};
use glam::{IVec2, IVec3, Vec2, Vec3};

/// Largest |level|; the shorter edge of a cell is 2^level surface units.
const COARSEST_FACET_LEVEL: f32 = 24.0;
/// Longest cells: 2 to this times as long as wide.
const MAX_RATIO_LEVEL: f32 = 6.0;
/// Longest derivative that counts, so that squares of squares are finite.
const LONGEST: f32 = 1e8;
/// Cells beyond this are clamped.
const FARTHEST: f32 = 5e8;
/// Most facets of a draw.
const MAX_FACETS: f32 = 1e16;
/// Patches are this many levels coarser than the cells at least, and up to three more: their size changes every fourth level only.
const PATCH_LEVELS: i32 = 5;
/// Directions of cells over their ratio, before rounding; they are 3 for cells twice as long as wide, then 5, 11, 22, 44, 88.
const SECTORS: f32 = 1.375;
/// How square cells are turned, cosine and sine: not along the axes, where the pixels of most pictures would meet them in rows.
const SQUARE_TURN: Vec2 = Vec2::new(0.894_427_2, 0.447_213_6);
/// Step of seeds between levels: 2³² over the golden ratio, odd.
const LEVEL_STEP: u32 = 0x9e37_79b9;
/// Draw of a cell's threshold, beyond those of the counts.
const THRESHOLD_DRAW: u32 = 30;
/// Draw of the offset of a cell's directions.
const OFFSET_DRAW: u32 = 31;

/// A pixel's footprint as a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootprintBox {
    /// log₂ of its shorter edge in surface units, −24 to 23.
    pub lod: f32,
    /// log₂ of its longer edge over the shorter, 0 to 6.
    pub ratio: f32,
    /// Direction of its longer edge: twice its angle, in quarter turns, 0 to 4.
    pub turn: f32,
}

/// A surface in space as its facets see it: a plane along two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacingPlane {
    /// Place in the plane.
    pub position: Vec2,
    /// Derivatives of the place along the screen's axes, a pixel.
    pub d_dx: Vec2,
    /// The second of them.
    pub d_dy: Vec2,
    /// Seed of the plane: the facets of three planes have nothing in common.
    pub seed: u32,
    /// Area of a pixel on the surface over that in the plane, from 1: a factor on the density of facets.
    pub area_ratio: f32,
}

/// Area of a pixel whose place changes by `d_dx` and `d_dy` along the screen's axes, in square surface units.
pub fn footprint_area(d_dx: Vec2, d_dy: Vec2) -> f32 {
    let limit = Vec2::splat(LONGEST);
    let (dx, dy) = (d_dx.clamp(-limit, limit), d_dy.clamp(-limit, limit));
    (dx.x * dy.y - dx.y * dy.x).abs()
}

/// Facets under a pixel of `area` at `density` facets a unit.
pub fn footprint_facets(area: f32, density: f32) -> f32 {
    (area * density).clamp(0.0, MAX_FACETS)
}

/// log₂ of x > 0 from the bits of an f32: exact at powers of two and straight between them, at most 0.09 less than the logarithm.
fn quick_log2(x: f32) -> f32 {
    x.to_bits() as f32 * (1.0 / 8_388_608.0) - 127.0
}

/// Box of the pixel whose place changes by `d_dx` and `d_dy`: area, length and direction are those of the pixel's parallelogram, up to
/// 64 : 1, beyond which it is wider.
pub fn footprint_box(d_dx: Vec2, d_dy: Vec2) -> FootprintBox {
    let axes = pixel_axes(d_dx, d_dy);
    let major2 = axes.major2.max(1e-14);
    let minor2 = axes.minor2.max(major2 * (1.0 / 4096.0));
    let lod = (0.5 * quick_log2(minor2)).clamp(-COARSEST_FACET_LEVEL, COARSEST_FACET_LEVEL - 1.0);
    let ratio = (0.5 * quick_log2(major2) - lod).clamp(0.0, MAX_RATIO_LEVEL);
    let twice = axes.difference;
    let around = twice.x.abs() + twice.y.abs();
    let along = if around > 0.0 { twice.x / around } else { 1.0 };
    let quarters = half_turn(along);
    FootprintBox { lod, ratio, turn: if twice.y >= 0.0 { quarters } else { 4.0 - quarters } }
}

/// Angle of the vector (x, 1 − |x|), in quarter turns from (1, 0) on, 0 to 2, to 5e-4: from the middle of its quarter it is an arc tangent.
fn half_turn(x: f32) -> f32 {
    let t = 1.0 - 2.0 * x.abs();
    let t2 = t * t;
    let arc = t * (0.633_288 - t2 * (0.181_715 - t2 * 0.048_427));
    if x >= 0.0 { 0.5 + arc } else { 1.5 - arc }
}

/// Mixes 32 bits in one round, a bijection: enough for the upper bits of sums of random numbers.
fn cell_mix(value: u32) -> u32 {
    let v = (value ^ (value >> 16)).wrapping_mul(0xbb67_ae85);
    v ^ (v >> 15)
}

/// State of a cell of a grid: two Feistel rounds, a bijection of the place. Each draw mixes once more.
fn grid_state(at: IVec2, key: u32) -> CellState {
    let (x, y) = (at.x as u32, at.y as u32);
    let a = x.wrapping_add(cell_mix(y.wrapping_add(key)));
    CellState { a, b: y.wrapping_add(cell_mix(a ^ key)) }
}

/// 32 random bits of a cell, draw `index`. Half a round is enough: what it leaves the lower bits unmixed with, the upper ones, is
/// mixed into these.
pub fn cell_bits(state: CellState, index: u32) -> u32 {
    let value = state.a.wrapping_add((state.b | 1).wrapping_mul(index.wrapping_add(1)));
    (value ^ (value >> 16)).wrapping_mul(0xbb67_ae85)
}

/// A uniform number in [0, 1) of the upper 16 of these bits.
fn cell_unit(bits: u32) -> f32 {
    (bits >> 16) as f32 * (1.0 / 65_536.0)
}

/// A threshold, ¼ to ¾, of a uniform number.
fn threshold(unit: f32) -> f32 {
    0.25 + 0.5 * unit
}

/// 2^−level, exactly.
fn level_scale(level: i32) -> f32 {
    f32::from_bits(((127 - level) as u32) << 23)
}

/// Level of the patches of cells of `level`.
fn patch_level(level: i32) -> i32 {
    // A shift of a negative number rounds down.
    ((level >> 2) << 2) + 3 + PATCH_LEVELS
}

/// Random state of the patch that a place lies in, in which cells of `level` choose between ratios and directions alike.
fn patch_state(position: Vec2, level: i32, seed: u32) -> CellState {
    let patch = patch_level(level);
    let place = (position * level_scale(patch)).clamp(Vec2::splat(-FARTHEST), Vec2::splat(FARTHEST));
    grid_state(place.floor().as_ivec2(), mix_bits(seed.wrapping_add((patch as u32).wrapping_mul(LEVEL_STEP))))
}

/// Directions of cells 2^`ratio` times as long as wide, over half a turn.
///
/// A turn by δ exchanges δ · sectors / π of the cells, where boxes that turn lose δ · ratio / 4: more directions would exchange more than
/// twice as many, and fewer lie across their footprints.
fn sectors(ratio: f32) -> f32 {
    (SECTORS * level_scale(-(ratio as i32)) + 0.25).floor()
}

/// Cosine and sine, to 6e-4, of half the angle `turn`, see [`FootprintBox::turn`].
fn turn_direction(turn: f32) -> Vec2 {
    let h = 2.0 - turn;
    let h2 = h * h;
    Vec2::new(h * (0.785_160 - h2 * (0.080_265 - h2 * 0.002_245_7)), 0.999_404 - h2 * (0.305_702 - h2 * 0.014_000_4))
}

/// Random state of the cell of a pixel's facets: `footprint` around `position` (surface units) of the surface `seed`.
pub fn facet_cell(footprint: FootprintBox, position: Vec2, seed: u32) -> CellState {
    let whole = footprint.lod.floor();
    let level = whole as i32;
    let patch = patch_state(position, level, seed);
    let ratio = (footprint.ratio + cell_unit(cell_bits(patch, 0))).floor().min(MAX_RATIO_LEVEL);
    let count = sectors(ratio);
    let number = (footprint.turn * 0.25 * count + threshold(cell_unit(cell_bits(patch, 1)))).floor();
    let sector = if number < count { number } else { 0.0 };
    let is_square = ratio < 0.5;
    let along = if is_square { SQUARE_TURN } else { turn_direction(sector * 4.0 / count) };
    let shape = if is_square { 0 } else { ratio as u32 * 256 + sector as u32 };
    let turned = Vec2::new(position.dot(along), along.perp_dot(position));
    let ratio_scale = level_scale(level + ratio as i32);
    let place = turned * Vec2::new(ratio_scale, level_scale(level));
    let at = place.clamp(Vec2::splat(-FARTHEST), Vec2::splat(FARTHEST)).floor().as_ivec2();
    let key = mix_bits(seed.wrapping_add(shape)).wrapping_add((level as u32).wrapping_mul(LEVEL_STEP));
    let coarse = grid_state(at >> 1, key.wrapping_add(LEVEL_STEP));
    let is_coarse = footprint.lod - whole > threshold(cell_unit(cell_bits(coarse, THRESHOLD_DRAW)));
    if is_coarse { coarse } else { grid_state(at, key) }
}

/// State of a cell's facets towards one direction, `place` in cells of directions: which lattice of such cells holds differs from cell
/// to cell of the surface, so that facets come and go one by one.
pub fn angle_state(state: CellState, place: Vec2) -> CellState {
    let bits = cell_bits(state, OFFSET_DRAW);
    let offset = Vec2::new((bits >> 16) as f32, (bits & 0xffff) as f32) * (1.0 / 65_536.0);
    let at = (place + offset).clamp(Vec2::splat(-FARTHEST), Vec2::splat(FARTHEST)).floor().as_ivec2();
    let number = (at.x as u32).wrapping_mul(LEVEL_STEP).wrapping_add(at.y as u32);
    CellState { a: cell_mix(state.a ^ cell_mix(number.wrapping_add(state.b))), b: state.b }
}

/// Word `index` of a cell, above 0 and below 1.
fn cell_word(state: CellState, index: u32) -> f32 {
    unit_from_bits(cell_bits(state, index))
}

/// The words that [`multinomial`](crate::counting::multinomial()) reads for `leaves` leaves of its tree, above 0 and below 1.
pub fn cell_words(state: CellState, leaves: usize) -> [f32; MAX_LEVELS] {
    let mut words = [0.0; MAX_LEVELS];
    for (index, word) in words.iter_mut().enumerate().take(leaves) {
        *word = cell_word(state, index as u32);
    }
    words
}

/// The part of a vector across axis 0, 1 or 2.
fn plane_part(v: Vec3, axis: u32) -> Vec2 {
    match axis {
        0 => Vec2::new(v.y, v.z),
        1 => Vec2::new(v.z, v.x),
        _ => Vec2::new(v.x, v.y),
    }
}

/// The plane in which a surface in space is seen at `position`, whose derivatives along the screen's axes are `d_dx` and `d_dy`: across
/// the axis that `normal` (unit length) is near to. Where it lies between axes, patches many pixels wide take one of them each, as often as the square of
/// the normal's part along it says.
pub fn facing_plane(position: Vec3, d_dx: Vec3, d_dy: Vec3, normal: Vec3, seed: u32) -> FacingPlane {
    let limit = Vec3::splat(LONGEST);
    let (dx, dy) = (d_dx.clamp(-limit, limit), d_dy.clamp(-limit, limit));
    let front = dx.cross(dy);
    let area = front.length().max(1e-14);
    let lod = 0.5 * quick_log2(area);
    let patch = patch_level(lod.clamp(-COARSEST_FACET_LEVEL, COARSEST_FACET_LEVEL - 1.0).floor() as i32);
    let place = (position * level_scale(patch)).clamp(Vec3::splat(-FARTHEST), Vec3::splat(FARTHEST));
    let at: IVec3 = place.floor().as_ivec3();
    let key = mix_bits(seed.wrapping_add((patch as u32).wrapping_mul(LEVEL_STEP)));
    let state = grid_state(IVec2::new(at.x, at.y), key.wrapping_add(cell_mix((at.z as u32).wrapping_add(key))));
    let chosen = (state.b >> 8) as f32 * (1.0 / 16_777_216.0);
    let shares = normal * normal;
    let axis = if chosen < shares.x {
        0
    } else if chosen < shares.x + shares.y {
        1
    } else {
        2
    };
    FacingPlane {
        position: plane_part(position, axis),
        d_dx: plane_part(dx, axis),
        d_dy: plane_part(dy, axis),
        seed: seed ^ (axis << 30),
        area_ratio: area / front.to_array()[axis as usize].abs().max(1e-3 * area),
    }
}
