// Bindings of lobes, and of the surface synthesised from their map if there is one: group 1. One layout for both.

#import lobes::query
#import synthesis::paths
#import bind_loads

struct LobesUniform {
    map: GlintLobesMap,
    // Zeros where the map is no surface's sample.
    @align(16) synthesis: GlintSynthesis,
    @align(16) levels: array<GlintLobesLevel, 16>,
}

// Section LOUB.
@group(1) @binding(0) var<uniform> lobes: LobesUniform;
// Section LOBE.
@group(1) @binding(1) var<storage, read> lobes_records: array<vec4u>;
// Section LONM: each texel and the one below it.
@group(1) @binding(2) var<storage, read> lobes_normals: array<vec2u>;
// Section SYPO: x in the lower half.
@group(1) @binding(3) var<storage, read> synthesis_offsets: array<u32>;
// Section SYSE.
@group(1) @binding(4) var<storage, read> synthesis_seams: array<u32>;

fn glint_lobes_level(index: u32) -> GlintLobesLevel {
    return lobes.levels[min(index, 15u)];
}

fn glint_lobes_words(index: u32) -> vec4u {
    bound_loads += 1u;
    return lobes_records[index];
}

fn glint_lobes_normals_pair(index: u32) -> vec2u {
    bound_loads += 1u;
    return lobes_normals[index];
}

fn glint_synthesis_offset(patch_index: u32) -> vec2i {
    bound_loads += 1u;
    let word = synthesis_offsets[patch_index];
    return vec2i(i32(word & 0xffffu), i32(word >> 16u));
}

fn glint_synthesis_seam_word(index: u32) -> u32 {
    bound_loads += 1u;
    return synthesis_seams[index];
}

fn glint_lobes_map() -> GlintLobesMap {
    return lobes.map;
}

fn glint_synthesis() -> GlintSynthesis {
    return lobes.synthesis;
}
