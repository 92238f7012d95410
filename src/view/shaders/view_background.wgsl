// What lies behind the mesh: the room, or the environment of a pack.
//
// fn shade_background(direction: vec3f) -> vec3f gives the environment's radiance from a unit world direction.

#import view_scene
#import view_sky

override LIGHTS: u32 = 1u;

struct ViewBackground {
    @builtin(position) clip: vec4f,
    @location(0) place: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> ViewBackground {
    let place = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    // Depth 0 is infinitely far.
    return ViewBackground(vec4f(place, 0.0, 1.0), place);
}

@fragment
fn fragment(f: ViewBackground) -> @location(0) vec4f {
    let direction = normalize(scene.world_from_camera * vec3f(f.place * scene.half_size, -1.0));
    if (LIGHTS & VIEW_LIGHT_ENVIRONMENT) != 0u {
        return vec4f(shade_background(direction), 0.0);
    }
    if (LIGHTS & VIEW_LIGHT_ROOM) != 0u {
        // Dimmer than it lights, so that the mesh stands out.
        return vec4f(view_sky(direction) * 0.5, 0.0);
    }
    return vec4f(0.0);
}
