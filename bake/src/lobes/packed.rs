//! Lobes of 16 bytes, as `packed.wgsl` decodes them; the record is [`PackedLobe`].

use super::eval::{Lobe, covariance, factor};
use glam::{Mat2, Vec2, Vec4};
use glint_formats::lobes::{LevelUniform, LobesParams, MAX_CORRELATION, PackedLobe};

/// The bytes of a word, the lowest first.
fn bytes(word: u32) -> Vec4 {
    Vec4::from_array(word.to_le_bytes().map(f32::from))
}

/// The bytes of a word, the lowest first, with signs.
fn signed_bytes(word: u32) -> Vec4 {
    Vec4::from_array(word.to_le_bytes().map(|byte| f32::from(byte as i8)))
}

/// The lobe in a record of a level.
pub(super) fn lobe(map: &LobesParams, level: &LevelUniform, record: &PackedLobe) -> Lobe {
    let record: [u32; 4] = bytemuck::cast(*record);
    let slope = signed_bytes(record[0]) / 127.0;
    let jacobian = level.jacobian_scale * slope * slope.abs();
    let normal = Vec2::new((record[1] & 0xfff) as f32, ((record[1] >> 12) & 0xfff) as f32) / 4095.0;
    let root = (record[1] >> 24) as f32 / 255.0;
    let position = bytes(record[2]).truncate().truncate() / 255.0;
    let correlation = signed_bytes(record[2]) / 127.0 * MAX_CORRELATION;
    let codes = bytes(record[3]);
    let sigma = |code: f32| level.position_sigma * libm::exp2f(code / 255.0 * level.position_log_ratio);
    // Code 0 is no residual, 1 to 255 are its logarithm.
    let rest = |code: f32| match code {
        0.0 => 0.0,
        _ => level.residual_sigma * libm::exp2f((code - 1.0) / 254.0 * level.residual_log_ratio),
    };
    Lobe {
        weight: level.weight_scale * root * root,
        position: position * Vec2::from(level.extent),
        normal: Vec2::from(map.normal_low) + normal * Vec2::from(map.normal_extent),
        factor: factor(Vec2::new(sigma(codes.x), sigma(codes.y)), correlation.z),
        jacobian: Mat2::from_cols_array(&jacobian.to_array()),
        residual: covariance(Vec2::new(rest(codes.z), rest(codes.w)), correlation.w),
    }
}
