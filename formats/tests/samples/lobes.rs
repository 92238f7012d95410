//! Sections of lobes.

use glint_formats::Section;
use glint_formats::Wrap;
use glint_formats::lobes::{self, HalfLobe, LobeLevel, LobeStorage, LobesParams, NormalsStorage, PackedLobe};
use glint_formats::synthesis::SynthesisUniform;

/// A map of 5 × 3 texels: two cells of 4 texels, one of 8, two lobes each.
pub fn lobes_params(storage: LobeStorage) -> LobesParams {
    let level = LobeLevel {
        cell_texels: 4,
        cells_x: 2,
        cells_y: 1,
        first_lobe: 0,
        weight_scale: 12.0,
        position_sigma: [0.3, 2.0],
        residual_sigma: [1e-5, 0.02],
        jacobian_scale: 0.1,
    };
    LobesParams {
        width: 5,
        height: 3,
        wrap: Wrap::Repeat,
        filter: lobes::Filter::Linear,
        intrinsic_roughness: 0.02,
        storage,
        normals: NormalsStorage::Unorm8,
        merge: lobes::Merge::Runnalls,
        seeds: 4,
        lobes_per_cell: 2,
        step_texels: 0,
        normal_low: [-0.5, -0.25],
        normal_extent: [0.75, 0.5],
        levels: vec![level, LobeLevel { cell_texels: 8, cells_x: 1, first_lobe: 4, ..level }],
        rim_roughness: 0.1,
        measured_roughness: 0.02,
        measured: vec![lobes::FootprintError { sigma_texels: 2.0, mean: 0.01, worst: 0.02 }],
    }
}

/// One lobe a cell, and one without weight.
pub fn packed_lobes() -> Vec<PackedLobe> {
    let lobe = PackedLobe {
        jacobian: [3, -4, 127, 0],
        normal_weight: 0xff80_0800,
        position: [100, 200],
        correlation: [-127, 5],
        position_sigma: [9, 255],
        residual_sigma: [0, 30],
    };
    [lobe, PackedLobe::default()].repeat(3)
}

/// The same as half floats.
pub fn half_lobes() -> Vec<HalfLobe> {
    let lobe = HalfLobe {
        jacobian: [0x2c00, 0xac00, 0, 0],
        normal: [9, 0xffff],
        position: [0, 7],
        position_sigma: [0x3800, 0x3c00],
        residual_sigma: [0, 0x1400],
        correlation: [-32767, 3],
        weight: 0x3c00,
        reserved: 0,
    };
    [lobe, HalfLobe::default()].repeat(3)
}

/// The four sections of a map's lobes.
pub fn lobes_sections(
    params: &LobesParams,
    packed: &[PackedLobe],
    half: &[HalfLobe],
    normals: &[[u32; 2]],
) -> Vec<Section> {
    let records = match params.storage {
        LobeStorage::Packed => Section::buffer(lobes::LOBES, "hide", packed),
        LobeStorage::Half => Section::buffer(lobes::LOBES, "hide", half),
    };
    vec![
        Section::parameters(lobes::PARAMS, "hide", params),
        Section::buffer(lobes::UNIFORM, "hide", &[params.uniform(SynthesisUniform::default())]),
        records,
        Section::buffer(lobes::NORMALS, "hide", normals),
    ]
}

/// Normals of [`lobes_params`], each with the one below it; the number of texels is odd.
pub fn lobes_normals() -> Vec<[u32; 2]> {
    let mut pairs = vec![[0x0080_0080; 2]; 5 * 3];
    pairs.push([0; 2]);
    pairs
}

pub fn good_lobes() -> Vec<Section> {
    lobes_sections(&lobes_params(LobeStorage::Packed), &packed_lobes(), &half_lobes(), &lobes_normals())
}
