//! A material of the tiny-example method as sections of a pack, and back.

use super::bake::BakedNdfMaps;
use super::eval::Material;
use super::placement::BakedPlacement;
use crate::error::{BakeError, Result};
use bytemuck::Pod;
use glint_formats::ndf_maps::{
    CLASSES, DENSITY, NOISE, NORMALS, NdfMapsParams, PALETTE, PARAMS, PLACEMENT, PlacementKind, PlacementParams, TILES,
};
use glint_formats::{Codec, FourCc, Pack, Resource, Section, params, vk_format};

/// The sections of one material under `name`; density texels are compressed when `codec` says so.
pub fn to_sections(name: &str, material: &Material, codec: Codec) -> Vec<Section> {
    let Material { maps, placement } = material;
    let (width, height) = (maps.params.width, maps.params.height);
    let texel_bytes = maps.params.storage.texel_bytes();
    let mut sections = vec![
        Section::parameters(PARAMS, name, &maps.params),
        Section::buffer(TILES, name, &maps.tiles),
        Section {
            resource: Resource::Buffer {
                stride: texel_bytes,
                count: maps.density.len() as u64 / u64::from(texel_bytes),
            },
            ..Section::buffer(DENSITY, name, &maps.density)
        },
        Section::texture(
            NORMALS,
            name,
            Resource::Texture { vk_format: vk_format::R16G16_SNORM, width, height, layers: 1, faces: 1, mips: 1 },
            bytemuck::cast_slice(&maps.normals).to_vec(),
        ),
        Section::parameters(PLACEMENT, name, &placement.params),
        Section::buffer(PALETTE, name, &placement.palette),
    ];
    if let PlacementKind::Stochastic { cells_x, cells_y, .. } = placement.params.kind {
        let texture = |vk_format, layers, mips| Resource::Texture {
            vk_format,
            width: cells_x,
            height: cells_y,
            layers,
            faces: 1,
            mips,
        };
        let layers = placement.params.palette_len.div_ceil(4);
        let mips = glint_formats::container::full_mip_count(cells_x, cells_y);
        sections.push(Section::texture(
            NOISE,
            name,
            texture(vk_format::R32G32B32A32_UINT, 1, 1),
            bytemuck::cast_slice(&placement.noise).to_vec(),
        ));
        sections.push(Section::texture(
            CLASSES,
            name,
            texture(vk_format::R8G8B8A8_UNORM, layers, mips),
            placement.classes.clone(),
        ));
    }
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Reads the material `name`. The pack must have passed verification; errors name what is missing or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<Material> {
    let maps_params: NdfMapsParams = parameters(pack, PARAMS, name)?;
    let placement_params: PlacementParams = parameters(pack, PLACEMENT, name)?;
    let stochastic = matches!(placement_params.kind, PlacementKind::Stochastic { .. });
    let (noise, classes) =
        if stochastic { (records(pack, NOISE, name)?, bytes(pack, CLASSES, name)?) } else { (Vec::new(), Vec::new()) };
    Ok(Material {
        maps: BakedNdfMaps {
            params: maps_params,
            tiles: records(pack, TILES, name)?,
            density: bytes(pack, DENSITY, name)?,
            normals: records(pack, NORMALS, name)?,
        },
        placement: BakedPlacement { params: placement_params, palette: records(pack, PALETTE, name)?, noise, classes },
    })
}

/// Names of the materials of this method in a pack.
pub fn materials(pack: &Pack) -> Vec<&str> {
    pack.names().into_iter().filter(|name| pack.find(PARAMS, name).is_some()).collect()
}

fn bytes(pack: &Pack, kind: FourCc, name: &str) -> Result<Vec<u8>> {
    let entry =
        pack.find(kind, name).ok_or_else(|| BakeError::BadInput(format!("material '{name}' has no section {kind}")))?;
    let payload = pack.payload(entry).map_err(|issue| BakeError::BadInput(issue.to_string()))?;
    Ok(payload.into_owned())
}

fn records<T: Pod>(pack: &Pack, kind: FourCc, name: &str) -> Result<Vec<T>> {
    let bytes = bytes(pack, kind, name)?;
    if bytes.len() % size_of::<T>() != 0 {
        return Err(BakeError::BadInput(format!("section {kind} of '{name}' does not hold whole records")));
    }
    Ok(bytemuck::pod_collect_to_vec(&bytes))
}

fn parameters<T: serde::de::DeserializeOwned>(pack: &Pack, kind: FourCc, name: &str) -> Result<T> {
    params::decode(&bytes(pack, kind, name)?)
        .map_err(|e| BakeError::BadInput(format!("section {kind} of '{name}': {e}")))
}
