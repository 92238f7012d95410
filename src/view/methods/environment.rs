//! An environment as a host sets it up beside its sections: pipeline constants, and what is bound where there is none.

use crate::gpu::{Gpu, GpuError, Resources, bind_sections};
use glint_formats::environment::{
    ALBEDO, ALBEDO_VK_FORMAT, BINDINGS, EnvironmentParams, EnvironmentUniform, MAX_LEVELS, UNIFORM,
};
use glint_formats::{Resource, Section, Wrap};
use half::f16;

/// Radiances of levels as pipeline constants.
const LEVELS: [&str; MAX_LEVELS] = [
    "ENVIRONMENT_LEVEL_0",
    "ENVIRONMENT_LEVEL_1",
    "ENVIRONMENT_LEVEL_2",
    "ENVIRONMENT_LEVEL_3",
    "ENVIRONMENT_LEVEL_4",
    "ENVIRONMENT_LEVEL_5",
    "ENVIRONMENT_LEVEL_6",
    "ENVIRONMENT_LEVEL_7",
    "ENVIRONMENT_LEVEL_8",
    "ENVIRONMENT_LEVEL_9",
    "ENVIRONMENT_LEVEL_10",
    "ENVIRONMENT_LEVEL_11",
    "ENVIRONMENT_LEVEL_12",
    "ENVIRONMENT_LEVEL_13",
    "ENVIRONMENT_LEVEL_14",
    "ENVIRONMENT_LEVEL_15",
];

/// Pipeline constants that follow from the parameters: what levels and look-ups there are, so that programs load nothing of them.
pub fn constants(params: &EnvironmentParams) -> Vec<(&'static str, f64)> {
    let mut constants = vec![
        ("ENVIRONMENT_LEVELS", params.levels.len() as f64),
        ("ENVIRONMENT_COLOURED", f64::from(u8::from(params.coloured))),
        ("ENVIRONMENT_LOOK_UPS", f64::from(params.look_ups)),
    ];
    constants.extend(LEVELS.into_iter().zip(params.levels.iter().copied()));
    constants
}

/// An environment without light, for scenes that have none: radiance is the zeros that are bound in its place.
///
/// # Errors
/// Those of [`bind_sections`].
pub fn empty(gpu: &Gpu) -> Result<Resources, GpuError> {
    let uniform = EnvironmentUniform {
        levels: 1,
        radiance_scale: 1.0,
        roughnesses: 1.0,
        per_size: 1.0,
        first_alpha: 1.0,
        look_ups: 1,
        ..EnvironmentUniform::default()
    };
    let one = Resource::Texture { vk_format: ALBEDO_VK_FORMAT, width: 1, height: 1, layers: 2, faces: 1, mips: 1 };
    let albedo = bytemuck::cast_slice(&[f16::ONE.to_bits(); 8]).to_vec();
    let sections = [Section::buffer(UNIFORM, "", &[uniform]), Section::texture(ALBEDO, "", one, albedo)];
    bind_sections(gpu, &sections, BINDINGS, Wrap::Clamp)
}
