// Answers queries of the P-NDF of a synthesised surface, one an invocation.

#import bind_lobes
#import surface::eval

struct SurfaceQuery {
    mean: vec2f,
    s: vec2f,
    // Covariance of the footprint: xx, xy, yy.
    xx: f32,
    xy: f32,
    yy: f32,
    roughness: f32,
    settings: GlintSurfaceSettings,
}

@group(0) @binding(0) var<storage, read> queries: array<SurfaceQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let footprint = GlintFootprint(q.mean, q.xx, q.xy, q.yy);
    answers[id.x] = glint_surface_p_ndf(
        glint_surface_query(lobes.map, lobes.synthesis, footprint, q.s, q.roughness, q.settings),
    );
}
