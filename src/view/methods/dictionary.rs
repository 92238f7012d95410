//! A slope dictionary on the GPU: `bind_dictionary.wgsl`. The sections, then the colours of the material's glints.

use crate::gpu::{Gpu, GpuError, ResourceSet, Resources, collect_pack, collect_sections};
use glam::Vec3;
use glint_formats::dictionary::BINDINGS;
use glint_formats::{Pack, Section, Wrap};

/// Binds the dictionary `name` of a pack, with the colours of its glints (linear RGB; none means white).
///
/// # Errors
/// [`GpuError::BadPack`] for a section that is damaged.
pub fn upload(gpu: &Gpu, pack: &Pack, name: &str, colours: &[Vec3]) -> Result<Resources, GpuError> {
    // No section is a map, so nothing wraps.
    Ok(with_colours(gpu, collect_pack(gpu, pack, name, BINDINGS, Wrap::Clamp)?, colours))
}

/// Binds the sections of a dictionary that is not in a pack yet, see [`upload`].
///
/// # Errors
/// [`GpuError::BadPack`] for a section that is larger than the device binds.
pub fn upload_sections(gpu: &Gpu, sections: &[Section], colours: &[Vec3]) -> Result<Resources, GpuError> {
    Ok(with_colours(gpu, collect_sections(gpu, sections, BINDINGS, Wrap::Clamp)?, colours))
}

fn with_colours(gpu: &Gpu, mut set: ResourceSet, colours: &[Vec3]) -> Resources {
    let colours: Vec<[f32; 4]> = colours.iter().map(|colour| colour.extend(1.0).to_array()).collect();
    set.storage(gpu, bytemuck::cast_slice(&colours));
    set.finish(gpu)
}
