//! Bad packs of NDF maps.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::ndf_maps::*;
use glint_formats::{IssueCode, Section, vk_format};

fn ndf_with_params(edit: impl Fn(&mut NdfMapsParams)) -> Vec<u8> {
    let mut params = ndf_params();
    edit(&mut params);
    pack(material(&params, &tiled(), &palette(), &tiles()))
}

fn ndf_with_tiles(edit: impl Fn(&mut Vec<TileRecord>)) -> Vec<u8> {
    let mut tiles = tiles();
    edit(&mut tiles);
    pack(material(&ndf_params(), &tiled(), &palette(), &tiles))
}

/// A section in place of the one of its kind.
fn ndf_with(section: Section) -> Vec<u8> {
    let mut sections = without(good_ndf_maps(), section.kind);
    sections.push(section);
    pack(sections)
}

/// A density that is not a number.
fn ndf_with_nan() -> Vec<u8> {
    let mut density = density();
    density[3] = 0x7e00;
    ndf_with(density_section(&density))
}

/// A table of tiles that are among the records.
fn ndf_with_table() -> Vec<u8> {
    let table = table(vk_format::R32G32B32A32_UINT, 6);
    let mut sections = good_ndf_maps();
    sections.push(Section::texture(TILES, ROCK, table, vec![0; 16384]).compressed());
    pack(sections)
}

/// A uniform that says another roughness than the parameters.
fn ndf_with_uniform() -> Vec<u8> {
    let other = NdfMapsParams { intrinsic_roughness: 0.02, ..ndf_params() };
    ndf_with(uniform_section(&uniform(&other, &tiled(), &palette(), &tiles())))
}

pub fn ndf_cases() -> Vec<Case> {
    vec![
        case(IssueCode::NdfParameters, ndf_with_params(|params| params.intrinsic_roughness = 0.0)),
        case(IssueCode::NdfLevels, ndf_with_params(|params| params.levels[1].first_tile = 1)),
        case(IssueCode::NdfTileCount, ndf_with_table()),
        case(IssueCode::NdfTileOutOfDensity, ndf_with_tiles(|tiles| tiles[2].first = 2045)),
        case(IssueCode::NdfTileValue, ndf_with_tiles(|tiles| tiles[1].inv_spacing[0] = f32::INFINITY)),
        case(IssueCode::NdfDensityValue, ndf_with_nan()),
        case(IssueCode::NdfUniform, ndf_with_uniform()),
    ]
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
    let mut deep_classes = without(placed(&noise_texels()), CLASSES);
    deep_classes.push(classes_section(5));
    vec![
        case(IssueCode::PaletteLength, ndf_with(Section::parameters(PLACEMENT, ROCK, &no_palette))),
        case(IssueCode::PaletteValue, pack(material(&ndf_params(), &tiled(), &flat, &tiles()))),
        case(IssueCode::PlacementGrid, pack(ndf_placed(&stochastic(8, 2)))),
        case(IssueCode::NoiseDescriptor, pack(small_noise)),
        case(IssueCode::ClassesDescriptor, pack(deep_classes)),
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
