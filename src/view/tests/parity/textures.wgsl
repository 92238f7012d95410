// Answers queries of the BRDF of glTF's materials (shade_textures_brdf.wgsl), one an invocation.

struct TexturesQuery {
    normal: vec3f,
    alpha: f32,
    view: vec3f,
    metallic: f32,
    light: vec3f,
    base: f32,
}

@group(0) @binding(0) var<storage, read> queries: array<TexturesQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    var surface: ShadeTexturesSurface;
    surface.normal = q.normal;
    surface.alpha = q.alpha;
    surface.f0 = mix(vec3f(0.04), vec3f(q.base), q.metallic);
    surface.diffuse = vec3f(q.base * (1.0 - q.metallic));
    answers[id.x] = shade_textures_brdf(surface, q.view, q.light).g;
}
