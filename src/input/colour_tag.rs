//! Does a file claim to be sRGB? Normals are linear; the claim is refused unless the user overrides it.
//!
//! Tags looked at: PNG's sRGB and cICP chunks, and the embedded colour profile of any format. PNG's gAMA chunk alone is
//! written by habit and merely noted; other profiles likewise.

use std::io::Cursor;
use std::path::Path;

use super::error::InputError;
use super::options::InputOptions;

/// cICP's code for the sRGB transfer function.
const CICP_TRANSFER_SRGB: u8 = 13;

/// gAMA of a linear file; chunks hold the exponent times 100 000.
const GAMA_LINEAR: u32 = 100_000;

/// What a file says of its colours.
#[derive(Clone, Default)]
pub(super) struct ColourTag {
    /// The tag that says sRGB.
    srgb: Option<&'static str>,
    /// What else it says.
    note: Option<String>,
}

impl ColourTag {
    /// What a colour profile says; profiles name themselves in ASCII or, in version 4, in UTF-16.
    pub fn of_profile(profile: &[u8]) -> ColourTag {
        let contains = |needle: &[u8]| profile.windows(needle.len()).any(|window| window == needle);
        if contains(b"sRGB") || contains(b"\0s\0R\0G\0B") {
            return ColourTag { srgb: Some("an sRGB colour profile"), note: None };
        }
        ColourTag { srgb: None, note: Some("carries a colour profile; ignored, the values are taken as linear".into()) }
    }

    /// What the chunks of a PNG say, apart from a profile. A file that cannot be parsed says nothing here: decoding it
    /// will report why.
    pub fn of_png_chunks(bytes: &[u8]) -> ColourTag {
        let Ok(reader) = png::Decoder::new(Cursor::new(bytes)).read_info() else { return ColourTag::default() };
        let info = reader.info();
        if info.srgb.is_some() {
            return ColourTag { srgb: Some("an sRGB chunk"), note: None };
        }
        if info.coding_independent_code_points.is_some_and(|c| c.transfer_function == CICP_TRANSFER_SRGB) {
            return ColourTag { srgb: Some("a cICP chunk that says sRGB"), note: None };
        }
        let gama = info.gama_chunk.map(|g| g.into_scaled()).filter(|&g| g != GAMA_LINEAR);
        let note = gama.map(|g| format!("carries a gAMA chunk of {g}; ignored, the values are taken as linear"));
        ColourTag { srgb: None, note }
    }

    /// Refuses sRGB unless `assume_linear`; adds what is to be noted.
    pub fn check(self, path: &Path, options: &InputOptions, notes: &mut Vec<String>) -> Result<(), InputError> {
        notes.extend(self.note);
        match self.srgb {
            Some(tag) if !options.assume_linear => Err(InputError::bad(
                path,
                format!(
                    "the file carries {tag}, so its values claim to be gamma-encoded colours; expected linear data. If \
                     it holds plain normals or heights (most tagged ones do), give --assume-linear; else export it \
                     as non-colour data"
                ),
            )),
            Some(tag) => {
                notes.push(format!("carries {tag}; the values are taken as linear, as asked"));
                Ok(())
            }
            None => Ok(()),
        }
    }
}
