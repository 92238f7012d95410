// A surface that repeats a normal map, by the map's lobes, in an engine: BRDF.
// Directions are unit vectors from the surface, in the tangent frame, z the normal.
//
// Accessors, besides those of lobes/eval.wgsl:
//   fn glint_lobes_map() -> GlintLobesMap   the map in section LOUB

#import include_map
#import lobes::query

// BRDF of a pixel, 1/sr, linear RGB, without the light's cosine; 0 unless both directions are above the surface. Settings for pictures are
// glint_lobes_realtime.
fn glint_lobes_eval(
    pixel: GlintPixelOnSurface,
    view: vec3f,
    light: vec3f,
    material: GlintMapMaterial,
    settings: GlintLobesSettings,
) -> vec3f {
    let frame = glint_lobes_frame_in_map(glint_lobes_map(), glint_map_footprint(pixel, material));
    let query = glint_lobes_query(frame, glint_half_vector(view, light).xy, material.intrinsic_roughness);
    return glint_map_brdf(glint_lobes_p_ndf(glint_lobes_map(), query, settings), material.f0, view, light);
}
