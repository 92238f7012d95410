// The smooth surface.

#import shade_smooth_brdf

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    return shade_smooth_brdf(point.view, light) * light.z;
}

fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    return shade_reflect(point, light);
}

fn shade_lod(point: ViewPoint) -> f32 {
    return 0.0;
}
