// A block of a synthesised surface as if it had no seams: one of the two ways to read a surface, for surface::eval.

#import surface::query

// Density and share of a block: the cell of the sample at which the patch at the block's middle begins there, or the last
// before it.
fn glint_surface_block(q: GlintSurfaceQuery, level_index: u32, place: vec2i, whole: bool) -> vec2f {
    let level = glint_lobes_level(level_index);
    let at = place * i32(level.cell_texels);
    let on_surface = q.origin + at;
    let source = glint_synthesis_nominal_texel(q.synthesis, on_surface.x, on_surface.y, i32(level.cell_texels));
    let most = vec2u(level.cells_x, level.cells_y) - 1u;
    let shown = min(vec2u(source) / glint_surface_step(q.map, level.cell_texels), most);
    let cell = select(shown, vec2u(place), whole);
    let first = level.first_lobe + (cell.y * level.cells_x + cell.x) * q.map.lobes_per_cell;
    return glint_lobes_cell(q.map, q.point, level, first, vec2f(at));
}

// Density and share of boxes of `edge` texels under the footprint: those of the sample, as if the patch that shows the
// footprint's middle showed all that it sees. One look-up of a patch serves them all.
fn glint_surface_boxes(q: GlintSurfaceQuery, edge: f32) -> vec2f {
    var query = q.point;
    let texel = floor(query.frame.mean);
    let on_surface = q.origin + vec2i(texel);
    let source = glint_synthesis_source_texel(q.synthesis, on_surface.x, on_surface.y);
    query.frame.mean = vec2f(source) + (query.frame.mean - texel);
    return glint_lobes_boxes(q.map, query, edge, q.settings.lobes.reach);
}
