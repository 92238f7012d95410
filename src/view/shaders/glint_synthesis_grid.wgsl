// Patches on a grid that repeats: one of the two arrangements, for glint_synthesis.wgsl. Tan et al. 2022, section 5.1.1. Twin of
// glint-bake-core synthesis/eval.rs.

// Where the left (`which` 0) or upper (1) cut of a patch lies at its row (column) `along`: its first own texel.
fn glint_synthesis_cut(synthesis: GlintSynthesis, patch_index: u32, which: u32, along: i32) -> i32 {
    let overlap = i32(synthesis.overlap);
    let first = (2u * patch_index + which) * synthesis.path_words;
    return glint_synthesis_path_entry(synthesis, first, u32(along + overlap)) - overlap;
}

// The patch that shows a texel of the grid. Its block's own patch does, unless a neighbour right or below claims it; of
// several the last in raster order.
fn glint_synthesis_place(synthesis: GlintSynthesis, x: i32, y: i32) -> GlintSynthesisPlace {
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
