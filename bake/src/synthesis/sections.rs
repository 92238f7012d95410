//! A synthesised surface as sections of a pack, and back.

use super::baked::Synthesis;
use crate::error::{BakeError, Result};
use crate::pack_access::{names_with, parameters, records};
use glint_formats::synthesis::{OFFSETS, PARAMS, SEAMS, SynthesisParams};
use glint_formats::{Codec, Pack, Section};

/// The sections of a surface under `name`, all compressed when `codec` says so.
pub fn to_sections(name: &str, surface: &Synthesis, codec: Codec) -> Vec<Section> {
    let mut sections = vec![
        Section::parameters(PARAMS, name, &surface.params),
        Section::buffer(OFFSETS, name, &surface.offsets),
        Section::buffer(SEAMS, name, &surface.seams),
    ];
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Reads the surface `name`. The pack must have passed verification; errors name what is missing or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<Synthesis> {
    let params: SynthesisParams = parameters(pack, PARAMS, name)?;
    let offsets: Vec<[u16; 2]> = records(pack, OFFSETS, name)?;
    let seams: Vec<u32> = records(pack, SEAMS, name)?;
    let counts = [(OFFSETS, params.offset_count(), offsets.len()), (SEAMS, params.seam_words(), seams.len())];
    for (kind, expected, found) in counts {
        if expected != found as u64 {
            let message = format!("section {kind} of '{name}': expected {expected} records, found {found}");
            return Err(BakeError::BadInput(message));
        }
    }
    Ok(Synthesis::new(params, offsets, seams))
}

/// Names of the synthesised surfaces in a pack.
pub fn surfaces(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}
