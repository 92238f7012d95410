// A glittering surface under a prefiltered environment in an engine: radiance with glints, and smooth.
// Directions are unit vectors in the environment's frame.
//
// Accessors, besides those of environment/eval.wgsl:
//   fn glint_environment_data() -> GlintEnvironment   section ENUB

#import counting::query
#import environment::eval

// A material of facets under an environment.
struct GlintEnvironmentMaterial {
    // Reflectance at normal incidence, linear RGB, 0 to 1.
    f0: vec3f,
    // GGX roughness, .001 to 1.
    alpha: f32,
    // Facets on one unit of the surface's places squared.
    density: f32,
    // Surfaces with different seeds have different glints.
    seed: u32,
}

// Aluminium of roughness .3 with a million facets a unit of the surface's places squared.
fn glint_environment_defaults() -> GlintEnvironmentMaterial {
    return GlintEnvironmentMaterial(vec3f(0.91, 0.92, 0.92), 0.3, 1.0e6, 0u);
}

// Radiance towards `view`, linear RGB, of the environment on a surface with this normal, with the glints of the facets that the pixel sees.
fn glint_environment_eval(
    pixel: GlintPixelOnSurface,
    normal: vec3f,
    view: vec3f,
    material: GlintEnvironmentMaterial,
) -> vec3f {
    let data = glint_environment_data();
    let facets = glint_footprint_facets(glint_footprint_area(pixel.d_dx, pixel.d_dy), material.density);
    let cell = glint_facet_cell(glint_footprint_box(pixel.d_dx, pixel.d_dy), pixel.position, material.seed);
    let surface = GlintSurface(normal, view, material.alpha, material.f0, facets);
    return glint_environment_glints(data, surface, glint_cell_words(cell, data.levels));
}

// Radiance towards `view`, linear RGB, of the environment on the smooth surface that facets converge to.
fn glint_environment_mean(normal: vec3f, view: vec3f, material: GlintEnvironmentMaterial) -> vec3f {
    return glint_environment_smooth(glint_environment_data(), GlintSurface(normal, view, material.alpha, material.f0, 0.0));
}
