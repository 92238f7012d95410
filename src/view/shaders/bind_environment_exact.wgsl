// Bindings of an environment for environment::eval: group 2, read texel by texel.
//
// What bind_environment.wgsl does by a sampler, in f32: samplers may round weights to 8 bits and differ at the corners of
// a cube. Twin of glint-bake-core environment/lookup.rs; for tests and for devices whose samplers do not serve.

#import environment::eval

@group(2) @binding(0) var<uniform> environment: GlintEnvironment;
// The same sections; faces of the cubes are layers.
@group(2) @binding(1) var environment_mirror: texture_2d_array<f32>;
@group(2) @binding(2) var environment_radiance: texture_2d_array<f32>;
@group(2) @binding(3) var environment_indicators: texture_2d_array<f32>;
@group(2) @binding(4) var environment_colours: texture_2d_array<f32>;
@group(2) @binding(5) var environment_albedo: texture_2d_array<f32>;

// Column, row, face.
struct EnvironmentCubeTaps {
    a: vec3i,
    b: vec3i,
    c: vec3i,
    d: vec3i,
    weights: vec4f,
}

// Face, s, t and what both are a fraction of; X goes before Y before Z where two are as large.
fn environment_face_fraction(v: vec3f) -> vec4f {
    let size = abs(v);
    if size.x >= size.y && size.x >= size.z {
        return select(vec4f(1.0, v.z, -v.y, size.x), vec4f(0.0, -v.z, -v.y, size.x), v.x > 0.0);
    }
    if size.y >= size.z {
        return select(vec4f(3.0, v.x, -v.z, size.y), vec4f(2.0, v.x, v.z, size.y), v.y > 0.0);
    }
    return select(vec4f(5.0, -v.x, -v.y, size.z), vec4f(4.0, v.x, -v.y, size.z), v.z > 0.0);
}

fn environment_face_fraction_whole(v: vec3i) -> vec4i {
    let size = abs(v);
    if size.x >= size.y && size.x >= size.z {
        return select(vec4i(1, v.z, -v.y, size.x), vec4i(0, -v.z, -v.y, size.x), v.x > 0);
    }
    if size.y >= size.z {
        return select(vec4i(3, v.x, -v.z, size.y), vec4i(2, v.x, v.z, size.y), v.y > 0);
    }
    return select(vec4i(5, -v.x, -v.y, size.z), vec4i(4, v.x, -v.y, size.z), v.z > 0);
}

// The texel at column i and row j of a face, which may lie one beyond its edge.
fn environment_seamless_texel(face: i32, i: i32, j: i32, size: i32) -> vec3i {
    if i >= 0 && j >= 0 && i < size && j < size {
        return vec3i(i, j, face);
    }
    let s = 2 * i + 1 - size;
    let t = 2 * j + 1 - size;
    var direction = vec3i(-s, -t, -size);
    switch face {
        case 0: { direction = vec3i(size, -t, -s); }
        case 1: { direction = vec3i(-size, -t, s); }
        case 2: { direction = vec3i(s, size, t); }
        case 3: { direction = vec3i(s, -size, -t); }
        case 4: { direction = vec3i(s, -t, size); }
        default: {}
    }
    let next = environment_face_fraction_whole(direction);
    let cell = clamp((next.yz + next.w) * size / (2 * next.w), vec2i(0), vec2i(size - 1));
    return vec3i(cell, next.x);
}

fn environment_cube_taps(direction: vec3f, size: i32) -> EnvironmentCubeTaps {
    let place = environment_face_fraction(direction);
    let face = i32(place.x);
    let p = 0.5 * (place.yz / place.w + 1.0) * f32(size) - 0.5;
    let base = floor(p);
    let f = p - base;
    let cell = clamp(vec2i(base), vec2i(-1), vec2i(size - 1));
    return EnvironmentCubeTaps(
        environment_seamless_texel(face, cell.x, cell.y, size),
        environment_seamless_texel(face, cell.x + 1, cell.y, size),
        environment_seamless_texel(face, cell.x, cell.y + 1, size),
        environment_seamless_texel(face, cell.x + 1, cell.y + 1, size),
        vec4f((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y),
    );
}

fn environment_mip_size(mip: i32) -> i32 {
    return i32(textureDimensions(environment_radiance).x) >> u32(mip);
}

fn glint_environment_mirror_at(direction: vec3f) -> vec4f {
    let taps = environment_cube_taps(direction, i32(textureDimensions(environment_mirror).x));
    let sum = taps.weights.x * textureLoad(environment_mirror, taps.a.xy, taps.a.z, 0)
        + taps.weights.y * textureLoad(environment_mirror, taps.b.xy, taps.b.z, 0)
        + taps.weights.z * textureLoad(environment_mirror, taps.c.xy, taps.c.z, 0)
        + taps.weights.w * textureLoad(environment_mirror, taps.d.xy, taps.d.z, 0);
    return sum * environment.radiance_scale;
}

fn glint_environment_radiance_at(layer: u32, direction: vec3f, mip: f32) -> vec4f {
    let level = i32(mip);
    let first = 6 * i32(layer);
    let taps = environment_cube_taps(direction, environment_mip_size(level));
    let sum = taps.weights.x * textureLoad(environment_radiance, taps.a.xy, first + taps.a.z, level)
        + taps.weights.y * textureLoad(environment_radiance, taps.b.xy, first + taps.b.z, level)
        + taps.weights.z * textureLoad(environment_radiance, taps.c.xy, first + taps.c.z, level)
        + taps.weights.w * textureLoad(environment_radiance, taps.d.xy, first + taps.d.z, level);
    return sum * environment.radiance_scale;
}

fn glint_environment_indicators_at(layer: u32, direction: vec3f, mip: f32) -> vec4f {
    let level = i32(mip);
    let first = 6 * i32(layer);
    let taps = environment_cube_taps(direction, environment_mip_size(level));
    return taps.weights.x * textureLoad(environment_indicators, taps.a.xy, first + taps.a.z, level)
        + taps.weights.y * textureLoad(environment_indicators, taps.b.xy, first + taps.b.z, level)
        + taps.weights.z * textureLoad(environment_indicators, taps.c.xy, first + taps.c.z, level)
        + taps.weights.w * textureLoad(environment_indicators, taps.d.xy, first + taps.d.z, level);
}

fn environment_colour_mip(layer: i32, direction: vec3f, mip: i32) -> vec3f {
    let taps = environment_cube_taps(direction, environment_mip_size(mip));
    return taps.weights.x * textureLoad(environment_colours, taps.a.xy, 6 * layer + taps.a.z, mip).rgb
        + taps.weights.y * textureLoad(environment_colours, taps.b.xy, 6 * layer + taps.b.z, mip).rgb
        + taps.weights.z * textureLoad(environment_colours, taps.c.xy, 6 * layer + taps.c.z, mip).rgb
        + taps.weights.w * textureLoad(environment_colours, taps.d.xy, 6 * layer + taps.d.z, mip).rgb;
}

fn glint_environment_colour_at(layer: u32, direction: vec3f, mip: f32) -> vec3f {
    let share = fract(mip);
    let low = environment_colour_mip(i32(layer), direction, i32(mip));
    let last = i32(environment.roughnesses / environment.per_size) - 1;
    let high = environment_colour_mip(i32(layer), direction, min(i32(mip) + 1, last));
    return (1.0 - share) * low + share * high;
}

fn glint_environment_albedo_at(layer: u32, place: vec2f) -> vec4f {
    let last = vec2f(textureDimensions(environment_albedo)) - 1.0;
    let p = clamp(place * (last + 1.0) - 0.5, vec2f(0.0), last);
    let base = floor(p);
    let f = p - base;
    let a = vec2u(base);
    let b = vec2u(min(base + 1.0, last));
    return (1.0 - f.x) * (1.0 - f.y) * textureLoad(environment_albedo, a, layer, 0)
        + f.x * (1.0 - f.y) * textureLoad(environment_albedo, vec2u(b.x, a.y), layer, 0)
        + (1.0 - f.x) * f.y * textureLoad(environment_albedo, vec2u(a.x, b.y), layer, 0)
        + f.x * f.y * textureLoad(environment_albedo, b, layer, 0);
}
