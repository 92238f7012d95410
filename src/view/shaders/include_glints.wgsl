// A surface of counted facets in an engine: BRDF, sampling, density, cones and rectangles of light. Several lights at once cost less by
// glint_counted_surface, glint_cone_light, glint_rect_facets and glint_four_lights themselves, see glints/eval.wgsl.
// Directions are unit vectors from the surface, in the tangent frame, z the normal.
//
// Accessors, besides those of glints/eval.wgsl:
//   fn glint_glints_material() -> GlintCountedMaterial   section GLUB; a host may change members before it calls

#import glints::sampling

// One light of those that are drawn.
fn glint_glints_one(surface: GlintCountedSurface, light: GlintFacetLight) -> vec3f {
    let drawn = vec4<bool>(true, false, false, false);
    return glint_four_lights(surface, light, glint_no_light(), glint_no_light(), glint_no_light(), drawn);
}

// Radiance towards `view`, linear RGB, of a light that is a small cone: a sun, or a sphere far away.
fn glint_glints_cone(
    pixel: GlintPixelOnSurface,
    view: vec3f,
    light: GlintConeLight,
    material: GlintCountedMaterial,
) -> vec3f {
    let surface = glint_counted_surface(material, pixel.position, pixel.d_dx, pixel.d_dy, view);
    return glint_glints_one(surface, glint_cone_light(surface, light));
}

// Radiance towards `view`, linear RGB, of a rectangle whose corners are given from the surface, in the tangent frame.
fn glint_glints_rect(
    pixel: GlintPixelOnSurface,
    view: vec3f,
    light: GlintRectLight,
    material: GlintCountedMaterial,
) -> vec3f {
    let surface = glint_counted_surface(material, pixel.position, pixel.d_dx, pixel.d_dy, view);
    return glint_glints_one(surface, glint_rect_facets(surface, light));
}

// BRDF of a pixel, 1/sr, linear RGB, without the light's cosine, for a light without extent; 0 unless both directions are above the surface.
fn glint_glints_eval(pixel: GlintPixelOnSurface, view: vec3f, light: vec3f, material: GlintCountedMaterial) -> vec3f {
    if !(view.z > 0.0 && light.z > 0.0) {
        return vec3f(0.0);
    }
    return glint_glints_cone(pixel, view, GlintConeLight(light, vec3f(1.0), 0.0), material) / light.z;
}

// A direction of light for `view` and three uniform numbers in [0, 1), in proportion to the smooth material; below the surface it brings
// nothing.
fn glint_glints_sample(view: vec3f, random: vec3f, material: GlintCountedMaterial) -> vec3f {
    return glint_counted_sample(material, view, random);
}

// Density over solid angle, 1/sr, of glint_glints_sample at `light`; 0 unless both directions are above the surface.
fn glint_glints_pdf(view: vec3f, light: vec3f, material: GlintCountedMaterial) -> f32 {
    return glint_counted_pdf(material, view, light);
}
