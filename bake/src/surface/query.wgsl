// A footprint on a surface synthesised by patches, and what the surface shows at a place of it.
// Tan et al. 2022, "Real-Time Microstructure Rendering with MIP-mapped Normal Map Samples", section 5.2.
//
// Accessors: those of lobes::query and synthesis::eval.

#import lobes::query
#import synthesis::eval

const GLINT_SURFACE_MOST_TEXELS: i32 = 1073741824; // 2^30

// Choice between speed and accuracy.
struct GlintSurfaceSettings {
    lobes: GlintLobesSettings,
    // Edge in texels of a level's cells from which on blocks that seams cross are read by the parts of lobes that each patch
    // owns; those of smaller ones by blocks of the finest level and boxes.
    owned_from: f32,
    // Geometric mean of the footprint's standard deviations, in texels, from which on all but the finest blocks are read so.
    owned_sigma: f32,
    // Largest range of normals in a box at a seam, over the roughness, that is not halved.
    box_range: f32,
    // Footprint's major standard deviation, in texels, up to which boxes at seams are halved along both axes.
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

fn glint_surface_default() -> GlintSurfaceSettings {
    return GlintSurfaceSettings(glint_lobes_default(), 32.0, 14.0, 2.0, 6.0);
}

// Few lobes, for pictures, with surface::blocks.
fn glint_surface_realtime() -> GlintSurfaceSettings {
    return GlintSurfaceSettings(glint_lobes_realtime(), 32.0, 14.0, 2.0, 6.0);
}

// Texels from one cell of `cell_texels` to the next.
fn glint_surface_step(map: GlintLobesMap, cell_texels: u32) -> u32 {
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
