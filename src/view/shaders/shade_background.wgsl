// The environment of a pack as it is seen behind the mesh: the mirror.

#import view_scene
#import bind_environment

fn shade_background(direction: vec3f) -> vec3f {
    let inside = scene.environment_from_world * direction;
    return glint_environment_mirror_at(inside).rgb * scene.environment_gain;
}
