//! A material of the tiny-example method as sections of a pack, and back. What shaders bind is made here, byte for byte: records
//! of the uniform, blocks of density, owners of sub-regions.

use super::baked::{BakedNdfMaps, BakedPlacement, Material};
use super::blocks::{self, BLOCK_BYTES};
use super::reach;
use crate::error::{BakeError, Result};
use crate::pack_access::{bytes, names_with, parameters, records};
use bytemuck::Pod;
use glint_formats::binding::TABLE_WIDTH;
use glint_formats::ndf_maps::{
    CLASSES, DENSITY, LAYERS, LAYERS_UNIFORM, LayeredMaterial, LayersUniform, MaterialUniform, NOISE, NORMALS,
    NdfMapsParams, PARAMS, PLACEMENT, PlacementKind, PlacementParams, TILES, TileRecord, TransformRecord, UNIFORM,
    UNIFORM_BYTES, classes_resource, noise_resource, table,
};
use glint_formats::{Codec, FourCc, Pack, Resource, Section, vk_format};

/// A table of elements of `bytes` bytes each as a section: whole rows, zeros at the end.
fn table_section(kind: FourCc, name: &str, format: u32, bytes: usize, mut elements: Vec<u8>) -> Section {
    let count = elements.len() / bytes;
    let row = TABLE_WIDTH as usize * bytes;
    elements.resize(elements.len().next_multiple_of(row).max(row), 0);
    Section::texture(kind, name, table(format, count as u64), elements)
}

/// The sections of one material under `name`, all compressed or none as `codec` says.
pub fn to_sections(name: &str, material: &Material, codec: Codec) -> Vec<Section> {
    let Material { maps, placement } = material;
    let blocks = blocks::blocks(maps);
    let mut tiles = maps.tiles.clone();
    for (tile, first) in tiles.iter_mut().zip(blocks.iter().flat_map(|blocks| &blocks.first)) {
        tile.first = *first;
    }
    let header = MaterialUniform::new(&maps.params, &placement.params, blocks.is_some(), material.most_texels());
    let mut sections = vec![
        Section::parameters(PARAMS, name, &maps.params),
        Section {
            resource: Resource::Buffer { stride: UNIFORM_BYTES as u32, count: 1 },
            ..Section::buffer(UNIFORM, name, &uniform_bytes(material, &header, &tiles))
        },
    ];
    if header.few_tiles == 0 {
        // A tile is two elements.
        let records = bytemuck::cast_slice(&tiles).to_vec();
        sections.push(table_section(TILES, name, vk_format::R32G32B32A32_UINT, 16, records));
    }
    sections.push(match blocks {
        Some(blocks) => table_section(DENSITY, name, vk_format::R32G32B32A32_UINT, BLOCK_BYTES, blocks.payload),
        None => {
            let mut texels = maps.density.clone();
            texels.resize(texels.len().next_multiple_of(4), 0);
            table_section(DENSITY, name, vk_format::R32_UINT, 4, texels)
        }
    });
    let normals = bytemuck::cast_slice(&maps.normals).to_vec();
    sections.push(Section::texture(NORMALS, name, maps.params.normals_resource(), normals));
    sections.push(Section::parameters(PLACEMENT, name, &placement.params));
    if let PlacementKind::Stochastic { cells_x, .. } = placement.params.kind {
        let noise = bytemuck::cast_slice(&placement.noise).to_vec();
        sections.push(Section::texture(NOISE, name, noise_resource(cells_x), noise));
        let shape = classes_resource(cells_x, placement.params.palette_len);
        sections.push(Section::texture(CLASSES, name, shape, placement.classes.clone()));
    }
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Section [`UNIFORM`]: the header, then levels, palette, reach mask, and tiles if they are few; the rest is zero.
fn uniform_bytes(material: &Material, header: &MaterialUniform, tiles: &[TileRecord]) -> Vec<u8> {
    let mut bytes = bytemuck::bytes_of(header).to_vec();
    for level in &material.maps.params.levels {
        let record = [level.tile_texels, level.tiles_x, level.tiles_y, level.first_tile];
        bytes.extend_from_slice(bytemuck::cast_slice(&record));
    }
    bytes.extend_from_slice(bytemuck::cast_slice(&material.placement.palette));
    bytes.extend_from_slice(bytemuck::cast_slice(&reach::mask(material)));
    if header.few_tiles == 1 {
        bytes.extend_from_slice(bytemuck::cast_slice(tiles));
    }
    bytes.resize(UNIFORM_BYTES, 0);
    bytes
}

/// The sections of a two-layer material under `name`; the materials of its layers have their own.
pub fn layer_sections(name: &str, layers: &LayeredMaterial) -> Vec<Section> {
    vec![Section::parameters(LAYERS, name, layers), Section::buffer(LAYERS_UNIFORM, name, &[LayersUniform::of(layers)])]
}

/// The first bytes of the uniform section of the material `name`: what a program of it may be made for.
///
/// # Errors
/// A section that is missing or damaged.
pub fn uniform(pack: &Pack, name: &str) -> Result<MaterialUniform> {
    Ok(bytemuck::pod_read_unaligned(&uniform_of(pack, name)?[..size_of::<MaterialUniform>()]))
}

fn uniform_of(pack: &Pack, name: &str) -> Result<Vec<u8>> {
    let bytes = bytes(pack, UNIFORM, name)?;
    if bytes.len() != UNIFORM_BYTES {
        let found = bytes.len();
        let message = format!("section {UNIFORM} of '{name}': expected {UNIFORM_BYTES} bytes, found {found}");
        return Err(BakeError::BadInput(message));
    }
    Ok(bytes)
}

/// Records of `T` from the record of 16 bytes with index `first` on.
fn read<T: Pod>(records: &[u8], first: u32, count: usize) -> Option<Vec<T>> {
    let from = first as usize * 16;
    Some(bytemuck::pod_collect_to_vec(records.get(from..from.checked_add(count.checked_mul(size_of::<T>())?)?)?))
}

/// Reads the material `name`. The pack must have passed verification; errors name what is missing or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<Material> {
    let maps_params: NdfMapsParams = parameters(pack, PARAMS, name)?;
    let placement_params: PlacementParams = parameters(pack, PLACEMENT, name)?;
    let short = |kind: FourCc| BakeError::BadInput(format!("section {kind} of '{name}' ends too early"));
    let uniform = uniform_of(pack, name)?;
    let (header, from_uniform) = uniform.split_at(size_of::<MaterialUniform>());
    let header: MaterialUniform = bytemuck::pod_read_unaligned(header);
    let palette: Vec<TransformRecord> =
        read(from_uniform, header.palette_records, placement_params.palette_len as usize).ok_or(short(UNIFORM))?;
    let count = maps_params.tile_count() as usize;
    let mut tiles: Vec<TileRecord> = if header.few_tiles == 1 {
        read(from_uniform, header.tile_records, count).ok_or(short(UNIFORM))?
    } else {
        read(&bytes(pack, TILES, name)?, 0, count).ok_or(short(TILES))?
    };
    let density = if header.blocks == 1 {
        blocks::texels_of(&records(pack, DENSITY, name)?, &mut tiles).ok_or(short(DENSITY))?
    } else {
        let end = |tile: &TileRecord| tile.first as usize + (tile.width() * tile.height()) as usize;
        let texels = tiles.iter().map(end).max().unwrap_or(0);
        let mut words = bytes(pack, DENSITY, name)?;
        if words.len() < texels * maps_params.storage.texel_bytes() as usize {
            return Err(short(DENSITY));
        }
        words.truncate(texels * maps_params.storage.texel_bytes() as usize);
        words
    };
    let stochastic = matches!(placement_params.kind, PlacementKind::Stochastic { .. });
    let (noise, classes) =
        if stochastic { (records(pack, NOISE, name)?, bytes(pack, CLASSES, name)?) } else { (Vec::new(), Vec::new()) };
    Ok(Material {
        maps: BakedNdfMaps { params: maps_params, tiles, density, normals: records(pack, NORMALS, name)? },
        placement: BakedPlacement { params: placement_params, palette, noise, classes },
    })
}

/// The layered materials of a pack, by the names of their sections.
///
/// # Errors
/// Parameters that do not decode.
pub fn layered(pack: &Pack) -> Result<Vec<(&str, LayeredMaterial)>> {
    names_with(pack, LAYERS).into_iter().map(|name| Ok((name, parameters(pack, LAYERS, name)?))).collect()
}

/// Names of the materials of this method in a pack.
pub fn materials(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}
