// What shade_area_light.wgsl is measured against: the same mean normals with one roughness everywhere, material.alpha.x,
// under the same lights (plain LTC for rectangles). Its reference is itself.

#import view_scene
#import bind_area_light_sampler
#import shade_rect_light
#import ggx

fn shade_plain_ltc_level(point: ViewPoint) -> f32 {
    let scale = material.texels_per_unit;
    let longer2 = max(dot(point.d_dx * scale, point.d_dx * scale), dot(point.d_dy * scale, point.d_dy * scale));
    return glint_area_light_level(area_light_maps, 2.0 * material.pixel_sigma * sqrt(longer2));
}

fn shade_plain_ltc_normal(point: ViewPoint) -> vec3f {
    let position = glint_into_map(area_light_maps, point.uv * material.texels_per_unit);
    return glint_mean_direction(glint_area_light_normals(position, shade_plain_ltc_level(point)).xyz);
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    return glint_ggx_cosine(shade_plain_ltc_normal(point), point.view, light, material.alpha.x, material.f0);
}

fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    return shade_reflect(point, light);
}

fn shade_rect(point: ViewPoint) -> vec3f {
    let light = shade_rect_light(point);
    return glint_isotropic_radiance(shade_plain_ltc_normal(point), material.alpha.x, point.view, material.f0, light);
}

fn shade_lod(point: ViewPoint) -> f32 {
    return shade_plain_ltc_level(point);
}
