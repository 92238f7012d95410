// A block of a synthesised surface as if it had no seams: one of the two ways to read a surface, for glint_surface.wgsl. Twin of
// glint-bake-core surface/query.rs with `whole_blocks`.

// Density and share of a block: the cell of the sample at which the patch at the block's middle begins there, or the last
// before it.
fn glint_surface_block(q: GlintSurfaceQuery, level_index: u32, at: vec2i) -> vec2f {
    let level = glint_lobes_level(level_index);
    let on_surface = q.origin + at;
    let source = glint_synthesis_nominal_texel(q.synthesis, on_surface.x, on_surface.y, i32(level.cell_texels));
    let most = vec2u(level.cells_x, level.cells_y) - 1u;
    let cell = min(vec2u(source) / glint_lobes_step(q.map, level.cell_texels), most);
    let first = level.first_lobe + (cell.y * level.cells_x + cell.x) * q.map.lobes_per_cell;
    return glint_lobes_cell(q.map, q.point, level, first, vec2f(at));
}

// Normal, Jacobian and twist of a box around `u`: that of the patch that shows the first of its four texels.
fn glint_surface_box_patch(q: GlintSurfaceQuery, u: vec2f) -> GlintLobesPatch {
    let nearest = q.map.nearest == 1u;
    let p = select(u - 0.5, u, nearest);
    let cell = floor(p);
    let on_surface = q.origin + vec2i(cell);
    let source = glint_synthesis_source_texel(q.synthesis, on_surface.x, on_surface.y);
    return glint_lobes_patch(q.map, source, select(p - cell, vec2f(0.0), nearest));
}
