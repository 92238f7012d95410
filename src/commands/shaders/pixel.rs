//! What examples read and write: pixels and answers, as they lie in memory and as JSON.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use glint_bake_core::footprint::PixelOnSurface;
use serde::Serialize;

/// `ExamplePixel` of example_pixels.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable, Serialize)]
pub struct Pixel {
    position: [f32; 2],
    d_dx: [f32; 2],
    d_dy: [f32; 2],
    #[serde(skip)]
    unused_0: [u32; 2],
    view: [f32; 3],
    #[serde(skip)]
    unused_1: u32,
    light: [f32; 3],
    #[serde(skip)]
    unused_2: u32,
    random: [f32; 3],
    #[serde(skip)]
    unused_3: u32,
}

impl Pixel {
    /// A pixel of the surface, seen from the direction `view`, lit from `light`, with three uniform numbers to sample by.
    pub fn new(on: PixelOnSurface, view: Vec3, light: Vec3, random: [f32; 3]) -> Pixel {
        Pixel {
            position: on.position.into(),
            d_dx: on.d_dx.into(),
            d_dy: on.d_dy.into(),
            view: view.into(),
            light: light.into(),
            random,
            ..Pixel::zeroed()
        }
    }

    /// Where it lies.
    pub fn on_surface(&self) -> PixelOnSurface {
        PixelOnSurface { position: self.position.into(), d_dx: self.d_dx.into(), d_dy: self.d_dy.into() }
    }

    /// To the eye.
    pub fn view(&self) -> Vec3 {
        self.view.into()
    }

    /// To the light.
    pub fn light(&self) -> Vec3 {
        self.light.into()
    }

    /// Uniform numbers to sample by.
    pub fn random(&self) -> Vec3 {
        self.random.into()
    }
}

/// `ExampleAnswer` of example_pixels.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable, Serialize)]
pub struct Answer {
    /// BRDF, 1/sr; of environments the radiance without glints.
    pub brdf: [f32; 3],
    /// Density of sampling the light, 1/sr.
    pub pdf: f32,
    /// The direction that is sampled.
    pub sampled: [f32; 3],
    #[serde(skip)]
    pub unused_0: f32,
    /// Of the light that the example has besides.
    pub radiance: [f32; 3],
    #[serde(skip)]
    pub unused_1: f32,
}
