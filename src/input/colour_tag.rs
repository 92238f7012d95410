//! What a file claims of its colours: the curve that its values were encoded with. A claim, no more: most normal maps
//! that say sRGB hold linear data, so `meaning` asks the data.
//!
//! Of a PNG's chunks the first of cICP, iCCP, sRGB and gAMA counts (PNG, third edition, 4.3); of other formats the
//! embedded profile.

use super::icc;
use super::transfer::Transfer;
use std::io::Cursor;

/// What a file claims; None where it claims nothing.
#[derive(Clone, Default)]
pub(super) struct ColourTag(pub Option<Claim>);

/// A claim and where it stands.
#[derive(Clone)]
pub(super) struct Claim {
    /// The tag, such as "an sRGB chunk".
    pub tag: String,
    /// The curve it names.
    pub transfer: Transfer,
}

impl ColourTag {
    fn claim(tag: impl Into<String>, transfer: Transfer) -> ColourTag {
        ColourTag(Some(Claim { tag: tag.into(), transfer }))
    }

    /// What a colour profile says.
    pub fn of_profile(profile: &[u8]) -> ColourTag {
        let transfer = icc::transfer(profile);
        let tag = match transfer {
            Transfer::Linear => "a linear colour profile",
            Transfer::Srgb => "a colour profile with the curve of sRGB",
            Transfer::Unknown => "a colour profile whose curve cannot be read",
            Transfer::Power(_) | Transfer::Table(_) => "a colour profile with a curve of its own",
        };
        ColourTag::claim(tag, transfer)
    }

    /// What the chunks of a PNG say. A file that cannot be parsed says nothing here: decoding it will report why.
    pub fn of_png(bytes: &[u8]) -> ColourTag {
        let Ok(reader) = png::Decoder::new(Cursor::new(bytes)).read_info() else { return ColourTag::default() };
        let info = reader.info();
        if let Some(code) = info.coding_independent_code_points {
            let number = code.transfer_function;
            let name = match number {
                8 => "linear",
                13 => "sRGB",
                16 => "PQ",
                18 => "HLG",
                _ => "another curve",
            };
            return ColourTag::claim(format!("a cICP chunk that says {name} ({number})"), Transfer::of_h273(number));
        }
        if let Some(profile) = &info.icc_profile {
            return ColourTag::of_profile(profile);
        }
        if info.srgb.is_some() {
            return ColourTag::claim("an sRGB chunk", Transfer::Srgb);
        }
        // Such a chunk holds the exponent of encoding.
        match info.gama_chunk.map(|gamma| gamma.into_value()) {
            Some(exponent) if exponent > 0.0 => {
                let transfer =
                    if (exponent - 1.0).abs() < 0.01 { Transfer::Linear } else { Transfer::Power(1.0 / exponent) };
                ColourTag::claim(format!("a gAMA chunk of {exponent}"), transfer)
            }
            _ => ColourTag::default(),
        }
    }
}
