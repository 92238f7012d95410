//! Sections of a dictionary.

use glint_formats::Section;
use glint_formats::dictionary::{self, DictionaryParams};

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

/// A row's half floats, each with the next of four: words of the table.
pub fn dictionary_pairs(table: &[u16]) -> Vec<u32> {
    let pair = |row: &[u16], b: usize| u32::from(row[b]) | u32::from(row[(b + 1).min(row.len() - 1)]) << 16;
    table.chunks(4).flat_map(|row| (0..row.len()).map(move |b| pair(row, b))).collect()
}

/// The three sections of a dictionary: parameters, the uniforms that follow from them, and a table.
pub fn dictionary_sections(params: &DictionaryParams, words: &[u32]) -> Vec<Section> {
    vec![
        Section::parameters(dictionary::PARAMS, "lobes", params),
        Section::buffer(dictionary::UNIFORM, "lobes", &[params.uniform()]),
        Section::buffer(dictionary::TABLE, "lobes", words),
    ]
}

pub fn good_dictionary() -> Vec<Section> {
    dictionary_sections(&dictionary_params(), &dictionary_pairs(&dictionary_table()))
}
