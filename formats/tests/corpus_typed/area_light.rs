//! Bad packs of area lights.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::area_light::{self, AreaLightParams, AreaLightUniform};
use glint_formats::{IssueCode, Resource};

fn area_light_with_params(edit: impl Fn(&mut AreaLightParams)) -> Vec<u8> {
    let mut params = area_light_params();
    edit(&mut params);
    pack(area_light_sections(&params, &area_light_texels(), &ltc_table()))
}

fn area_light_with_texels(edit: impl Fn(&mut [Vec<u8>; 2])) -> Vec<u8> {
    let mut texels = area_light_texels();
    edit(&mut texels);
    pack(area_light_sections(&area_light_params(), &texels, &ltc_table()))
}

fn area_light_with_table(edit: impl Fn(&mut Vec<u16>)) -> Vec<u8> {
    let mut table = ltc_table();
    edit(&mut table);
    pack(area_light_sections(&area_light_params(), &area_light_texels(), &table))
}

/// An LTC table of half the height.
fn short_table() -> Vec<u8> {
    let mut sections = good_area_light();
    let table = sections.iter_mut().find(|section| section.kind == area_light::TERMS).unwrap();
    table.payload.truncate(64 * 32 * 8);
    if let Resource::Texture { height, .. } = &mut table.resource {
        *height = 32;
    }
    pack(sections)
}

fn area_light_with_uniform(edit: impl Fn(&mut AreaLightUniform)) -> Vec<u8> {
    let mut sections = good_area_light();
    let mut uniform = area_light_params().uniform();
    edit(&mut uniform);
    sections[1].payload = bytemuck::bytes_of(&uniform).to_vec();
    pack(sections)
}

pub fn cases() -> Vec<Case> {
    vec![
        case(IssueCode::AreaLightParameters, area_light_with_params(|params| params.base_roughness = 0.0)),
        case(IssueCode::AreaLightShape, area_light_with_params(|params| params.anisotropic = false)),
        case(IssueCode::AreaLightNormal, area_light_with_texels(|[normals, _]| normals[4] = 100)),
        case(IssueCode::AreaLightRoughness, area_light_with_texels(|[_, roughness]| roughness[9] = 100)),
        case(IssueCode::LtcShape, short_table()),
        case(IssueCode::LtcValue, area_light_with_table(|table| table[1] = 0xbc00)),
        case(IssueCode::AreaLightUniform, area_light_with_uniform(|uniform| uniform.mips = 1)),
    ]
}

#[test]
fn every_way_an_area_light_can_be_wrong_is_found() {
    let edits: [fn(&mut AreaLightParams); 9] = [
        |params| params.width = 0,
        |params| params.width = 8193,
        |params| params.height = u32::MAX,
        |params| params.base_roughness = f32::NAN,
        |params| params.base_roughness = 1.5,
        |params| params.base_roughness = 0.0005,
        |params| params.measured.normal_angle = f64::NAN,
        |params| params.measured.roughness = -1.0,
        |params| params.measured.table_mean = f64::INFINITY,
    ];
    for edit in edits {
        assert_eq!(codes(&area_light_with_params(edit)), [IssueCode::AreaLightParameters]);
    }
    // Below the surface, a roughness below 0, in the last mip as in the first.
    for (at, value) in [(2, 0x81), (3, 0xf0), (11, 0xf0)] {
        assert_eq!(codes(&area_light_with_texels(|[normals, _]| normals[at] = value)), [IssueCode::AreaLightNormal]);
    }
    for (at, value) in [(8, 0xc0), (11, 1), (1, 127)] {
        assert_eq!(codes(&area_light_with_texels(|[_, found]| found[at] = value)), [IssueCode::AreaLightRoughness]);
    }
    assert_eq!(codes(&area_light_with_params(|params| params.height = 2)), [IssueCode::AreaLightShape; 2]);
    // A matrix that mirrors, which terms may be; then a negative term, which a matrix may have.
    assert_eq!(codes(&area_light_with_table(|table| table[1] = 0x3c00)), [] as [IssueCode; 0]);
    assert_eq!(codes(&area_light_with_table(|table| table[1..3].fill(0x3d00))), [IssueCode::LtcValue; 2]);
    assert_eq!(codes(&area_light_with_table(|table| table[7] = 0x7e00)), [IssueCode::LtcValue; 2]);
    let edits: [fn(&mut AreaLightUniform); 4] = [
        |uniform| uniform.size[0] = 3.0,
        |uniform| uniform.wrap = 0,
        |uniform| uniform.anisotropic = 2,
        |uniform| uniform.unused_2 = 1,
    ];
    for edit in edits {
        assert_eq!(codes(&area_light_with_uniform(edit)), [IssueCode::AreaLightUniform]);
    }
    for kind in
        [area_light::UNIFORM, area_light::NORMALS, area_light::ROUGHNESS, area_light::INVERSE, area_light::TERMS]
    {
        assert_eq!(codes(&pack(without(good_area_light(), kind))), [IssueCode::MissingSection]);
    }
    assert_eq!(codes(&pack(without(good_area_light(), area_light::PARAMS))), [IssueCode::OrphanSection; 5]);
}
