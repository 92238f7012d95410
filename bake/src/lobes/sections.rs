//! A map's lobes as sections of a pack, and back.

use super::baked::BakedLobes;
use crate::error::{BakeError, Result};
use crate::pack_access::{bytes, names_with, parameters, records};
use glint_formats::lobes::{LOBES, LobesParams, NORMALS, PARAMS, UNIFORM};
use glint_formats::synthesis::SynthesisUniform;
use glint_formats::{Codec, Pack, Resource, Section};

/// The sections of one map under `name`, stored as `codec` says.
pub fn to_sections(name: &str, baked: &BakedLobes, codec: Codec) -> Vec<Section> {
    parts_to_sections(name, baked, SynthesisUniform::default(), codec)
}

/// The sections of lobes of either kind; `synthesis` is that of a surface, or zeros.
pub(crate) fn parts_to_sections(
    name: &str,
    baked: &BakedLobes,
    synthesis: SynthesisUniform,
    codec: Codec,
) -> Vec<Section> {
    let params = &baked.params;
    let stride = params.storage.stride();
    let mut sections = vec![
        Section::parameters(PARAMS, name, params),
        Section::buffer(UNIFORM, name, &[params.uniform(synthesis)]),
        Section {
            resource: Resource::Buffer { stride, count: baked.lobes.len() as u64 / u64::from(stride) },
            ..Section::buffer(LOBES, name, &baked.lobes)
        },
        Section::buffer(NORMALS, name, &baked.normals),
    ];
    for section in &mut sections {
        section.codec = codec;
    }
    sections
}

/// Reads the lobes of the map `name`. The pack must have passed verification; errors name what is missing or damaged, or
/// that the lobes are those of a surface of patches, whose cells overlap: [`crate::surface::sections`] reads them.
pub fn from_pack(pack: &Pack, name: &str) -> Result<BakedLobes> {
    let lobes = parts_from_pack(pack, name)?;
    if lobes.params.step_texels != 0 {
        return Err(BakeError::BadInput(format!("'{name}' holds the lobes of a surface of patches, not of a map")));
    }
    Ok(lobes)
}

/// Reads the parameters of lobes of either kind.
///
/// # Errors
/// `BadInput` for a section that is missing or damaged.
pub fn params(pack: &Pack, name: &str) -> Result<LobesParams> {
    parameters(pack, PARAMS, name)
}

/// Reads lobes of either kind.
pub(crate) fn parts_from_pack(pack: &Pack, name: &str) -> Result<BakedLobes> {
    Ok(BakedLobes {
        params: params(pack, name)?,
        lobes: bytes(pack, LOBES, name)?,
        normals: records(pack, NORMALS, name)?,
    })
}

/// Names of the maps of this method in a pack; surfaces of patches are not among them.
pub fn maps(pack: &Pack) -> Vec<&str> {
    named(pack, |params| params.step_texels == 0)
}

/// Names whose parameters of lobes are as wanted.
pub(crate) fn named(pack: &Pack, wanted: impl Fn(&LobesParams) -> bool) -> Vec<&str> {
    let read = |name: &&str| params(pack, name).is_ok_and(|params| wanted(&params));
    names_with(pack, PARAMS).into_iter().filter(read).collect()
}
