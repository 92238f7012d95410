//! Bad packs of lobes.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::lobes::{self, HalfLobe, LobeLevel, LobeStorage, LobesParams, LobesUniform, PackedLobe};
use glint_formats::synthesis::SynthesisUniform;
use glint_formats::{IssueCode, Section};

fn lobes_with_params(edit: impl Fn(&mut LobesParams)) -> Vec<u8> {
    let mut params = lobes_params(LobeStorage::Packed);
    edit(&mut params);
    pack(lobes_sections(&params, &packed_lobes(), &half_lobes(), &lobes_normals()))
}

fn lobes_with_packed(edit: impl Fn(&mut Vec<PackedLobe>)) -> Vec<u8> {
    let mut lobes = packed_lobes();
    edit(&mut lobes);
    pack(lobes_sections(&lobes_params(LobeStorage::Packed), &lobes, &[], &lobes_normals()))
}

fn lobes_with_half(edit: impl Fn(&mut HalfLobe)) -> Vec<u8> {
    let mut lobes = half_lobes();
    edit(&mut lobes[2]);
    pack(lobes_sections(&lobes_params(LobeStorage::Half), &[], &lobes, &lobes_normals()))
}

fn lobes_with_normals(edit: impl Fn(&mut Vec<[u32; 2]>)) -> Vec<u8> {
    let mut normals = lobes_normals();
    edit(&mut normals);
    pack(lobes_sections(&lobes_params(LobeStorage::Packed), &packed_lobes(), &[], &normals))
}

fn lobes_with_uniform(edit: impl Fn(&mut LobesUniform)) -> Vec<u8> {
    let mut uniform = lobes_params(LobeStorage::Packed).uniform(SynthesisUniform::default());
    edit(&mut uniform);
    let mut sections = good_lobes();
    sections[1] = Section::buffer(lobes::UNIFORM, "hide", &[uniform]);
    pack(sections)
}

pub fn cases() -> Vec<Case> {
    // In the corner of the square, outside the disk; the texel above it has it too.
    let corner = |normals: &mut Vec<[u32; 2]>| (normals[8][0], normals[3][1]) = (0x00ff_00ff, 0x00ff_00ff);
    vec![
        case(IssueCode::LobesParameters, lobes_with_params(|params| params.lobes_per_cell = 0)),
        case(IssueCode::LobesLevels, lobes_with_params(|params| params.levels[1].first_lobe = 5)),
        case(IssueCode::LobesCount, lobes_with_packed(|lobes| lobes.truncate(4))),
        case(IssueCode::LobeValue, lobes_with_packed(|lobes| lobes[2].correlation[1] = -128)),
        case(IssueCode::LobeCellEmpty, lobes_with_packed(|lobes| lobes[4].normal_weight = 0x00ff_ffff)),
        case(IssueCode::LobesNormalsShape, lobes_with_normals(|normals| normals.truncate(15))),
        case(IssueCode::LobesNormal, lobes_with_normals(corner)),
        case(IssueCode::LobesNormalPair, lobes_with_normals(|normals| normals[14][1] = 0x0081_0080)),
        case(IssueCode::LobesUniform, lobes_with_uniform(|uniform| uniform.map.lobes_per_cell = 3)),
    ]
}

#[test]
fn every_way_lobes_can_be_wrong_is_found() {
    assert_eq!(codes(&lobes_with_params(|_| ())), [] as [IssueCode; 0]);
    assert_eq!(codes(&lobes_with_half(|_| ())), [] as [IssueCode; 0]);
    let parameters: [fn(&mut LobesParams); 11] = [
        |params| params.rim_roughness = -0.1,
        |params| params.measured_roughness = 0.01,
        |params| params.width = 0,
        |params| params.height = 20_000,
        |params| params.lobes_per_cell = 257,
        |params| params.seeds = 2,
        |params| params.intrinsic_roughness = f32::NAN,
        |params| params.normal_low[0] = -1.5,
        |params| params.normal_extent[1] = f32::NAN,
        |params| params.normal_extent[0] = 1.75,
        |params| params.measured[0].mean = -0.1,
    ];
    for edit in parameters {
        assert_eq!(codes(&lobes_with_params(edit)), [IssueCode::LobesParameters]);
    }
    let levels: [fn(&mut LobesParams); 12] = [
        |params| params.levels.clear(),
        |params| params.levels = vec![params.levels[0]; 17],
        |params| params.levels = vec![LobeLevel { cell_texels: 1, cells_x: 5, cells_y: 3, ..params.levels[0] }],
        |params| params.levels[0].cell_texels = 6,
        |params| params.levels[1].cell_texels = 16,
        |params| params.levels[0].cells_y = 2,
        |params| params.levels[0].weight_scale = 0.0,
        |params| params.levels[0].position_sigma = [0.0, 1.0],
        |params| params.levels[0].position_sigma = [2.0, 1.0],
        |params| params.levels[0].residual_sigma = [1e-9, 1.0],
        |params| params.levels[1].jacobian_scale = f32::INFINITY,
        |params| params.levels[1].first_lobe = 0,
    ];
    for edit in levels {
        assert_eq!(codes(&lobes_with_params(edit)), [IssueCode::LobesLevels]);
    }
    // Two cells may be the last level; its lobes are then too many.
    assert_eq!(codes(&lobes_with_params(|params| params.levels.truncate(1))), [IssueCode::LobesCount]);
    let halves: [fn(&mut HalfLobe); 6] = [
        |lobe| lobe.weight = 0x7e00,
        |lobe| lobe.position_sigma[1] = 0xbc00,
        |lobe| lobe.residual_sigma[0] = 0x7c00,
        |lobe| lobe.jacobian[3] = 0xfc00,
        |lobe| lobe.correlation[0] = i16::MIN,
        |lobe| lobe.reserved = 1,
    ];
    for edit in halves {
        let found = codes(&lobes_with_half(edit));
        assert!(found.contains(&IssueCode::LobeValue), "{found:?}");
    }
    assert_eq!(codes(&lobes_with_half(|lobe| lobe.weight = 0)), [IssueCode::LobeCellEmpty]);
    assert_eq!(codes(&lobes_with_packed(|lobes| lobes[0].jacobian[2] = -128)), [IssueCode::LobeValue]);
    assert_eq!(codes(&lobes_with_packed(|lobes| lobes.push(PackedLobe::default()))), [IssueCode::LobesCount]);
    let uniforms: [fn(&mut LobesUniform); 4] = [
        |uniform| uniform.map.wrap = 1,
        |uniform| uniform.synthesis.columns = 1,
        |uniform| uniform.levels[1].position_log_ratio += 1e-3,
        |uniform| uniform.levels[15].cells_x = 1,
    ];
    for edit in uniforms {
        assert_eq!(codes(&lobes_with_uniform(edit)), [IssueCode::LobesUniform]);
    }
    assert_eq!(codes(&lobes_with_uniform(|uniform| uniform.levels[0].residual_log_ratio += 2e-6)), []);
    assert_eq!(codes(&lobes_with_normals(|normals| normals[15] = [1; 2])), [IssueCode::LobesNormalPair]);
    let wide = |normals: &mut Vec<[u32; 2]>| (normals[8][0], normals[3][1]) = (0x0100_0080, 0x0100_0080);
    assert_eq!(codes(&lobes_with_normals(wide)), [IssueCode::LobesNormal]);
    for kind in [lobes::UNIFORM, lobes::LOBES, lobes::NORMALS] {
        assert_eq!(codes(&pack(without(good_lobes(), kind))), [IssueCode::MissingSection]);
    }
    assert_eq!(codes(&pack(without(good_lobes(), lobes::PARAMS))), [IssueCode::OrphanSection; 3]);
}
