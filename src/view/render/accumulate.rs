//! The pass that takes the mean of frames.

use super::full_screen;
use super::targets::{RADIANCE, Side, view};
use crate::gpu::{Gpu, GpuError};

/// The pass.
#[derive(Debug)]
pub(super) struct Accumulate {
    pipeline: wgpu::RenderPipeline,
}

impl Accumulate {
    pub fn new(gpu: &Gpu) -> Result<Accumulate, GpuError> {
        Ok(Accumulate { pipeline: full_screen::pipeline(gpu, "mean", RADIANCE)? })
    }

    /// Adds the last frame of `side`, the `count`th, to the mean; both parities of `count` have their own texture.
    pub fn add(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        side: &Side,
        count: u32,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let weight = [1.0 / count as f32, 0.0, 0.0, 0.0];
        let uniform = gpu.buffer(wgpu::BufferUsages::UNIFORM, bytemuck::cast_slice(&weight));
        let [after, before] = [count, count + 1].map(|parity| view(&side.means[(parity % 2) as usize]));
        // The first frame is taken as it is: what the other texture holds may be no number.
        let before = if count == 1 { view(&side.frame) } else { before };
        full_screen::draw(gpu, encoder, &self.pipeline, &uniform, [&view(&side.frame), &before], &after, timestamps);
    }
}
