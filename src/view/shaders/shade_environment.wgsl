// A surface with glints under an environment. Other lights have no extent, so that no facet would ever reflect them to the eye: they
// see the smooth surface.

// Radiance levels of the pack, and whether they have colours: what is known when a pipeline is made costs no branches, which some
// devices take both ways. 0 reads them from the environment.
override ENVIRONMENT_LEVELS: u32 = 0u;
override ENVIRONMENT_COLOURED: u32 = 0u;

fn shade_environment_data() -> GlintEnvironment {
    var data = environment;
    if ENVIRONMENT_LEVELS != 0u {
        data.levels = ENVIRONMENT_LEVELS;
        data.coloured = ENVIRONMENT_COLOURED;
    }
    return data;
}

fn shade_environment(point: ViewPoint) -> vec3f {
    let area = glint_footprint_area(point.d_dx, point.d_dy);
    let surface = shade_environment_point(point, glint_footprint_facets(area, material.density));
    let cells = glint_surface_cells(point.uv, glint_surface_lod(area), material.seed);
    let data = shade_environment_data();
    let words = glint_surface_words(cells, data.levels);
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
    return glint_surface_lod(glint_footprint_area(point.d_dx, point.d_dy));
}
