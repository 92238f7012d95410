//! An environment as sections of a pack, and back.

use super::baked::Environment;
use crate::error::{BakeError, Result};
use crate::pack_access::{names_with, parameters, records};
use glint_formats::environment::{
    ALBEDO, COLOURS, EnvironmentParams, EnvironmentUniform, INDICATORS, MIRROR, PARAMS, RADIANCE, UNIFORM,
};
use glint_formats::{Codec, Pack, Section};

/// The sections of an environment under `name`, compressed when `codec` says so.
pub fn to_sections(name: &str, environment: &Environment, codec: Codec) -> Vec<Section> {
    let params = &environment.params;
    let mut sections = vec![
        Section::parameters(PARAMS, name, params),
        Section::buffer(UNIFORM, name, &[environment.uniform]),
        Section::texture(MIRROR, name, params.mirror_resource(), bytemuck::cast_slice(&environment.mirror).to_vec()),
        Section::texture(
            RADIANCE,
            name,
            params.radiance_resource(),
            bytemuck::cast_slice(&environment.radiance).to_vec(),
        ),
    ];
    if params.indicator_layers() > 0 {
        let resource = params.indicators_resource();
        let payload = bytemuck::cast_slice(&environment.indicators).to_vec();
        sections.push(Section::texture(INDICATORS, name, resource, payload));
    }
    if params.coloured {
        let payload = bytemuck::cast_slice(&environment.colours).to_vec();
        sections.push(Section::texture(COLOURS, name, params.colours_resource(), payload));
    }
    let payload = bytemuck::cast_slice(&environment.albedo).to_vec();
    sections.push(Section::texture(ALBEDO, name, params.albedo_resource(), payload));
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Reads the environment `name`. The pack must have passed verification; errors name what is missing or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<Environment> {
    let params = params(pack, name)?;
    let Some(uniform) = records::<EnvironmentUniform>(pack, UNIFORM, name)?.first().copied() else {
        return Err(BakeError::BadInput(format!("'{name}': expected a record of {UNIFORM}, found none")));
    };
    let mut environment = Environment {
        mirror: records(pack, MIRROR, name)?,
        radiance: records(pack, RADIANCE, name)?,
        indicators: Vec::new(),
        colours: Vec::new(),
        albedo: records(pack, ALBEDO, name)?,
        uniform,
        params,
    };
    let params = &environment.params;
    let mut lengths = vec![
        (params.mirror_resource(), 2 * environment.mirror.len()),
        (params.radiance_resource(), 2 * environment.radiance.len()),
        (params.albedo_resource(), 2 * environment.albedo.len()),
    ];
    if params.indicator_layers() > 0 {
        environment.indicators = records(pack, INDICATORS, name)?;
        lengths.push((params.indicators_resource(), 2 * environment.indicators.len()));
    }
    if params.coloured {
        environment.colours = records(pack, COLOURS, name)?;
        lengths.push((params.colours_resource(), 4 * environment.colours.len()));
    }
    for (resource, found) in lengths {
        if resource.byte_len() != Ok(Some(found as u64)) {
            return Err(BakeError::BadInput(format!("'{name}': expected {resource:?}, found {found} bytes")));
        }
    }
    Ok(environment)
}

/// Reads the parameters of the environment `name`.
///
/// # Errors
/// `BadInput` for a section that is missing or damaged.
pub fn params(pack: &Pack, name: &str) -> Result<EnvironmentParams> {
    parameters(pack, PARAMS, name)
}

/// Names of the environments in a pack.
pub fn environments(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}
