// Bindings of NDF maps for glint_ndf_maps.wgsl: group 1. Materials share two buffers, so that a layered material takes no more
// bindings than a plain one.

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
}

@group(1) @binding(0) var<uniform> ndf_maps: NdfMapsData;
// Levels, tiles, palettes and noise maps.
@group(1) @binding(1) var<storage, read> ndf_maps_records: array<vec4u>;
// Normals, densities, classes and reach masks.
@group(1) @binding(2) var<storage, read> ndf_maps_words: array<u32>;

fn glint_ndf_record(at: u32) -> vec4u {
    bound_loads += 1u;
    return ndf_maps_records[at];
}

fn glint_ndf_word(at: u32) -> u32 {
    bound_loads += 1u;
    return ndf_maps_words[at];
}
