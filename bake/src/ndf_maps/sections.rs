//! A material of the tiny-example method as sections of a pack, and back. What shaders bind is made here, byte for byte: records
//! of the uniform, nodes, the atlas of their tables, owners of sub-regions.

use super::baked::{BakedNdfMaps, BakedPlacement, Material};
use super::reach;
use crate::error::{BakeError, Result};
use crate::pack_access::{bytes, names_with, parameters, records};
use bytemuck::Pod;
use glint_formats::binding::TABLE_WIDTH;
use glint_formats::ndf_maps::{
    CLASSES, DENSITY, LAYERS, LAYERS_UNIFORM, LayeredMaterial, LayersUniform, MaterialUniform, MomentsRecord, NODES,
    NOISE, NORMALS, NdfMapsParams, NodeRecord, PARAMS, PLACEMENT, PlacementKind, PlacementParams, TransformRecord,
    UNIFORM, UNIFORM_BYTES, atlas_resource, classes_resource, noise_resource, table,
};
use glint_formats::{Codec, FourCc, Pack, Resource, Section, vk_format};

/// The sections of one material under `name`, all compressed or none as `codec` says.
pub fn to_sections(name: &str, material: &Material, codec: Codec) -> Vec<Section> {
    let Material { maps, placement } = material;
    let header = MaterialUniform::new(&maps.params, &placement.params, maps.atlas_size, material.most_texels());
    let mut nodes: Vec<u8> = bytemuck::cast_slice(&maps.nodes).to_vec();
    nodes.extend_from_slice(bytemuck::cast_slice(&maps.moments));
    nodes.resize(nodes.len().next_multiple_of(TABLE_WIDTH as usize * size_of::<NodeRecord>()), 0);
    let node_table = table(vk_format::R32G32B32A32_UINT, maps.params.node_elements());
    let mut sections = vec![
        Section::parameters(PARAMS, name, &maps.params),
        Section {
            resource: Resource::Buffer { stride: UNIFORM_BYTES as u32, count: 1 },
            ..Section::buffer(UNIFORM, name, &uniform_bytes(material, &header))
        },
        Section::texture(NODES, name, node_table, nodes),
        Section::texture(DENSITY, name, atlas_resource(maps.atlas_size), maps.atlas.clone()),
    ];
    let normals = bytemuck::cast_slice(&normal_patches(maps)).to_vec();
    sections.push(Section::texture(NORMALS, name, maps.params.normals_resource(), normals));
    sections.push(Section::parameters(PLACEMENT, name, &placement.params));
    if let PlacementKind::Stochastic { cells_x, .. } = placement.params.kind {
        let noise = bytemuck::cast_slice(&placement.noise).to_vec();
        sections.push(Section::texture(NOISE, name, noise_resource(cells_x), noise));
        let shape = classes_resource(cells_x);
        sections.push(Section::texture(CLASSES, name, shape, bytemuck::cast_slice(&placement.classes).to_vec()));
    }
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Section [`NORMALS`]: the four normals around each patch between texel centres, from the one that ends at the first texel on.
fn normal_patches(maps: &BakedNdfMaps) -> Vec<[[i16; 2]; 4]> {
    let (width, height) = (maps.params.width as usize, maps.params.height as usize);
    let before = |k: usize, edge: usize| if k == 0 { edge - 1 } else { k - 1 };
    let patch = |k: usize| {
        let (i, j) = (k % width, k / width);
        let (left, up) = (before(i, width), before(j, height));
        [[left, up], [i, up], [left, j], [i, j]].map(|[i, j]| maps.normals[j * width + i])
    };
    (0..width * height).map(patch).collect()
}

/// Section [`UNIFORM`]: the header, then levels, palette and reach mask; the rest is zero.
fn uniform_bytes(material: &Material, header: &MaterialUniform) -> Vec<u8> {
    let mut bytes = bytemuck::bytes_of(header).to_vec();
    for level in &material.maps.params.levels {
        let record = [level.nodes_x, level.nodes_y, level.first_node, 0];
        bytes.extend_from_slice(bytemuck::cast_slice(&record));
    }
    bytes.extend_from_slice(bytemuck::cast_slice(&material.placement.palette));
    bytes.extend_from_slice(bytemuck::cast_slice(&reach::mask(material)));
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
    let table = bytes(pack, NODES, name)?;
    let count = maps_params.node_count() as usize;
    let nodes: Vec<NodeRecord> = read(&table, 0, count).ok_or(short(NODES))?;
    let moments: Vec<MomentsRecord> = read(&table, header.moments, count).ok_or(short(NODES))?;
    let atlas = bytes(pack, DENSITY, name)?;
    let atlas_size = match pack.find(DENSITY, name).map(|entry| entry.resource) {
        Some(Resource::Texture { width, height, .. }) if u64::from(width) * u64::from(height) == atlas.len() as u64 => {
            [width, height]
        }
        _ => return Err(short(DENSITY)),
    };
    let patches: Vec<[[i16; 2]; 4]> = records(pack, NORMALS, name)?;
    let normals = patches.into_iter().map(|[.., own]| own).collect();
    let stochastic = matches!(placement_params.kind, PlacementKind::Stochastic { .. });
    let (noise, classes) = if stochastic {
        (records(pack, NOISE, name)?, records(pack, CLASSES, name)?)
    } else {
        (Vec::new(), Vec::new())
    };
    Ok(Material {
        maps: BakedNdfMaps { params: maps_params, nodes, moments, atlas_size, atlas, normals },
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
