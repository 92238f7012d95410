// Bindings of an environment for environment::eval: group 2, read by a sampler.

#import environment::eval
#import bind_loads

// Section ENUB.
@group(2) @binding(0) var<uniform> environment: GlintEnvironment;
// Section ENMI: RGBA16Float.
@group(2) @binding(1) var environment_mirror: texture_cube<f32>;
// Section ENRA: RGBA16Float, a roughness a layer, a face size a mip.
@group(2) @binding(2) var environment_radiance: texture_cube_array<f32>;
// Section ENIN: RGBA16Float, four levels a layer, the layers of each roughness together; one black texel if there is one level.
@group(2) @binding(3) var environment_indicators: texture_cube_array<f32>;
// Section ENCO: RGB9E5Ufloat, a level a layer; one black texel without colours.
@group(2) @binding(4) var environment_colours: texture_cube_array<f32>;
// Section ENAL: RGBA16Float, a layer for albedo and the first look-up, one for their squares, one for each other look-up.
@group(2) @binding(5) var environment_albedo: texture_2d_array<f32>;
// Filters between texels and mips, clamps.
@group(2) @binding(6) var environment_sampler: sampler;

fn glint_environment_mirror_at(direction: vec3f) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(environment_mirror, environment_sampler, direction, 0.0) * environment.radiance_scale;
}

fn glint_environment_radiance_at(layer: u32, direction: vec3f, mip: f32) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(environment_radiance, environment_sampler, direction, layer, mip)
        * environment.radiance_scale;
}

fn glint_environment_indicators_at(layer: u32, direction: vec3f, mip: f32) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(environment_indicators, environment_sampler, direction, layer, mip);
}

fn glint_environment_colour_at(layer: u32, direction: vec3f, mip: f32) -> vec3f {
    bound_loads += 1u;
    return textureSampleLevel(environment_colours, environment_sampler, direction, layer, mip).rgb;
}

fn glint_environment_albedo_at(layer: u32, place: vec2f) -> vec4f {
    bound_loads += 1u;
    return textureSampleLevel(environment_albedo, environment_sampler, place, layer, 0.0);
}

fn glint_environment_data() -> GlintEnvironment {
    return environment;
}
