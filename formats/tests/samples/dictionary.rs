//! Sections of a dictionary.

use glint_formats::dictionary::{self, DictionaryParams};
use glint_formats::{Resource, Section, vk_format};

/// Two marginals at two levels, of four entries half a slope apart.
pub fn dictionary_params() -> DictionaryParams {
    DictionaryParams {
        marginals: 2,
        levels: 2,
        entries: 4,
        alpha_dict: 0.7,
        lobe_std: 0.25,
        domain: 2.0,
        seed: 7,
        measured: dictionary::MeasuredError::default(),
    }
}

/// Sixteen half floats, all 0.25: the rows of [`dictionary_params`] as a box.
pub fn dictionary_table() -> Vec<u16> {
    vec![0x3400; 16]
}

/// The two sections of a dictionary.
pub fn dictionary_sections(params: &DictionaryParams, table: &[u16]) -> Vec<Section> {
    let resource = Resource::Texture {
        vk_format: vk_format::R16_SFLOAT,
        width: 4,
        height: table.len() as u32 / 4,
        layers: 1,
        faces: 1,
        mips: 1,
    };
    vec![
        Section::parameters(dictionary::PARAMS, "lobes", params),
        Section::texture(dictionary::TABLE, "lobes", resource, bytemuck::cast_slice(table).to_vec()),
    ]
}
