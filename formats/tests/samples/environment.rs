//! Sections of an environment.

use glint_formats::Section;
use glint_formats::environment::{self, EnvironmentParams};

/// A mirror of two texels, one filtered roughness on faces of one, three levels with colours.
pub fn environment_params() -> EnvironmentParams {
    EnvironmentParams {
        face_size: 2,
        per_size: 1,
        kernel: environment::Kernel::Ndf,
        roughness: vec![0.0, 1.0],
        radiance_scale: 1.0,
        levels: vec![0.0, 1.0, 4.0],
        level_choice: environment::LevelChoice::Optimal,
        coloured: true,
        albedo_size: 2,
        look_ups: 2,
        source_width: 8,
        source_height: 4,
        negative_pixels: 1,
        mean_radiance: [1.0, 0.5, 0.25],
        filter_error: 0.005,
        max_error: Some(0.01),
        measured: environment::MeasuredError {
            reads: vec![environment::MeasuredReads { count: 9, relative: 0.01, of_mean: 0.02, worst: 0.03 }; 2],
            texels: vec![environment::MeasuredTexels { rmse: 0.001, worst: 0.002 }; 2],
            texels_measured: 16,
            energy: 1e-6,
            second_moment: 0.1,
            rounding: vec![2e-4; 2],
        },
    }
}

/// Half floats of the indicators of [`environment_params`]: six texels, all ½, ¼, 0, 0.
pub fn environment_indicators() -> Vec<u16> {
    [0x3800, 0x3400, 0, 0].repeat(6)
}

/// Half floats of the table of [`environment_params`]: three layers of four texels, all ½ but the shifts, −1.
pub fn environment_albedo() -> Vec<u16> {
    let layers = [[0x3800, 0x3800, 0xbc00, 0x3800], [0x3800; 4], [0xbc00, 0x3800, 0x3800, 0]];
    layers.into_iter().flat_map(|texel| texel.repeat(4)).collect()
}

/// The seven sections of an environment whose radiance is all `value`.
pub fn environment_sections(params: &EnvironmentParams, indicators: &[u16], value: u16) -> Vec<Section> {
    let sound = environment_params();
    let halves = |count: usize| bytemuck::cast_slice(&vec![value; count]).to_vec();
    let texture = |kind, resource, payload| Section::texture(kind, "sky", resource, payload);
    vec![
        Section::parameters(environment::PARAMS, "sky", params),
        Section::buffer(environment::UNIFORM, "sky", &[params.uniform()]),
        texture(environment::MIRROR, sound.mirror_resource(), halves(96)),
        texture(environment::RADIANCE, sound.radiance_resource(), halves(24)),
        texture(environment::INDICATORS, sound.indicators_resource(), bytemuck::cast_slice(indicators).to_vec()),
        texture(environment::COLOURS, sound.colours_resource(), vec![0x80; 48]),
        texture(environment::ALBEDO, sound.albedo_resource(), bytemuck::cast_slice(&environment_albedo()).to_vec()),
    ]
}
