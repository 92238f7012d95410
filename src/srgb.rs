//! The transfer function of sRGB (IEC 61966-2-1).

/// The light, 0 to 1, of an encoded value, 0 to 1; NaN stays NaN.
pub fn decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The encoded value, 0 to 1, of light, 0 to 1.
pub fn encode(light: f32) -> f32 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::powf(light, 1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_undoes_the_other() {
        for byte in 0..=255u8 {
            let encoded = f32::from(byte) / 255.0;
            assert!((encode(decode(encoded)) - encoded).abs() < 1e-5, "{byte}");
        }
        assert!(decode(f32::NAN).is_nan());
    }
}
