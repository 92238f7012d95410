//! A material of counted facets as sections of a pack, and back.

use super::baked::CountedFacets;
use crate::area_light::sections::{table_sections, tables_from_pack};
use crate::error::Result;
use crate::pack_access::{names_with, parameters};
use glint_formats::glints::{COLOURS, GlintsParams, INVERSE, PARAMS, TERMS, UNIFORM};
use glint_formats::{Codec, Pack, Section};

/// The sections of a material under `name`, all compressed when `codec` says so.
pub fn to_sections(name: &str, facets: &CountedFacets, codec: Codec) -> Vec<Section> {
    let params = &facets.params;
    let mut sections = vec![
        Section::parameters(PARAMS, name, params),
        Section::buffer(UNIFORM, name, &[params.uniform()]),
        Section::buffer(COLOURS, name, &params.palette()),
    ];
    sections.extend(table_sections([INVERSE, TERMS], name, &facets.tables));
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
    let tables = tables_from_pack(pack, [INVERSE, TERMS], name)?;
    Ok(CountedFacets { params: params(pack, name)?, tables })
}

/// Names of the materials of counted facets in a pack.
pub fn materials(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::BakeError;
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
