//! Sections of counted facets.

use super::ltc_table;
use glint_formats::glints::{self, GlintsParams, Slopes};
use glint_formats::{Resource, Section, vk_format};

/// Two colours, everything else as plain as can be.
pub fn glints_params() -> GlintsParams {
    GlintsParams {
        slopes: Slopes::Ggx,
        alpha: [0.3, 0.2],
        turn: 0.5,
        f0: [0.9, 0.8, 0.7],
        density: 1e6,
        relative_area: 0.75,
        facet_area: 1.125,
        facet_spread: 0.005,
        sky_spread: 0.0,
        seed: 7,
        diffuse: [0.5, 0.25, 0.125],
        coat: 0.5,
        coat_alpha: 0.05,
        colours: vec![[1.0, 0.5, 0.25], [0.0, 0.5, 0.75]],
        table_mean_error: 0.0754,
    }
}

/// The five sections of a material, the uniforms and the palette as they follow from the parameters.
pub fn glints_sections(params: &GlintsParams, table: &[u16]) -> Vec<Section> {
    let ltc = Resource::Texture {
        vk_format: vk_format::R16G16B16A16_SFLOAT,
        width: 64,
        height: 64,
        layers: 1,
        faces: 1,
        mips: 1,
    };
    let table: Vec<u8> = bytemuck::cast_slice(table).to_vec();
    vec![
        Section::parameters(glints::PARAMS, "flakes", params),
        Section::buffer(glints::UNIFORM, "flakes", &[params.uniform()]),
        Section::buffer(glints::COLOURS, "flakes", &params.palette()),
        Section::texture(glints::INVERSE, "flakes", ltc, table.clone()).compressed(),
        Section::texture(glints::TERMS, "flakes", ltc, table).compressed(),
    ]
}

pub fn good_glints() -> Vec<Section> {
    glints_sections(&glints_params(), &ltc_table())
}
