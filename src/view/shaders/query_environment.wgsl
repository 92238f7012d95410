// Answers queries of glints under an environment, one an invocation.

#import environment::eval
#import counting::query

struct EnvironmentQuery {
    normal: vec3f,
    alpha: f32,
    view: vec3f,
    f0: f32,
    // Facets on a surface unit squared, and where the pixel lies there.
    density: f32,
    seed: u32,
    position: vec2f,
    d_dx: vec2f,
    d_dy: vec2f,
    // Random words of the draw; the place's own where `own_words` is not 0.
    words: GlintWords,
    own_words: u32,
    facets: f32,
}

struct EnvironmentAnswer {
    smooth_radiance: vec3f,
    std_factor: f32,
    glints: vec3f,
    facets: f32,
    moments: vec2f,
    lod: f32,
    unused: u32,
    p: GlintLevels,
    words: GlintWords,
}

@group(0) @binding(0) var<storage, read> queries: array<EnvironmentQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<EnvironmentAnswer>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let area = glint_footprint_area(q.d_dx, q.d_dy);
    let footprint = glint_footprint_box(q.d_dx, q.d_dy);
    var facets = q.facets;
    var words = q.words;
    if q.own_words != 0u {
        facets = glint_footprint_facets(area, q.density);
        words = glint_cell_words(glint_facet_cell(footprint, q.position, q.seed), environment.levels);
    }
    let surface = GlintSurface(q.normal, q.view, q.alpha, vec3f(q.f0), facets);
    let chances = glint_chances(environment, surface);
    answers[id.x] = EnvironmentAnswer(
        chances.smooth_radiance, chances.std_factor, glint_environment_glints(environment, surface, words), facets,
        chances.moments, footprint.lod, 0u, chances.p, words,
    );
}
