// No environment: nothing comes from around.

fn shade_environment(point: ViewPoint) -> vec3f {
    return vec3f(0.0);
}
