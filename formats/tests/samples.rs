//! Small good packs, and the means to make bad ones of them.

use glint_formats::area_light::{self, AreaLightParams, NormalStorage};
use glint_formats::container::{ENTRY_BYTES, FourCc, HEADER_BYTES, Limits, full_mip_count};
use glint_formats::dictionary::{self, DictionaryParams};
use glint_formats::environment::{self, EnvironmentParams};
use glint_formats::lobes::{self, HalfLobe, LobeLevel, LobeStorage, LobesParams, NormalsStorage, PackedLobe};
use glint_formats::ndf_maps::*;
use glint_formats::provenance::{InputDigest, PROVENANCE, Provenance};
use glint_formats::synthesis::{self, Layout, SynthesisParams};
use glint_formats::{IssueCode, PackBuilder, Resource, Section, validate, vk_format};
use xxhash_rust::xxh3::xxh3_64;

/// Name of the sample material.
pub const ROCK: &str = "rock";

pub fn pack(sections: Vec<Section>) -> Vec<u8> {
    let mut builder = PackBuilder::new();
    for section in sections {
        builder.push(section).unwrap();
    }
    builder.finish().unwrap()
}

pub fn codes(bytes: &[u8]) -> Vec<IssueCode> {
    validate(bytes, &Limits::default()).iter().map(|issue| issue.code).collect()
}

pub fn provenance() -> Provenance {
    Provenance {
        tool_version: String::from("0.1.0"),
        method: String::from("ndf-maps"),
        options: vec![(String::from("preset"), String::from("draft"))],
        seed: 7,
        inputs: vec![InputDigest::of("rock.png", b"pixels")],
        normal_convention: String::from("y-up"),
        ..Provenance::default()
    }
}

pub fn provenance_section() -> Section {
    Section::parameters(PROVENANCE, "", &provenance()).optional()
}

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

/// Two marginals at two levels, of four entries half a slope apart.
pub fn dictionary_params() -> DictionaryParams {
    DictionaryParams {
        marginals: 2,
        levels: 2,
        entries: 4,
        alpha_dict: 0.7,
        lobe_std: 0.25,
        domain: 2.0,
        seed: 7,
        measured: dictionary::MeasuredError::default(),
    }
}

/// Sixteen half floats, all 0.25: the rows of [`dictionary_params`] as a box.
pub fn dictionary_table() -> Vec<u16> {
    vec![0x3400; 16]
}

/// The two sections of a dictionary.
pub fn dictionary_sections(params: &DictionaryParams, table: &[u16]) -> Vec<Section> {
    let resource = Resource::Texture {
        vk_format: vk_format::R16_SFLOAT,
        width: 4,
        height: table.len() as u32 / 4,
        layers: 1,
        faces: 1,
        mips: 1,
    };
    vec![
        Section::parameters(dictionary::PARAMS, "lobes", params),
        Section::texture(dictionary::TABLE, "lobes", resource, bytemuck::cast_slice(table).to_vec()),
    ]
}

/// Faces of two texels and of one, three levels with colours.
pub fn environment_params() -> EnvironmentParams {
    EnvironmentParams {
        face_size: 2,
        kernel: environment::Kernel::Ndf,
        storage: environment::Storage::F16,
        roughness: vec![0.0, 1.0],
        radiance_scale: 1.0,
        levels: vec![0.0, 1.0, 4.0],
        level_choice: environment::LevelChoice::Optimal,
        coloured: true,
        albedo_size: 2,
        source_width: 8,
        source_height: 4,
        negative_pixels: 1,
        mean_radiance: [1.0, 0.5, 0.25],
        max_error: 0.005,
        measured: environment::MeasuredError {
            mips: vec![environment::MeasuredMip { rmse: 0.001, worst: 0.002 }; 2],
            texels: 16,
            energy: 1e-6,
            second_moment: 0.1,
            rounding: vec![2e-4; 2],
        },
    }
}

/// Half floats of the indicators of [`environment_params`]: thirty texels, all ½, ¼, 0, 0.
pub fn environment_indicators() -> Vec<u16> {
    [0x3800, 0x3400, 0, 0].repeat(30)
}

/// The five sections of an environment whose radiance and albedo are all `value`.
pub fn environment_sections(params: &EnvironmentParams, indicators: &[u16], value: u16) -> Vec<Section> {
    let sound = environment_params();
    let halves = |count: usize| bytemuck::cast_slice(&vec![value; count]).to_vec();
    let texture = |kind, resource, payload| Section::texture(kind, "sky", resource, payload);
    vec![
        Section::parameters(environment::PARAMS, "sky", params),
        texture(environment::RADIANCE, sound.radiance_resource(), halves(120)),
        texture(environment::INDICATORS, sound.indicators_resource(), bytemuck::cast_slice(indicators).to_vec()),
        texture(environment::COLOURS, sound.colours_resource(), vec![0x80; 240]),
        texture(environment::ALBEDO, sound.albedo_resource(), bytemuck::cast_slice(&[0x3800u16; 16]).to_vec()),
    ]
}

/// A map of 2 × 1 texels, with roughness by direction.
pub fn area_light_params() -> AreaLightParams {
    AreaLightParams {
        width: 2,
        height: 1,
        wrap: Wrap::Clamp,
        base_roughness: 0.1,
        storage: NormalStorage::Snorm8,
        anisotropic: true,
        measured: area_light::MeasuredError::default(),
    }
}

/// Normals and roughness of [`area_light_params`]: two texels and their mean.
pub fn area_light_texels() -> [Vec<u8>; 2] {
    [vec![0, 0, 127, 0, 40, 0, 120, 0, 20, 0, 123, 60], vec![0, 0, 0, 0, 0, 0, 0, 0, 90, 30, 40, 0]]
}

/// A table of half floats: every texel (1, 0, 0, 1).
pub fn ltc_table() -> Vec<u16> {
    [0x3c00, 0, 0, 0x3c00].repeat(64 * 64)
}

/// The five sections of an area-light material.
pub fn area_light_sections(params: &AreaLightParams, texels: &[Vec<u8>; 2], table: &[u16]) -> Vec<Section> {
    let texture =
        |vk_format, width, height, mips| Resource::Texture { vk_format, width, height, layers: 1, faces: 1, mips };
    let map = texture(vk_format::R8G8B8A8_SNORM, 2, 1, 2);
    let ltc = texture(vk_format::R16G16B16A16_SFLOAT, 64, 64, 1);
    let [normals, roughness] = texels;
    let table: Vec<u8> = bytemuck::cast_slice(table).to_vec();
    vec![
        Section::parameters(area_light::PARAMS, "metal", params),
        Section::texture(area_light::NORMALS, "metal", map, normals.clone()),
        Section::texture(area_light::ROUGHNESS, "metal", map, roughness.clone()),
        Section::texture(area_light::INVERSE, "metal", ltc, table.clone()).compressed(),
        Section::texture(area_light::TERMS, "metal", ltc, table).compressed(),
    ]
}

pub fn good_area_light() -> Vec<Section> {
    area_light_sections(&area_light_params(), &area_light_texels(), &ltc_table())
}

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

/// The three sections of a map's lobes.
pub fn lobes_sections(params: &LobesParams, packed: &[PackedLobe], half: &[HalfLobe], normals: &[u8]) -> Vec<Section> {
    let texture =
        Resource::Texture { vk_format: vk_format::R8G8_UNORM, width: 5, height: 3, layers: 1, faces: 1, mips: 1 };
    let records = match params.storage {
        LobeStorage::Packed => Section::buffer(lobes::LOBES, "hide", packed),
        LobeStorage::Half => Section::buffer(lobes::LOBES, "hide", half),
    };
    vec![
        Section::parameters(lobes::PARAMS, "hide", params),
        records,
        Section::texture(lobes::NORMALS, "hide", texture, normals.to_vec()),
    ]
}

/// Normals of [`lobes_params`].
pub fn lobes_normals() -> Vec<u8> {
    vec![128; 5 * 3 * 2]
}

pub fn good_lobes() -> Vec<Section> {
    lobes_sections(&lobes_params(LobeStorage::Packed), &packed_lobes(), &half_lobes(), &lobes_normals())
}

/// A surface of 2 × 1 patches of four texels, which overlap by two.
pub fn synthesis_params() -> SynthesisParams {
    SynthesisParams {
        sample_width: 8,
        sample_height: 6,
        wrap: Wrap::Clamp,
        patch: 4,
        overlap: 2,
        alignment: 2,
        alpha: 0.9,
        error_tolerance: 0.5,
        seed: 7,
        layout: Layout::Patches { width: 7, height: 4, columns: 2, rows: 1 },
        measured: synthesis::MeasuredError { seam_ratio: 1.25, distinct_offsets: 2 },
    }
}

/// Two tiles for four corners of the one colour.
pub fn corner_tile_params() -> SynthesisParams {
    let layout = Layout::CornerTiles { colours: 1, variants: 2, margin: 1, hash_seed: 3 };
    SynthesisParams { sample_width: 12, sample_height: 12, patch: 10, overlap: 2, layout, ..synthesis_params() }
}

/// Offsets of [`synthesis_params`].
pub fn synthesis_offsets() -> Vec<[u16; 2]> {
    vec![[2, 2], [4, 2]]
}

/// Paths of [`synthesis_params`]: six entries of one bit in a word, left and upper of each patch.
pub fn synthesis_seams() -> Vec<u32> {
    vec![0b001100, 0b111111, 0, 0b100000]
}

/// The three sections of a synthesis.
pub fn synthesis_sections(params: &SynthesisParams, offsets: &[[u16; 2]], seams: &[u32]) -> Vec<Section> {
    vec![
        Section::parameters(synthesis::PARAMS, "gold", params),
        Section::buffer(synthesis::OFFSETS, "gold", offsets),
        Section::buffer(synthesis::SEAMS, "gold", seams),
    ]
}

pub fn good_synthesis() -> Vec<Section> {
    synthesis_sections(&synthesis_params(), &synthesis_offsets(), &synthesis_seams())
}

/// Lobes of the sample of a surface: 2 × 2 cells of 4 texels and the whole, a lobe each.
pub fn surface_lobes_params() -> LobesParams {
    let mut params = LobesParams {
        width: 8,
        height: 8,
        wrap: Wrap::Clamp,
        step_texels: 4,
        lobes_per_cell: 1,
        ..lobes_params(LobeStorage::Packed)
    };
    params.levels[0].cells_y = 2;
    params
}

/// The synthesis that goes with [`surface_lobes_params`].
pub fn surface_synthesis_params() -> SynthesisParams {
    SynthesisParams { sample_height: 8, alignment: 4, ..synthesis_params() }
}

/// The six sections of a surface.
pub fn surface_sections(lobes: &LobesParams, synthesis: &SynthesisParams) -> Vec<Section> {
    let format = vk_format::R8G8_UNORM;
    let texture =
        Resource::Texture { vk_format: format, width: lobes.width, height: lobes.height, layers: 1, faces: 1, mips: 1 };
    let normals = vec![128; (lobes.width * lobes.height * 2) as usize];
    let mut sections = vec![
        Section::parameters(lobes::PARAMS, "gold", lobes),
        Section::buffer(lobes::LOBES, "gold", &[packed_lobes()[0]; 5]),
        Section::texture(lobes::NORMALS, "gold", texture, normals),
    ];
    sections.extend(synthesis_sections(synthesis, &[[4, 4]; 2], &synthesis_seams()));
    sections
}

/// A pack with every kind of section, one of them compressed.
pub fn full_pack() -> Vec<u8> {
    let mut sections = vec![provenance_section()];
    sections.extend(good_ndf_maps());
    sections.extend(placement(&palette(), &noise_texels()));
    sections.push(Section::parameters(LAYERS, "coated rock", &layered()));
    sections.extend(dictionary_sections(&dictionary_params(), &dictionary_table()));
    sections.extend(environment_sections(&environment_params(), &environment_indicators(), 0x3c00));
    sections.extend(good_area_light());
    sections.extend(good_lobes());
    sections.extend(good_synthesis());
    pack(sections)
}

/// A section of four bytes that the checks of contents do not look at.
pub fn plain_section(name: &str) -> Section {
    Section::buffer(FourCc(*b"test"), name, &[1u8, 2, 3, 4]).optional()
}

/// Where a field of a table entry lies in the file.
pub fn entry_at(entry: usize, field: usize) -> usize {
    HEADER_BYTES as usize + entry * ENTRY_BYTES as usize + field
}

/// Puts bytes in place and makes header checksum and file length right again.
pub fn patched(mut bytes: Vec<u8>, at: usize, with: &[u8]) -> Vec<u8> {
    bytes[at..at + with.len()].copy_from_slice(with);
    seal(&mut bytes);
    bytes
}

/// Makes file length and header checksum right, where header and table are there at all.
pub fn seal(bytes: &mut [u8]) {
    if bytes.len() < HEADER_BYTES as usize {
        return;
    }
    let len = bytes.len() as u64;
    bytes[24..32].copy_from_slice(&len.to_le_bytes());
    reseal_header(bytes);
}

/// Makes the header checksum right and leaves the stated length.
pub fn reseal_header(bytes: &mut [u8]) {
    let count = u64::from(u32::from_le_bytes(bytes[16..20].try_into().unwrap()));
    let end = HEADER_BYTES + count * ENTRY_BYTES;
    if end > bytes.len() as u64 {
        return;
    }
    bytes[32..40].fill(0);
    let checksum = xxh3_64(&bytes[..end as usize]);
    bytes[32..40].copy_from_slice(&checksum.to_le_bytes());
}

/// Makes every checksum right whose section lies in the file.
pub fn reseal_sections(bytes: &mut [u8]) {
    let mut at = HEADER_BYTES as usize;
    while let Some(entry) = bytes.get(at..at + ENTRY_BYTES as usize) {
        let word = |i: usize| u64::from_le_bytes(entry[i..i + 8].try_into().unwrap());
        let range = word(8)..word(8).saturating_add(word(16));
        if range.end <= bytes.len() as u64 {
            let checksum = xxh3_64(&bytes[range.start as usize..range.end as usize]);
            bytes[at + 32..at + 40].copy_from_slice(&checksum.to_le_bytes());
        }
        at += ENTRY_BYTES as usize;
        let count = u32::from_le_bytes(bytes[16..20].try_into().unwrap()) as usize;
        if at >= HEADER_BYTES as usize + count.saturating_mul(ENTRY_BYTES as usize) {
            return;
        }
    }
}
