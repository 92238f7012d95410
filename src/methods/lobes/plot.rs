//! Pictures of lobes: the NDF of a whole map or surface, and which patch shows each texel of a surface.

use crate::canvas::{Canvas, colour_wheel, heat};
use glam::Vec2;
use glint_bake_core::synthesis::Synthesis;

/// Edge of the pictures in pixels.
const EDGE: u32 = 512;
/// Roughness below which a lobe could fall between two pixels.
pub const LEAST_ROUGHNESS: f32 = 2.5 / EDGE as f32;

/// A density over the disk of projected normals, +Y up: the square root of its share of the greatest one.
pub fn density(p_ndf: impl Fn(Vec2) -> f32) -> Canvas {
    let at = |x: u32, y: u32| Vec2::new(x as f32 + 0.5, EDGE as f32 - 0.5 - y as f32) * (2.0 / EDGE as f32) - 1.0;
    let values: Vec<f32> = (0..EDGE * EDGE).map(|k| p_ndf(at(k % EDGE, k / EDGE))).collect();
    let most = values.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let mut canvas = Canvas::new(EDGE, EDGE, [0; 3]);
    for (k, value) in (0..).zip(values) {
        let (x, y) = (k % EDGE, k / EDGE);
        if at(x, y).length_squared() <= 1.0 {
            canvas.set(x, y, heat((value / most).sqrt()));
        }
    }
    canvas
}

/// The first texels of a surface, a colour a patch: borders between colours are its seams.
pub fn patches(synthesis: &Synthesis) -> Canvas {
    // Steps of the golden ratio keep the hues of neighbours apart.
    const STEP: f32 = 0.618_034;
    let mut canvas = Canvas::new(EDGE, EDGE, [0; 3]);
    for (x, y) in (0..EDGE).flat_map(|y| (0..EDGE).map(move |x| (x, y))) {
        let patch = synthesis.source(x as i32, y as i32).patch;
        canvas.set(x, y, colour_wheel((patch as f32 * STEP).fract()));
    }
    canvas
}
