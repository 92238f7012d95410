// Image-based light without glints, for methods that have none of their own: group 2 holds the environment.

#import shade_environment_surface
#import shade_environment_levels

fn shade_environment(point: ViewPoint) -> vec3f {
    return glint_environment_smooth(shade_environment_data(), shade_environment_point(point, 0.0)) * scene.environment_gain;
}
