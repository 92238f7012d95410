//! Sections of an area light.

use glint_formats::Wrap;
use glint_formats::area_light::{self, AreaLightParams, NormalStorage};
use glint_formats::{Resource, Section, vk_format};

/// A map of 2 × 1 texels, with roughness by direction.
pub fn area_light_params() -> AreaLightParams {
    AreaLightParams {
        width: 2,
        height: 1,
        wrap: Wrap::Clamp,
        base_roughness: 0.1,
        storage: NormalStorage::Snorm8,
        anisotropic: true,
        measured: area_light::MeasuredError::default(),
    }
}

/// Normals and roughness of [`area_light_params`]: two texels and their mean.
pub fn area_light_texels() -> [Vec<u8>; 2] {
    [vec![0, 0, 127, 0, 40, 0, 120, 0, 20, 0, 123, 60], vec![0, 0, 0, 0, 0, 0, 0, 0, 90, 30, 40, 0]]
}

/// A table of half floats: every texel (1, 0, 0, 1).
pub fn ltc_table() -> Vec<u16> {
    [0x3c00, 0, 0, 0x3c00].repeat(64 * 64)
}

/// The six sections of an area-light material, uniforms as they follow from the parameters.
pub fn area_light_sections(params: &AreaLightParams, texels: &[Vec<u8>; 2], table: &[u16]) -> Vec<Section> {
    let texture =
        |vk_format, width, height, mips| Resource::Texture { vk_format, width, height, layers: 1, faces: 1, mips };
    let map = texture(vk_format::R8G8B8A8_SNORM, 2, 1, 2);
    let ltc = texture(vk_format::R16G16B16A16_SFLOAT, 64, 64, 1);
    let [normals, roughness] = texels;
    let table: Vec<u8> = bytemuck::cast_slice(table).to_vec();
    vec![
        Section::parameters(area_light::PARAMS, "metal", params),
        Section::buffer(area_light::UNIFORM, "metal", &[params.uniform()]),
        Section::texture(area_light::NORMALS, "metal", map, normals.clone()),
        Section::texture(area_light::ROUGHNESS, "metal", map, roughness.clone()),
        Section::texture(area_light::INVERSE, "metal", ltc, table.clone()).compressed(),
        Section::texture(area_light::TERMS, "metal", ltc, table).compressed(),
    ]
}

pub fn good_area_light() -> Vec<Section> {
    area_light_sections(&area_light_params(), &area_light_texels(), &ltc_table())
}
