//! The pass that brings radiance to the display.

use super::full_screen;
use crate::gpu::{Gpu, GpuError};
use bytemuck::{Pod, Zeroable};

/// From exposed radiance to what a display can show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneMapping {
    /// A filmic curve.
    #[default]
    Filmic,
    /// Clamped at white.
    Linear,
}

/// False colours in place of radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    /// None.
    #[default]
    None,
    /// Footprint's standard deviation, in texels of the map: 2⁻³ blue to 2⁶ red.
    Footprint,
    /// Level of detail that is read: 0 blue to 10 red.
    Lod,
    /// Look-ups of the method's data, log₂(1 + how many): 0 blue to 10 red.
    Loads,
    /// Arithmetic operations that a pixel executes ([`glint_shaders::operations`]), log₂(1 + how many): 0 blue to 16 red.
    Operations,
}

impl Overlay {
    /// The number of `OVERLAY` in view_surface.wgsl.
    pub(super) fn number(self) -> u32 {
        match self {
            Overlay::None => 0,
            Overlay::Footprint => 1,
            Overlay::Lod => 2,
            Overlay::Loads => 3,
            Overlay::Operations => 4,
        }
    }

    /// What blue and red stand for.
    pub fn range(self) -> [f32; 2] {
        match self {
            Overlay::None => [0.0, 1.0],
            Overlay::Footprint => [-3.0, 6.0],
            Overlay::Lod | Overlay::Loads => [0.0, 10.0],
            Overlay::Operations => [0.0, 16.0],
        }
    }
}

/// How radiance is displayed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Display {
    /// Factor on radiance.
    pub exposure: f32,
    /// Tone mapping.
    pub tone: ToneMapping,
    /// False colours.
    pub overlay: Overlay,
}

impl Default for Display {
    fn default() -> Display {
        Display { exposure: 1.0, tone: ToneMapping::Filmic, overlay: Overlay::None }
    }
}

/// Which of two sides a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Show {
    Left,
    Split(f32),
    Error,
}

/// `Present` of view_present.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct PresentUniform {
    exposure: f32,
    tone: u32,
    show: u32,
    split: f32,
    overlay: u32,
    overlay_low: f32,
    overlay_high: f32,
    unused: f32,
}

/// The pass, for targets of one format.
#[derive(Debug)]
pub(super) struct Present {
    pub format: wgpu::TextureFormat,
    pipeline: wgpu::RenderPipeline,
}

impl Present {
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Present, GpuError> {
        Ok(Present { format, pipeline: full_screen::pipeline(gpu, "display", format)? })
    }

    /// Shows one or both of two textures on `target`.
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        values: &PresentUniform,
        sources: [&wgpu::TextureView; 2],
        target: &wgpu::TextureView,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let uniform = gpu.buffer(wgpu::BufferUsages::UNIFORM, bytemuck::bytes_of(values));
        full_screen::draw(gpu, encoder, &self.pipeline, &uniform, sources, target, timestamps);
    }
}

impl PresentUniform {
    pub fn new(show: Show, display: &Display) -> PresentUniform {
        let (show, split) = match show {
            Show::Left => (0, 0.0),
            Show::Split(at) => (1, at),
            Show::Error => (2, 0.0),
        };
        let [overlay_low, overlay_high] = display.overlay.range();
        PresentUniform {
            exposure: display.exposure,
            tone: u32::from(display.tone == ToneMapping::Linear),
            show,
            split,
            overlay: display.overlay.number(),
            overlay_low,
            overlay_high,
            unused: 0.0,
        }
    }
}
