//! A dictionary as sections of a pack, and back.

use super::options::DictionaryOptions;
use super::tables::Dictionary;
use crate::error::{BakeError, Result};
use crate::pack_access::{bytes, names_with, parameters};
use glint_formats::dictionary::{DictionaryParams, MeasuredError, PARAMS, TABLE};
use glint_formats::{Codec, Pack, Resource, Section};

/// The sections of a dictionary under `name`, both compressed when `codec` says so.
pub fn to_sections(name: &str, dictionary: &Dictionary, measured: MeasuredError, codec: Codec) -> Vec<Section> {
    let shape = dictionary.shape();
    let texture = Resource::Texture {
        vk_format: shape.vk_format,
        width: shape.width,
        height: shape.height,
        layers: 1,
        faces: 1,
        mips: 1,
    };
    let mut sections = vec![
        Section::parameters(PARAMS, name, &dictionary.params(measured)),
        Section::texture(TABLE, name, texture, dictionary.payload()),
    ];
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Reads the dictionary `name` and its parameters. The pack must have passed verification; errors name what is missing
/// or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<(Dictionary, DictionaryParams)> {
    let params: DictionaryParams = parameters(pack, PARAMS, name)?;
    let options = DictionaryOptions {
        marginals: params.marginals,
        levels: params.levels,
        entries: params.entries,
        alpha_dict: params.alpha_dict,
        lobe_std: params.lobe_std,
        seed: params.seed,
    };
    if (params.domain / options.domain() - 1.0).abs() > 1e-9 {
        let (expected, found) = (options.domain(), params.domain);
        let message = format!("section {PARAMS} of '{name}': expected a domain of {expected}, found {found}");
        return Err(BakeError::BadInput(message));
    }
    let table = bytes(pack, TABLE, name)?;
    let texels = options.tables().saturating_mul(u64::from(params.entries));
    if table.len() as u64 / 2 != texels {
        let found = table.len() / 2;
        let message = format!("section {TABLE} of '{name}': expected {texels} texels, found {found}");
        return Err(BakeError::BadInput(message));
    }
    let mut bits = Vec::with_capacity(table.len() / 2);
    for texel in table.chunks_exact(2) {
        bits.push(u16::from_le_bytes([texel[0], texel[1]]));
    }
    Ok((Dictionary { options, bits }, params))
}

/// Names of the dictionaries in a pack.
pub fn dictionaries(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dictionary::{bake, quality};
    use glint_formats::{Limits, PackBuilder};

    #[test]
    fn what_was_baked_is_read_back() {
        let options = DictionaryOptions { marginals: 3, levels: 4, entries: 32, lobe_std: 0.05, ..Default::default() };
        let dictionary = bake(&options).unwrap();
        let measured = quality::measure(&dictionary);
        for codec in [Codec::None, Codec::Zstd] {
            let mut builder = PackBuilder::new();
            for section in to_sections("lobes", &dictionary, measured, codec) {
                builder.push(section).unwrap();
            }
            let pack = Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap();
            assert_eq!(pack.verify(), []);
            assert_eq!(dictionaries(&pack), ["lobes"]);
            assert_eq!(from_pack(&pack, "lobes").unwrap(), (dictionary.clone(), dictionary.params(measured)));
            assert!(matches!(from_pack(&pack, "none"), Err(BakeError::BadInput(_))));
        }
    }
}
