//! The paths along which patches meet, as they are stored: integer twin of `paths.wgsl`, whose `GlintSynthesis` is
//! [`glint_formats::synthesis::SynthesisUniform`].

use super::baked::Synthesis;

/// A patch and the texel of it that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Record of the patch's offset.
    pub patch_index: u32,
    /// Column in the patch; negative left of its block.
    pub x: i32,
    /// Row in the patch; negative above its block.
    pub y: i32,
}

/// Quotient rounded down, and its remainder, for b > 0.
pub(super) fn floor_div(a: i32, b: i32) -> (i32, i32) {
    (a.div_euclid(b), a.rem_euclid(b))
}

/// Entry `k` of the path that begins at word `first`.
pub(super) fn path_entry(synthesis: &Synthesis, first: u32, k: u32) -> i32 {
    let uniform = &synthesis.uniform;
    if uniform.path_bits == 0 {
        return 0;
    }
    let at = k / uniform.path_per_word;
    let word = synthesis.seams[(first + at) as usize];
    let shift = (k - at * uniform.path_per_word) * uniform.path_bits;
    (word >> shift & ((1 << uniform.path_bits) - 1)) as i32
}
