// The facets that a pixel sees, as the random state of one cell of the surface: what its draws read, so that glints stay put when the
// camera moves. Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", section 3.3, in place of the grids of Deliot and
// Belcour 2023. Twin of glint-bake-core counting/query.rs, where deviations are derived: a pixel has one cell, a box as large, long and turned
// as its footprint, so that one draw has the distribution of its facets at every place.
//
// Pure functions, no accessors. Places in surface units, those of the density.

#import footprint
#import hash
#import counting::eval

// Largest |level|; the shorter edge of a cell is 2^level surface units.
const GLINT_COARSEST_FACET_LEVEL: f32 = 24.0;
// Longest cells: 2 to this times as long as wide.
const GLINT_MAX_RATIO_LEVEL: f32 = 6.0;
const GLINT_LONGEST: f32 = 1.0e8;
const GLINT_FARTHEST: f32 = 5.0e8;
// Most facets of a draw.
const GLINT_MAX_FACETS: f32 = 1.0e16;
const GLINT_PATCH_LEVELS: i32 = 5;
const GLINT_SECTORS: f32 = 1.375;
const GLINT_SQUARE_TURN: vec2f = vec2f(0.8944272, 0.4472136);
const GLINT_LEVEL_STEP: u32 = 0x9e3779b9u;
const GLINT_THRESHOLD_DRAW: u32 = 30u;
const GLINT_OFFSET_DRAW: u32 = 31u;

// A pixel's footprint as a box.
struct GlintFootprintBox {
    // log2 of its shorter edge in surface units.
    lod: f32,
    // log2 of its longer edge over the shorter.
    ratio: f32,
    // Direction of its longer edge: twice its angle, in quarter turns, 0 to 4.
    turn: f32,
}

// A surface in space as its facets see it: a plane along two axes.
struct GlintFacingPlane {
    position: vec2f,
    // Derivatives of the place along the screen's axes, a pixel.
    d_dx: vec2f,
    d_dy: vec2f,
    seed: u32,
    // Area of a pixel on the surface over that in the plane, from 1: a factor on the density of facets.
    area_ratio: f32,
}

// Area of a pixel whose place changes by `d_dx` and `d_dy` along the screen's axes.
fn glint_footprint_area(d_dx: vec2f, d_dy: vec2f) -> f32 {
    let limit = vec2f(GLINT_LONGEST);
    let dx = clamp(d_dx, -limit, limit);
    let dy = clamp(d_dy, -limit, limit);
    return abs(dx.x * dy.y - dx.y * dy.x);
}

// Facets under a pixel of `area` at `density` facets a unit.
fn glint_footprint_facets(area: f32, density: f32) -> f32 {
    return clamp(area * density, 0.0, GLINT_MAX_FACETS);
}

// log2 of a positive number from the bits of an f32: exact at powers of two and straight between them.
fn glint_quick_log2(x: f32) -> f32 {
    return f32(bitcast<i32>(x)) * (1.0 / 8388608.0) - 127.0;
}

// Box of the pixel whose place changes by `d_dx` and `d_dy`: area, length and direction are those of the pixel's parallelogram, up to
// 64 : 1.
fn glint_footprint_box(d_dx: vec2f, d_dy: vec2f) -> GlintFootprintBox {
    let axes = glint_pixel_axes(d_dx, d_dy);
    let major2 = max(axes.major2, 1.0e-14);
    let minor2 = max(axes.minor2, major2 * (1.0 / 4096.0));
    let lod = clamp(0.5 * glint_quick_log2(minor2), -GLINT_COARSEST_FACET_LEVEL, GLINT_COARSEST_FACET_LEVEL - 1.0);
    let ratio = clamp(0.5 * glint_quick_log2(major2) - lod, 0.0, GLINT_MAX_RATIO_LEVEL);
    let twice = axes.difference;
    let around = abs(twice.x) + abs(twice.y);
    let along = select(1.0, twice.x / around, around > 0.0);
    let quarters = glint_half_turn(along);
    return GlintFootprintBox(lod, ratio, select(4.0 - quarters, quarters, twice.y >= 0.0));
}

// Angle of the vector (x, 1 - |x|), in quarter turns from (1, 0) on, 0 to 2.
fn glint_half_turn(x: f32) -> f32 {
    let t = 1.0 - 2.0 * abs(x);
    let t2 = t * t;
    let arc = t * (0.633288 - t2 * (0.181715 - t2 * 0.048427));
    return select(1.5 - arc, 0.5 + arc, x >= 0.0);
}

// Mixes 32 bits in one round, a bijection: enough for the upper bits of sums of random numbers.
fn glint_cell_mix(value: u32) -> u32 {
    let v = (value ^ (value >> 16u)) * 0xbb67ae85u;
    return v ^ (v >> 15u);
}

// State of a cell of a grid: two Feistel rounds, a bijection of the place.
fn glint_grid_state(at: vec2i, key: u32) -> GlintCellState {
    let place = bitcast<vec2u>(at);
    let a = place.x + glint_cell_mix(place.y + key);
    return GlintCellState(a, place.y + glint_cell_mix(a ^ key));
}

// 32 random bits of a cell, draw `index`. Half a round is enough: what it leaves the lower bits unmixed with, the upper ones, is mixed
// into these.
fn glint_cell_bits(state: GlintCellState, index: u32) -> u32 {
    let value = state.a + (state.b | 1u) * (index + 1u);
    return (value ^ (value >> 16u)) * 0xbb67ae85u;
}

// A uniform number in [0, 1) of the upper 16 of these bits.
fn glint_cell_unit(bits: u32) -> f32 {
    return f32(bits >> 16u) * (1.0 / 65536.0);
}

// A threshold, 1/4 to 3/4, of a uniform number.
fn glint_threshold(unit: f32) -> f32 {
    return 0.25 + 0.5 * unit;
}

// 2^-level, exactly.
fn glint_level_scale(level: i32) -> f32 {
    return bitcast<f32>(u32(127 - level) << 23u);
}

// Level of the patches of cells of `level`.
fn glint_patch_level(level: i32) -> i32 {
    // A shift of a negative number rounds down.
    return ((level >> 2u) << 2u) + 3 + GLINT_PATCH_LEVELS;
}

// Random state of the patch that a place lies in, in which cells of `level` choose between ratios and directions alike.
fn glint_patch_state(position: vec2f, level: i32, seed: u32) -> GlintCellState {
    let patch_number = glint_patch_level(level);
    let place = clamp(position * glint_level_scale(patch_number), vec2f(-GLINT_FARTHEST), vec2f(GLINT_FARTHEST));
    return glint_grid_state(vec2i(floor(place)), glint_mix_bits(seed + bitcast<u32>(patch_number) * GLINT_LEVEL_STEP));
}

// Directions of cells 2^`ratio` times as long as wide, over half a turn.
fn glint_sectors(ratio: f32) -> f32 {
    return floor(GLINT_SECTORS * glint_level_scale(-i32(ratio)) + 0.25);
}

// Cosine and sine of half the angle `turn`.
fn glint_turn_direction(turn: f32) -> vec2f {
    let h = 2.0 - turn;
    let h2 = h * h;
    return vec2f(h * (0.78516 - h2 * (0.080265 - h2 * 2.2457e-3)), 0.999404 - h2 * (0.305702 - h2 * 0.0140004));
}

// Random state of the cell of a pixel's facets: `footprint` around `position` (surface units) of the surface `seed`.
fn glint_facet_cell(footprint: GlintFootprintBox, position: vec2f, seed: u32) -> GlintCellState {
    let whole = floor(footprint.lod);
    let level = i32(whole);
    let chooser = glint_patch_state(position, level, seed);
    let ratio = min(floor(footprint.ratio + glint_cell_unit(glint_cell_bits(chooser, 0u))), GLINT_MAX_RATIO_LEVEL);
    let count = glint_sectors(ratio);
    let number = floor(footprint.turn * 0.25 * count + glint_threshold(glint_cell_unit(glint_cell_bits(chooser, 1u))));
    let sector = select(0.0, number, number < count);
    let is_square = ratio < 0.5;
    let along = select(glint_turn_direction(sector * 4.0 / count), GLINT_SQUARE_TURN, is_square);
    let shape = select(u32(ratio) * 256u + u32(sector), 0u, is_square);
    let turned = vec2f(dot(position, along), along.x * position.y - along.y * position.x);
    let place = turned * vec2f(glint_level_scale(level + i32(ratio)), glint_level_scale(level));
    let at = vec2i(floor(clamp(place, vec2f(-GLINT_FARTHEST), vec2f(GLINT_FARTHEST))));
    let key = glint_mix_bits(seed + shape) + bitcast<u32>(level) * GLINT_LEVEL_STEP;
    let coarse = glint_grid_state(at >> vec2u(1u), key + GLINT_LEVEL_STEP);
    let fine = glint_grid_state(at, key);
    let is_coarse = footprint.lod - whole > glint_threshold(glint_cell_unit(glint_cell_bits(coarse, GLINT_THRESHOLD_DRAW)));
    return GlintCellState(select(fine.a, coarse.a, is_coarse), select(fine.b, coarse.b, is_coarse));
}

// State of a cell's facets towards one direction, `place` in cells of directions, which lie otherwise for every cell of the surface.
fn glint_angle_state(state: GlintCellState, place: vec2f) -> GlintCellState {
    let bits = glint_cell_bits(state, GLINT_OFFSET_DRAW);
    let offset = vec2f(f32(bits >> 16u), f32(bits & 0xffffu)) * (1.0 / 65536.0);
    let at = bitcast<vec2u>(vec2i(floor(clamp(place + offset, vec2f(-GLINT_FARTHEST), vec2f(GLINT_FARTHEST)))));
    let number = at.x * GLINT_LEVEL_STEP + at.y;
    return GlintCellState(glint_cell_mix(state.a ^ glint_cell_mix(number + state.b)), state.b);
}

// Words `index` to `index` + 3 of a cell.
fn glint_cell_word(state: GlintCellState, index: u32) -> vec4f {
    return glint_unit_from_bits(vec4u(
        glint_cell_bits(state, index), glint_cell_bits(state, index + 1u),
        glint_cell_bits(state, index + 2u), glint_cell_bits(state, index + 3u),
    ));
}

// The words that a multinomial draw of `levels` levels reads.
fn glint_cell_words(state: GlintCellState, levels: u32) -> GlintWords {
    let none = vec4f(0.0);
    var words = GlintWords(glint_cell_word(state, 0u), none, none, none);
    if levels > 4u {
        words.b = glint_cell_word(state, 4u);
    }
    if levels > 8u {
        words.c = glint_cell_word(state, 8u);
        words.d = glint_cell_word(state, 12u);
    }
    return words;
}

// The part of a vector across axis 0, 1 or 2.
fn glint_plane_part(v: vec3f, axis: u32) -> vec2f {
    return select(select(v.xy, v.zx, axis == 1u), v.yz, axis == 0u);
}

// The plane in which a surface in space is seen at `position`, whose derivatives along the screen's axes are `d_dx` and `d_dy`: across the
// axis that `normal` (unit length) is near to. Where it lies between axes, patches many pixels wide take one of them each, as often as the
// square of the normal's part along it says.
fn glint_facing_plane(position: vec3f, d_dx: vec3f, d_dy: vec3f, normal: vec3f, seed: u32) -> GlintFacingPlane {
    let limit = vec3f(GLINT_LONGEST);
    let dx = clamp(d_dx, -limit, limit);
    let dy = clamp(d_dy, -limit, limit);
    let front = cross(dx, dy);
    let area = max(length(front), 1.0e-14);
    let lod = 0.5 * glint_quick_log2(area);
    let patch_number = glint_patch_level(i32(floor(clamp(lod, -GLINT_COARSEST_FACET_LEVEL, GLINT_COARSEST_FACET_LEVEL - 1.0))));
    let place = clamp(position * glint_level_scale(patch_number), vec3f(-GLINT_FARTHEST), vec3f(GLINT_FARTHEST));
    let at = vec3i(floor(place));
    let key = glint_mix_bits(seed + bitcast<u32>(patch_number) * GLINT_LEVEL_STEP);
    let state = glint_grid_state(at.xy, key + glint_cell_mix(bitcast<u32>(at.z) + key));
    let chosen = f32(state.b >> 8u) * (1.0 / 16777216.0);
    let shares = normal * normal;
    let axis = select(select(2u, 1u, chosen < shares.x + shares.y), 0u, chosen < shares.x);
    let seen_area = abs(select(select(front.z, front.y, axis == 1u), front.x, axis == 0u));
    return GlintFacingPlane(
        glint_plane_part(position, axis), glint_plane_part(dx, axis), glint_plane_part(dy, axis), seed ^ (axis << 30u),
        area / max(seen_area, 1.0e-3 * area),
    );
}
