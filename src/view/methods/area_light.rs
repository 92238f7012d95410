//! An area-light material on the GPU: `bind_area_light.wgsl`.

use crate::gpu::{Gpu, GpuTexture, ResourceSet, Resources};
use bytemuck::{Pod, Zeroable};
use glam::Vec2;
use glint_bake_core::area_light::AreaLightMaterial;
use glint_formats::Wrap;
use glint_formats::area_light::{NormalStorage, TABLE_SIZE};
use glint_formats::container::full_mip_count;

/// `AreaLightData`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct AreaLightUniform {
    texel_scale: Vec2,
    padding: [u32; 2],
    size: Vec2,
    mips: u32,
    wrap: u32,
    anisotropic: u32,
    unused: [u32; 3],
}

/// Uploads a material. Mips that are larger than the device's textures may be are left out, with a note.
pub fn upload(gpu: &Gpu, material: &AreaLightMaterial) -> Resources {
    upload_within(gpu, material, gpu.device.limits().max_texture_dimension_2d)
}

/// Uploads a material in textures of at most `most` texels along an edge.
pub fn upload_within(gpu: &Gpu, material: &AreaLightMaterial, most: u32) -> Resources {
    let params = &material.params;
    let (mut width, mut height) = (params.width, params.height);
    let mut first = 0;
    while width.max(height) > most {
        first += width as usize * height as usize * params.storage.texel_bytes();
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
    }
    let mips = full_mip_count(width, height);
    let (wrap, address) = match params.wrap {
        Wrap::Repeat => (0, wgpu::AddressMode::Repeat),
        Wrap::Clamp => (1, wgpu::AddressMode::ClampToEdge),
    };
    let uniform = AreaLightUniform {
        texel_scale: Vec2::new(width as f32 / params.width as f32, height as f32 / params.height as f32),
        padding: [0; 2],
        size: Vec2::new(width as f32, height as f32),
        mips,
        wrap,
        anisotropic: u32::from(params.anisotropic),
        unused: [0; 3],
    };
    let format = match params.storage {
        NormalStorage::F16 => wgpu::TextureFormat::Rgba16Float,
        NormalStorage::Snorm8 => wgpu::TextureFormat::Rgba8Snorm,
    };
    let shape =
        |format, size, mips| GpuTexture { format, size, layers: 1, mips, dimension: wgpu::TextureViewDimension::D2 };
    let map = shape(format, [width, height], mips);
    let table = shape(wgpu::TextureFormat::Rgba16Float, [TABLE_SIZE; 2], 1);
    let mut set = ResourceSet::default();
    if first > 0 {
        set.note(format!(
            "the map of {} x {} texels is larger than the adapter's textures of {most}; its finest mips are left out",
            params.width, params.height
        ));
    }
    set.uniform(gpu, bytemuck::bytes_of(&uniform));
    set.texture(gpu, map, true, &material.normals[first..]);
    if params.anisotropic {
        set.texture(gpu, map, true, &material.roughness[first..]);
    } else {
        set.texture(gpu, shape(format, [1, 1], 1), true, &vec![0; params.storage.texel_bytes()]);
    }
    for texels in [&material.tables.inverse, &material.tables.terms] {
        set.texture(gpu, table, true, bytemuck::cast_slice(texels.as_flattened()));
    }
    set.sampler(gpu, address);
    set.sampler(gpu, wgpu::AddressMode::ClampToEdge);
    set.finish(gpu)
}
