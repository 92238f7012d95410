// Answers queries of the P-NDF of a map's lobes, one an invocation.

#import bind_lobes

struct LobesQuery {
    mean: vec2f,
    s: vec2f,
    // Covariance of the footprint: xx, xy, yy.
    xx: f32,
    xy: f32,
    yy: f32,
    roughness: f32,
    settings: GlintLobesSettings,
}

@group(0) @binding(0) var<storage, read> queries: array<LobesQuery>;
@group(0) @binding(1) var<storage, read_write> answers: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let q = queries[id.x];
    let frame = glint_lobes_frame_in_map(lobes.map, GlintFootprint(q.mean, q.xx, q.xy, q.yy));
    answers[id.x] = glint_lobes_p_ndf(lobes.map, glint_lobes_query(frame, q.s, q.roughness), q.settings);
}
