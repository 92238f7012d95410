// Bindings of an area-light material for area_light/{eval,rect}.wgsl: group 1. How they are read is in
// bind_area_light_sampler.wgsl (by samplers, for engines) or bind_area_light_loads.wgsl (to the last bit of a float).

#import area_light::eval

// Section ALUB.
@group(1) @binding(0) var<uniform> area_light_maps: GlintAreaLightMaps;
// Section ALNM, RGBA16Float or RGBA8Snorm, all mips.
@group(1) @binding(1) var area_light_normals: texture_2d<f32>;
// Section ALRO likewise; one texel of zeros for isotropic materials.
@group(1) @binding(2) var area_light_roughness: texture_2d<f32>;
// Sections ALLI and ALLT, RGBA16Float, 64 x 64.
@group(1) @binding(3) var area_light_inverse: texture_2d<f32>;
@group(1) @binding(4) var area_light_terms: texture_2d<f32>;
// Linear within and between mips; repeats or clamps as the map does.
@group(1) @binding(5) var area_light_sampler: sampler;
// Linear, clamps.
@group(1) @binding(6) var area_light_table_sampler: sampler;

fn glint_area_light_maps() -> GlintAreaLightMaps {
    return area_light_maps;
}
