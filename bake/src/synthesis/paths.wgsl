// Parameters of a synthesised surface, and the paths along which its patches meet.
//
// Accessors that the including program defines:
//   fn glint_synthesis_seam_word(index: u32) -> u32         word of the section SYSE

const GLINT_SYNTHESIS_PATCHES: u32 = 0u;
const GLINT_SYNTHESIS_CORNER_TILES: u32 = 1u;

// A part of the section LOUB.
struct GlintSynthesis {
    sample_width: u32,
    sample_height: u32,
    // 0: patches may cross the sample's edge; 1: they may not.
    wrap: u32,
    // Edge of a patch (or tile) in texels.
    patch_texels: u32,
    // Texels over which patches overlap.
    overlap: u32,
    // GLINT_SYNTHESIS_PATCHES or GLINT_SYNTHESIS_CORNER_TILES.
    arrangement: u32,
    // Patches after which the surface repeats, along both axes.
    columns: u32,
    rows: u32,
    // Of corner tiles.
    colours: u32,
    variants: u32,
    margin: u32,
    hash_seed: u32,
    // Bits of a path's entry, 0 where there is no choice, and entries in a word.
    path_bits: u32,
    path_per_word: u32,
    // Words of a path: of a patch of the grid or of a tile's middle patch; of two corner colours.
    path_words: u32,
    colour_path_words: u32,
}

// A patch and the texel of it that is shown.
struct GlintSynthesisPlace {
    patch_index: u32,
    x: i32,
    y: i32,
}

// Quotient rounded down, and its remainder, for b > 0 and |a| to 2^30. By products with 1 / b, since adapters without an integer
// divider take many times as long: the second one leaves less than b of what rounding of the first left over.
fn glint_floor_div(a: i32, b: i32) -> vec2i {
    let inverse = 1.0 / f32(b);
    let first = i32(floor(f32(a) * inverse));
    let rest = a - first * b;
    let second = i32(floor(f32(rest) * inverse));
    let q = first + second;
    let r = rest - second * b;
    return select(select(vec2i(q, r), vec2i(q + 1, r - b), r >= b), vec2i(q - 1, r + b), r < 0);
}

// Entry `k` of the path that begins at word `first`.
fn glint_synthesis_path_entry(synthesis: GlintSynthesis, first: u32, k: u32) -> i32 {
    if synthesis.path_bits == 0u {
        return 0;
    }
    // k is less than 2^20: half a step keeps the quotient off the whole numbers that rounding could miss.
    let at = u32((f32(k) + 0.5) / f32(synthesis.path_per_word));
    let word = glint_synthesis_seam_word(first + at);
    let shift = (k - at * synthesis.path_per_word) * synthesis.path_bits;
    return i32((word >> shift) & ((1u << synthesis.path_bits) - 1u));
}
