//! Lobes of 32 bytes, as `half.wgsl` decodes them; the record is [`HalfLobe`].

use super::eval::{Lobe, covariance, factor};
use ::half::f16;
use glam::{Mat2, Vec2};
use glint_formats::lobes::{HalfLobe, LevelUniform, LobesParams, MAX_CORRELATION};

/// The lobe in a record of a level.
pub(super) fn lobe(map: &LobesParams, level: &LevelUniform, record: &HalfLobe) -> Lobe {
    let float = |bits: u16| f16::from_bits(bits).to_f32();
    let floats = |bits: [u16; 2]| Vec2::from(bits.map(float));
    let unorm = |v: [u16; 2]| Vec2::new(v[0] as f32, v[1] as f32) / 65535.0;
    let correlation = record.correlation.map(|c| c as f32 / 32767.0 * MAX_CORRELATION);
    Lobe {
        weight: level.weight_scale * float(record.weight),
        position: unorm(record.position) * Vec2::from(level.extent),
        normal: Vec2::from(map.normal_low) + unorm(record.normal) * Vec2::from(map.normal_extent),
        factor: factor(floats(record.position_sigma), correlation[0]),
        jacobian: Mat2::from_cols_array(&record.jacobian.map(float)),
        residual: covariance(floats(record.residual_sigma), correlation[1]),
    }
}
