//! The pixels of an image with all the channels that are filtered, worked out where they are asked for: an image with all of them
//! takes several times the memory of its radiance: 32 bytes a pixel at four levels, 256 at sixteen with colours, for 12.

use super::image::{EnvironmentImage, luminance};
use super::levels::shares;

/// Channels that are always there: red, green, blue and squared luminance.
pub const BASE_CHANNELS: usize = 4;

/// An image, whose pixels may be divided, and the levels that its radiance is shared between.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    image: &'a EnvironmentImage,
    /// In how many parts a side pixels are divided.
    parts: u32,
    levels: &'a [f64],
    coloured: bool,
    /// Columns of parts.
    pub width: u32,
    /// Rows of parts.
    pub height: u32,
    /// Numbers a pixel, a multiple of 4: [`BASE_CHANNELS`], indicators of levels from 1 on, where levels have colours R, G
    /// and B of each level's light, and zeros.
    pub channels: usize,
}

impl<'a> Source<'a> {
    /// The image with its pixels whole.
    pub fn new(image: &'a EnvironmentImage, levels: &'a [f64], coloured: bool) -> Source<'a> {
        let extra = (levels.len() - 1) * if coloured { 4 } else { 1 };
        let channels = (BASE_CHANNELS + extra).next_multiple_of(4);
        Source { image, parts: 1, levels, coloured, width: image.width, height: image.height, channels }
    }

    /// The same radiance in pixels of 1/parts the size.
    pub fn divided(self, parts: u32) -> Source<'a> {
        Source { parts, width: self.image.width * parts, height: self.image.height * parts, ..self }
    }

    /// Whether indicators are among the channels, which are worth finer blocks.
    pub fn has_levels(&self) -> bool {
        self.levels.len() > 1
    }

    /// All channels of a pixel.
    pub fn values(&self, x: u32, y: u32, out: &mut [f32]) {
        let rgb @ [r, g, b] = self.rgb(x, y);
        let l = luminance([f64::from(r), f64::from(g), f64::from(b)]);
        out[..3].copy_from_slice(&rgb);
        out[3] = l.powi(2) as f32;
        self.extra(rgb, l, &mut out[BASE_CHANNELS..]);
    }

    /// All channels of a pixel times its solid angle; its colour and luminance.
    pub fn sums(&self, x: u32, y: u32, solid_angle: f64, out: &mut [f32]) -> ([f64; 3], f64) {
        let stored @ [r, g, b] = self.rgb(x, y);
        let rgb = [f64::from(r), f64::from(g), f64::from(b)];
        let l = luminance(rgb);
        for (sum, value) in out.iter_mut().zip([rgb[0], rgb[1], rgb[2], l * l]) {
            *sum = (value * solid_angle) as f32;
        }
        let out = &mut out[BASE_CHANNELS..];
        self.extra(stored, l, out);
        for sum in out {
            *sum = (f64::from(*sum) * solid_angle) as f32;
        }
        (rgb, l)
    }

    fn rgb(&self, x: u32, y: u32) -> [f32; 3] {
        // Divisions are slow, and most images are not divided.
        let (x, y) = if self.parts == 1 { (x, y) } else { (x / self.parts, y / self.parts) };
        self.image.pixels[(y * self.image.width + x) as usize]
    }

    /// Channels after the base, of a pixel's colour and luminance.
    fn extra(&self, rgb: [f32; 3], l: f64, out: &mut [f32]) {
        out.fill(0.0);
        let more = self.levels.len() - 1;
        if more == 0 {
            return;
        }
        shares(self.levels, l, &mut out[..more]);
        if self.coloured && l > 0.0 {
            for k in 0..more {
                for c in 0..3 {
                    out[more + 3 * k + c] = (f64::from(out[k]) * (f64::from(rgb[c]) / l)) as f32;
                }
            }
        }
    }
}
