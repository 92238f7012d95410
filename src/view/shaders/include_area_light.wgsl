// A normal-mapped surface under rectangles of light in an engine: radiance of a rectangle, BRDF for other lights.
// Directions are unit vectors from the surface, in the tangent frame of the plane, z its normal.
//
// Accessors, besides those of area_light/eval.wgsl:
//   fn glint_area_light_maps() -> GlintAreaLightMaps   section ALUB

#import area_light::eval
#import footprint
#import ggx

// How a surface shows a map of area lights.
struct GlintAreaLightMaterial {
    // Reflectance at normal incidence, linear RGB, 0 to 1.
    f0: vec3f,
    // GGX roughness of the surface below what the map holds, 0 to 1.
    base_alpha: f32,
    // Texels of the map on one unit of the surface's places, above 0.
    texels_per_unit: f32,
    // Standard deviation of the pixel's filter, in pixels, above 0.
    pixel_sigma: f32,
    // Lobes of roughness by direction, at most 9; 0 takes the same roughness in all directions.
    lobes: u32,
}

// Aluminium of roughness .1; 256 texels a unit; the filter of a pixel's own square; one lobe.
fn glint_area_light_defaults() -> GlintAreaLightMaterial {
    return GlintAreaLightMaterial(vec3f(0.91, 0.92, 0.92), 0.1, 256.0, 0.5, 0u);
}

// What a pixel sees of the map, its roughness by direction where the material has lobes.
fn glint_area_light_surface(pixel: GlintPixelOnSurface, material: GlintAreaLightMaterial) -> GlintAreaLightSurface {
    let texels = material.texels_per_unit;
    let dx = pixel.d_dx * texels;
    let dy = pixel.d_dy * texels;
    let footprint = 2.0 * material.pixel_sigma * sqrt(max(dot(dx, dx), dot(dy, dy)));
    return glint_area_light_fetch(glint_area_light_maps(), pixel.position * texels, footprint, material.lobes > 0u);
}

// Radiance towards `view`, linear RGB, of a rectangle whose corners are given from the surface, in the tangent frame.
fn glint_area_light_rect(
    pixel: GlintPixelOnSurface,
    view: vec3f,
    light: GlintRectLight,
    material: GlintAreaLightMaterial,
) -> vec3f {
    let surface = glint_area_light_surface(pixel, material);
    return glint_surface_radiance(surface, material.base_alpha, view, material.f0, light, material.lobes);
}

// BRDF of a pixel, 1/sr, linear RGB, without the light's cosine: GGX of the mean normal and of the roughness of base and map together; 0 unless
// both directions are above the plane.
fn glint_area_light_eval(pixel: GlintPixelOnSurface, view: vec3f, light: vec3f, material: GlintAreaLightMaterial) -> vec3f {
    if !(view.z > 0.0 && light.z > 0.0) {
        return vec3f(0.0);
    }
    let surface = glint_area_light_surface(pixel, material);
    let alpha = glint_convolve_alpha(material.base_alpha, surface.alpha);
    return glint_ggx_cosine(surface.normal, view, light, alpha, material.f0) / light.z;
}
