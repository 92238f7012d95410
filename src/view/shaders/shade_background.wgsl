// The environment of a pack as it is seen behind the mesh: its sharpest mip.

#import view_scene
#import bind_environment

fn shade_background(direction: vec3f) -> vec3f {
    let inside = scene.environment_from_world * direction;
    return glint_environment_radiance_at(inside, 0.0).rgb * scene.environment_gain;
}
