// Light of a room around the scene, so that shapes show where no light reaches: soft, without texture, without glints.

// Radiance from a unit world direction: a floor, a dim wall and a bright window above and behind the surface.
fn view_sky(direction: vec3f) -> vec3f {
    let height = smoothstep(-0.4, 0.9, direction.y);
    let room = mix(vec3f(0.012, 0.011, 0.011), vec3f(0.050, 0.056, 0.066), height);
    let window = smoothstep(0.55, 0.95, dot(direction, normalize(vec3f(0.3, 0.6, -0.75))));
    return room + vec3f(0.12, 0.116, 0.108) * window;
}
