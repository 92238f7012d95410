//! Bad packs of NDF maps.

use super::without;
use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::ndf_maps::*;
use glint_formats::{IssueCode, Section};

fn ndf_with_params(edit: impl Fn(&mut NdfMapsParams)) -> Vec<u8> {
    let mut params = ndf_params();
    edit(&mut params);
    pack(ndf_maps(&params, &tiles()))
}

fn ndf_with_tiles(edit: impl Fn(&mut Vec<TileRecord>)) -> Vec<u8> {
    let mut tiles = tiles();
    edit(&mut tiles);
    pack(ndf_maps(&ndf_params(), &tiles))
}

/// A density that is not a number.
fn ndf_with_nan() -> Vec<u8> {
    let mut density = density();
    density[3] = 0x7e00;
    let mut sections = without(good_ndf_maps(), DENSITY);
    sections.push(Section::buffer(DENSITY, ROCK, &density));
    pack(sections)
}

pub fn ndf_cases() -> Vec<Case> {
    vec![
        case(IssueCode::NdfParameters, ndf_with_params(|params| params.intrinsic_roughness = 0.0)),
        case(IssueCode::NdfLevels, ndf_with_params(|params| params.levels[1].first_tile = 1)),
        case(IssueCode::NdfTileCount, ndf_with_tiles(|tiles| tiles.truncate(2))),
        case(IssueCode::NdfTileOutOfDensity, ndf_with_tiles(|tiles| tiles[2].texel_offset = 9)),
        case(IssueCode::NdfTileValue, ndf_with_tiles(|tiles| tiles[1].inv_spacing[0] = f32::INFINITY)),
        case(IssueCode::NdfDensityValue, ndf_with_nan()),
    ]
}

/// NDF maps and a placement side by side.
fn tiled(palette_len: u32, palette: &[TransformRecord]) -> Vec<u8> {
    let mut sections = good_ndf_maps();
    sections.push(Section::parameters(PLACEMENT, ROCK, &PlacementParams { kind: PlacementKind::Tiled, palette_len }));
    sections.push(Section::buffer(PALETTE, ROCK, palette));
    pack(sections)
}

fn with_placement(placement: Vec<Section>) -> Vec<u8> {
    let mut sections = good_ndf_maps();
    sections.extend(placement);
    pack(sections)
}

pub fn placement_cases() -> Vec<Case> {
    let mut flat = palette();
    flat[1].normal_to_local = [1.0, 2.0, 2.0, 4.0];
    let mut odd_grid = placement(&palette(), &noise_texels());
    odd_grid[0] = Section::parameters(PLACEMENT, ROCK, &stochastic(3, 1));
    let mut small_noise = placement(&palette(), &noise_texels());
    small_noise[2] = noise_section(&noise_texels()[..1], 1, 1);
    let mut deep_classes = placement(&palette(), &noise_texels());
    deep_classes[3] = classes_section(2);
    vec![
        case(IssueCode::PaletteLength, tiled(3, &palette())),
        case(IssueCode::PaletteValue, tiled(2, &flat)),
        case(IssueCode::PlacementGrid, with_placement(odd_grid)),
        case(IssueCode::NoiseDescriptor, with_placement(small_noise)),
        case(IssueCode::ClassesDescriptor, with_placement(deep_classes)),
    ]
}

fn with_noise(edit: impl Fn(&mut NoiseTexel)) -> Vec<u8> {
    let mut texels = noise_texels();
    edit(&mut texels[1]);
    with_placement(placement(&palette(), &texels))
}

pub fn noise_cases() -> Vec<Case> {
    vec![
        case(IssueCode::NoiseClass, with_noise(|texel| texel.class_and_owners = 0x4444_0002)),
        case(IssueCode::NoiseOwner, with_noise(|texel| texel.class_and_owners = 0x9444_0000)),
        case(IssueCode::NoiseReserved, with_noise(|texel| texel.reserved = 1)),
    ]
}

fn with_layers(layers: LayeredMaterial) -> Vec<u8> {
    let mut sections = good_ndf_maps();
    sections.push(Section::parameters(LAYERS, "coated rock", &layers));
    pack(sections)
}

pub fn layer_cases() -> Vec<Case> {
    vec![
        case(IssueCode::LayerName, with_layers(LayeredMaterial { coat: String::from("lacquer"), ..layered() })),
        case(IssueCode::LayerValue, with_layers(LayeredMaterial { coat_f0: 1.5, ..layered() })),
    ]
}
