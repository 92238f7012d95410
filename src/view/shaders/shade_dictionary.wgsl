// A surface with the glints of a slope dictionary.

#import view_scene
#import bind_dictionary

// What a material has; false leaves its part out of the program.
// Parts that do not glint.
override DICTIONARY_PARTIAL: bool = true;
// Cells of randomised density.
override DICTIONARY_RANDOMISED: bool = true;
// Colours.
override DICTIONARY_COLOURED: bool = true;

fn shade_dictionary_brdf(pixel: GlintPixelOnSurface, view: vec3f, light: vec3f) -> vec3f {
    let parameters = GlintDictionaryMaterial(
        material.alpha,
        NORMAL_TARGET,
        material.density,
        select(1.0, material.relative_area, DICTIONARY_PARTIAL),
        select(0.0, material.density_randomisation, DICTIONARY_RANDOMISED),
        material.max_anisotropy,
        material.seed,
        select(0u, material.colours, DICTIONARY_COLOURED),
        select(vec3f(1.0), material.mean_colour, DICTIONARY_COLOURED),
    );
    return glint_patch_brdf(dictionary_tables, parameters, material.f0, pixel, view, light).value;
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
    let cells_per_unit = exp2(f32(dictionary_tables.levels - 1u));
    return glint_pixel_footprint(point.d_dx * cells_per_unit, point.d_dy * cells_per_unit, material.max_anisotropy).lod;
}
