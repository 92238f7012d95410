//! Sections of a pack as a bind group: bytes as they are, in the order of the method's `BINDINGS`. Nothing is converted.

use super::device::{Gpu, GpuError};
use super::resources::{GpuTexture, ResourceSet, Resources};
use glint_formats::binding::{Binding, View};
use glint_formats::{FourCc, Pack, Resource, Section, Wrap, vk_format};
use std::borrow::Cow;
use wgpu::{TextureFormat, TextureViewDimension};

/// Descriptor and bytes of a section.
type Content<'a> = (Resource, Cow<'a, [u8]>);

/// Binds the sections of material `name` of a pack as `bindings` say; `wrap` is how the map goes on beyond its edge.
///
/// # Errors
/// [`GpuError::BadPack`] for a section that is damaged, or larger than the device binds.
pub fn bind_pack(gpu: &Gpu, pack: &Pack, name: &str, bindings: &[Binding], wrap: Wrap) -> Result<Resources, GpuError> {
    Ok(collect_pack(gpu, pack, name, bindings, wrap)?.finish(gpu))
}

/// Binds sections of several materials of a pack one after the other in a group; those of no name as if they were missing. `wrap` is
/// how maps go on beyond their edges.
///
/// # Errors
/// [`GpuError::BadPack`] for a section that is damaged, or larger than the device binds.
pub fn bind_parts(
    gpu: &Gpu,
    pack: &Pack,
    parts: &[(Option<&str>, &[Binding])],
    wrap: Wrap,
) -> Result<Resources, GpuError> {
    let mut set = ResourceSet::default();
    for (name, bindings) in parts {
        let content = |kind: FourCc| {
            let Some(entry) = name.and_then(|name| pack.find(kind, name)) else { return Ok(None) };
            let payload = pack.payload(entry).map_err(|issue| GpuError::BadPack(issue.to_string()))?;
            Ok(Some((entry.resource, payload)))
        };
        bind(gpu, &mut set, &content, bindings, wrap)?;
    }
    Ok(set.finish(gpu))
}

/// Binds sections that are not in a pack yet; one of each kind. See [`bind_pack`].
///
/// # Errors
/// [`GpuError::BadPack`] for a section that is larger than the device binds.
pub fn bind_sections(gpu: &Gpu, sections: &[Section], bindings: &[Binding], wrap: Wrap) -> Result<Resources, GpuError> {
    Ok(collect_sections(gpu, sections, bindings, wrap)?.finish(gpu))
}

/// What [`bind_pack`] binds, for a host to add bindings of its own after.
///
/// # Errors
/// Those of [`bind_pack`].
pub fn collect_pack(
    gpu: &Gpu,
    pack: &Pack,
    name: &str,
    bindings: &[Binding],
    wrap: Wrap,
) -> Result<ResourceSet, GpuError> {
    let content = |kind: FourCc| {
        let Some(entry) = pack.find(kind, name) else { return Ok(None) };
        let payload = pack.payload(entry).map_err(|issue| GpuError::BadPack(issue.to_string()))?;
        Ok(Some((entry.resource, payload)))
    };
    let mut set = ResourceSet::default();
    bind(gpu, &mut set, &content, bindings, wrap)?;
    Ok(set)
}

/// What [`bind_sections`] binds, for a host to add bindings of its own after.
///
/// # Errors
/// Those of [`bind_sections`].
pub fn collect_sections(
    gpu: &Gpu,
    sections: &[Section],
    bindings: &[Binding],
    wrap: Wrap,
) -> Result<ResourceSet, GpuError> {
    let content = |kind: FourCc| {
        let section = sections.iter().find(|section| section.kind == kind);
        Ok(section.map(|section| (section.resource, Cow::Borrowed(&section.payload[..]))))
    };
    let mut set = ResourceSet::default();
    bind(gpu, &mut set, &content, bindings, wrap)?;
    Ok(set)
}

/// Adds the sections that `bindings` name, by `content`, to a bind group.
fn bind<'a>(
    gpu: &Gpu,
    set: &mut ResourceSet,
    content: &dyn Fn(FourCc) -> Result<Option<Content<'a>>, GpuError>,
    bindings: &[Binding],
    wrap: Wrap,
) -> Result<(), GpuError> {
    for binding in bindings {
        match *binding {
            Binding::Uniform(kind) => match content(kind)? {
                Some((_, bytes)) => set.section(kind).uniform(gpu, &bytes),
                None => set.uniform(gpu, &[]),
            },
            Binding::Storage(kind) => match content(kind)? {
                Some((_, bytes)) => set.section(kind).storage(gpu, &bytes),
                None => set.storage(gpu, &[]),
            },
            Binding::Texture(kind, view) => match content(kind)? {
                Some((resource, bytes)) => {
                    let texture = texture(gpu, kind, resource, view)?;
                    set.section(kind).texture_of(gpu, texture, sample_type(view), &bytes)
                }
                None => {
                    let (texture, zeros) = absent(view);
                    set.texture_of(gpu, texture, sample_type(view), &zeros)
                }
            },
            Binding::MapSampler => match wrap {
                Wrap::Repeat => set.sampler(gpu, wgpu::AddressMode::Repeat),
                Wrap::Clamp => set.sampler(gpu, wgpu::AddressMode::ClampToEdge),
            },
            Binding::ClampSampler => set.sampler(gpu, wgpu::AddressMode::ClampToEdge),
        };
    }
    Ok(())
}

fn sample_type(view: View) -> wgpu::TextureSampleType {
    match view {
        View::Uint2d => wgpu::TextureSampleType::Uint,
        View::Float2d | View::Float2dArray | View::FloatCube | View::FloatCubeArray => {
            wgpu::TextureSampleType::Float { filterable: true }
        }
    }
}

fn dimension(view: View) -> TextureViewDimension {
    match view {
        View::Float2d | View::Uint2d => TextureViewDimension::D2,
        View::Float2dArray => TextureViewDimension::D2Array,
        View::FloatCube => TextureViewDimension::Cube,
        View::FloatCubeArray => TextureViewDimension::CubeArray,
    }
}

/// What is bound where a pack has no such section: zeros.
fn absent(view: View) -> (GpuTexture, Vec<u8>) {
    let (format, bytes, layers) = match view {
        View::Uint2d => (TextureFormat::R32Uint, 4, 1),
        View::Float2d => (TextureFormat::Rgba8Unorm, 4, 1),
        View::Float2dArray | View::FloatCube | View::FloatCubeArray => (TextureFormat::Rgba8Unorm, 4, 6),
    };
    let texture = GpuTexture { format, size: [1; 2], layers, mips: 1, dimension: dimension(view) };
    (texture, vec![0; bytes * layers as usize])
}

/// The texture that a descriptor says.
fn texture(gpu: &Gpu, kind: FourCc, resource: Resource, view: View) -> Result<GpuTexture, GpuError> {
    let bad = |what: String| Err(GpuError::BadPack(format!("section {kind}: {what}")));
    let Resource::Texture { vk_format, width, height, layers, faces, mips } = resource else {
        return bad(format!("expected a texture, found {resource:?}"));
    };
    let Some(format) = wgpu_format(vk_format) else {
        let name = vk_format::name(vk_format).unwrap_or("unknown");
        return bad(format!("the texture format {name} is none that every GPU reads"));
    };
    let limits = gpu.device.limits();
    let most = limits.max_texture_dimension_2d;
    if width.max(height) > most || layers * faces > limits.max_texture_array_layers {
        return bad(format!("{width} x {height} texels of {} layers, and this GPU has {most} at most", layers * faces));
    }
    Ok(GpuTexture { format, size: [width, height], layers: layers * faces, mips, dimension: dimension(view) })
}

/// Formats within WebGPU's baseline.
fn wgpu_format(code: u32) -> Option<TextureFormat> {
    Some(match code {
        vk_format::R8_UNORM => TextureFormat::R8Unorm,
        vk_format::R8G8_UNORM => TextureFormat::Rg8Unorm,
        vk_format::R8G8B8A8_UNORM => TextureFormat::Rgba8Unorm,
        vk_format::R8G8B8A8_SNORM => TextureFormat::Rgba8Snorm,
        vk_format::R16G16B16A16_SFLOAT => TextureFormat::Rgba16Float,
        vk_format::R32_UINT => TextureFormat::R32Uint,
        vk_format::R32G32_UINT => TextureFormat::Rg32Uint,
        vk_format::R32G32B32A32_UINT => TextureFormat::Rgba32Uint,
        vk_format::E5B9G9R9_UFLOAT_PACK32 => TextureFormat::Rgb9e5Ufloat,
        _ => return None,
    })
}
