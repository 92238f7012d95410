// A surface with the glints of a slope dictionary.

fn shade_dictionary_brdf(pixel: GlintPixelOnSurface, view: vec3f, light: vec3f) -> vec3f {
    let parameters = GlintDictionaryMaterial(
        material.alpha, material.normal_target, material.density, material.relative_area,
        material.density_randomisation, material.max_anisotropy, material.seed, material.colours, material.mean_colour,
    );
    let half = glint_half_vector(view, light);
    let sum = glint_patch_sdf(dictionary.tables, parameters, pixel, glint_normal_to_slope(half));
    return glint_facet_brdf(glint_sdf_to_ndf(sum.sdf, half.z), material.f0, view, light);
}

fn shade_reflect(point: ViewPoint, light: vec3f) -> vec3f {
    let pixel = GlintPixelOnSurface(point.uv, point.d_dx, point.d_dy);
    return shade_dictionary_brdf(pixel, point.view, light) * light.z;
}

// A pixel is its sixteen parts, each shaded by itself: what supersampling makes of the procedural surface.
fn shade_reference(point: ViewPoint, light: vec3f, random: vec2f) -> vec3f {
    let part = floor(random * 4.0) * 0.25 - 0.375;
    let place = point.uv + point.d_dx * part.x + point.d_dy * part.y;
    let pixel = GlintPixelOnSurface(place, point.d_dx * 0.25, point.d_dy * 0.25);
    return shade_dictionary_brdf(pixel, point.view, light) * light.z;
}

fn shade_lod(point: ViewPoint) -> f32 {
    let cells_per_unit = exp2(f32(dictionary.tables.levels - 1u));
    return glint_pixel_footprint(point.d_dx * cells_per_unit, point.d_dy * cells_per_unit, material.max_anisotropy).lod;
}
