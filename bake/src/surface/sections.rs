//! A surface as sections of a pack, and back: those of its lobes and of its synthesis, under one name.

use super::baked::Surface;
use crate::error::{BakeError, Result};
use crate::lobes::sections as lobes;
use crate::synthesis::sections as synthesis;
use glint_formats::{Codec, Pack, Section};

/// The sections of one surface under `name`, stored as `codec` says.
pub fn to_sections(name: &str, surface: &Surface, codec: Codec) -> Vec<Section> {
    let mut sections = lobes::parts_to_sections(name, &surface.lobes, surface.synthesis.uniform, codec);
    sections.extend(synthesis::to_sections(name, &surface.synthesis, codec));
    sections
}

/// Reads the surface `name`. The pack must have passed verification, which checks that both parts fit; errors name what is
/// missing or damaged.
pub fn from_pack(pack: &Pack, name: &str) -> Result<Surface> {
    let surface = Surface { lobes: lobes::parts_from_pack(pack, name)?, synthesis: synthesis::from_pack(pack, name)? };
    if surface.lobes.params.step_texels == 0 {
        return Err(BakeError::BadInput(format!("'{name}' holds the lobes of a map, not of a surface of patches")));
    }
    Ok(surface)
}

/// Names of the surfaces in a pack.
pub fn surfaces(pack: &Pack) -> Vec<&str> {
    lobes::named(pack, |params| params.step_texels != 0)
}
