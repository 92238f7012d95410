// Bindings of a dictionary for glint_dictionary.wgsl: group 1.

struct DictionaryData {
    tables: GlintDictionaryTables,
}

@group(1) @binding(0) var<uniform> dictionary: DictionaryData;
// Section SDTB as it is in the pack: R16Float, entries x (levels * marginals).
@group(1) @binding(1) var dictionary_table: texture_2d<f32>;
// Glint colours, linear RGB and one unused; at least one element.
@group(1) @binding(2) var<storage, read> dictionary_colours: array<vec4f>;

fn glint_dictionary_texel(entry: u32, row: u32) -> f32 {
    return textureLoad(dictionary_table, vec2u(entry, row), 0).r;
}

fn glint_dictionary_colour(index: u32) -> vec3f {
    return dictionary_colours[index].rgb;
}
