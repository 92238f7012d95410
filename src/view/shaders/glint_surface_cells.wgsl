// Random words of a place on a surface: what a pixel's draw reads, so that glints stay put when the camera moves.
// Kneiphof and Klein 2025, "Real-Time Image-based Lighting of Glints", section 3.3, in place of the grids of Deliot and Belcour
// 2023. Twin of glint-bake-core environment/cells.rs, where the deviation is derived: words are blended, not counts, so one
// draw a pixel has the distribution of its facets at every place.
//
// Pure functions, no accessors. Places in surface units, those of the density.

// Largest |level|; the edge of a cell is 2^level surface units.
const GLINT_SURFACE_MAX_LEVEL: f32 = 24.0;
// Most facets of a draw.
const GLINT_MAX_FACETS: f32 = 1.0e16;
// (sqrt(3) - 1) / 2.
const GLINT_SKEW: f32 = 0.3660254;

// Three corners of one level: random states, and one over their weights.
struct GlintSurfaceLevel {
    a: GlintCellState,
    b: GlintCellState,
    c: GlintCellState,
    inverse_weights: vec3f,
}

struct GlintSurfaceCells {
    fine: GlintSurfaceLevel,
    coarse: GlintSurfaceLevel,
}

// Area of a pixel whose place changes by `d_dx` and `d_dy` along the screen's axes.
fn glint_footprint_area(d_dx: vec2f, d_dy: vec2f) -> f32 {
    let limit = vec2f(1.0e15);
    let dx = clamp(d_dx, -limit, limit);
    let dy = clamp(d_dy, -limit, limit);
    return abs(dx.x * dy.y - dx.y * dy.x);
}

// Level at which cells have the pixel's area.
fn glint_surface_lod(area: f32) -> f32 {
    return clamp(0.5 * log2(max(area, 1.0e-20)), -GLINT_SURFACE_MAX_LEVEL, GLINT_SURFACE_MAX_LEVEL - 1.0);
}

// Facets under a pixel of `area` at `density` facets a unit.
fn glint_footprint_facets(area: f32, density: f32) -> f32 {
    return clamp(area * density, 0.0, GLINT_MAX_FACETS);
}

fn glint_surface_level(position: vec2f, level: i32, share: f32, surface_seed: u32) -> GlintSurfaceLevel {
    // 2^-level, exactly.
    let scale = bitcast<f32>(u32(127 - level) << 23u);
    let limit = vec2f(1.0e9);
    let p = clamp(position * scale, -limit, limit);
    let q = p + vec2f((p.x + p.y) * GLINT_SKEW);
    let base = floor(q);
    let f = q - base;
    let cell = bitcast<vec2u>(vec2i(base));
    let below = f.x > f.y;
    let high = max(f.x, f.y);
    let low = min(f.x, f.y);
    let side = select(vec2u(0u, 1u), vec2u(1u, 0u), below);
    let seed = surface_seed ^ glint_mix_bits(bitcast<u32>(level));
    let weights = vec3f(1.0 - high, high - low, low) * share;
    return GlintSurfaceLevel(
        glint_cell_state(cell.x, cell.y, seed),
        glint_cell_state(cell.x + side.x, cell.y + side.y, seed),
        glint_cell_state(cell.x + 1u, cell.y + 1u, seed),
        1.0 / max(weights, vec3f(1.0e-12)),
    );
}

// The corners around `position` for a pixel of level `lod` (glint_surface_lod).
fn glint_surface_cells(position: vec2f, lod: f32, seed: u32) -> GlintSurfaceCells {
    let fine = floor(lod);
    let blend = lod - fine;
    let level = i32(fine);
    return GlintSurfaceCells(
        glint_surface_level(position, level, 1.0 - blend, seed),
        glint_surface_level(position, level + 1, blend, seed),
    );
}

// -ln(1 - h) for h in (0, 1), off by 1e-6 of itself.
fn glint_exponential(h: f32) -> f32 {
    let high = 0.18720224 + h * (0.5240135 + h * (-0.6401686 + h * 0.9920757));
    let small = h * (1.000001 + h * (0.49981508 + h * (0.3389499 + h * high)));
    return select(small, -log(1.0 - h), h > 0.5);
}

fn glint_level_exponential(level: GlintSurfaceLevel, index: u32) -> f32 {
    let a = glint_exponential(glint_unit_from_bits(glint_draw_bits(level.a, index))) * level.inverse_weights.x;
    let b = glint_exponential(glint_unit_from_bits(glint_draw_bits(level.b, index))) * level.inverse_weights.y;
    let c = glint_exponential(glint_unit_from_bits(glint_draw_bits(level.c, index))) * level.inverse_weights.z;
    return min(min(a, b), c);
}

// Word `index` of a place: uniform, and small where a corner has a rare number.
fn glint_surface_word(cells: GlintSurfaceCells, index: u32) -> u32 {
    let least = min(glint_level_exponential(cells.fine, index), glint_level_exponential(cells.coarse, index));
    return u32(min(glint_one_minus_exp(least) * 4294967296.0, 4294967040.0));
}

// The words that a multinomial draw of `levels` levels reads: small where the facet of a fraction is there, large where the
// brighter branch of a node gets more.
fn glint_surface_words(cells: GlintSurfaceCells, levels: u32) -> GlintWords {
    let first = vec4u(
        glint_surface_word(cells, 0u), ~glint_surface_word(cells, 1u),
        ~glint_surface_word(cells, 2u), ~glint_surface_word(cells, 3u),
    );
    if levels <= 4u {
        return GlintWords(first, vec4u(0u), vec4u(0u), vec4u(0u));
    }
    let second = vec4u(
        ~glint_surface_word(cells, 4u), ~glint_surface_word(cells, 5u),
        ~glint_surface_word(cells, 6u), ~glint_surface_word(cells, 7u),
    );
    if levels <= 8u {
        return GlintWords(first, second, vec4u(0u), vec4u(0u));
    }
    var words = array<vec4u, 4>(first, second, vec4u(0u), vec4u(0u));
    for (var i = 8u; i < 16u; i++) {
        words[i / 4u][i % 4u] = ~glint_surface_word(cells, i);
    }
    return GlintWords(words[0], words[1], words[2], words[3]);
}
