// A surface synthesised by patches of a normal map, by the map's lobes, in an engine: BRDF.
// Directions are unit vectors from the surface, in the tangent frame, z the normal.
//
// Accessors, besides those of surface/eval.wgsl:
//   fn glint_lobes_map() -> GlintLobesMap      the map in section LOUB
//   fn glint_synthesis() -> GlintSynthesis     the synthesis in section LOUB

#import include_map
#import surface::eval

// BRDF of a pixel, 1/sr, linear RGB, without the light's cosine; 0 unless both directions are above the surface. Settings for pictures are
// glint_surface_realtime.
fn glint_surface_eval(
    pixel: GlintPixelOnSurface,
    view: vec3f,
    light: vec3f,
    material: GlintMapMaterial,
    settings: GlintSurfaceSettings,
) -> vec3f {
    let footprint = glint_map_footprint(pixel, material);
    let s = glint_half_vector(view, light).xy;
    let query =
        glint_surface_query(glint_lobes_map(), glint_synthesis(), footprint, s, material.intrinsic_roughness, settings);
    return glint_map_brdf(glint_surface_p_ndf(query), material.f0, view, light);
}
