// Patches on a grid that repeats: one of the two arrangements, for synthesis::eval. Tan et al. 2022, section 5.1.1.

#import synthesis::paths

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
    let near = edge - i32(synthesis.overlap);
    let columns = i32(synthesis.columns);
    let rows = i32(synthesis.rows);
    let in_x = glint_floor_div(x, edge);
    let in_y = glint_floor_div(y, edge);
    let bx = glint_floor_div(in_x.x, columns).y;
    let by = glint_floor_div(in_y.x, rows).y;
    let near_right = in_x.y >= near;
    var place = GlintSynthesisPlace(u32(by * columns + bx), in_x.y, in_y.y);
    // Neighbours by bits, 1 right and 2 below, the last in raster order first. Most texels have none. That to the right and below
    // has two cuts to pass, one a round.
    var neighbour = select(0, 1, near_right) + select(0, 2, in_y.y >= near);
    var upper = neighbour == 2;
    while neighbour > 0 {
        let right = (neighbour & 1) == 1;
        let below = neighbour >= 2;
        let column = select(bx, select(bx + 1, 0, bx + 1 == columns), right);
        let row = select(by, select(by + 1, 0, by + 1 == rows), below);
        let patch_index = u32(row * columns + column);
        let lx = in_x.y - select(0, edge, right);
        let ly = in_y.y - select(0, edge, below);
        let cut = glint_synthesis_cut(synthesis, patch_index, select(0u, 1u, upper), select(ly, lx, upper));
        let claims = select(lx, ly, upper) >= cut;
        if claims && (upper || !below) {
            place = GlintSynthesisPlace(patch_index, lx, ly);
            break;
        }
        if claims {
            upper = true;
        } else {
            neighbour = select(0, neighbour - 1, near_right);
            upper = neighbour == 2;
        }
    }
    return place;
}
