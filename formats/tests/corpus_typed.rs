//! Bad packs whose container is right: G2xxx and G3xxx.

use crate::corrupt_corpus::{Case, case};
use crate::samples::*;
use glint_formats::area_light::{self, AreaLightParams};
use glint_formats::dictionary::{self, DictionaryParams};
use glint_formats::environment::{self, EnvironmentParams};
use glint_formats::lobes::{self, HalfLobe, LobeLevel, LobeStorage, LobesParams, PackedLobe};
use glint_formats::ndf_maps::*;
use glint_formats::provenance::{PROVENANCE, Provenance};
use glint_formats::synthesis::{self, Layout, SynthesisParams};
use glint_formats::{IssueCode, Resource, Section, params};

pub fn cases() -> Vec<Case> {
    let mut cases = parameter_cases();
    cases.extend(group_cases());
    cases.extend(ndf_cases());
    cases.extend(placement_cases());
    cases.extend(noise_cases());
    cases.extend(layer_cases());
    cases.extend(dictionary_cases());
    cases.extend(environment_cases());
    cases.extend(area_light_cases());
    cases.extend(lobes_cases());
    cases.extend(synthesis_cases());
    cases.push(case(IssueCode::SurfaceMismatch, surface_with(|_, surface| surface.alignment = 2)));
    cases
}

/// A provenance section with these bytes.
fn raw_provenance(payload: Vec<u8>) -> Section {
    Section { payload, ..provenance_section() }
}

/// Parameters above the decode limit, which the writer refuses: a compressed buffer whose entry says otherwise.
fn too_large() -> Vec<u8> {
    let zeros = vec![0u8; params::MAX_BYTES + 1];
    let bytes = pack(vec![Section::buffer(PROVENANCE, "", &zeros).compressed()]);
    patched(bytes, entry_at(0, 40), &[0; 32])
}

fn with_path() -> Section {
    let mut provenance: Provenance = provenance();
    provenance.inputs[0].name = String::from("textures/rock.png");
    Section::parameters(PROVENANCE, "", &provenance)
}

fn parameter_cases() -> Vec<Case> {
    let mut trailing = params::encode(&provenance());
    trailing.push(0);
    vec![
        case(IssueCode::ParametersMalformed, pack(vec![raw_provenance(vec![0xff; 8])])),
        case(IssueCode::ParametersTrailing, pack(vec![raw_provenance(trailing)])),
        case(IssueCode::ParametersTooLarge, too_large()),
        case(IssueCode::BadProvenance, pack(vec![with_path()])),
    ]
}

fn without(sections: Vec<Section>, kind: glint_formats::FourCc) -> Vec<Section> {
    sections.into_iter().filter(|section| section.kind != kind).collect()
}

fn group_cases() -> Vec<Case> {
    let mut normals = normals_section();
    normals.payload.truncate(12);
    if let Resource::Texture { height, .. } = &mut normals.resource {
        *height = 1;
    }
    let mut wrong_size = without(good_ndf_maps(), NORMALS);
    wrong_size.push(normals);
    vec![
        case(IssueCode::MissingSection, pack(without(good_ndf_maps(), NORMALS))),
        case(IssueCode::OrphanSection, pack(vec![normals_section()])),
        case(IssueCode::WrongDescriptor, pack(wrong_size)),
    ]
}

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

fn ndf_cases() -> Vec<Case> {
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

fn placement_cases() -> Vec<Case> {
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

fn noise_cases() -> Vec<Case> {
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

fn layer_cases() -> Vec<Case> {
    vec![
        case(IssueCode::LayerName, with_layers(LayeredMaterial { coat: String::from("lacquer"), ..layered() })),
        case(IssueCode::LayerValue, with_layers(LayeredMaterial { coat_f0: 1.5, ..layered() })),
    ]
}

fn dictionary_with_params(edit: impl Fn(&mut DictionaryParams)) -> Vec<u8> {
    let mut params = dictionary_params();
    edit(&mut params);
    pack(dictionary_sections(&params, &dictionary_table()))
}

fn dictionary_with_table(edit: impl Fn(&mut Vec<u16>)) -> Vec<u8> {
    let mut table = dictionary_table();
    edit(&mut table);
    pack(dictionary_sections(&dictionary_params(), &table))
}

fn dictionary_cases() -> Vec<Case> {
    vec![
        case(IssueCode::DictionaryParameters, dictionary_with_params(|params| params.domain = f64::NAN)),
        case(IssueCode::DictionaryShape, dictionary_with_params(|params| params.levels = 3)),
        case(IssueCode::DictionaryValue, dictionary_with_table(|table| table[5] = 0xb400)),
        case(IssueCode::DictionaryRow, dictionary_with_table(|table| table[4..8].fill(0))),
    ]
}

#[test]
fn every_way_a_dictionary_can_be_wrong_is_found() {
    let edits: [fn(&mut DictionaryParams); 9] = [
        |params| params.marginals = 0,
        |params| params.levels = 0,
        |params| params.entries = 0,
        |params| params.entries = u32::MAX,
        |params| (params.marginals, params.levels) = (1 << 31, 1 << 31),
        |params| params.alpha_dict = -0.5,
        |params| params.lobe_std = 0.0,
        |params| params.domain = f64::INFINITY,
        |params| params.measured.ks_last_level = f64::NAN,
    ];
    for edit in edits {
        assert_eq!(codes(&dictionary_with_params(edit)), [IssueCode::DictionaryParameters]);
    }
    for bits in [0x7e00, 0x7c00, 0xfc00, 0x8001] {
        assert_eq!(codes(&dictionary_with_table(|table| table[15] = bits)), [IssueCode::DictionaryValue]);
    }
    assert_eq!(codes(&dictionary_with_table(|table| table.truncate(12))), [IssueCode::DictionaryShape]);
    assert_eq!(codes(&dictionary_with_table(|table| table[12] = 0x3410)), [IssueCode::DictionaryRow]);
    let lacking = |kind| pack(without(dictionary_sections(&dictionary_params(), &dictionary_table()), kind));
    assert_eq!(codes(&lacking(dictionary::TABLE)), [IssueCode::MissingSection]);
    assert_eq!(codes(&lacking(dictionary::PARAMS)), [IssueCode::OrphanSection]);
}

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

fn environment_cases() -> Vec<Case> {
    let infinite = |section: &mut Section| section.payload[6..8].copy_from_slice(&0x7c00u16.to_le_bytes());
    vec![
        case(IssueCode::EnvironmentParameters, environment_with_params(|params| params.radiance_scale = 0.0)),
        case(IssueCode::EnvironmentLevels, environment_with_params(|params| params.levels[0] = 0.5)),
        case(IssueCode::EnvironmentShape, environment_with_params(|params| params.albedo_size = 4)),
        case(IssueCode::EnvironmentRadiance, environment_with(environment::RADIANCE, infinite)),
        case(IssueCode::EnvironmentIndicators, environment_with_indicators(|indicators| indicators[5] = 0x3c00)),
        case(IssueCode::EnvironmentAlbedo, environment_with(environment::ALBEDO, infinite)),
    ]
}

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

fn area_light_cases() -> Vec<Case> {
    vec![
        case(IssueCode::AreaLightParameters, area_light_with_params(|params| params.base_roughness = 0.0)),
        case(IssueCode::AreaLightShape, area_light_with_params(|params| params.anisotropic = false)),
        case(IssueCode::AreaLightNormal, area_light_with_texels(|[normals, _]| normals[4] = 100)),
        case(IssueCode::AreaLightRoughness, area_light_with_texels(|[_, roughness]| roughness[9] = 100)),
        case(IssueCode::LtcShape, short_table()),
        case(IssueCode::LtcValue, area_light_with_table(|table| table[1] = 0xbc00)),
    ]
}

#[test]
fn every_way_an_environment_can_be_wrong_is_found() {
    let edits: [fn(&mut EnvironmentParams); 16] = [
        |params| params.face_size = 0,
        |params| params.face_size = 3,
        |params| params.face_size = 1 << 31,
        |params| params.roughness.clear(),
        |params| params.roughness.push(1.5),
        |params| params.roughness[0] = 0.1,
        |params| params.roughness[1] = 0.0,
        |params| params.roughness[1] = f64::NAN,
        |params| params.albedo_size = 0,
        |params| params.radiance_scale = f64::INFINITY,
        |params| params.max_error = -1.0,
        |params| params.levels = vec![2.0],
        |params| params.mean_radiance[1] = f64::NAN,
        |params| params.measured.energy = f64::INFINITY,
        |params| params.measured.mips[1].worst = -1.0,
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
    for (at, bits) in [(0, 0x8400), (1, 0x7e00), (0, 0x3a01), (2, 0x0001), (119, 0x3c00)] {
        let bytes = environment_with_indicators(|indicators| indicators[at] = bits);
        assert_eq!(codes(&bytes), [IssueCode::EnvironmentIndicators], "{at} {bits:#x}");
    }
    assert_eq!(codes(&environment_with_indicators(|indicators| indicators[0] = 0x3a00)), []);
    let sections = || environment_sections(&environment_params(), &environment_indicators(), 0x3c00);
    for kind in [environment::RADIANCE, environment::INDICATORS, environment::COLOURS, environment::ALBEDO] {
        assert_eq!(codes(&pack(without(sections(), kind))), [IssueCode::MissingSection], "{kind}");
    }
    assert_eq!(codes(&pack(without(sections(), environment::PARAMS))), [IssueCode::OrphanSection; 4]);
}

#[test]
fn every_way_an_area_light_can_be_wrong_is_found() {
    let edits: [fn(&mut AreaLightParams); 8] = [
        |params| params.width = 0,
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
    for kind in [area_light::NORMALS, area_light::ROUGHNESS, area_light::INVERSE, area_light::TERMS] {
        assert_eq!(codes(&pack(without(good_area_light(), kind))), [IssueCode::MissingSection]);
    }
    assert_eq!(codes(&pack(without(good_area_light(), area_light::PARAMS))), [IssueCode::OrphanSection; 4]);
}

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

/// A texel in the corner of the square, outside the disk.
fn lobes_with_corner_normal() -> Vec<u8> {
    let mut normals = lobes_normals();
    normals[6..8].fill(255);
    pack(lobes_sections(&lobes_params(LobeStorage::Packed), &packed_lobes(), &[], &normals))
}

fn lobes_cases() -> Vec<Case> {
    let format = |params: &mut LobesParams| params.normals = lobes::NormalsStorage::Snorm16;
    vec![
        case(IssueCode::LobesParameters, lobes_with_params(|params| params.lobes_per_cell = 0)),
        case(IssueCode::LobesLevels, lobes_with_params(|params| params.levels[1].first_lobe = 5)),
        case(IssueCode::LobesCount, lobes_with_packed(|lobes| lobes.truncate(4))),
        case(IssueCode::LobeValue, lobes_with_packed(|lobes| lobes[2].correlation[1] = -128)),
        case(IssueCode::LobeCellEmpty, lobes_with_packed(|lobes| lobes[4].normal_weight = 0x00ff_ffff)),
        case(IssueCode::LobesNormalsShape, lobes_with_params(format)),
        case(IssueCode::LobesNormal, lobes_with_corner_normal()),
    ]
}

#[test]
fn every_way_lobes_can_be_wrong_is_found() {
    assert_eq!(codes(&lobes_with_params(|_| ())), [] as [IssueCode; 0]);
    assert_eq!(codes(&lobes_with_half(|_| ())), [] as [IssueCode; 0]);
    let parameters: [fn(&mut LobesParams); 10] = [
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
    let levels: [fn(&mut LobesParams); 11] = [
        |params| params.levels.clear(),
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
    for kind in [lobes::LOBES, lobes::NORMALS] {
        assert_eq!(codes(&pack(without(good_lobes(), kind))), [IssueCode::MissingSection]);
    }
    assert_eq!(codes(&pack(without(good_lobes(), lobes::PARAMS))), [IssueCode::OrphanSection; 2]);
}

fn synthesis_with_params(edit: impl Fn(&mut SynthesisParams)) -> Vec<u8> {
    let mut params = synthesis_params();
    edit(&mut params);
    pack(synthesis_sections(&params, &synthesis_offsets(), &synthesis_seams()))
}

fn synthesis_with_offset(offset: [u16; 2]) -> Vec<u8> {
    pack(synthesis_sections(&synthesis_params(), &[[2, 2], offset], &synthesis_seams()))
}

fn synthesis_with_seam(word: u32) -> Vec<u8> {
    let mut seams = synthesis_seams();
    seams[3] = word;
    pack(synthesis_sections(&synthesis_params(), &synthesis_offsets(), &seams))
}

fn synthesis_cases() -> Vec<Case> {
    vec![
        case(IssueCode::SynthesisParameters, synthesis_with_params(|params| params.alignment = 3)),
        case(IssueCode::SynthesisShape, pack(synthesis_sections(&synthesis_params(), &[[2, 2]], &synthesis_seams()))),
        case(IssueCode::SynthesisOffset, synthesis_with_offset([6, 2])),
        case(IssueCode::SynthesisSeam, synthesis_with_seam(0b1000000)),
    ]
}

#[test]
fn every_way_a_synthesis_can_be_wrong_is_found() {
    let edits: [fn(&mut SynthesisParams); 17] = [
        |params| params.sample_width = 0,
        |params| params.sample_height = u32::MAX,
        |params| params.sample_height = 5,
        |params| params.patch = 3,
        |params| params.patch = u32::MAX,
        |params| params.overlap = 3,
        |params| params.overlap = u32::MAX,
        |params| params.alignment = 0,
        |params| params.alpha = 1.5,
        |params| params.alpha = f32::NAN,
        |params| params.error_tolerance = f32::INFINITY,
        |params| params.error_tolerance = -1.0,
        |params| params.measured.seam_ratio = f64::NAN,
        |params| params.layout = Layout::Patches { width: 0, height: 4, columns: 0, rows: 1 },
        |params| params.layout = Layout::Patches { width: 7, height: 4, columns: 3, rows: 1 },
        |params| params.layout = Layout::Patches { width: u32::MAX, height: 4, columns: 1 << 30, rows: 1 },
        |params| params.layout = Layout::CornerTiles { colours: 1, variants: 1, margin: 1, hash_seed: 0 },
    ];
    for edit in edits {
        assert_eq!(codes(&synthesis_with_params(edit)), [IssueCode::SynthesisParameters]);
    }
    // Outside, not aligned, and the last that lies inside.
    for offset in [[0, 2], [2, 4], [3, 2], [u16::MAX, u16::MAX]] {
        assert_eq!(codes(&synthesis_with_offset(offset)), [IssueCode::SynthesisOffset], "{offset:?}");
    }
    assert_eq!(codes(&synthesis_with_offset([4, 2])), []);
    let lacking = |kind| pack(without(good_synthesis(), kind));
    assert_eq!(codes(&lacking(synthesis::OFFSETS)), [IssueCode::MissingSection]);
    assert_eq!(codes(&lacking(synthesis::SEAMS)), [IssueCode::MissingSection]);
    assert_eq!(codes(&lacking(synthesis::PARAMS)), [IssueCode::OrphanSection; 2]);
}

/// Offsets and paths of no bits of a sound surface with these parameters.
fn blank_synthesis(params: &SynthesisParams) -> (Vec<[u16; 2]>, Vec<u32>) {
    (vec![[2, 2]; params.offset_count() as usize], vec![0; params.seam_words() as usize])
}

#[test]
fn every_way_corner_tiles_can_be_wrong_is_found() {
    let sound = corner_tile_params();
    let codes_of = |params: &SynthesisParams, seams: &[u32]| {
        codes(&pack(synthesis_sections(params, &blank_synthesis(&sound).0, seams)))
    };
    let (offsets, mut seams) = blank_synthesis(&sound);
    // One colour and two tiles; a pair of paths of six entries, four paths of eight a tile, all in a word each.
    assert_eq!((offsets.len(), seams.len()), (3, 10));
    assert_eq!(codes_of(&sound, &seams), []);
    seams[9] = 0b1_0000_0000;
    assert_eq!(codes_of(&sound, &seams), [IssueCode::SynthesisSeam]);
    let layouts = [(0, 1, 1), (5, 1, 1), (1, 0, 1), (1, 17, 1), (1, 2, 0), (1, 2, 2), (1, 2, u32::MAX)];
    for (colours, variants, margin) in layouts {
        let layout = Layout::CornerTiles { colours, variants, margin, hash_seed: 3 };
        let params = SynthesisParams { layout, ..sound.clone() };
        assert_eq!(codes_of(&params, &seams), [IssueCode::SynthesisParameters], "{colours} {variants} {margin}");
    }
    let odd = SynthesisParams { patch: 11, sample_width: 14, sample_height: 14, alignment: 1, ..sound };
    assert_eq!(codes_of(&odd, &seams), [IssueCode::SynthesisParameters]);
}

#[test]
fn a_path_that_jumps_or_leaves_the_overlap_is_found() {
    // An overlap of three takes two bits an entry; three is no entry, and from nought to two is no step.
    let params = SynthesisParams { sample_width: 9, sample_height: 9, patch: 6, overlap: 3, ..synthesis_params() };
    let layout = Layout::Patches { width: 6, height: 6, columns: 1, rows: 1 };
    let params = SynthesisParams { alignment: 3, layout, ..params };
    let codes_of = |word: u32| codes(&pack(synthesis_sections(&params, &[[3, 3]], &[0, word])));
    assert_eq!(codes_of(0b01_10_01_00), []);
    assert_eq!(codes_of(0b11_10), [IssueCode::SynthesisSeam]);
    assert_eq!(codes_of(0b10_00), [IssueCode::SynthesisSeam]);
}

fn surface_with(edit: impl Fn(&mut LobesParams, &mut SynthesisParams)) -> Vec<u8> {
    let (mut lobes, mut synthesis) = (surface_lobes_params(), surface_synthesis_params());
    edit(&mut lobes, &mut synthesis);
    pack(surface_sections(&lobes, &synthesis))
}

#[test]
fn lobes_and_synthesis_that_do_not_fit_are_found() {
    assert_eq!(codes(&surface_with(|_, _| ())), []);
    let edits: [fn(&mut LobesParams, &mut SynthesisParams); 5] = [
        |_, surface| surface.sample_width = 9,
        |_, surface| surface.wrap = Wrap::Repeat,
        |_, surface| surface.alignment = 2,
        |_, surface| (surface.patch, surface.alignment) = (8, 8),
        |lobes, _| lobes.wrap = Wrap::Repeat,
    ];
    for edit in edits {
        let found = codes(&surface_with(edit));
        assert!(found.contains(&IssueCode::SurfaceMismatch), "{found:?}");
    }
    // Cells of four texels cannot be told from the surface as a whole, and of cells in steps there must be one.
    let levels: [fn(&mut LobesParams, &mut SynthesisParams); 3] = [
        |lobes, _| lobes.levels[0].cells_x = 1,
        |lobes, _| lobes.levels[1].cells_x = 5,
        |lobes, _| lobes.levels[1].cell_texels = 4,
    ];
    for edit in levels {
        assert_eq!(codes(&surface_with(edit)), [IssueCode::LobesLevels]);
    }
    let odd_step = codes(&surface_with(|lobes, _| lobes.step_texels = 3));
    assert!(odd_step.contains(&IssueCode::LobesParameters), "{odd_step:?}");
    let alone = without(surface_sections(&surface_lobes_params(), &surface_synthesis_params()), synthesis::PARAMS);
    assert!(codes(&pack(alone)).contains(&IssueCode::MissingSection));
    let one = LobesParams { levels: vec![surface_lobes_params().levels[1]], ..surface_lobes_params() };
    assert!(!codes(&pack(surface_sections(&one, &surface_synthesis_params()))).is_empty());
}
