//! Bad packs of dictionaries.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::IssueCode;
use glint_formats::dictionary::{self, DictionaryParams};

fn dictionary_with_params(edit: impl Fn(&mut DictionaryParams)) -> Vec<u8> {
    let mut params = dictionary_params();
    edit(&mut params);
    pack(dictionary_sections(&params, &dictionary_table()))
}

fn dictionary_with_table(edit: impl Fn(&mut Vec<u16>)) -> Vec<u8> {
    let mut table = dictionary_table();
    edit(&mut table);
    pack(dictionary_sections(&dictionary_params(), &table))
}

pub fn cases() -> Vec<Case> {
    vec![
        case(IssueCode::DictionaryParameters, dictionary_with_params(|params| params.domain = f64::NAN)),
        case(IssueCode::DictionaryShape, dictionary_with_params(|params| params.levels = 3)),
        case(IssueCode::DictionaryValue, dictionary_with_table(|table| table[5] = 0xb400)),
        case(IssueCode::DictionaryRow, dictionary_with_table(|table| table[4..8].fill(0))),
    ]
}

#[test]
fn every_way_a_dictionary_can_be_wrong_is_found() {
    let edits: [fn(&mut DictionaryParams); 9] = [
        |params| params.marginals = 0,
        |params| params.levels = 0,
        |params| params.entries = 0,
        |params| params.entries = u32::MAX,
        |params| (params.marginals, params.levels) = (1 << 31, 1 << 31),
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
    let lacking = |kind| pack(without(dictionary_sections(&dictionary_params(), &dictionary_table()), kind));
    assert_eq!(codes(&lacking(dictionary::TABLE)), [IssueCode::MissingSection]);
    assert_eq!(codes(&lacking(dictionary::PARAMS)), [IssueCode::OrphanSection]);
}
