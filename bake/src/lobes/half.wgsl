// Lobes of 32 bytes: one of the two ways that a pack stores them, for lobes::eval. Twin of half.rs; the record is that of FORMAT.md,
// section LOBE.

#import lobes::eval

// A lobe by its index among all; `level` is its level.
fn glint_lobes_lobe(map: GlintLobesMap, level: GlintLobesLevel, index: u32) -> GlintLobe {
    let low = glint_lobes_words(2u * index);
    let high = glint_lobes_words(2u * index + 1u);
    let correlation = unpack2x16snorm(high.z) * GLINT_LOBES_MAX_CORRELATION;
    return GlintLobe(
        level.weight_scale * unpack2x16float(high.w).x,
        unpack2x16unorm(low.w) * level.extent,
        map.normal_low + unpack2x16unorm(low.z) * map.normal_extent,
        glint_lobes_factor(unpack2x16float(high.x), correlation.x),
        mat2x2f(unpack2x16float(low.x), unpack2x16float(low.y)),
        glint_lobes_covariance(unpack2x16float(high.y), correlation.y),
    );
}
