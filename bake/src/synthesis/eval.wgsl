// Surfaces synthesised by patches: which texel of the sample a texel of the surface shows.
// Tan et al. 2022, "Real-Time Microstructure Rendering with MIP-mapped Normal Map Samples", section 5.1.1; corner tiles for
// surfaces without end. A look-up reads one offset and at most
// six entries of paths; there are no loops.
//
// Accessors that the including program defines:
//   fn glint_synthesis_offset(patch_index: u32) -> vec2i    record of the section SYPO: sample texel at the patch's texel (0, 0)
//   fn glint_synthesis_place(synthesis: GlintSynthesis, x: i32, y: i32) -> GlintSynthesisPlace
//                                                           the patch that shows a texel of the surface, which goes on in all
//                                                           directions: by synthesis::grid or
//                                                           synthesis::tiles, as patches are arranged

#import synthesis::paths

// First texel of a block of the sample, if there is one.
struct GlintSynthesisBlock {
    found: bool,
    source: vec2i,
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

// The sample texel at which a block of `size` texels at the surface texel (x, y) would begin if the patch at its middle showed
// all of it.
fn glint_synthesis_nominal_texel(synthesis: GlintSynthesis, x: i32, y: i32, size: i32) -> vec2i {
    let half = size / 2;
    let middle = glint_synthesis_place(synthesis, x + half, y + half);
    return glint_synthesis_in_sample(
        synthesis, GlintSynthesisPlace(middle.patch_index, middle.x - half, middle.y - half),
    );
}
