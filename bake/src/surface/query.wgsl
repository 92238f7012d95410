// Distribution of normals (P-NDF) that a footprint sees on a surface synthesised by patches.
// Tan et al. 2022, "Real-Time Microstructure Rendering with MIP-mapped Normal Map Samples", section 5.2. Twin of glint-bake-core
// surface/query.rs, where deviations from the paper are derived: a level is walked by blocks of its cells' edge.
//
// Accessors that the including program defines, besides those of glint_lobes.wgsl and glint_synthesis.wgsl:
//   fn glint_surface_block(q: GlintSurfaceQuery, level: u32, place: vec2i, whole: bool) -> vec2f
//       density and share of a block of a level's edge, `place` of them from the origin; with `whole` of the cell `place` of
//       the level, as if every place were alike; and
//   fn glint_surface_boxes(q: GlintSurfaceQuery, edge: f32) -> vec2f
//       density and share of boxes of `edge` texels under the footprint: both by glint_surface_seams.wgsl, which follows every
//       seam, or glint_surface_blocks.wgsl, which follows none

#import lobes::query
#import synthesis::eval

const GLINT_SURFACE_MOST_TEXELS: i32 = 1073741824; // 2^30

// Choice between speed and accuracy.
struct GlintSurfaceSettings {
    lobes: GlintLobesSettings,
    // Edge in texels of a level's cells from which on blocks that seams cross are read by the parts of lobes that each patch
    // owns; those of smaller ones by blocks of the finest level and boxes.
    owned_from: f32,
    // Geometric mean of the footprint's deviations, in texels, from which on all but the finest blocks are read so.
    owned_sigma: f32,
    // Largest range of normals in a box at a seam, over the roughness, that is not halved.
    box_range: f32,
    // Footprint's major deviation, in texels, up to which boxes at seams are halved along both axes.
    halves_until: f32,
}

// A surface, and what is asked of it. The frame's centre is relative to `origin`, a texel of the surface that is a corner of
// blocks of every level.
struct GlintSurfaceQuery {
    map: GlintLobesMap,
    synthesis: GlintSynthesis,
    point: GlintLobesQuery,
    origin: vec2i,
    settings: GlintSurfaceSettings,
}

fn glint_surface_default_settings() -> GlintSurfaceSettings {
    return GlintSurfaceSettings(glint_lobes_default(), 32.0, 14.0, 2.0, 6.0);
}

// Few lobes, for pictures, with glint_surface_blocks.wgsl.
fn glint_surface_realtime_settings() -> GlintSurfaceSettings {
    return GlintSurfaceSettings(glint_lobes_realtime(), 32.0, 14.0, 2.0, 6.0);
}

// Texels from one cell of `cell_texels` to the next.
fn glint_lobes_step(map: GlintLobesMap, cell_texels: u32) -> u32 {
    return select(min(cell_texels, map.step_texels), cell_texels, map.step_texels == 0u);
}

// The query of a footprint: its centre in the surface's first period, and then relative to a corner of a largest block near
// it, where places have the most digits.
fn glint_surface_query(
    map: GlintLobesMap,
    synthesis: GlintSynthesis,
    footprint: GlintFootprint,
    s: vec2f,
    roughness: f32,
    settings: GlintSurfaceSettings,
) -> GlintSurfaceQuery {
    let edge = i32(synthesis.patch_texels);
    var patches = vec2i(i32(synthesis.columns), i32(synthesis.rows));
    if synthesis.arrangement == GLINT_SYNTHESIS_CORNER_TILES {
        patches = vec2i(GLINT_SURFACE_MOST_TEXELS / edge);
    }
    let limit = vec2f(1.0e7);
    let place = clamp(footprint.mean, -limit, limit);
    let first = floor(place / f32(edge));
    let at = vec2i(first);
    let origin = edge * vec2i(glint_floor_div(at.x, patches.x).y, glint_floor_div(at.y, patches.y).y);
    let mean = place - first * f32(edge);
    let frame = glint_lobes_frame(GlintFootprint(mean, footprint.xx, footprint.xy, footprint.yy));
    return GlintSurfaceQuery(map, synthesis, glint_lobes_query(frame, s, roughness), origin, settings);
}

// Projected normal of the surface's texel.
fn glint_surface_texel(q: GlintSurfaceQuery, at: vec2i) -> vec2f {
    let on_surface = q.origin + at;
    let source = glint_synthesis_source_texel(q.synthesis, on_surface.x, on_surface.y);
    return glint_lobes_texel(q.map, source.x, source.y);
}

// Normal, Jacobian and twist of the surface at a place.
fn glint_surface_patch_at(q: GlintSurfaceQuery, u: vec2f) -> GlintLobesPatch {
    if q.map.nearest == 1u {
        return GlintLobesPatch(glint_surface_texel(q, vec2i(floor(u))), mat2x2f(), vec2f(0.0));
    }
    let p = u - 0.5;
    let cell = floor(p);
    let at = vec2i(cell);
    return glint_lobes_bilinear(
        glint_surface_texel(q, at),
        glint_surface_texel(q, at + vec2i(1, 0)),
        glint_surface_texel(q, at + vec2i(0, 1)),
        glint_surface_texel(q, at + vec2i(1, 1)),
        p - cell,
    );
}

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
