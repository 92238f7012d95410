// Answers queries of area lights on a normal-mapped surface, one an invocation.

#import bind_area_light_loads
#import ggx

struct AreaLightQuery {
    // Corners of the light; w is unused.
    corner_0: vec4f,
    corner_1: vec4f,
    corner_2: vec4f,
    corner_3: vec4f,
    view: vec3f,
    base_alpha: f32,
    f0: vec3f,
    footprint_texels: f32,
    radiance: vec3f,
    two_sided: u32,
    // Unit direction of a light that is a direction.
    light: vec3f,
    lobes: u32,
    position: vec2f,
    deficit: f32,
}

struct AreaLightAnswer {
    // From the rectangle.
    radiance: vec3f,
    alpha_from_deficit: f32,
    // BRDF times cosine for the light that is a direction.
    reflected: vec3f,
    size: f32,
    normal: vec3f,
    alpha: f32,
    major: f32,
    minor: f32,
    axis: vec2f,
}

@group(0) @binding(0) var<storage, read> queries: array<AreaLightQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<AreaLightAnswer>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let light =
        GlintRectLight(q.corner_0.xyz, q.corner_1.xyz, q.corner_2.xyz, q.corner_3.xyz, q.radiance, q.two_sided);
    let surface = glint_area_light_fetch(area_light_maps, q.position, q.footprint_texels, q.lobes > 0u);
    let alpha = glint_convolve_alpha(q.base_alpha, surface.alpha);
    var answer: AreaLightAnswer;
    answer.radiance = glint_surface_radiance(surface, q.base_alpha, q.view, q.f0, light, q.lobes);
    answer.alpha_from_deficit = glint_alpha_from_deficit(q.deficit);
    answer.reflected = glint_ggx_cosine(surface.normal, q.view, q.light, alpha, q.f0);
    answer.size = surface.length;
    answer.normal = surface.normal;
    answer.alpha = surface.alpha;
    answer.major = surface.by_direction.major;
    answer.minor = surface.by_direction.minor;
    answer.axis = surface.by_direction.axis;
    answers[id.x] = answer;
}
