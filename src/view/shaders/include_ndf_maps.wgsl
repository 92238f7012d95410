// A surface with the NDF maps of tiny examples in an engine, in one or two layers: BRDF, sampling, density, and the rough surface that an
// engine's own environment lights. A clear coat over the base after Xing et al. 2024, Eq. 3: f = f_base (1 - F_coat) + f_coat.
// Directions are unit vectors from the surface, in the tangent frame, z the normal.
//
// Accessors, besides those of ndf_maps/eval.wgsl:
//   fn glint_ndf_material(layer: u32) -> GlintNdfMaterial   the material in section NMUB: of the base, 0, or of the coat, 1
//   fn glint_ndf_layers() -> GlintNdfLayers                 section LAUB; zeros where there is none

#import include_map
#import ndf_maps::moments

// Layers of a material: section LAUB.
struct GlintNdfLayers {
    // Reflectance of the coat at normal incidence.
    coat_f0: f32,
    // How many layers there are: 2, or 0 where there is no such section.
    count: u32,
}

// Settings for pictures: footprints up to four times as long as wide, patches up to 2.5 standard deviations away.
fn glint_ndf_maps_settings() -> GlintNdfSettings {
    return GlintNdfSettings(4.0, 2.5);
}

// Density of one layer at the projected normal `s`.
fn glint_ndf_maps_density(layer: u32, footprint: GlintFootprint, s: vec2f, settings: GlintNdfSettings) -> f32 {
    // Most of a picture lies outside the highlight and is done with here.
    if !glint_ndf_reaches(glint_ndf_material(layer), s) {
        return 0.0;
    }
    return glint_ndf_density(glint_ndf_material(layer), footprint, settings, s).density;
}

// BRDF of a pixel, 1/sr, linear RGB, without the light's cosine; 0 unless both directions are above the surface.
fn glint_ndf_maps_eval(
    pixel: GlintPixelOnSurface,
    view: vec3f,
    light: vec3f,
    material: GlintMapMaterial,
    settings: GlintNdfSettings,
) -> vec3f {
    let footprint = glint_map_footprint(pixel, material);
    let s = glint_half_vector(view, light).xy;
    let base = glint_map_brdf(glint_ndf_maps_density(0u, footprint, s, settings), material.f0, view, light);
    let layers = glint_ndf_layers();
    if layers.count < 2u {
        return base;
    }
    let coat_f0 = vec3f(layers.coat_f0);
    let coat = glint_map_brdf(glint_ndf_maps_density(1u, footprint, s, settings), coat_f0, view, light);
    return base * (vec3f(1.0) - glint_fresnel(coat_f0, dot(view, glint_half_vector(view, light)))) + coat;
}

// Mean and covariance of the projected normals that a pixel sees of the base: for glint_moments_sample, glint_moments_pdf, and
// glint_rough_normal, whose normal and roughness an engine's own environment takes.
fn glint_ndf_maps_moments(pixel: GlintPixelOnSurface, material: GlintMapMaterial, settings: GlintNdfSettings) -> GlintMoments {
    return glint_ndf_moments(glint_ndf_material(0u), glint_map_footprint(pixel, material), settings);
}

// A direction of light for `view` and three uniform numbers in [0, 1); the zero vector where this sample has none.
fn glint_ndf_maps_sample(view: vec3f, random: vec3f, moments: GlintMoments) -> vec3f {
    return glint_moments_sample(moments, view, random);
}

// Density over solid angle, 1/sr, of glint_ndf_maps_sample at `light`.
fn glint_ndf_maps_pdf(view: vec3f, light: vec3f, moments: GlintMoments) -> f32 {
    return glint_moments_pdf(moments, view, light);
}
