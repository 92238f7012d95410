// Answers queries of a dictionary's slope distribution, one an invocation.

#import bind_dictionary

struct DictionaryQuery {
    alpha: vec2f,
    slope: vec2f,
    position: vec2f,
    d_dx: vec2f,
    d_dy: vec2f,
    normal_target: u32,
    density: f32,
    relative_area: f32,
    density_randomisation: f32,
    max_anisotropy: f32,
    seed: u32,
    colours: u32,
    mean_colour: vec4f,
}

struct DictionaryAnswer {
    sdf: vec3f,
    coverage: f32,
}

@group(0) @binding(0) var<storage, read> queries: array<DictionaryQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<DictionaryAnswer>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let material = GlintDictionaryMaterial(
        q.alpha, q.normal_target, q.density, q.relative_area, q.density_randomisation, q.max_anisotropy, q.seed,
        q.colours, q.mean_colour.rgb,
    );
    let pixel = GlintPixelOnSurface(q.position, q.d_dx, q.d_dy);
    let sum = glint_patch_sdf(dictionary_tables, material, pixel, q.slope);
    answers[id.x] = DictionaryAnswer(sum.sdf, sum.coverage);
}
