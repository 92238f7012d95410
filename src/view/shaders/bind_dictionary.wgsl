// Bindings of a dictionary for dictionary/eval.wgsl: group 1.

#import dictionary::eval
#import bind_loads

// Section SDUB.
@group(1) @binding(0) var<uniform> dictionary_tables: GlintDictionaryTables;
// Section SDTB: pairs of half floats, each entry and the next of its row, so that a look-up is one load.
@group(1) @binding(1) var<storage, read> dictionary_table: array<u32>;
// Glint colours of the material, which a host sets: linear RGB and one unused; at least one element.
@group(1) @binding(2) var<storage, read> dictionary_colours: array<vec4f>;

fn glint_dictionary_filtered(row: u32, place: f32) -> f32 {
    bound_loads += 1u;
    let low = floor(place);
    let tables = dictionary_tables;
    // A clamp that has no effect: without it compilers for software adapters work out the index once for every lane.
    let at = min(row * tables.entries + u32(low), tables.marginals * tables.levels * tables.entries - 1u);
    let pair = unpack2x16float(dictionary_table[at]);
    return pair.x + (pair.y - pair.x) * (place - low);
}

fn glint_dictionary_colour(index: u32) -> vec3f {
    bound_loads += 1u;
    return dictionary_colours[index].rgb;
}

fn glint_dictionary_tables() -> GlintDictionaryTables {
    return dictionary_tables;
}
