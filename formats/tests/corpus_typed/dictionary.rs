//! Bad packs of dictionaries.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::IssueCode;
use glint_formats::dictionary::{self, DictionaryParams, DictionaryUniform};

fn dictionary_with_params(edit: impl Fn(&mut DictionaryParams)) -> Vec<u8> {
    let mut params = dictionary_params();
    edit(&mut params);
    pack(dictionary_sections(&params, &dictionary_pairs(&dictionary_table())))
}

fn dictionary_with_table(edit: impl Fn(&mut Vec<u16>)) -> Vec<u8> {
    let mut table = dictionary_table();
    edit(&mut table);
    pack(dictionary_sections(&dictionary_params(), &dictionary_pairs(&table)))
}

fn dictionary_with_words(edit: impl Fn(&mut Vec<u32>)) -> Vec<u8> {
    let mut words = dictionary_pairs(&dictionary_table());
    edit(&mut words);
    pack(dictionary_sections(&dictionary_params(), &words))
}

fn dictionary_with_uniform(edit: impl Fn(&mut DictionaryUniform)) -> Vec<u8> {
    let mut sections = good_dictionary();
    let mut uniform = dictionary_params().uniform();
    edit(&mut uniform);
    sections[1].payload = bytemuck::bytes_of(&uniform).to_vec();
    pack(sections)
}

pub fn cases() -> Vec<Case> {
    vec![
        case(IssueCode::DictionaryParameters, dictionary_with_params(|params| params.domain = f64::NAN)),
        case(IssueCode::DictionaryShape, dictionary_with_params(|params| params.levels = 3)),
        case(IssueCode::DictionaryValue, dictionary_with_table(|table| table[5] = 0xb400)),
        case(IssueCode::DictionaryRow, dictionary_with_table(|table| table[4..8].fill(0))),
        case(IssueCode::DictionaryUniform, dictionary_with_uniform(|uniform| uniform.entries = 8)),
        case(IssueCode::DictionaryPair, dictionary_with_words(|words| words[6] = 0x3400)),
    ]
}

#[test]
fn every_way_a_dictionary_can_be_wrong_is_found() {
    let edits: [fn(&mut DictionaryParams); 10] = [
        |params| params.marginals = 0,
        |params| params.levels = 0,
        |params| params.entries = 0,
        |params| params.entries = u32::MAX,
        |params| (params.marginals, params.levels) = (1 << 31, 1 << 31),
        |params| (params.marginals, params.entries) = (4096, 8192),
        |params| params.alpha_dict = -0.5,
        |params| params.lobe_std = 0.0,
        |params| params.domain = f64::INFINITY,
        |params| params.measured.ks_last_level = f64::NAN,
    ];
    for edit in edits {
        assert_eq!(codes(&dictionary_with_params(edit)), [IssueCode::DictionaryParameters]);
    }
    for bits in [0x7e00, 0x7c00, 0xfc00, 0x8001] {
        assert_eq!(codes(&dictionary_with_table(|table| table[15] = bits)), [IssueCode::DictionaryValue]);
    }
    assert_eq!(codes(&dictionary_with_table(|table| table.truncate(12))), [IssueCode::DictionaryShape]);
    assert_eq!(codes(&dictionary_with_table(|table| table[12] = 0x3410)), [IssueCode::DictionaryRow]);
    // The last entry is paired with itself; words after the last row are zeros.
    assert_eq!(codes(&dictionary_with_words(|words| words[15] = 0x3400)), [IssueCode::DictionaryPair]);
    let odd = DictionaryParams { marginals: 1, levels: 1, entries: 3, domain: 1.5, ..dictionary_params() };
    let with_end = |end| codes(&pack(dictionary_sections(&odd, &[0x3555_3555, 0x3555_3555, 0x3555_3555, end])));
    assert_eq!(with_end(0), []);
    assert_eq!(with_end(1), [IssueCode::DictionaryPair]);
    let edits: [fn(&mut DictionaryUniform); 3] =
        [|uniform| uniform.lobe_area *= 2.0, |uniform| uniform.unused = 1, |uniform| uniform.domain = f32::NAN];
    for edit in edits {
        assert_eq!(codes(&dictionary_with_uniform(edit)), [IssueCode::DictionaryUniform]);
    }
    let lacking = |kind| pack(without(good_dictionary(), kind));
    assert_eq!(codes(&lacking(dictionary::TABLE)), [IssueCode::MissingSection]);
    assert_eq!(codes(&lacking(dictionary::UNIFORM)), [IssueCode::MissingSection]);
    assert_eq!(codes(&lacking(dictionary::PARAMS)), [IssueCode::OrphanSection; 2]);
}
