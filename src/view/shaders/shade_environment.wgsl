// A surface with glints under an environment. Other lights have no extent, so that no facet would ever reflect them to the eye: they
// see the smooth surface.

fn shade_environment(point: ViewPoint) -> vec3f {
    let area = glint_footprint_area(point.d_dx, point.d_dy);
    let surface = shade_environment_point(point, glint_footprint_facets(area, material.density));
    let cells = glint_surface_cells(point.uv, glint_surface_lod(area), material.seed);
    let words = glint_surface_words(cells, environment.levels);
    return glint_environment_glints(environment, surface, words) * scene.environment_gain;
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    return shade_smooth_brdf(point.view, light) * light.z;
}

fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    return shade_reflect(point, light);
}

fn shade_lod(point: ViewPoint) -> f32 {
    return glint_surface_lod(glint_footprint_area(point.d_dx, point.d_dy));
}
