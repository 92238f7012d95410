// Image-based light without glints, for methods that have none of their own: group 2 holds the environment.

#import shade_environment_surface

fn shade_environment(point: ViewPoint) -> vec3f {
    return glint_environment_smooth(environment, shade_environment_point(point, 0.0)) * scene.environment_gain;
}
