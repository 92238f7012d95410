//! Bad packs of NDF maps.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::ndf_maps::*;
use glint_formats::{IssueCode, Resource, Section, vk_format};

fn ndf_with_params(edit: impl Fn(&mut NdfMapsParams)) -> Vec<u8> {
    let mut params = ndf_params();
    edit(&mut params);
    pack(material(&params, &tiled(), &palette(), &nodes()))
}

fn ndf_with_levels(edit: impl Fn(&mut Vec<Level>)) -> Vec<u8> {
    ndf_with_params(|params| edit(&mut params.levels))
}

/// Something else in the record of node 1.
fn ndf_with_node(edit: impl Fn(&mut NodeRecord)) -> Vec<u8> {
    let mut nodes = nodes();
    edit(&mut nodes[1]);
    pack(material(&ndf_params(), &tiled(), &palette(), &nodes))
}

/// A section in place of the one of its kind.
fn ndf_with(section: Section) -> Vec<u8> {
    let mut sections = without(good_ndf_maps(), section.kind);
    sections.push(section);
    pack(sections)
}

/// A texel of the atlas that is not zero.
fn ndf_with_texel(x: usize, y: usize) -> Vec<u8> {
    let mut density = density();
    density[y * ATLAS[0] as usize + x] = 1;
    ndf_with(density_section(&density))
}

/// An atlas whose descriptor is not as it should be.
fn ndf_with_atlas(vk_format: u32, width: u32, mips: u32) -> Vec<u8> {
    let resource = Resource::Texture { vk_format, width, height: 1, layers: 1, faces: 1, mips };
    let payload = vec![0; resource.byte_len().unwrap().unwrap() as usize];
    ndf_with(Section::texture(DENSITY, ROCK, resource, payload).compressed())
}

/// A uniform one byte of which differs.
fn ndf_with_uniform(at: usize) -> Vec<u8> {
    let mut bytes = uniform(&ndf_params(), &tiled(), &palette());
    bytes[at] ^= 1;
    ndf_with(uniform_section(&bytes))
}

/// A fourth node in the table.
fn one_node_more() -> Vec<u8> {
    let mut nodes = nodes();
    nodes.push(nodes[2]);
    ndf_with(nodes_section(&nodes))
}

/// A row more than the table needs.
fn one_row_more() -> Vec<u8> {
    let resource = table(vk_format::R32G32B32A32_UINT, 1025);
    let mut section = nodes_section(&nodes());
    section.payload.resize(resource.byte_len().unwrap().unwrap() as usize, 0);
    ndf_with(Section { resource, ..section })
}

fn parameter_cases() -> Vec<Case> {
    let parameters = |edit: fn(&mut NdfMapsParams)| case(IssueCode::NdfParameters, ndf_with_params(edit));
    vec![
        parameters(|params| params.height = 0),
        parameters(|params| params.width = MAX_EDGE + 1),
        parameters(|params| params.intrinsic_roughness = f32::MIN_POSITIVE / 64.0),
        parameters(|params| params.finest_variance = 0.0),
        parameters(|params| params.finest_variance = f32::INFINITY),
        parameters(|params| params.measured.worst = f64::NAN),
        parameters(|params| params.node_errors[2] = -0.5),
        parameters(|params| params.pixel.mean = -0.25),
        parameters(|params| params.pixel.worst_sigma_texels = 0.0),
        parameters(|params| params.intrinsic_roughness = 0.0),
    ]
}

fn level_cases() -> Vec<Case> {
    let levels = |edit: fn(&mut Vec<Level>)| case(IssueCode::NdfLevels, ndf_with_levels(edit));
    vec![
        levels(|levels| levels.clear()),
        levels(|levels| *levels = vec![levels[1]; MAX_LEVELS + 1]),
        levels(|levels| levels[0].nodes_y = 0),
        levels(|levels| levels.truncate(1)),
        levels(|levels| levels[1].nodes_y = 2),
        levels(|levels| (levels[0].nodes_x, levels[0].nodes_y, levels[1].first_node) = (1 << 12, 1 << 11, 1 << 23)),
        levels(|levels| levels[1].first_node = 1),
    ]
}

fn node_cases() -> Vec<Case> {
    let value = |edit: fn(&mut NodeRecord)| case(IssueCode::NdfNodeValue, ndf_with_node(edit));
    let outside = |x: u32, y: u32| case(IssueCode::NdfNodeOutOfAtlas, ndf_with_node(|node| node.place = x | y << 16));
    let border = |x: usize, y: usize| case(IssueCode::NdfNodeBorder, ndf_with_texel(x, y));
    vec![
        case(IssueCode::NdfNodeCount, ndf_with_params(|params| params.node_errors.truncate(2))),
        case(IssueCode::NdfNodeCount, one_row_more()),
        case(IssueCode::NdfNodeCount, one_node_more()),
        outside(4, 0),
        outside(0, 4),
        outside(4, 6),
        outside(14, 4),
        value(|node| node.shape &= !0xff00),
        value(|node| node.shape &= !0xff_0000),
        value(|node| node.shape &= !0xff00_0000),
        value(|node| node.scale = 0.0),
        value(|node| node.scale = f32::INFINITY),
        border(0, 0),
        border(9, 2),
        border(5, 3),
    ]
}

pub fn ndf_cases() -> Vec<Case> {
    let mut cases = parameter_cases();
    cases.extend(level_cases());
    cases.extend(node_cases());
    let descriptor = |bytes| case(IssueCode::WrongDescriptor, bytes);
    cases.extend([
        descriptor(ndf_with_atlas(vk_format::R8_UINT, 16, 1)),
        descriptor(ndf_with_atlas(vk_format::R8_UNORM, 16, 2)),
        descriptor(ndf_with_atlas(vk_format::R8_UNORM, MAX_EDGE + 1, 1)),
    ]);
    let header = size_of::<MaterialUniform>();
    let used = header + 16 * (2 + 4 + REACH_CELLS);
    // Zero after the records, that of a level's record, a level, an entry of the header.
    cases.extend([used, header + 12, header, 16].map(|at| case(IssueCode::NdfUniform, ndf_with_uniform(at))));
    cases
}

/// A placement whose other sections are right.
fn ndf_placed(placement: &PlacementParams) -> Vec<Section> {
    let mut sections = without(placed(&noise_texels()), PLACEMENT);
    sections.push(Section::parameters(PLACEMENT, ROCK, placement));
    sections
}

pub fn placement_cases() -> Vec<Case> {
    let mut flat = palette();
    flat[1].normal_to_local = [1.0, 2.0, 2.0, 4.0];
    let no_palette = PlacementParams { palette_len: 0, ..tiled() };
    let mut small_noise = without(placed(&noise_texels()), NOISE);
    small_noise.push(noise_section(&noise_texels()[..4], 1));
    let mut small_classes = without(placed(&noise_texels()), CLASSES);
    small_classes.push(classes_section(1));
    vec![
        case(IssueCode::PaletteLength, ndf_with(Section::parameters(PLACEMENT, ROCK, &no_palette))),
        case(IssueCode::PaletteValue, pack(material(&ndf_params(), &tiled(), &flat, &nodes()))),
        case(IssueCode::PlacementGrid, pack(ndf_placed(&stochastic(8, 2)))),
        case(IssueCode::NoiseDescriptor, pack(small_noise)),
        case(IssueCode::ClassesDescriptor, pack(small_classes)),
    ]
}

fn with_noise(edit: impl Fn(&mut NoiseTexel)) -> Vec<u8> {
    let mut texels = noise_texels();
    edit(&mut texels[1]);
    pack(placed(&texels))
}

pub fn noise_cases() -> Vec<Case> {
    vec![
        case(IssueCode::NoiseClass, with_noise(|texel| texel.class_and_neighbour = 4 << 16 | 2)),
        case(IssueCode::NoiseOwner, with_noise(|texel| texel.class_and_neighbour = 9 << 16)),
        case(IssueCode::NoiseReserved, with_noise(|texel| texel.reserved = 1)),
    ]
}

fn with_layers(sections: Vec<Section>) -> Vec<u8> {
    let mut all = good_ndf_maps();
    all.extend(sections);
    pack(all)
}

pub fn layer_cases() -> Vec<Case> {
    let without_coat = LayeredMaterial { coat: String::from("lacquer"), ..layered() };
    let bright = LayeredMaterial { coat_f0: 1.5, ..layered() };
    let mut differing = layer_sections(&layered());
    differing[1] = layer_sections(&LayeredMaterial { coat_f0: 0.05, ..layered() }).remove(1);
    vec![
        case(IssueCode::LayerName, with_layers(layer_sections(&without_coat))),
        case(IssueCode::LayerValue, with_layers(layer_sections(&bright))),
        case(IssueCode::LayerUniform, with_layers(differing)),
    ]
}
