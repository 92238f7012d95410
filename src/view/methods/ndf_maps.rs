//! NDF maps and their placement on the GPU: `bind_ndf_maps.wgsl`.

mod blocks;
mod reach;

use crate::gpu::{Gpu, GpuError, ResourceSet, Resources, TABLE_WIDTH};
use bytemuck::{Pod, Zeroable};
use glint_bake_core::ndf_maps::baked::Material;
use glint_formats::Wrap;
use glint_formats::ndf_maps::{DensityStorage, NoiseTexel, PlacementKind};

/// `GlintNdfMaterial`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
struct MaterialUniform {
    size: [u32; 2],
    wrap: u32,
    storage: u32,
    intrinsic_roughness: f32,
    levels: u32,
    palette: u32,
    cells: u32,
    cell_texels: f32,
    level_records: u32,
    tile_records: u32,
    palette_records: u32,
    noise_records: u32,
    density_words: u32,
    normal_words: u32,
    class_words: u32,
    reach_words: u32,
    blocks: u32,
    few_tiles: u32,
    most_texels: f32,
}

/// `NdfMapsData`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
struct DataUniform {
    layers: [MaterialUniform; 2],
    count: u32,
    coat_f0: f32,
    unused: [u32; 2],
}

/// Elements of `NdfMapsData.records`: as many as fit in the 64 KiB that every adapter binds.
const RECORDS: usize = 4000;

/// The tables while they are filled.
#[derive(Default)]
struct Tables {
    /// Levels and palettes.
    records: Vec<u8>,
    tiles: Vec<u8>,
    noise: Vec<u8>,
    words: Vec<u8>,
    blocks: Vec<[u32; 4]>,
}

/// Appends whole units of `unit` bytes and returns the index of the first.
fn append(buffer: &mut Vec<u8>, unit: usize, bytes: &[u8]) -> u32 {
    let first = (buffer.len() / unit) as u32;
    buffer.extend_from_slice(bytes);
    buffer.resize(buffer.len().next_multiple_of(unit), 0);
    first
}

impl Tables {
    fn record(&mut self, bytes: &[u8]) -> u32 {
        append(&mut self.records, 16, bytes)
    }

    fn word(&mut self, bytes: &[u8]) -> u32 {
        append(&mut self.words, 4, bytes)
    }

    /// Adds a material's sections: bytes as in the pack, but for the density where it goes into blocks.
    fn add(&mut self, material: &Material) -> MaterialUniform {
        let Material { maps, placement } = material;
        let blocks = blocks::of(maps, self.blocks.len());
        let mut tiles = maps.tiles.clone();
        if let Some(blocks) = &blocks {
            for (tile, first) in tiles.iter_mut().zip(&blocks.first) {
                // Nothing that is drawn needs the tile's error.
                tile.error = f32::from_bits(*first);
            }
            self.blocks.extend(&blocks.blocks);
        }
        let levels: Vec<[u32; 4]> =
            maps.params.levels.iter().map(|l| [l.tile_texels, l.tiles_x, l.tiles_y, l.first_tile]).collect();
        let (cells, cell_texels) = match placement.params.kind {
            PlacementKind::Tiled => (0, 0.0),
            PlacementKind::Stochastic { cells_x, cell_texels, .. } => (cells_x, cell_texels),
        };
        MaterialUniform {
            size: [maps.params.width, maps.params.height],
            wrap: match maps.params.wrap {
                Wrap::Repeat => 0,
                Wrap::Clamp => 1,
            },
            storage: match maps.params.storage {
                DensityStorage::SqrtU8 => 0,
                DensityStorage::F16 => 1,
                DensityStorage::PaperF32 => 2,
            },
            intrinsic_roughness: maps.params.intrinsic_roughness,
            levels: levels.len() as u32,
            palette: placement.params.palette_len,
            cells,
            cell_texels,
            level_records: self.record(bytemuck::cast_slice(&levels)),
            tile_records: append(&mut self.tiles, 16, bytemuck::cast_slice(&tiles)),
            palette_records: self.record(bytemuck::cast_slice(&placement.palette)),
            noise_records: append(&mut self.noise, 16, bytemuck::cast_slice(&owners(&placement.noise, cells))),
            density_words: self.word(if blocks.is_some() { &[] } else { &maps.density }),
            normal_words: self.word(bytemuck::cast_slice(&maps.normals)),
            class_words: self.word(&placement.classes),
            reach_words: self.word(bytemuck::cast_slice(&reach::mask(material))),
            blocks: u32::from(blocks.is_some()),
            few_tiles: 0,
            most_texels: material.most_texels(),
        }
    }
}

/// What every sub-region of `cells` by `cells` shows, row by row: the noise texel of its owner, with which of the 3 × 3 cells around
/// its own that is in place of that one's owners. One load finds what would take two, the second by what the first has.
fn owners(noise: &[NoiseTexel], cells: u32) -> Vec<NoiseTexel> {
    let owner = |k: u32| {
        let (x, y) = (k % (2 * cells), k / (2 * cells));
        let own = noise[(y / 2 * cells + x / 2) as usize];
        let neighbour = own.class_and_owners >> (16 + 4 * (x % 2 + 2 * (y % 2))) & 0xf;
        let cell = |at: u32, step: u32| (at / 2 + cells + step - 1) % cells;
        let owner = noise[(cell(y, neighbour / 3) * cells + cell(x, neighbour % 3)) as usize];
        NoiseTexel { class_and_owners: owner.class_and_owners & 0xff | neighbour << 16, ..owner }
    };
    (0..4 * cells * cells).map(owner).collect()
}

/// Uploads a material, or the base of a layered one with its clear coat and that one's reflectance at normal incidence.
/// Errors: materials larger than what a program can bind.
pub fn upload(gpu: &Gpu, base: &Material, coat: Option<(&Material, f32)>) -> Result<Resources, GpuError> {
    let mut tables = Tables::default();
    let mut data = DataUniform { count: 1, ..DataUniform::default() };
    data.layers[0] = tables.add(base);
    if let Some((coat, f0)) = coat {
        data.layers[1] = tables.add(coat);
        data.count = 2;
        data.coat_f0 = f0;
    }
    // Tiles come last: after the levels and palettes, or after the noise maps.
    let few_tiles = tables.records.len() + tables.tiles.len() <= 16 * RECORDS;
    let with_tiles = if few_tiles { &mut tables.records } else { &mut tables.noise };
    let before = append(with_tiles, 16, &tables.tiles);
    for layer in &mut data.layers {
        layer.tile_records += before;
        layer.few_tiles = u32::from(few_tiles);
    }
    if tables.records.len() > 16 * RECORDS {
        return Err(GpuError::BadPack("the palettes of the NDF maps have too many transforms".into()));
    }
    tables.records.resize(16 * RECORDS, 0);
    let limit = u64::from(gpu.device.limits().max_texture_dimension_2d) * u64::from(TABLE_WIDTH);
    let largest = (tables.noise.len() / 16).max(tables.words.len() / 4).max(tables.blocks.len()) as u64;
    if largest > limit {
        return Err(GpuError::BadPack(format!(
            "the NDF maps need a table of {largest} elements, and the GPU has {limit} at most; bake with fewer cells or a \
             smaller palette"
        )));
    }
    let mut set = ResourceSet::default();
    set.uniform(gpu, &[bytemuck::bytes_of(&data), &tables.records].concat());
    set.table(gpu, wgpu::TextureFormat::Rgba32Uint, &tables.noise);
    set.table(gpu, wgpu::TextureFormat::R32Uint, &tables.words);
    set.table(gpu, wgpu::TextureFormat::Rgba32Uint, bytemuck::cast_slice(&tables.blocks));
    Ok(set.finish(gpu))
}

/// Pipeline constants that follow from the data: `NDF_MAPS_LAYERS`, `NDF_MAPS_CELLS`, `NDF_MAPS_BLOCKS` and `NDF_MAPS_FEW_TILES`. What two layers do not
/// share is left open.
pub fn constants(base: &Material, coat: Option<&Material>) -> Vec<(&'static str, f64)> {
    let cells = |material: &Material| match material.placement.params.kind {
        PlacementKind::Tiled => 0,
        PlacementKind::Stochastic { cells_x, .. } => cells_x,
    };
    let has_blocks = |material: &Material| blocks::count(&material.maps).is_some();
    let mut constants = vec![("NDF_MAPS_LAYERS", if coat.is_some() { 2.0 } else { 1.0 })];
    if coat.is_none_or(|coat| cells(coat) == cells(base)) {
        constants.push(("NDF_MAPS_CELLS", f64::from(cells(base))));
    }
    if coat.is_none_or(|coat| has_blocks(coat) == has_blocks(base)) {
        constants.push(("NDF_MAPS_BLOCKS", f64::from(u8::from(has_blocks(base)))));
    }
    let records = |material: &Material| {
        material.maps.params.levels.len() + 2 * (material.maps.tiles.len() + material.placement.palette.len())
    };
    let few_tiles = records(base) + coat.map_or(0, records) <= RECORDS;
    constants.push(("NDF_MAPS_FEW_TILES", f64::from(u8::from(few_tiles))));
    constants
}
