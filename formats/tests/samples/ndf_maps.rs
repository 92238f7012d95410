//! Sections of NDF maps.

use super::*;
use glint_formats::ndf_maps::*;
use glint_formats::{Resource, Section, Wrap, vk_format};

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
        first: 0,
        size: 2 | 2 << 16,
        error: 0.02,
    };
    vec![tile, TileRecord { first: 4, ..tile }, TileRecord { first: 8, ..tile }]
}

/// A table of half floats, the first twelve of them 1.0.
pub fn density() -> Vec<u16> {
    let mut texels = vec![0; 2048];
    texels[..12].fill(0x3c00);
    texels
}

pub fn density_section(texels: &[u16]) -> Section {
    let payload = bytemuck::cast_slice(texels).to_vec();
    Section::texture(DENSITY, ROCK, table(vk_format::R32_UINT, payload.len() as u64 / 4), payload).compressed()
}

pub fn normals_section() -> Section {
    Section::texture(NORMALS, ROCK, ndf_params().normals_resource(), vec![0; 24])
}

pub fn palette() -> Vec<TransformRecord> {
    let identity = [1.0, 0.0, 0.0, 1.0];
    let quarter_turn = [0.0, 1.0, -1.0, 0.0];
    vec![
        TransformRecord { position_to_local: identity, normal_to_local: identity },
        TransformRecord { position_to_local: quarter_turn, normal_to_local: quarter_turn },
    ]
}

/// Bytes of the uniform: header, levels, palette, a reach mask of ones, tiles if they are few.
pub fn uniform(
    params: &NdfMapsParams,
    placement: &PlacementParams,
    palette: &[TransformRecord],
    tiles: &[TileRecord],
) -> Vec<u8> {
    let header = MaterialUniform::new(params, placement, false, 1.0);
    let mut bytes = bytemuck::bytes_of(&header).to_vec();
    for level in &params.levels {
        let record = [level.tile_texels, level.tiles_x, level.tiles_y, level.first_tile];
        bytes.extend_from_slice(bytemuck::cast_slice(&record));
    }
    bytes.extend_from_slice(bytemuck::cast_slice(palette));
    bytes.resize(bytes.len() + 16 * REACH_CELLS, 0xff);
    if header.few_tiles == 1 {
        bytes.extend_from_slice(bytemuck::cast_slice(tiles));
    }
    bytes.resize(UNIFORM_BYTES, 0);
    bytes
}

pub fn uniform_section(bytes: &[u8]) -> Section {
    let resource = Resource::Buffer { stride: UNIFORM_BYTES as u32, count: 1 };
    Section { resource, ..Section::buffer(UNIFORM, ROCK, bytes) }.compressed()
}

/// The sections of a material, but for those of a stochastic placement.
pub fn material(
    params: &NdfMapsParams,
    placement: &PlacementParams,
    palette: &[TransformRecord],
    tiles: &[TileRecord],
) -> Vec<Section> {
    vec![
        Section::parameters(PARAMS, ROCK, params),
        uniform_section(&uniform(params, placement, palette, tiles)),
        density_section(&density()),
        normals_section(),
        Section::parameters(PLACEMENT, ROCK, placement),
    ]
}

pub fn tiled() -> PlacementParams {
    PlacementParams { kind: PlacementKind::Tiled, palette_len: 2 }
}

/// A material that is tiled.
pub fn good_ndf_maps() -> Vec<Section> {
    material(&ndf_params(), &tiled(), &palette(), &tiles())
}

pub fn stochastic(cells_x: u32, cells_y: u32) -> PlacementParams {
    let kind = PlacementKind::Stochastic { cells_x, cells_y, cell_texels: 1.5, seed: 7 };
    PlacementParams { kind, palette_len: 2 }
}

/// What the sub-regions of 2 × 2 cells show: the example of their own cell, of the first class but for one.
pub fn noise_texels() -> Vec<NoiseTexel> {
    let texel = NoiseTexel { centre: 0x8000_8000, offset: 0, class_and_neighbour: 4 << 16, reserved: 0 };
    let mut texels = vec![texel; 16];
    texels[0].class_and_neighbour |= 1;
    texels
}

/// The noise map of `cells` × `cells`.
pub fn noise_section(texels: &[NoiseTexel], cells: u32) -> Section {
    Section::texture(NOISE, ROCK, noise_resource(cells), bytemuck::cast_slice(texels).to_vec())
}

/// A class map of 2 × 2 cells for a palette of `palette_len`.
pub fn classes_section(palette_len: u32) -> Section {
    let layers = palette_len.div_ceil(4) as usize;
    Section::texture(CLASSES, ROCK, classes_resource(2, palette_len), vec![0; 20 * layers])
}

/// A material of a stochastic placement of 2 × 2 cells.
pub fn placed(noise: &[NoiseTexel]) -> Vec<Section> {
    let mut sections = material(&ndf_params(), &stochastic(2, 2), &palette(), &tiles());
    sections.push(noise_section(noise, 2));
    sections.push(classes_section(2));
    sections
}

pub fn layered() -> LayeredMaterial {
    LayeredMaterial { coat: String::from(ROCK), base: String::from(ROCK), coat_f0: 0.04, base_f0: [0.5; 3] }
}

/// The sections of a two-layer material.
pub fn layer_sections(layers: &LayeredMaterial) -> Vec<Section> {
    let name = "coated rock";
    vec![Section::parameters(LAYERS, name, layers), Section::buffer(LAYERS_UNIFORM, name, &[LayersUniform::of(layers)])]
}
