// Bindings of NDF maps for glint_ndf_maps.wgsl: group 1. Materials share the tables, so that a layered material takes no more
// bindings than a plain one.

#import ndf_maps::eval
#import bind_loads
#import bind_table

struct NdfMapsLayer {
    @align(16) material: GlintNdfMaterial,
}

struct NdfMapsData {
    // The only layer, or the base and the clear coat over it.
    layers: array<NdfMapsLayer, 2>,
    // How many there are.
    count: u32,
    // Reflectance of the coat at normal incidence.
    coat_f0: f32,
    // Levels and palettes, and the tiles if they are few.
    @align(16) records: array<vec4u, 4000>,
}

@group(1) @binding(0) var<uniform> ndf_maps: NdfMapsData;
// Tables: noise maps, and tiles if they are many;
@group(1) @binding(1) var ndf_maps_table: texture_2d<u32>;
// normals, densities without blocks, classes and reach masks;
@group(1) @binding(2) var ndf_maps_words: texture_2d<u32>;
// densities in blocks.
@group(1) @binding(3) var ndf_maps_blocks: texture_2d<u32>;

fn glint_ndf_record(at: u32) -> vec4u {
    bound_loads += 1u;
    return ndf_maps.records[at];
}

fn glint_ndf_tile(at: u32) -> vec4u {
    bound_loads += 1u;
    return textureLoad(ndf_maps_table, bind_table_place(at), 0);
}

fn glint_ndf_noise_texel(at: u32) -> vec4u {
    bound_loads += 1u;
    return textureLoad(ndf_maps_table, bind_table_place(at), 0);
}

fn glint_ndf_word(at: u32) -> u32 {
    bound_loads += 1u;
    return textureLoad(ndf_maps_words, bind_table_place(at), 0).x;
}

fn glint_ndf_block(at: u32) -> vec3u {
    bound_loads += 1u;
    return textureLoad(ndf_maps_blocks, bind_table_place(at), 0).xyz;
}
