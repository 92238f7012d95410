//! Sections of NDF maps.

use super::*;
use glint_formats::Wrap;
use glint_formats::container::full_mip_count;
use glint_formats::ndf_maps::*;
use glint_formats::{Resource, Section, vk_format};

/// A map of 3 × 2 texels: two tiles of 2 texels, one of 4.
pub fn ndf_params() -> NdfMapsParams {
    NdfMapsParams {
        width: 3,
        height: 2,
        wrap: Wrap::Repeat,
        intrinsic_roughness: 0.01,
        storage: DensityStorage::F16,
        levels: vec![
            Level { tile_texels: 2, tiles_x: 2, tiles_y: 1, first_tile: 0 },
            Level { tile_texels: 4, tiles_x: 1, tiles_y: 1, first_tile: 2 },
        ],
        max_error: 0.1,
        measured: MeasuredError { mean: 0.01, p95: 0.02, worst: 0.03, energy: 0.001 },
    }
}

pub fn tiles() -> Vec<TileRecord> {
    let tile = TileRecord {
        origin: [-0.5, -0.5],
        inv_spacing: [2.0, 2.0],
        scale: 1.0,
        texel_offset: 0,
        size: 2 | 2 << 16,
        error: 0.02,
    };
    vec![tile, TileRecord { texel_offset: 4, ..tile }, TileRecord { texel_offset: 8, ..tile }]
}

/// Twelve half floats, all 1.0.
pub fn density() -> Vec<u16> {
    vec![0x3c00; 12]
}

pub fn normals_section() -> Section {
    let resource =
        Resource::Texture { vk_format: vk_format::R16G16_SNORM, width: 3, height: 2, layers: 1, faces: 1, mips: 1 };
    Section::texture(NORMALS, ROCK, resource, vec![0; 24])
}

/// The four sections of NDF maps.
pub fn ndf_maps(params: &NdfMapsParams, tiles: &[TileRecord]) -> Vec<Section> {
    vec![
        Section::parameters(PARAMS, ROCK, params),
        Section::buffer(TILES, ROCK, tiles),
        Section::buffer(DENSITY, ROCK, &density()).compressed(),
        normals_section(),
    ]
}

pub fn good_ndf_maps() -> Vec<Section> {
    ndf_maps(&ndf_params(), &tiles())
}

pub fn stochastic(cells_x: u32, cells_y: u32) -> PlacementParams {
    let kind = PlacementKind::Stochastic { cells_x, cells_y, cell_texels: 1.5, seed: 7 };
    PlacementParams { kind, palette_len: 2 }
}

pub fn palette() -> Vec<TransformRecord> {
    let identity = [1.0, 0.0, 0.0, 1.0];
    let quarter_turn = [0.0, 1.0, -1.0, 0.0];
    vec![
        TransformRecord { position_to_local: identity, normal_to_local: identity },
        TransformRecord { position_to_local: quarter_turn, normal_to_local: quarter_turn },
    ]
}

pub fn noise_texels() -> Vec<NoiseTexel> {
    let texel = NoiseTexel { centre: 0x8000_8000, offset: 0, class_and_owners: 0x4480_0001, reserved: 0 };
    vec![texel, NoiseTexel { class_and_owners: 0x4444_0000, ..texel }]
}

pub fn noise_section(texels: &[NoiseTexel], width: u32, height: u32) -> Section {
    let resource =
        Resource::Texture { vk_format: vk_format::R32G32B32A32_UINT, width, height, layers: 1, faces: 1, mips: 1 };
    Section::texture(NOISE, ROCK, resource, bytemuck::cast_slice(texels).to_vec())
}

/// A class map of 2 × 1 cells with `layers` layers.
pub fn classes_section(layers: u32) -> Section {
    let mips = full_mip_count(2, 1);
    let resource =
        Resource::Texture { vk_format: vk_format::R8G8B8A8_UNORM, width: 2, height: 1, layers, faces: 1, mips };
    Section::texture(CLASSES, ROCK, resource, vec![0; 12 * layers as usize])
}

/// The four sections of a stochastic placement of 2 × 1 cells.
pub fn placement(palette: &[TransformRecord], noise: &[NoiseTexel]) -> Vec<Section> {
    vec![
        Section::parameters(PLACEMENT, ROCK, &stochastic(2, 1)),
        Section::buffer(PALETTE, ROCK, palette),
        noise_section(noise, 2, 1),
        classes_section(1),
    ]
}

pub fn layered() -> LayeredMaterial {
    LayeredMaterial { coat: String::from(ROCK), base: String::from(ROCK), coat_f0: 0.04, base_f0: [0.5; 3] }
}
