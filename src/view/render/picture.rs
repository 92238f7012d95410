//! Pictures without a window.

use super::renderer::{Renderer, View, texture_bytes};
use super::targets::{texture, view};
use crate::gpu::{Gpu, GpuError};

/// What a display would show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels.
    pub size: [u32; 2],
    /// sRGB and alpha (255), row by row.
    pub rgba: Vec<u8>,
}

/// Format of pictures.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The mean of `frames` (at least 1) frames of a view; frames of a view that does not converge are equal, and one is drawn.
pub fn picture(gpu: &Gpu, renderer: &mut Renderer, view_of: &View, frames: u32) -> Result<Picture, GpuError> {
    renderer.restart();
    further(gpu, renderer, view_of, frames)
}

/// The mean of the frames of a view that were drawn so far and `frames` (at least 1) more.
pub fn further(gpu: &Gpu, renderer: &mut Renderer, view_of: &View, frames: u32) -> Result<Picture, GpuError> {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
    let target = texture(gpu, view_of.size, FORMAT, usage);
    let frames = if view_of.converges() { frames.max(1) } else { 1 };
    for _ in 0..frames {
        renderer.frame(gpu, view_of, &view(&target), FORMAT)?;
        // Software adapters queue whole frames in memory.
        gpu.wait()?;
    }
    read_picture(gpu, &target)
}

/// What a texture of four bytes a texel holds; waits for the device.
pub fn read_picture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Picture, GpuError> {
    Ok(Picture { size: [texture.width(), texture.height()], rgba: texture_bytes(gpu, texture, 4)? })
}
