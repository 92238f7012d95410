// Lobes of 16 bytes: one of the two ways that a pack stores them, for lobes::eval. Twin of packed.rs; the record is that of FORMAT.md,
// section LOBE.

#import lobes::eval

// The bytes of a word, the lowest first.
fn glint_lobes_bytes(word: u32) -> vec4f {
    return vec4f((vec4u(word) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(0xffu));
}

// The bytes of a word, the lowest first, with signs.
fn glint_lobes_signed_bytes(word: u32) -> vec4f {
    return vec4f((vec4i(bitcast<i32>(word)) << vec4u(24u, 16u, 8u, 0u)) >> vec4u(24u));
}

// A lobe by its index among all; `level` is its level. Stored numbers are multiplied by what they are parts of: most of what a
// lobe costs would be divisions.
fn glint_lobes_lobe(map: GlintLobesMap, level: GlintLobesLevel, index: u32) -> GlintLobe {
    let record = glint_lobes_words(index);
    let slope = glint_lobes_signed_bytes(record.x);
    let jacobian = (level.jacobian_scale * (1.0 / (127.0 * 127.0))) * slope * abs(slope);
    let normal = vec2f(f32(record.y & 0xfffu), f32((record.y >> 12u) & 0xfffu)) * (1.0 / 4095.0);
    let root = f32(record.y >> 24u) * (1.0 / 255.0);
    let position = glint_lobes_bytes(record.z).xy * (1.0 / 255.0);
    let correlation = glint_lobes_signed_bytes(record.z).zw * (GLINT_LOBES_MAX_CORRELATION / 127.0);
    let codes = glint_lobes_bytes(record.w);
    let sigmas = level.position_sigma * exp2(codes.xy * (level.position_log_ratio * (1.0 / 255.0)));
    // Code 0 is no residual, 1 to 255 are its logarithm.
    let place = (codes.zw - 1.0) * (level.residual_log_ratio * (1.0 / 254.0));
    let rest = select(vec2f(0.0), level.residual_sigma * exp2(place), codes.zw > vec2f(0.0));
    return GlintLobe(
        level.weight_scale * root * root,
        position * level.extent,
        map.normal_low + normal * map.normal_extent,
        glint_lobes_factor(sigmas, correlation.x),
        mat2x2f(jacobian.xy, jacobian.zw),
        glint_lobes_covariance(rest, correlation.y),
    );
}
