// What engines ask of methods of normal maps alike: a material, its footprint of a pixel, and from a density of normals to a BRDF.

#import brdf
#import footprint

// How a surface shows a map: glint_map_defaults, and what the host changes.
struct GlintMapMaterial {
    // Reflectance at normal incidence, linear RGB, 0 to 1.
    f0: vec3f,
    // Texels of the map on one unit of the surface's places, above 0.
    texels_per_unit: f32,
    // Standard deviation of the pixel's filter, in pixels, above 0.
    pixel_sigma: f32,
    // Standard deviation of the projected normals of one facet, .001 to .3; of lobes and surfaces (NDF maps have theirs baked).
    intrinsic_roughness: f32,
}

// Aluminium; 256 texels a unit; the filter of a pixel's own square; a facet as wide as the defaults of the bake have it.
fn glint_map_defaults() -> GlintMapMaterial {
    return GlintMapMaterial(vec3f(0.91, 0.92, 0.92), 256.0, 0.5, 0.02);
}

// Footprint of a pixel on the map, in its texels.
fn glint_map_footprint(pixel: GlintPixelOnSurface, material: GlintMapMaterial) -> GlintFootprint {
    let texels = material.texels_per_unit;
    return glint_footprint_of_pixel(pixel.position * texels, pixel.d_dx * texels, pixel.d_dy * texels, material.pixel_sigma);
}

// BRDF of a density over the disk of projected normals, taken at the half vector of `view` and `light`: projected solid angle is area of
// the disk, so that the density is the microfacet distribution D.
fn glint_map_brdf(density: f32, f0: vec3f, view: vec3f, light: vec3f) -> vec3f {
    return glint_facet_brdf(vec3f(density), f0, view, light);
}
