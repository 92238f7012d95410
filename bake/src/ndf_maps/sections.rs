//! A material of the tiny-example method as sections of a pack, and back.

use super::baked::{BakedNdfMaps, BakedPlacement, Material};
use crate::error::Result;
use crate::pack_access::{bytes, names_with, parameters, records};
use glint_formats::ndf_maps::{
    CLASSES, DENSITY, LAYERS, LayeredMaterial, NOISE, NORMALS, NdfMapsParams, PALETTE, PARAMS, PLACEMENT,
    PlacementKind, PlacementParams, TILES,
};
use glint_formats::{Codec, Pack, Resource, Section, vk_format};

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

/// The layered materials of a pack.
pub fn layered(pack: &Pack) -> Result<Vec<LayeredMaterial>> {
    names_with(pack, LAYERS).into_iter().map(|name| parameters(pack, LAYERS, name)).collect()
}

/// Names of the materials of this method in a pack.
pub fn materials(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}
