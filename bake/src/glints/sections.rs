//! A material of counted facets as sections of a pack, and back.

use super::baked::CountedFacets;
use crate::area_light::baked::{LtcTables, SIZE};
use crate::error::{BakeError, Result};
use crate::pack_access::{names_with, parameters, records};
use glint_formats::area_light::TABLE_VK_FORMAT;
use glint_formats::glints::{COLOURS, GlintsParams, INVERSE, PARAMS, TERMS, UNIFORM};
use glint_formats::{Codec, FourCc, Pack, Resource, Section};

/// The sections of a material under `name`, all compressed when `codec` says so.
pub fn to_sections(name: &str, facets: &CountedFacets, codec: Codec) -> Vec<Section> {
    let side = SIZE as u32;
    let table =
        Resource::Texture { vk_format: TABLE_VK_FORMAT, width: side, height: side, layers: 1, faces: 1, mips: 1 };
    let params = &facets.params;
    let mut sections = vec![
        Section::parameters(PARAMS, name, params),
        Section::buffer(UNIFORM, name, &[params.uniform()]),
        Section::buffer(COLOURS, name, &params.palette()),
    ];
    for (kind, texels) in [(INVERSE, &facets.tables.inverse), (TERMS, &facets.tables.terms)] {
        let payload = texels.as_flattened().iter().flat_map(|bits| bits.to_le_bytes()).collect();
        sections.push(Section::texture(kind, name, table, payload));
    }
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Reads the parameters of the material `name`.
///
/// # Errors
/// `BadInput` where there are none, or they are damaged.
pub fn params(pack: &Pack, name: &str) -> Result<GlintsParams> {
    parameters(pack, PARAMS, name)
}

/// Reads the material `name`. The pack must have passed verification; errors name what is missing or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<CountedFacets> {
    let table = |kind: FourCc| -> Result<Vec<[u16; 4]>> {
        let texels: Vec<[u16; 4]> = records(pack, kind, name)?;
        if texels.len() == SIZE * SIZE {
            return Ok(texels);
        }
        let message = format!("section {kind} of '{name}': expected {} texels, found {}", SIZE * SIZE, texels.len());
        Err(BakeError::BadInput(message))
    };
    let tables = LtcTables { inverse: table(INVERSE)?, terms: table(TERMS)? };
    Ok(CountedFacets { params: params(pack, name)?, tables })
}

/// Names of the materials of counted facets in a pack.
pub fn materials(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glints::{GlintsOptions, bake};
    use crate::progress::Silent;
    use glint_formats::{Limits, PackBuilder};

    #[test]
    fn what_was_baked_is_read_back() {
        for (colours, codec) in [(Vec::new(), Codec::None), (vec![[1.0, 0.5, 0.25], [0.0, 0.5, 0.75]], Codec::Zstd)] {
            let options = GlintsOptions { colours, turn: 1.0, ..GlintsOptions::default() };
            let facets = bake(&options, &Silent).unwrap();
            let mut builder = PackBuilder::new();
            for section in to_sections("flakes", &facets, codec) {
                builder.push(section).unwrap();
            }
            let pack = Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap();
            assert_eq!(pack.verify(), []);
            assert_eq!(materials(&pack), ["flakes"]);
            assert_eq!(from_pack(&pack, "flakes").unwrap(), facets);
            assert!(matches!(from_pack(&pack, "none"), Err(BakeError::BadInput(_))));
        }
    }
}
