// Bindings of counted facets for glints/eval.wgsl: group 1, read by a sampler.

#import glints::eval
#import bind_loads

// Section GLUB.
@group(1) @binding(0) var<uniform> counted_material: GlintCountedMaterial;
// Section GLCO: linear RGB and 1.
@group(1) @binding(1) var<storage, read> counted_colours: array<vec4f>;
// Section GLLI: RGBA16Float.
@group(1) @binding(2) var counted_inverse: texture_2d<f32>;
// Section GLLT: RGBA16Float.
@group(1) @binding(3) var counted_terms: texture_2d<f32>;
// Filters between texels, clamps.
@group(1) @binding(4) var counted_sampler: sampler;

fn glint_facet_palette(index: u32) -> vec3f {
    bound_loads += 1u;
    return counted_colours[index].rgb;
}

fn glint_ltc_inverse(place: vec2f) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(counted_inverse, counted_sampler, (place + 0.5) / GLINT_LTC_SIZE, 0.0);
}

fn glint_ltc_terms(place: vec2f) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(counted_terms, counted_sampler, (place + 0.5) / GLINT_LTC_SIZE, 0.0);
}

fn glint_glints_material() -> GlintCountedMaterial {
    return counted_material;
}
