// Bindings of a material as textures: group 1. Textures that it does not have are white, and normals straight up.

// Where a texture lies, by the mesh's texture coordinates.
struct TexturesPlace {
    // Columns of the matrix.
    linear: vec4f,
    offset: vec2f,
    // Texels of the first mip.
    size: vec2f,
}

struct TexturesMaterial {
    // Of the textures below, in their order.
    places: array<TexturesPlace, 5>,
    base_colour: vec3f,
    metallic: f32,
    emissive: vec3f,
    // Perceptual, as glTF has it.
    roughness: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    // Texels that are one surface unit where material.texels_per_unit is this.
    texels: f32,
    // Share of material.f0 in the base colour: 1 where nothing else says it.
    own_colour: f32,
}

@group(1) @binding(0) var<uniform> textures: TexturesMaterial;
// Red, green and blue.
@group(1) @binding(1) var textures_base_colour: texture_2d<f32>;
@group(1) @binding(2) var textures_base_colour_sampler: sampler;
// Normals as 0 to 1, green up.
@group(1) @binding(3) var textures_normal: texture_2d<f32>;
@group(1) @binding(4) var textures_normal_sampler: sampler;
// Green is roughness, blue metallic.
@group(1) @binding(5) var textures_roughness: texture_2d<f32>;
@group(1) @binding(6) var textures_roughness_sampler: sampler;
// Red is occlusion.
@group(1) @binding(7) var textures_occlusion: texture_2d<f32>;
@group(1) @binding(8) var textures_occlusion_sampler: sampler;
@group(1) @binding(9) var textures_emissive: texture_2d<f32>;
@group(1) @binding(10) var textures_emissive_sampler: sampler;
