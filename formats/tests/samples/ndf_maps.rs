//! Sections of NDF maps.

use super::*;
use glint_formats::ndf_maps::*;
use glint_formats::{Resource, Section, vk_format};

/// Texels of the atlas.
pub const ATLAS: [u32; 2] = [16, 8];

/// A map of 3 × 2 texels: a level of two nodes and one of one.
pub fn ndf_params() -> NdfMapsParams {
    NdfMapsParams {
        width: 3,
        height: 2,
        intrinsic_roughness: 0.01,
        finest_variance: 0.5,
        levels: vec![Level { nodes_x: 2, nodes_y: 1, first_node: 0 }, Level { nodes_x: 1, nodes_y: 1, first_node: 2 }],
        max_error: 0.1,
        measured: MeasuredError { mean: 0.01, p95: 0.02, worst: 0.03, energy: 0.001 },
        pixel: PixelError { mean: 0.04, worst: 0.05, worst_sigma_texels: 0.75 },
        node_errors: vec![0.01, 0.02, 0.03],
    }
}

/// Three nodes of 2 × 2 texels side by side, one more texel between them; texel (0, 0) is that of s = (0, 0).
pub fn nodes() -> Vec<NodeRecord> {
    let node = NodeRecord { origin: 300 | 300 << 16, place: 0, shape: 2 | 2 << 8 | 1 << 16 | 3 << 24, scale: 1.0 };
    [1, 4, 7].map(|x| NodeRecord { place: x | 1 << 16, ..node }).to_vec()
}

/// Nodes and a mean and covariance of each.
pub fn nodes_section(nodes: &[NodeRecord]) -> Section {
    let resource = table(vk_format::R32G32B32A32_UINT, nodes.len() as u64);
    let mut payload: Vec<u8> = bytemuck::cast_slice(nodes).to_vec();
    let moments = vec![MomentsRecord::new([0.1, -0.2], [0.01, 0.002, 0.02]); nodes.len()];
    payload.extend_from_slice(bytemuck::cast_slice(&moments));
    payload.resize(resource.byte_len().unwrap().unwrap() as usize, 0);
    Section::texture(NODES, ROCK, resource, payload).compressed()
}

/// Texels of the atlas: 255 in the tables of the nodes, else 0.
pub fn density() -> Vec<u8> {
    let mut texels = vec![0; (ATLAS[0] * ATLAS[1]) as usize];
    for node in nodes() {
        let ([x, y], [width, height]) = (node.place(), node.size());
        for row in y..y + height {
            let first = (row * ATLAS[0] + x) as usize;
            texels[first..first + width as usize].fill(255);
        }
    }
    texels
}

pub fn density_section(texels: &[u8]) -> Section {
    Section::texture(DENSITY, ROCK, atlas_resource(ATLAS), texels.to_vec()).compressed()
}

pub fn normals_section() -> Section {
    Section::texture(NORMALS, ROCK, ndf_params().normals_resource(), vec![0; 96])
}

pub fn palette() -> Vec<TransformRecord> {
    let identity = [1.0, 0.0, 0.0, 1.0];
    let quarter_turn = [0.0, 1.0, -1.0, 0.0];
    vec![
        TransformRecord { position_to_local: identity, normal_to_local: identity },
        TransformRecord { position_to_local: quarter_turn, normal_to_local: quarter_turn },
    ]
}

/// Bytes of the uniform: header, levels, palette, a reach mask of ones.
pub fn uniform(params: &NdfMapsParams, placement: &PlacementParams, palette: &[TransformRecord]) -> Vec<u8> {
    let mut bytes = bytemuck::bytes_of(&MaterialUniform::new(params, placement, ATLAS, 1.0)).to_vec();
    for level in &params.levels {
        let record = [level.nodes_x, level.nodes_y, level.first_node, 0];
        bytes.extend_from_slice(bytemuck::cast_slice(&record));
    }
    bytes.extend_from_slice(bytemuck::cast_slice(palette));
    bytes.resize(bytes.len() + 16 * REACH_CELLS, 0xff);
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
    nodes: &[NodeRecord],
) -> Vec<Section> {
    vec![
        Section::parameters(PARAMS, ROCK, params),
        uniform_section(&uniform(params, placement, palette)),
        nodes_section(nodes),
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
    material(&ndf_params(), &tiled(), &palette(), &nodes())
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

/// A class map of `cells` × `cells`, a power of two.
pub fn classes_section(cells: u32) -> Section {
    let texels: u32 = (0..=cells.trailing_zeros() + 1).map(|mip| ((2 * cells) >> mip).pow(2)).sum();
    Section::texture(CLASSES, ROCK, classes_resource(cells), vec![0; 16 * texels as usize])
}

/// A material of a stochastic placement of 2 × 2 cells.
pub fn placed(noise: &[NoiseTexel]) -> Vec<Section> {
    let mut sections = material(&ndf_params(), &stochastic(2, 2), &palette(), &nodes());
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
