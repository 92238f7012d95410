// Running mean of frames.

struct Accumulate {
    // 1 over the number of frames so far, this one counted.
    weight: f32,
}

@group(0) @binding(0) var<uniform> accumulate: Accumulate;
@group(0) @binding(1) var frame: texture_2d<f32>;
@group(0) @binding(2) var mean_before: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2i(position.xy);
    let before = textureLoad(mean_before, at, 0);
    return before + (textureLoad(frame, at, 0) - before) * accumulate.weight;
}
