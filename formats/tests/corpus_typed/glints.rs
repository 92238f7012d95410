//! Bad packs of counted facets.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::IssueCode;
use glint_formats::glints::{self, GlintsParams, GlintsUniform};

fn with_params(edit: impl Fn(&mut GlintsParams)) -> Vec<u8> {
    let mut params = glints_params();
    edit(&mut params);
    pack(glints_sections(&params, &ltc_table()))
}

fn with_uniform(edit: impl Fn(&mut GlintsUniform)) -> Vec<u8> {
    let mut sections = good_glints();
    let mut uniform = glints_params().uniform();
    edit(&mut uniform);
    sections[1].payload = bytemuck::bytes_of(&uniform).to_vec();
    pack(sections)
}

fn with_colour(at: usize, value: f32) -> Vec<u8> {
    let mut sections = good_glints();
    let mut colours = glints_params().palette();
    colours.as_flattened_mut()[at] = value;
    sections[2].payload = bytemuck::cast_slice(&colours).to_vec();
    pack(sections)
}

/// A pack whose parameters name one colour more than its sections hold.
fn with_one_more_colour() -> Vec<u8> {
    let mut sections = good_glints();
    let mut params = glints_params();
    params.colours.push([0.25; 3]);
    sections[0] = glints_sections(&params, &ltc_table()).swap_remove(0);
    sections[1] = glints_sections(&params, &ltc_table()).swap_remove(1);
    pack(sections)
}

pub fn cases() -> Vec<Case> {
    vec![
        case(IssueCode::GlintsParameters, with_params(|params| params.density = f32::NAN)),
        case(IssueCode::GlintsShape, with_one_more_colour()),
        case(IssueCode::GlintsUniform, with_uniform(|uniform| uniform.seed = 8)),
        case(IssueCode::GlintsColours, with_colour(5, 0.25)),
    ]
}

#[test]
fn every_way_counted_facets_can_be_wrong_is_found() {
    let edits: [fn(&mut GlintsParams); 18] = [
        |params| params.alpha[1] = 0.0,
        |params| params.alpha[0] = 1.5,
        |params| params.turn = 4.0,
        |params| params.f0[2] = -0.1,
        |params| params.density = 0.0,
        |params| params.density = f32::INFINITY,
        |params| params.relative_area = 1.01,
        |params| params.facet_area = 0.5,
        |params| params.facet_spread = 0.0,
        |params| params.sky_spread = -1.0,
        |params| params.diffuse[1] = 1.5,
        |params| params.coat = -0.25,
        |params| params.coat = f32::NAN,
        |params| params.coat_alpha = 0.0,
        |params| params.colours = vec![[0.5; 3]; 257],
        |params| params.colours[1][2] = -0.5,
        |params| params.colours[0][0] = f32::INFINITY,
        |params| params.table_mean_error = f64::NAN,
    ];
    for edit in edits {
        assert_eq!(codes(&with_params(edit)), [IssueCode::GlintsParameters]);
    }
    let edits: [fn(&mut GlintsUniform); 4] = [
        |uniform| uniform.unused[1] = 1,
        |uniform| uniform.turn[0] = f32::NAN,
        |uniform| uniform.layers.coat = 0.25,
        |uniform| uniform.layers.unused[2] = 1,
    ];
    for edit in edits {
        assert_eq!(codes(&with_uniform(edit)), [IssueCode::GlintsUniform]);
    }
    assert_eq!(codes(&with_colour(3, 0.0)), [IssueCode::GlintsColours]);
    assert_eq!(codes(&with_params(|params| params.colours.clear())), []);
    let mut table = ltc_table();
    table[6] = 0x7e00;
    assert_eq!(codes(&pack(glints_sections(&glints_params(), &table))), [IssueCode::LtcValue; 2]);
    let lacking = |kind| pack(without(good_glints(), kind));
    for kind in [glints::UNIFORM, glints::COLOURS, glints::INVERSE, glints::TERMS] {
        assert_eq!(codes(&lacking(kind)), [IssueCode::MissingSection]);
    }
    assert_eq!(codes(&lacking(glints::PARAMS)), [IssueCode::OrphanSection; 4]);
}
