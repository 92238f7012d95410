// A normal-mapped surface with the mean normal and roughness of what lies under a pixel, under rectangles (multi-scale LTC),
// points and directions (GGX). The base roughness is material.alpha.x; material.lobes above 0 asks for roughness by
// direction.

#import view_scene
#import bind_area_light_sampler
#import shade_rect_light
#import ggx
#import hash

// Whether material.lobes is obeyed. A pipeline that is made with false is for lobes of 0 and leaves out what directions take:
// rasterisers on CPUs execute both sides of a branch.
override AREA_LIGHT_DIRECTIONAL: bool = true;

// Twice the standard deviation of the pixel's footprint along its longer side, in texels of the first mip.
fn shade_area_light_footprint(point: ViewPoint) -> f32 {
    let scale = material.texels_per_unit;
    let longer2 = max(dot(point.d_dx * scale, point.d_dx * scale), dot(point.d_dy * scale, point.d_dy * scale));
    return 2.0 * material.pixel_sigma * sqrt(longer2);
}

fn shade_area_light_surface(point: ViewPoint, directional: bool) -> GlintAreaLightSurface {
    let position = point.uv * material.texels_per_unit;
    return glint_area_light_fetch(area_light_maps, position, shade_area_light_footprint(point), directional);
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    let surface = shade_area_light_surface(point, false);
    let alpha = glint_convolve_alpha(material.alpha.x, surface.alpha);
    return glint_ggx_cosine(surface.normal, point.view, light, alpha, material.f0);
}

// Normal of the first mip at a place drawn from the pixel's footprint.
fn shade_area_light_facet(point: ViewPoint, random: vec2f) -> vec3f {
    let radius = sqrt(-2.0 * log(1.0 - random.x)) * material.pixel_sigma;
    let angle = 6.2831853 * random.y;
    let place = point.uv + point.d_dx * (radius * cos(angle)) + point.d_dy * (radius * sin(angle));
    let position = glint_into_map(area_light_maps, place * material.texels_per_unit);
    return glint_mean_direction(glint_area_light_normals(position, 0.0).xyz);
}

// One normal of the first mip with the base roughness. What the first mip itself averages, a texel, is not in it.
fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    return glint_ggx_cosine(shade_area_light_facet(point, random), point.view, light, material.alpha.x, material.f0);
}

// One place of the footprint and one of the light, drawn by area.
fn shade_area_light_rect_sample(point: ViewPoint) -> vec3f {
    let state = glint_cell_state(bitcast<u32>(point.uv.x), bitcast<u32>(point.uv.y), scene.frame);
    let light = shade_rect_light(point);
    let u = light.corner_1 - light.corner_0;
    let v = light.corner_3 - light.corner_0;
    let to_light = light.corner_0 + u * glint_draw_uniform(state, 2u) + v * glint_draw_uniform(state, 3u);
    let distance2 = max(dot(to_light, to_light), 1.0e-12);
    let direction = to_light * inverseSqrt(distance2);
    var area = -dot(cross(u, v), direction);
    if light.two_sided != 0u {
        area = abs(area);
    }
    let random = vec2f(glint_draw_uniform(state, 4u), glint_draw_uniform(state, 5u));
    return shade_reference(point, direction, random) * light.radiance * (max(area, 0.0) / distance2);
}

fn shade_rect(point: ViewPoint) -> vec3f {
    if REFERENCE {
        return shade_area_light_rect_sample(point);
    }
    let light = shade_rect_light(point);
    if AREA_LIGHT_DIRECTIONAL {
        let surface = shade_area_light_surface(point, material.lobes > 0u);
        return glint_surface_radiance(surface, material.alpha.x, point.view, material.f0, light, material.lobes);
    }
    let surface = shade_area_light_surface(point, false);
    let alpha = glint_convolve_alpha(material.alpha.x, surface.alpha);
    return glint_isotropic_radiance(surface.normal, alpha, point.view, material.f0, light);
}

fn shade_lod(point: ViewPoint) -> f32 {
    return glint_area_light_level(area_light_maps, shade_area_light_footprint(point));
}
