//! From radiance to sRGB: a little glare around what is brighter than white, a filmic curve, the sRGB transfer function.

use crate::canvas::Canvas;
use crate::srgb;
use glam::Vec3;
use rayon::prelude::*;

/// Share of the light above white that spreads, and how far, in pixels of a picture 640 high.
const GLARE: [(f32, f32); 2] = [(0.06, 1.2), (0.006, 6.0)];
/// Exposed radiance above which light spreads, and the most of it that counts: a glint is small, not a lamp.
const GLARE_FROM: f32 = 1.5;
const GLARE_MOST: f32 = 12.0;

/// Develops a picture.
pub fn develop(radiance: &[Vec3], width: u32, height: u32, exposure: f32) -> Canvas {
    let mut exposed: Vec<Vec3> = radiance.iter().map(|&v| v * exposure).collect();
    let bright: Vec<Vec3> =
        exposed.iter().map(|&v| (v - GLARE_FROM).clamp(Vec3::ZERO, Vec3::splat(GLARE_MOST))).collect();
    for (share, sigma) in GLARE {
        let spread = blur(&bright, width as usize, height as usize, sigma * height as f32 / 640.0);
        for (pixel, glare) in exposed.iter_mut().zip(spread) {
            *pixel += glare * (share * sigma * sigma);
        }
    }
    let pixels = exposed.iter().flat_map(|&v| film(v).to_array().map(encode)).collect();
    Canvas { width, height, pixels }
}

/// One pixel, without glare.
pub fn pixel(radiance: Vec3, exposure: f32) -> [u8; 3] {
    film(radiance * exposure).to_array().map(encode)
}

/// Gaussian blur, rows then columns, edges repeated.
fn blur(pixels: &[Vec3], width: usize, height: usize, sigma: f32) -> Vec<Vec3> {
    let reach = (3.0 * sigma).ceil() as isize;
    let weight = |k: isize| libm::expf(-0.5 * (k as f32 / sigma).powi(2));
    let total: f32 = (-reach..=reach).map(weight).sum();
    let weights: Vec<f32> = (-reach..=reach).map(|k| weight(k) / total).collect();
    let pass = |source: &[Vec3], step: usize, along: fn(usize, usize) -> usize, length: usize| {
        let mut out = vec![Vec3::ZERO; source.len()];
        out.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                let at = along(x, y) as isize;
                let here = y * width + x;
                for (k, &weight) in weights.iter().enumerate() {
                    let other = (at + k as isize - reach).clamp(0, length as isize - 1) - at;
                    *pixel += source[(here as isize + other * step as isize) as usize] * weight;
                }
            }
        });
        out
    };
    let rows = pass(pixels, 1, |x, _| x, width);
    pass(&rows, width, |_, y| y, height)
}

/// A filmic curve: Narkowicz's fit of ACES, channel by channel.
fn film(v: Vec3) -> Vec3 {
    let v = v.max(Vec3::ZERO).min(Vec3::splat(1e4)) * 0.8;
    (v * (v * 2.51 + 0.03) / (v * (v * 2.43 + 0.59) + 0.14)).clamp(Vec3::ZERO, Vec3::ONE)
}

/// Linear 0…1 as an sRGB byte.
fn encode(linear: f32) -> u8 {
    (255.0 * srgb::encode(linear) + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transfer_function_meets_its_ends() {
        assert_eq!((encode(0.0), encode(1.0), encode(0.214)), (0, 255, 127));
    }

    #[test]
    fn nothing_that_is_not_a_number_reaches_a_pixel() {
        let canvas = develop(&[Vec3::splat(f32::INFINITY), Vec3::splat(1e30), Vec3::ZERO, Vec3::ONE], 2, 2, 1.0);
        assert_eq!(canvas.pixels.len(), 12);
    }
}
