// Answers queries of counted facets, one an invocation.

#import bind_glints
#import glints::sampling

struct GlintsQuery {
    f0: vec3f,
    normal_target: u32,
    alpha: vec2f,
    turn: vec2f,
    position: vec2f,
    density: f32,
    relative_area: f32,
    d_dx: vec2f,
    d_dy: vec2f,
    view: vec3f,
    facet_spread: f32,
    light: vec3f,
    solid_angle_sr: f32,
    corner_0: vec3f,
    sky_spread: f32,
    corner_1: vec3f,
    seed: u32,
    corner_2: vec3f,
    facet_area: f32,
    corner_3: vec3f,
    // Colours of the palette; 0 is white.
    colours: u32,
    diffuse: vec3f,
    coat: f32,
    // Uniform numbers.
    random: vec3f,
    coat_alpha: f32,
}

struct GlintsAnswer {
    cone_radiance: vec3f,
    cone_chance: f32,
    rect_radiance: vec3f,
    rect_chance: f32,
    cone_beside: vec3f,
    pdf: f32,
    rect_beside: vec3f,
    sampled_pdf: f32,
    sampled: vec3f,
    unused_0: u32,
    radiance: vec3f,
    facets: f32,
    ratios: vec2f,
    whole: f32,
    facet_area: f32,
    cell: vec2u,
    cone_state: vec2u,
    rect_state: vec2u,
    plane: u32,
    area_ratio: f32,
    words: vec4f,
}

@group(0) @binding(0) var<storage, read> queries: array<GlintsQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<GlintsAnswer>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let counted = GlintCountedMaterial(
        q.f0, q.normal_target, q.alpha, q.turn, counted_material.mean_colour, min(q.colours, counted_material.colours), q.density,
        q.relative_area, q.facet_area, q.facet_spread, q.sky_spread, q.seed,
        GlintLayers(q.diffuse, q.coat, q.coat_alpha),
    );
    let surface = glint_counted_surface(counted, q.position, q.d_dx, q.d_dy, q.view);
    let cone = glint_cone_light(surface, GlintConeLight(q.light, vec3f(1.0, 2.0, 3.0), q.solid_angle_sr));
    let rect_light = GlintRectLight(q.corner_0, q.corner_1, q.corner_2, q.corner_3, vec3f(2.0), 1u);
    let rect = glint_rect_facets(surface, rect_light);
    let sampled = glint_counted_sample(counted, q.view, q.random);
    let drawn = vec4<bool>(true, true, false, false);
    let ratios = glint_hit_ratios(surface, cone, rect, glint_no_light(), glint_no_light(), drawn);
    let plane = glint_facing_plane(vec3f(q.position, q.density), vec3f(q.d_dx, 0.0), vec3f(q.d_dy, 0.1), q.view, q.seed);
    answers[id.x] = GlintsAnswer(
        cone.radiance, cone.chance, rect.radiance, rect.chance, cone.beside,
        glint_counted_pdf(counted, q.view, q.light), rect.beside, glint_counted_pdf(counted, q.view, sampled), sampled, 0u,
        glint_four_lights(surface, cone, rect, glint_no_light(), glint_no_light(), drawn), surface.facets, ratios.xy, surface.whole,
        glint_microfacet_area(GlintSmoothSurface(q.alpha * q.alpha, q.normal_target)),
        vec2u(surface.cell.a, surface.cell.b), vec2u(cone.state.a, cone.state.b), vec2u(rect.state.a, rect.state.b), plane.seed, plane.area_ratio,
        glint_sky_words(surface, 4u).a,
    );
}
