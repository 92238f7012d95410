// Surfaces synthesised by patches: which texel of the sample a texel of the surface shows.
// Tan et al. 2022, "Real-Time Microstructure Rendering with MIP-mapped Normal Map Samples", section 5.1.1; corner tiles for
// surfaces without end. Integer twin of glint-bake-core synthesis/{eval,eval_tiles}.rs. A look-up reads one offset and at most
// six entries of paths; there are no loops.
//
// Accessors that the including program defines:
//   fn glint_synthesis_offset(patch_index: u32) -> vec2i    record of the section SYPO: sample texel at the patch's texel (0, 0)
//   fn glint_synthesis_seam_word(index: u32) -> u32         word of the section SYSE

const GLINT_SYNTHESIS_PATCHES: u32 = 0u;
const GLINT_SYNTHESIS_CORNER_TILES: u32 = 1u;

// From the section SYPP.
struct GlintSynthesis {
    sample_width: u32,
    sample_height: u32,
    // 0: patches may cross the sample's edge; 1: they may not.
    wrap: u32,
    // Edge of a patch (or tile) in texels.
    patch_texels: u32,
    // Texels over which patches overlap.
    overlap: u32,
    // GLINT_SYNTHESIS_PATCHES or GLINT_SYNTHESIS_CORNER_TILES.
    arrangement: u32,
    // Patches after which the surface repeats, along both axes.
    columns: u32,
    rows: u32,
    // Of corner tiles.
    colours: u32,
    variants: u32,
    margin: u32,
    hash_seed: u32,
    // Bits of a path's entry, 0 where there is no choice, and entries in a word.
    path_bits: u32,
    path_per_word: u32,
    // Words of a path: of a patch of the grid or of a tile's middle patch; of two corner colours.
    path_words: u32,
    colour_path_words: u32,
}

// A patch and the texel of it that is shown.
struct GlintSynthesisPlace {
    patch_index: u32,
    x: i32,
    y: i32,
}

// First texel of a block of the sample, if there is one.
struct GlintSynthesisBlock {
    found: bool,
    source: vec2i,
}

// Quotient rounded down, and its remainder, for b > 0.
fn glint_floor_div(a: i32, b: i32) -> vec2i {
    let q = a / b;
    let r = a - q * b;
    return select(vec2i(q, r), vec2i(q - 1, r + b), r < 0);
}

// Entry `k` of the path that begins at word `first`.
fn glint_synthesis_path_entry(synthesis: GlintSynthesis, first: u32, k: u32) -> i32 {
    if synthesis.path_bits == 0u {
        return 0;
    }
    let at = k / synthesis.path_per_word;
    let word = glint_synthesis_seam_word(first + at);
    let shift = (k - at * synthesis.path_per_word) * synthesis.path_bits;
    return i32((word >> shift) & ((1u << synthesis.path_bits) - 1u));
}

// Where the left (`which` 0) or upper (1) cut of a patch lies at its row (column) `along`: its first own texel.
fn glint_synthesis_cut(synthesis: GlintSynthesis, patch_index: u32, which: u32, along: i32) -> i32 {
    let overlap = i32(synthesis.overlap);
    let first = (2u * patch_index + which) * synthesis.path_words;
    return glint_synthesis_path_entry(synthesis, first, u32(along + overlap)) - overlap;
}

// The patch that shows a texel of the grid. Its block's own patch does, unless a neighbour right or below claims it; of
// several the last in raster order.
fn glint_synthesis_grid_place(synthesis: GlintSynthesis, x: i32, y: i32) -> GlintSynthesisPlace {
    let edge = i32(synthesis.patch_texels);
    let overlap = i32(synthesis.overlap);
    let columns = i32(synthesis.columns);
    let rows = i32(synthesis.rows);
    let in_x = glint_floor_div(x, edge);
    let in_y = glint_floor_div(y, edge);
    let bx = glint_floor_div(in_x.x, columns).y;
    let by = glint_floor_div(in_y.x, rows).y;
    let lx = in_x.y;
    let ly = in_y.y;
    let right = select(bx + 1, 0, bx + 1 == columns);
    let below = select(by + 1, 0, by + 1 == rows);
    let near_right = lx >= edge - overlap;
    let near_below = ly >= edge - overlap;
    if near_right && near_below {
        let diagonal = u32(below * columns + right);
        if lx - edge >= glint_synthesis_cut(synthesis, diagonal, 0u, ly - edge)
            && ly - edge >= glint_synthesis_cut(synthesis, diagonal, 1u, lx - edge) {
            return GlintSynthesisPlace(diagonal, lx - edge, ly - edge);
        }
    }
    if near_below {
        let lower = u32(below * columns + bx);
        if ly - edge >= glint_synthesis_cut(synthesis, lower, 1u, lx) {
            return GlintSynthesisPlace(lower, lx, ly - edge);
        }
    }
    if near_right {
        let beside = u32(by * columns + right);
        if lx - edge >= glint_synthesis_cut(synthesis, beside, 0u, ly) {
            return GlintSynthesisPlace(beside, lx - edge, ly);
        }
    }
    return GlintSynthesisPlace(u32(by * columns + bx), lx, ly);
}

// Uniform in 0 ... n - 1 (n <= 65536) from random bits.
fn glint_synthesis_below(bits: u32, n: u32) -> u32 {
    return ((bits >> 16u) * n) >> 16u;
}

// Colour of the corner (i, j) of the lattice of tiles.
fn glint_synthesis_corner_colour(synthesis: GlintSynthesis, i: i32, j: i32) -> u32 {
    let state = glint_cell_state(bitcast<u32>(i), bitcast<u32>(j), synthesis.hash_seed);
    return glint_synthesis_below(glint_draw_bits(state, 0u), synthesis.colours);
}

// Whether the middle patch's path on one side of a tile leaves it a texel that lies `depth` texels inside.
fn glint_synthesis_inside(synthesis: GlintSynthesis, first: u32, depth: i32, along: i32) -> bool {
    if depth >= i32(synthesis.overlap) {
        return true;
    }
    return depth >= glint_synthesis_path_entry(synthesis, first, u32(along - i32(synthesis.margin)));
}

// Whether the middle patch shows texel (x, y) of its tile.
fn glint_synthesis_in_middle(synthesis: GlintSynthesis, tile: u32, x: i32, y: i32) -> bool {
    let near = i32(synthesis.margin);
    let far = i32(synthesis.patch_texels) - near;
    if x < near || y < near || x >= far || y >= far {
        return false;
    }
    let words = synthesis.path_words;
    let pairs = synthesis.colour_path_words * 2u * synthesis.colours * synthesis.colours;
    let first = pairs + tile * 4u * words;
    return glint_synthesis_inside(synthesis, first, x - near, y)
        && glint_synthesis_inside(synthesis, first + words, y - near, x)
        && glint_synthesis_inside(synthesis, first + 2u * words, far - 1 - x, y)
        && glint_synthesis_inside(synthesis, first + 3u * words, far - 1 - y, x);
}

// Where the second of two corner patches begins, from the middle of the tile's edge on, at the tile's row (column) `along`; 0
// away from the edge, where middle patches lie.
fn glint_synthesis_pair_cut(synthesis: GlintSynthesis, a: u32, b: u32, which: u32, along: i32) -> i32 {
    let edge = i32(synthesis.patch_texels);
    let reach = i32(synthesis.margin + synthesis.overlap);
    if along >= reach && along < edge - reach {
        return 0;
    }
    let k = select(along + reach - edge, along + reach, along < reach);
    let first = ((a * synthesis.colours + b) * 2u + which) * synthesis.colour_path_words;
    return glint_synthesis_path_entry(synthesis, first, u32(k)) - i32(synthesis.overlap);
}

// The corner patch that shows texel (x, y) of a tile outside its middle. A corner patch has its middle at the corner.
fn glint_synthesis_corner_place(synthesis: GlintSynthesis, corners: vec4u, x: i32, y: i32) -> GlintSynthesisPlace {
    let half = i32(synthesis.patch_texels) / 2;
    let down = y >= half;
    let far = x >= half;
    var column = far;
    var row = down;
    if !far {
        let pair = select(corners.xy, corners.zw, down);
        column = x - half >= glint_synthesis_pair_cut(synthesis, pair.x, pair.y, 0u, y);
    }
    if !down {
        let pair = select(corners.xz, corners.yw, far);
        row = y - half >= glint_synthesis_pair_cut(synthesis, pair.x, pair.y, 1u, x);
    }
    let of_row = select(corners.xy, corners.zw, row);
    return GlintSynthesisPlace(
        select(of_row.x, of_row.y, column), select(x + half, x - half, column), select(y + half, y - half, row),
    );
}

// The patch that shows a texel of corner tiles.
fn glint_synthesis_tile_place(synthesis: GlintSynthesis, x: i32, y: i32) -> GlintSynthesisPlace {
    let edge = i32(synthesis.patch_texels);
    let in_x = glint_floor_div(x, edge);
    let in_y = glint_floor_div(y, edge);
    let tx = in_x.x;
    let ty = in_y.x;
    let corners = vec4u(
        glint_synthesis_corner_colour(synthesis, tx, ty),
        glint_synthesis_corner_colour(synthesis, tx + 1, ty),
        glint_synthesis_corner_colour(synthesis, tx, ty + 1),
        glint_synthesis_corner_colour(synthesis, tx + 1, ty + 1),
    );
    let state = glint_cell_state(bitcast<u32>(tx), bitcast<u32>(ty), synthesis.hash_seed);
    let variant_index = glint_synthesis_below(glint_draw_bits(state, 1u), synthesis.variants);
    let c = synthesis.colours;
    let tile = (corners.x + c * (corners.y + c * (corners.z + c * corners.w))) * synthesis.variants + variant_index;
    if glint_synthesis_in_middle(synthesis, tile, in_x.y, in_y.y) {
        return GlintSynthesisPlace(c + tile, in_x.y, in_y.y);
    }
    return glint_synthesis_corner_place(synthesis, corners, in_x.y, in_y.y);
}

// The patch that shows a texel of the surface, which goes on in all directions.
fn glint_synthesis_place(synthesis: GlintSynthesis, x: i32, y: i32) -> GlintSynthesisPlace {
    if synthesis.arrangement == GLINT_SYNTHESIS_PATCHES {
        return glint_synthesis_grid_place(synthesis, x, y);
    }
    return glint_synthesis_tile_place(synthesis, x, y);
}

fn glint_synthesis_in_sample(synthesis: GlintSynthesis, place: GlintSynthesisPlace) -> vec2i {
    let offset = glint_synthesis_offset(place.patch_index);
    return vec2i(
        glint_floor_div(offset.x + place.x, i32(synthesis.sample_width)).y,
        glint_floor_div(offset.y + place.y, i32(synthesis.sample_height)).y,
    );
}

// The sample texel (column, row) that the surface shows at (x, y).
fn glint_synthesis_source_texel(synthesis: GlintSynthesis, x: i32, y: i32) -> vec2i {
    return glint_synthesis_in_sample(synthesis, glint_synthesis_place(synthesis, x, y));
}

// Whether a block of `size` texels from `v` on, along an axis of `side` texels, is one of the sample's cells.
fn glint_synthesis_fits(synthesis: GlintSynthesis, v: i32, side: i32, size: i32, step: i32) -> bool {
    let crosses = synthesis.wrap == 0u && side % step == 0;
    return v % step == 0 && (v + size <= side || crosses);
}

fn glint_synthesis_aligned(
    synthesis: GlintSynthesis,
    place: GlintSynthesisPlace,
    size: i32,
    step: i32,
) -> GlintSynthesisBlock {
    let at = glint_synthesis_in_sample(synthesis, place);
    let fits = glint_synthesis_fits(synthesis, at.x, i32(synthesis.sample_width), size, step)
        && glint_synthesis_fits(synthesis, at.y, i32(synthesis.sample_height), size, step);
    return GlintSynthesisBlock(fits, at);
}

// The block of `size` texels of the sample that the one at the surface texel (x, y) shows as a whole, where the sample's cells
// of that size begin at all multiples of `step`. None where a seam may cross it.
fn glint_synthesis_block_source(synthesis: GlintSynthesis, x: i32, y: i32, size: i32, step: i32) -> GlintSynthesisBlock {
    let edge = i32(synthesis.patch_texels);
    var low = 0;
    var high = edge - i32(synthesis.overlap);
    if synthesis.arrangement == GLINT_SYNTHESIS_CORNER_TILES {
        low = i32(synthesis.margin + synthesis.overlap);
        high = edge - low;
    }
    let lx = glint_floor_div(x, edge).y;
    let ly = glint_floor_div(y, edge).y;
    if lx < low || ly < low || lx + size > high || ly + size > high {
        return GlintSynthesisBlock(false, vec2i(0));
    }
    return glint_synthesis_aligned(synthesis, glint_synthesis_place(synthesis, x, y), size, step);
}

// The block of the sample that most of the block of `size` texels at the surface texel (x, y) shows: that of the patch at its
// middle, as if the patch had no seams. None where the block is larger than a patch, or its source is no cell.
fn glint_synthesis_nominal_block(synthesis: GlintSynthesis, x: i32, y: i32, size: i32, step: i32) -> GlintSynthesisBlock {
    let edge = i32(synthesis.patch_texels);
    if glint_floor_div(x, edge).y + size > edge || glint_floor_div(y, edge).y + size > edge {
        return GlintSynthesisBlock(false, vec2i(0));
    }
    let half = size / 2;
    let middle = glint_synthesis_place(synthesis, x + half, y + half);
    let place = GlintSynthesisPlace(middle.patch_index, middle.x - half, middle.y - half);
    return glint_synthesis_aligned(synthesis, place, size, step);
}
