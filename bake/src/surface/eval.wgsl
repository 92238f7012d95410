// Distribution of normals (P-NDF) that a footprint sees on a surface synthesised by patches.
// Tan et al. 2022, "Real-Time Microstructure Rendering with MIP-mapped Normal Map Samples", section 5.2: a level is walked by
// blocks of its cells' edge.
//
// Accessors that the including program defines, besides those of surface::query:
//   fn glint_surface_block(q: GlintSurfaceQuery, level: u32, place: vec2i, whole: bool) -> vec2f
//       density and share of a block of a level's edge, `place` of them from the origin; with `whole` of the cell `place` of
//       the level, as if every place were alike; and
//   fn glint_surface_boxes(q: GlintSurfaceQuery, edge: f32) -> vec2f
//       density and share of boxes of `edge` texels under the footprint: both by surface::seams, which follows every seam, or
//       surface::blocks, which follows none

#import surface::query

// Density and share of what the surface shows of a level under the footprint: 0 boxes, then the stored ones; the last, and
// what would lie beyond it, is the whole surface.
fn glint_surface_level_sum(given: GlintSurfaceQuery, level: u32, box_edge: f32) -> vec2f {
    if level == 0u {
        return glint_surface_boxes(given, box_edge);
    }
    let whole = level >= given.map.levels;
    let index = min(level, given.map.levels) - 1u;
    let stored = glint_lobes_level(index);
    var q = given;
    if whole {
        q.point.along = vec2f(0.0);
        q.point.across = vec2f(0.0);
    }
    let frame = q.point.frame;
    let ellipse = glint_lobes_ellipse(frame, q.settings.lobes.cells_reach);
    let edge = f32(stored.cell_texels);
    let first = i32(floor((frame.mean.y - ellipse.top) / edge));
    let below = min(i32(floor((frame.mean.y + ellipse.top) / edge)), first + i32(GLINT_LOBES_MOST_STEPS));
    let last = select(below, i32(stored.cells_y) - 1, whole);
    let every = vec2i(0, i32(stored.cells_x) - 1);
    var sum = vec2f(0.0);
    // One loop over rows and columns: of pixels that run in step few have their longest rows together.
    var j = select(first, 0, whole);
    var row = select(glint_lobes_row(ellipse, 0.0, edge, f32(j) * edge), every, whole);
    while j <= last {
        if row.x <= row.y {
            sum += glint_surface_block(q, index, vec2i(row.x, j), whole);
        }
        row.x += 1;
        if row.x > row.y {
            j += 1;
            row = select(glint_lobes_row(ellipse, 0.0, edge, f32(j) * edge), every, whole);
        }
    }
    return sum;
}

// P-NDF at the query's normal: density over the disk, 0 outside it.
fn glint_surface_p_ndf(q: GlintSurfaceQuery) -> f32 {
    if !(dot(q.point.s, q.point.s) <= 1.0) {
        return 0.0;
    }
    let lod = glint_lobes_lod(q.map, q.point.frame, q.settings.lobes);
    let whole = q.map.levels;
    let last = select(lod.finer, lod.finer + 1u, lod.fraction > 0.0);
    var density = 0.0;
    var at = select(lod.finer, last, lod.fraction >= 1.0);
    var level = at;
    while at <= last {
        let sum = glint_surface_level_sum(q, level, lod.box_edge);
        if !(sum.y >= GLINT_LOBES_LEAST_SHARE) && level < whole {
            level = whole;
            continue;
        }
        density += select(1.0 - lod.fraction, lod.fraction, at > lod.finer) * sum.x / max(sum.y, GLINT_LOBES_LEAST_SHARE);
        at += 1u;
        level = at;
    }
    return density;
}
