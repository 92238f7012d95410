//! CPU preview: a few objects under one directional light, shaded with the NDF maps of a pack.
//!
//! Every pixel is computed on its own, so the picture is the same for any number of threads. Textures are filtered by
//! the pixel's footprint; only outlines and shadow edges take several samples.

mod scene;
mod shape;
mod sky;
mod surface;
pub mod tone;

pub use scene::{Camera, Object, Scene};
pub use shape::Shape;
pub use surface::{Layer, Surface};

use crate::canvas::Canvas;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Samples along each side of a pixel that an edge crosses.
const EDGE_SAMPLES: u32 = 4;

/// Renders a scene.
pub fn render(scene: &Scene, width: u32, height: u32) -> Canvas {
    let size = Vec2::new(width as f32, height as f32);
    let mut radiance = vec![Vec3::ZERO; width as usize * height as usize];
    radiance.par_chunks_mut(width as usize).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = render_pixel(scene, Vec2::new(x as f32, y as f32), size);
        }
    });
    tone::develop(&radiance, width, height, scene.exposure)
}

fn render_pixel(scene: &Scene, corner: Vec2, size: Vec2) -> Vec3 {
    let seen = |dx: f32, dy: f32| scene.identify(corner + Vec2::new(dx, dy), size);
    let centre = seen(0.5, 0.5);
    let on_edge = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].iter().any(|&(dx, dy)| seen(dx, dy) != centre);
    if !on_edge {
        return scene.radiance(corner + 0.5, size);
    }
    let mut sum = Vec3::ZERO;
    for j in 0..EDGE_SAMPLES {
        for i in 0..EDGE_SAMPLES {
            let inside = (Vec2::new(i as f32, j as f32) + 0.5) / EDGE_SAMPLES as f32;
            // One very bright sample must not stand for a sixteenth of an edge pixel: it would look like a hole in it.
            sum += scene.radiance(corner + inside, size).min(Vec3::splat(EDGE_BRIGHTNESS / scene.exposure));
        }
    }
    sum / (EDGE_SAMPLES * EDGE_SAMPLES) as f32
}

/// Brightest sample of an edge pixel, in exposed units; white begins near 4.
const EDGE_BRIGHTNESS: f32 = 8.0;
