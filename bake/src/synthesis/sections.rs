//! A synthesised surface as sections of a pack, and back.

use super::baked::Synthesis;
use crate::error::{BakeError, Result};
use crate::pack_access::{names_with, parameters, records};
use glint_formats::synthesis::{OFFSETS, PARAMS, SEAMS, SynthesisParams};
use glint_formats::{Codec, Pack, Section};

/// The sections of a surface under `name`, all compressed when `codec` says so. What shaders read of the parameters is in the
/// uniform of the lobes of the same name.
pub fn to_sections(name: &str, surface: &Synthesis, codec: Codec) -> Vec<Section> {
    let params = &surface.params;
    let mut offsets = surface.offsets.clone();
    offsets.resize(params.stored_offsets() as usize, [0; 2]);
    let mut seams = surface.seams.clone();
    seams.resize(params.stored_seam_words() as usize, 0);
    let mut sections = vec![
        Section::parameters(PARAMS, name, params),
        Section::buffer(OFFSETS, name, &offsets),
        Section::buffer(SEAMS, name, &seams),
    ];
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Reads the surface `name`. The pack must have passed verification; errors name what is missing or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<Synthesis> {
    let params = params(pack, name)?;
    let mut offsets: Vec<[u16; 2]> = records(pack, OFFSETS, name)?;
    let mut seams: Vec<u32> = records(pack, SEAMS, name)?;
    let counts = [(OFFSETS, params.stored_offsets(), offsets.len()), (SEAMS, params.stored_seam_words(), seams.len())];
    for (kind, expected, found) in counts {
        if expected != found as u64 {
            let message = format!("section {kind} of '{name}': expected {expected} records, found {found}");
            return Err(BakeError::BadInput(message));
        }
    }
    offsets.truncate(params.offset_count() as usize);
    seams.truncate(params.seam_words() as usize);
    Ok(Synthesis::new(params, offsets, seams))
}

/// Reads the parameters of the surface `name`.
///
/// # Errors
/// `BadInput` for a section that is missing or damaged.
pub fn params(pack: &Pack, name: &str) -> Result<SynthesisParams> {
    parameters(pack, PARAMS, name)
}

/// Names of the synthesised surfaces in a pack.
pub fn surfaces(pack: &Pack) -> Vec<&str> {
    names_with(pack, PARAMS)
}
