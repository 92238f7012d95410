// A surface of a slope dictionary in an engine: BRDF, sampling, density.
// Directions are unit vectors from the surface, in the tangent frame, z the normal.
//
// Accessors, besides those of dictionary/eval.wgsl:
//   fn glint_dictionary_tables() -> GlintDictionaryTables   section SDUB

#import dictionary::eval
#import microfacet

// GGX of roughness .3 with a million facets a unit of the surface's places squared.
fn glint_dictionary_defaults() -> GlintDictionaryMaterial {
    return GlintDictionaryMaterial(vec2f(0.3), GLINT_TARGET_GGX, 1.0e6, 1.0, 0.0, 8.0, 0u, 0u, vec3f(1.0));
}

// BRDF of a pixel, 1/sr, linear RGB, without the light's cosine; 0 unless both directions are above the surface. `f0` is the
// reflectance at normal incidence.
fn glint_dictionary_eval(
    pixel: GlintPixelOnSurface,
    view: vec3f,
    light: vec3f,
    material: GlintDictionaryMaterial,
    f0: vec3f,
) -> vec3f {
    return glint_patch_brdf(glint_dictionary_tables(), material, f0, pixel, view, light).value;
}

// A direction of light for `view` and two uniform numbers in [0, 1), in proportion to the smooth target; below the surface it brings
// nothing.
fn glint_dictionary_sample(view: vec3f, random: vec2f, material: GlintDictionaryMaterial) -> vec3f {
    let smooth_surface = GlintSmoothSurface(material.alpha * material.alpha, material.normal_target);
    let normal = glint_mirror_normal(smooth_surface, view, random);
    return normal * (2.0 * dot(view, normal)) - view;
}

// Density over solid angle, 1/sr, of glint_dictionary_sample at `light`; 0 unless both directions are above the surface.
fn glint_dictionary_pdf(view: vec3f, light: vec3f, material: GlintDictionaryMaterial) -> f32 {
    if !(view.z > 0.0 && light.z > 0.0) {
        return 0.0;
    }
    return glint_mirror_pdf(GlintSmoothSurface(material.alpha * material.alpha, material.normal_target), view, light);
}
