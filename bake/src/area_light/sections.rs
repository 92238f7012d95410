//! A material as sections of a pack, and back.

use super::baked::{AreaLightMaterial, LtcTables, SIZE};
use crate::error::{BakeError, Result};
use crate::pack_access::{bytes, names_with, parameters, records};
use glint_formats::area_light::{
    AreaLightParams, INVERSE, NORMALS, PARAMS, ROUGHNESS, TABLE_VK_FORMAT, TERMS, UNIFORM,
};
use glint_formats::container::full_mip_count;
use glint_formats::{Codec, FourCc, Pack, Resource, Section};

/// The sections of a material under `name`, all compressed when `codec` says so.
pub fn to_sections(name: &str, material: &AreaLightMaterial, codec: Codec) -> Vec<Section> {
    let params = &material.params;
    let (width, height) = (params.width, params.height);
    let texture =
        |vk_format, width, height, mips| Resource::Texture { vk_format, width, height, layers: 1, faces: 1, mips };
    let map = texture(params.storage.vk_format(), width, height, full_mip_count(width, height));
    let mut sections = vec![
        Section::parameters(PARAMS, name, params),
        Section::buffer(UNIFORM, name, &[params.uniform()]),
        Section::texture(NORMALS, name, map, material.normals.clone()),
    ];
    if params.anisotropic {
        sections.push(Section::texture(ROUGHNESS, name, map, material.roughness.clone()));
    }
    sections.extend(table_sections([INVERSE, TERMS], name, &material.tables));
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// The LTC tables under `name`, as sections of these kinds: the inverse matrices, then the terms.
pub fn table_sections(kinds: [FourCc; 2], name: &str, tables: &LtcTables) -> [Section; 2] {
    let side = SIZE as u32;
    let table =
        Resource::Texture { vk_format: TABLE_VK_FORMAT, width: side, height: side, layers: 1, faces: 1, mips: 1 };
    let section = |kind, texels: &[[u16; 4]]| {
        let payload = texels.as_flattened().iter().flat_map(|bits| bits.to_le_bytes()).collect();
        Section::texture(kind, name, table, payload)
    };
    [section(kinds[0], &tables.inverse), section(kinds[1], &tables.terms)]
}

/// Reads the LTC tables of the material `name` from sections of these kinds.
///
/// # Errors
/// `BadInput` where there are none, or they are damaged.
pub fn tables_from_pack(pack: &Pack, kinds: [FourCc; 2], name: &str) -> Result<LtcTables> {
    let table = |kind: FourCc| -> Result<Vec<[u16; 4]>> {
        let texels: Vec<[u16; 4]> = records(pack, kind, name)?;
        if texels.len() == SIZE * SIZE {
            return Ok(texels);
        }
        let (expected, found) = (SIZE * SIZE, texels.len());
        Err(BakeError::BadInput(format!("section {kind} of '{name}': expected {expected} texels, found {found}")))
    };
    Ok(LtcTables { inverse: table(kinds[0])?, terms: table(kinds[1])? })
}

/// Reads the parameters of the material `name`.
///
/// # Errors
/// `BadInput` where there are none, or they are damaged.
pub fn params(pack: &Pack, name: &str) -> Result<AreaLightParams> {
    parameters(pack, PARAMS, name)
}

/// Reads the material `name`. The pack must have passed verification; errors name what is missing or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<AreaLightMaterial> {
    let params = params(pack, name)?;
    let texels: usize = (0..full_mip_count(params.width, params.height))
        .map(|mip| (params.width >> mip).max(1) as usize * (params.height >> mip).max(1) as usize)
        .sum();
    let read = |kind: FourCc, len: usize| -> Result<Vec<u8>> {
        let found = bytes(pack, kind, name)?;
        if found.len() == len {
            return Ok(found);
        }
        Err(BakeError::BadInput(format!("section {kind} of '{name}': expected {len} bytes, found {}", found.len())))
    };
    let map_bytes = texels * params.storage.texel_bytes();
    Ok(AreaLightMaterial {
        normals: read(NORMALS, map_bytes)?,
        roughness: if params.anisotropic { read(ROUGHNESS, map_bytes)? } else { Vec::new() },
        tables: tables_from_pack(pack, [INVERSE, TERMS], name)?,
        params,
    })
}

/// Names of the area-light materials in a pack.
pub fn materials(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::area_light::{AreaLightOptions, bake};
    use crate::normal_map::NormalMap;
    use crate::progress::Silent;
    use glint_formats::Wrap;
    use glint_formats::area_light::NormalStorage;
    use glint_formats::{Limits, PackBuilder};

    #[test]
    fn what_was_baked_is_read_back() {
        let projected = (0..15).map(|k| [0.05 * (k % 5) as f32, -0.1 * (k % 3) as f32]).collect();
        let map = NormalMap { width: 5, height: 3, wrap: Wrap::Repeat, projected };
        for (anisotropic, storage, codec) in
            [(false, NormalStorage::F16, Codec::None), (true, NormalStorage::Snorm8, Codec::Zstd)]
        {
            let options = AreaLightOptions { anisotropic, storage, ..AreaLightOptions::default() };
            let material = bake(&map, &options, &Silent).unwrap();
            let mut builder = PackBuilder::new();
            for section in to_sections("metal", &material, codec) {
                builder.push(section).unwrap();
            }
            let pack = Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap();
            assert_eq!(pack.verify(), []);
            assert_eq!(materials(&pack), ["metal"]);
            assert_eq!(from_pack(&pack, "metal").unwrap(), material);
            assert!(matches!(from_pack(&pack, "none"), Err(BakeError::BadInput(_))));
        }
    }
}
