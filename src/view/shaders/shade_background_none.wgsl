// No environment: nothing is behind the mesh.

fn shade_background(direction: vec3f) -> vec3f {
    return vec3f(0.0);
}
