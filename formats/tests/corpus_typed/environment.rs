//! Bad packs of environments.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::environment::{self, EnvironmentParams};
use glint_formats::{IssueCode, Section};

fn environment_with_params(edit: impl Fn(&mut EnvironmentParams)) -> Vec<u8> {
    let mut params = environment_params();
    edit(&mut params);
    pack(environment_sections(&params, &environment_indicators(), 0x3c00))
}

fn environment_with_indicators(edit: impl Fn(&mut Vec<u16>)) -> Vec<u8> {
    let mut indicators = environment_indicators();
    edit(&mut indicators);
    pack(environment_sections(&environment_params(), &indicators, 0x3c00))
}

fn environment_with(kind: glint_formats::FourCc, edit: impl Fn(&mut Section)) -> Vec<u8> {
    let mut sections = environment_sections(&environment_params(), &environment_indicators(), 0x3c00);
    sections.iter_mut().filter(|section| section.kind == kind).for_each(edit);
    pack(sections)
}

pub fn cases() -> Vec<Case> {
    let infinite = |section: &mut Section| section.payload[6..8].copy_from_slice(&0x7c00u16.to_le_bytes());
    vec![
        case(IssueCode::EnvironmentParameters, environment_with_params(|params| params.radiance_scale = 0.0)),
        case(IssueCode::EnvironmentLevels, environment_with_params(|params| params.levels[0] = 0.5)),
        case(IssueCode::EnvironmentShape, environment_with_params(|params| params.albedo_size = 4)),
        case(IssueCode::EnvironmentRadiance, environment_with(environment::RADIANCE, infinite)),
        case(IssueCode::EnvironmentIndicators, environment_with_indicators(|indicators| indicators[5] = 0x3c00)),
        case(IssueCode::EnvironmentAlbedo, environment_with(environment::ALBEDO, infinite)),
        case(IssueCode::EnvironmentUniform, environment_with(environment::UNIFORM, |section| section.payload[132] = 3)),
    ]
}

#[test]
fn every_way_an_environment_can_be_wrong_is_found() {
    let edits: [fn(&mut EnvironmentParams); 22] = [
        |params| params.face_size = 0,
        |params| params.face_size = 3,
        |params| params.face_size = 1 << 31,
        |params| params.roughness.clear(),
        |params| params.roughness.push(1.5),
        |params| params.roughness[0] = 0.1,
        |params| params.roughness[1] = 0.0,
        |params| params.roughness[1] = f64::NAN,
        |params| params.albedo_size = 0,
        |params| params.look_ups = 0,
        |params| params.look_ups = 4,
        |params| params.radiance_scale = f64::INFINITY,
        |params| params.filter_error = -1.0,
        |params| params.max_error = Some(0.0),
        |params| params.per_size = 0,
        |params| params.per_size = 2,
        |params| params.levels = vec![2.0],
        |params| params.mean_radiance[1] = f64::NAN,
        |params| params.measured.energy = f64::INFINITY,
        |params| params.measured.texels[1].worst = -1.0,
        |params| params.measured.reads[1].relative = -1.0,
        |params| params.measured.rounding[0] = f64::NAN,
    ];
    for edit in edits {
        assert_eq!(codes(&environment_with_params(edit)), [IssueCode::EnvironmentParameters]);
    }
    let levels: [&[f64]; 5] = [&[], &[0.0, 1.0, 1.0], &[0.0, 2.0, 1.0], &[0.0, 1.0, f64::NAN], &[0.0; 17]];
    for levels in levels {
        let bytes = environment_with_params(|params| {
            params.levels = levels.to_vec();
            params.coloured = false;
        });
        assert_eq!(codes(&bytes), [IssueCode::EnvironmentLevels], "{levels:?}");
    }
    // Negative, not a number, too much together, and a component beyond the levels.
    for (at, bits) in [(0, 0x8400), (1, 0x7e00), (0, 0x3a01), (2, 0x0001), (23, 0x3c00)] {
        let bytes = environment_with_indicators(|indicators| indicators[at] = bits);
        assert_eq!(codes(&bytes), [IssueCode::EnvironmentIndicators], "{at} {bits:#x}");
    }
    assert_eq!(codes(&environment_with_indicators(|indicators| indicators[0] = 0x3a00)), []);
    for at in (0..176).step_by(4) {
        let bytes = environment_with(environment::UNIFORM, |section| section.payload[at] ^= 1);
        assert_eq!(codes(&bytes), [IssueCode::EnvironmentUniform], "byte {at}");
    }
    // Layers of four texels: not a number, a negative albedo, ratio, square and share, and a share above 1. A shift may be negative.
    let albedo = [(2, 0x7e00), (18, 0xfc00), (0, 0xbc00), (3, 0xb800), (16, 0x8400), (34, 0xb800), (34, 0x3c01)];
    for (at, bits) in albedo.into_iter().map(|(at, bits): (usize, u16)| (2 * at, bits.to_le_bytes())) {
        let bytes = environment_with(environment::ALBEDO, |section| section.payload[at..at + 2].copy_from_slice(&bits));
        assert_eq!(codes(&bytes), [IssueCode::EnvironmentAlbedo], "{at} {bits:?}");
    }
    let sections = || environment_sections(&environment_params(), &environment_indicators(), 0x3c00);
    let textures = [
        environment::MIRROR,
        environment::RADIANCE,
        environment::INDICATORS,
        environment::COLOURS,
        environment::ALBEDO,
    ];
    for kind in textures.into_iter().chain([environment::UNIFORM]) {
        assert_eq!(codes(&pack(without(sections(), kind))), [IssueCode::MissingSection], "{kind}");
    }
    assert_eq!(codes(&pack(without(sections(), environment::PARAMS))), [IssueCode::OrphanSection; 6]);
}
