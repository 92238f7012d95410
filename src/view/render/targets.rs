//! Textures that passes draw to.

use crate::gpu::Gpu;

/// Format of radiance: glints are far brighter than half floats can hold, and means of them need the digits.
pub(super) const RADIANCE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Format of depth.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// One picture: the last frame, and the mean of all in either of two.
#[derive(Debug)]
pub(super) struct Side {
    pub frame: wgpu::Texture,
    pub means: [wgpu::Texture; 2],
}

/// All targets of one size.
#[derive(Debug)]
pub(super) struct Targets {
    pub size: [u32; 2],
    pub depth: wgpu::TextureView,
    pub sides: [Side; 2],
}

/// A texture of `size` pixels, one mip.
pub(super) fn texture(
    gpu: &Gpu,
    size: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// A view of all of a texture.
pub(super) fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

impl Targets {
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Targets {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC;
        let radiance = || texture(gpu, size, RADIANCE, usage);
        let side = || Side { frame: radiance(), means: [radiance(), radiance()] };
        let depth = texture(gpu, size, DEPTH, wgpu::TextureUsages::RENDER_ATTACHMENT);
        Targets { size, depth: view(&depth), sides: [side(), side()] }
    }
}
