//! NDF maps and their placement on the GPU: `bind_ndf_maps.wgsl`.

mod reach;

use crate::gpu::{Gpu, GpuError, ResourceSet, Resources};
use bytemuck::{Pod, Zeroable};
use glint_bake_core::ndf_maps::eval::Material;
use glint_formats::ndf_maps::{DensityStorage, PlacementKind, Wrap};

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
    /// Layers begin at multiples of 16 bytes.
    unused: [u32; 3],
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

/// The two buffers while they are filled.
#[derive(Default)]
struct Buffers {
    records: Vec<u8>,
    words: Vec<u8>,
}

/// Appends whole units of `unit` bytes and returns the index of the first.
fn append(buffer: &mut Vec<u8>, unit: usize, bytes: &[u8]) -> u32 {
    let first = (buffer.len() / unit) as u32;
    buffer.extend_from_slice(bytes);
    buffer.resize(buffer.len().next_multiple_of(unit), 0);
    first
}

impl Buffers {
    fn record(&mut self, bytes: &[u8]) -> u32 {
        append(&mut self.records, 16, bytes)
    }

    fn word(&mut self, bytes: &[u8]) -> u32 {
        append(&mut self.words, 4, bytes)
    }

    /// Adds a material's sections, bytes as in the pack.
    fn add(&mut self, material: &Material) -> MaterialUniform {
        let Material { maps, placement } = material;
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
            tile_records: self.record(bytemuck::cast_slice(&maps.tiles)),
            palette_records: self.record(bytemuck::cast_slice(&placement.palette)),
            noise_records: self.record(bytemuck::cast_slice(&placement.noise)),
            density_words: self.word(&maps.density),
            normal_words: self.word(bytemuck::cast_slice(&maps.normals)),
            class_words: self.word(&placement.classes),
            reach_words: self.word(bytemuck::cast_slice(&reach::mask(material))),
            unused: [0; 3],
        }
    }
}

/// Uploads a material, or the base of a layered one with its clear coat and that one's reflectance at normal incidence.
/// Errors: materials larger than what a program can bind.
pub fn upload(gpu: &Gpu, base: &Material, coat: Option<(&Material, f32)>) -> Result<Resources, GpuError> {
    let mut buffers = Buffers::default();
    let mut data = DataUniform { count: 1, ..DataUniform::default() };
    data.layers[0] = buffers.add(base);
    if let Some((coat, f0)) = coat {
        data.layers[1] = buffers.add(coat);
        data.count = 2;
        data.coat_f0 = f0;
    }
    let limit = gpu.device.limits().max_storage_buffer_binding_size;
    let largest = buffers.records.len().max(buffers.words.len()) as u64;
    if largest > limit {
        return Err(GpuError::BadPack(format!(
            "the NDF maps need a buffer of {largest} bytes, and the GPU binds {limit} at most; bake with fewer cells or a \
             smaller palette"
        )));
    }
    let mut set = ResourceSet::default();
    set.uniform(gpu, bytemuck::bytes_of(&data));
    set.storage(gpu, &buffers.records);
    set.storage(gpu, &buffers.words);
    Ok(set.finish(gpu))
}
