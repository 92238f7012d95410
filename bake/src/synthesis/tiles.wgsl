// Corner tiles, a surface without end: one of the two arrangements, for synthesis::eval. Lagae and Dutre 2006, "An Alternative for
// Wang Tiles": a tile is known by the colours of its corners, which are hashes of the lattice. A colour is a patch of the sample,
// its middle at the corner; over four of them lies the tile's middle patch.

#import synthesis::paths
#import hash

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

// The patch that shows a texel.
fn glint_synthesis_place(synthesis: GlintSynthesis, x: i32, y: i32) -> GlintSynthesisPlace {
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
