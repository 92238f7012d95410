//! A dictionary as sections of a pack, and back.

use super::baked::Dictionary;
use super::options::DictionaryOptions;
use crate::error::{BakeError, Result};
use crate::pack_access::{names_with, parameters, records};
use glint_formats::dictionary::{DictionaryParams, MeasuredError, PARAMS, TABLE, UNIFORM};
use glint_formats::{Codec, Pack, Section};

/// The sections of a dictionary under `name`, all compressed when `codec` says so.
pub fn to_sections(name: &str, dictionary: &Dictionary, measured: MeasuredError, codec: Codec) -> Vec<Section> {
    let params = dictionary.params(measured);
    let mut sections = vec![
        Section::parameters(PARAMS, name, &params),
        Section::buffer(UNIFORM, name, &[params.uniform()]),
        Section::buffer(TABLE, name, &dictionary.pairs()),
    ];
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Reads the parameters of the dictionary `name`.
///
/// # Errors
/// `BadInput` where there are none, or they are damaged.
pub fn params(pack: &Pack, name: &str) -> Result<DictionaryParams> {
    parameters(pack, PARAMS, name)
}

/// Reads the dictionary `name` and its parameters. The pack must have passed verification; errors name what is missing
/// or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<(Dictionary, DictionaryParams)> {
    let params = params(pack, name)?;
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
    let words: Vec<u32> = records(pack, TABLE, name)?;
    let entries = params.table_entries();
    if words.len() as u64 != entries.next_multiple_of(4) {
        let found = words.len();
        let message =
            format!("section {TABLE} of '{name}': expected {entries} words and zeros up to four, found {found}");
        return Err(BakeError::BadInput(message));
    }
    // The lower halves are the entries.
    let bits = words[..entries as usize].iter().map(|word| *word as u16).collect();
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
    use crate::progress::Silent;
    use glint_formats::{Limits, PackBuilder};

    #[test]
    fn what_was_baked_is_read_back() {
        let options = DictionaryOptions { marginals: 3, levels: 4, entries: 32, lobe_std: 0.05, ..Default::default() };
        let dictionary = bake(&options, &Silent).unwrap();
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
