// Random words of a place on a surface: what a pixel's draw reads, so that glints stay put when the camera moves.
// Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", section 3.3, in place of the grids of Deliot and Belcour
// 2023. Twin of glint-bake-core environment/query.rs, where the deviation is derived: words are blended, not counts, so one
// draw a pixel has the distribution of its facets at every place.
//
// Pure functions, no accessors. Places in surface units, those of the density.

#import hash
#import counting::eval

// Largest |level|; the edge of a cell is 2^level surface units.
const GLINT_SURFACE_MAX_LEVEL: f32 = 24.0;
// Most facets of a draw.
const GLINT_MAX_FACETS: f32 = 1.0e16;
// (sqrt(3) - 1) / 2.
const GLINT_SKEW: f32 = 0.3660254;

// The four corners around a place.
struct GlintSurfaceCells {
    a: GlintCellState,
    b: GlintCellState,
    c: GlintCellState,
    d: GlintCellState,
    // 2^-32 / weight; the weights add up to 1.
    inverse_weights: vec4f,
    // Sums of the products of two, three and four weights.
    sums: vec3f,
}

// Area of a pixel whose place changes by `d_dx` and `d_dy` along the screen's axes.
fn glint_footprint_area(d_dx: vec2f, d_dy: vec2f) -> f32 {
    let limit = vec2f(1.0e15);
    let dx = clamp(d_dx, -limit, limit);
    let dy = clamp(d_dy, -limit, limit);
    return abs(dx.x * dy.y - dx.y * dy.x);
}

// Level at which cells have the pixel's area, from the bits of an f32: exact at powers of two and straight between them, at most
// 0.05 less than the logarithm.
fn glint_surface_lod(area: f32) -> f32 {
    let logarithm = f32(bitcast<i32>(max(area, 1.0e-20))) * (1.0 / 8388608.0) - 127.0;
    return clamp(0.5 * logarithm, -GLINT_SURFACE_MAX_LEVEL, GLINT_SURFACE_MAX_LEVEL - 1.0);
}

// Facets under a pixel of `area` at `density` facets a unit.
fn glint_footprint_facets(area: f32, density: f32) -> f32 {
    return clamp(area * density, 0.0, GLINT_MAX_FACETS);
}

// Mixes 32 bits in one round, a bijection: enough for the upper bits of sums of random numbers.
fn glint_surface_mix(value: u32) -> u32 {
    let v = (value ^ (value >> 16u)) * 0xbb67ae85u;
    return v ^ (v >> 15u);
}

// Random state of the corner `offset` from `base` on the fine or the coarse grid: two Feistel rounds, a bijection of the place.
fn glint_surface_corner(base: vec2i, offset: vec2i, coarse: bool, seeds: vec2u) -> GlintCellState {
    let at = bitcast<vec2u>(select(base + base, base, coarse) + offset);
    let seed = select(seeds.x, seeds.y, coarse);
    let a = at.x + glint_surface_mix(at.y + seed);
    return GlintCellState(a, at.y + glint_surface_mix(a ^ seed));
}

// 32 random bits of a corner for each of the draws `index` to `index` + 3. Half a round is enough: what it leaves the lower bits
// unmixed with, the upper ones, is mixed into these.
fn glint_surface_bits(state: GlintCellState, index: u32) -> vec4u {
    let step = state.b | 1u;
    let first = state.a + step * (index + 1u);
    let second = first + step;
    let third = second + step;
    let values = vec4u(first, second, third, third + step);
    return (values ^ (values >> vec4u(16u))) * 0xbb67ae85u;
}

// Seed of a level's grid.
fn glint_surface_seed(level: i32, seed: u32) -> u32 {
    return glint_mix_bits(seed + bitcast<u32>(level) * 0x9e3779b9u);
}

// The corners around `position` for a pixel of level `lod` (glint_surface_lod).
fn glint_surface_cells(position: vec2f, lod: f32, seed: u32) -> GlintSurfaceCells {
    let fine = floor(lod);
    let t = lod - fine;
    let level = i32(fine);
    // 2^-(level + 1), exactly.
    let scale = bitcast<f32>(u32(126 - level) << 23u);
    let limit = vec2f(5.0e8);
    let p = clamp(position * scale, -limit, limit);
    let q = p + vec2f((p.x + p.y) * GLINT_SKEW);
    let whole = floor(q);
    let f = q - whole;
    let base = vec2i(whole);
    let below = f.x > f.y;
    let c2 = 2.0 * select(f.x, f.y, below);
    let a2 = 2.0 - 2.0 * select(f.y, f.x, below);
    let b2 = 2.0 - a2 - c2;
    let rest = 1.0 - t;
    let alpha = a2 - rest;
    let beta = b2 - rest;
    let near_a = alpha >= 2.0 * t;
    let near_b = beta >= 2.0 * t;
    let near_c = c2 - rest >= 2.0 * t;
    let coarse_a = alpha >= 0.0;
    let coarse_b = beta >= 0.0;
    // Weights of A', B', E and F of an octahedron.
    let wa = clamp(0.5 * alpha, 0.0, t);
    let wb = clamp(0.5 * beta, 0.0, t);
    let we = max(-alpha, 0.0);
    let wf = max(-beta, 0.0);
    let w1 = select(select(select(we, b2, near_c), c2, near_b), wa, coarse_a);
    let w2 = select(select(select(wf, a2, near_c), c2, near_a), wb, coarse_b);
    let w3 = select(select(t - wa - wb, alpha - 2.0 * t, near_a), beta - 2.0 * t, near_b);
    let w4 = select(select(select(rest - we - wf, c2 - rest - 2.0 * t, near_c), b2, near_a), a2, near_b);
    let seeds = vec2u(glint_surface_seed(level, seed), glint_surface_seed(level + 1, seed));
    let along = select(vec2i(0, 1), vec2i(1, 0), below);
    let one = vec2i(1);
    // E between B and C, or A'.
    let first = select(one + along, vec2i(0), coarse_a);
    // F between C and A, or B'.
    let second = select(one, along, coarse_b);
    // C', or A or B.
    let third = select(select(one, vec2i(0), near_a), along + along, near_b);
    // D between A and B, or C.
    let fourth = select(along, vec2i(2), near_c);
    let weights = max(vec4f(w1, w2, w3, w4), vec4f(1.0e-12));
    let pairs = weights.xz + weights.yw;
    let products = weights.xz * weights.yw;
    // One division for the inverses of both.
    let inverse = (1.0 / 4294967296.0) / products;
    return GlintSurfaceCells(
        glint_surface_corner(base, first, coarse_a, seeds),
        glint_surface_corner(base, second, coarse_b, seeds),
        glint_surface_corner(base, third, !(near_a || near_b), seeds),
        glint_surface_corner(base, fourth, false, seeds),
        weights.yxwz * inverse.xxyy,
        vec3f(
            products.x + products.y + pairs.x * pairs.y,
            products.x * pairs.y + products.y * pairs.x,
            products.x * products.y,
        ),
    );
}

// Words `index` to `index` + 3 of a place, from 0 to 1: uniform, and small where a corner has a rare number.
fn glint_surface_word(cells: GlintSurfaceCells, index: u32) -> vec4f {
    // Positive numbers have the order of their bits. As integers, no device minds what is not a number.
    let a = bitcast<vec4u>(vec4f(glint_surface_bits(cells.a, index)) * cells.inverse_weights.x);
    let b = bitcast<vec4u>(vec4f(glint_surface_bits(cells.b, index)) * cells.inverse_weights.y);
    let c = bitcast<vec4u>(vec4f(glint_surface_bits(cells.c, index)) * cells.inverse_weights.z);
    let d = bitcast<vec4u>(vec4f(glint_surface_bits(cells.d, index)) * cells.inverse_weights.w);
    let least = bitcast<vec4f>(min(min(a, b), min(c, d)));
    // Half a step of each corner's word: the least is a corner's as often as its weight says, and was divided by it.
    let x = least + 1.0 / 2147483648.0;
    // 1 less the product of all 1 - weight x by its terms, so that small ones keep their digits.
    return x * (1.0 - x * (cells.sums.x - x * (cells.sums.y - x * cells.sums.z)));
}

// The words that a multinomial draw of `levels` levels reads: rare bright facets are where a corner has a rare number.
fn glint_surface_words(cells: GlintSurfaceCells, levels: u32) -> GlintWords {
    let none = vec4f(0.0);
    var words = GlintWords(glint_surface_word(cells, 0u), none, none, none);
    if levels > 4u {
        words.b = glint_surface_word(cells, 4u);
    }
    if levels > 8u {
        words.c = glint_surface_word(cells, 8u);
        words.d = glint_surface_word(cells, 12u);
    }
    return words;
}
