// A surface with glints under an environment. Other lights have no extent, so that no facet would ever reflect them to the eye: they
// see the smooth surface.

#import shade_environment_surface
#import shade_environment_levels
#import shade_smooth_brdf
#import counting::query

fn shade_environment(point: ViewPoint) -> vec3f {
    let area = glint_footprint_area(point.d_dx, point.d_dy);
    let surface = shade_environment_point(point, glint_footprint_facets(area, material.density));
    let cell = glint_facet_cell(glint_footprint_box(point.d_dx, point.d_dy), point.uv, material.seed);
    let data = shade_environment_data();
    let words = glint_cell_words(cell, data.levels);
    glint_large_counts = false;
    return glint_environment_glints(data, surface, words) * scene.environment_gain;
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    return shade_smooth_brdf(point.view, light) * light.z;
}

fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    return shade_reflect(point, light);
}

fn shade_lod(point: ViewPoint) -> f32 {
    return glint_footprint_box(point.d_dx, point.d_dy).lod;
}
