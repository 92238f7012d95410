// Lobes of 16 bytes: one of the two ways that a pack stores them, for glint_lobes.wgsl. Twin of glint-bake-core
// lobes/quantise.rs; the record is that of FORMAT.md, section LOBE.

// A lobe by its index among all; `level` is its level.
fn glint_lobes_lobe(map: GlintLobesMap, level: GlintLobesLevel, index: u32) -> GlintLobe {
    let record = glint_lobes_words(index);
    let slope = unpack4x8snorm(record.x);
    let jacobian = level.jacobian_scale * slope * abs(slope);
    let normal = vec2f(f32(record.y & 0xfffu), f32((record.y >> 12u) & 0xfffu)) / 4095.0;
    let root = f32(record.y >> 24u) / 255.0;
    let position = unpack4x8unorm(record.z).xy;
    let correlation = unpack4x8snorm(record.z).zw * GLINT_LOBES_MAX_CORRELATION;
    let codes = unpack4x8unorm(record.w);
    let sigmas = level.position_sigma * exp2(codes.xy * level.position_log_ratio);
    // Code 0 is no residual, 1 to 255 are its logarithm.
    let place = (codes.zw * 255.0 - 1.0) / 254.0;
    let residual =
        select(vec2f(0.0), level.residual_sigma * exp2(place * level.residual_log_ratio), codes.zw > vec2f(0.0));
    return GlintLobe(
        level.weight_scale * root * root,
        position * level.extent,
        map.normal_low + normal * map.normal_extent,
        glint_lobes_factor(sigmas, correlation.x),
        mat2x2f(jacobian.xy, jacobian.zw),
        glint_lobes_covariance(residual, correlation.y),
    );
}
