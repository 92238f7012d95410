//! A picture in memory and its PNG, and the colours that values and directions have in pictures.

use image::{ExtendedColorType, ImageEncoder, codecs::png};

/// An sRGB picture, rows from the top.
pub struct Canvas {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Three bytes a pixel.
    pub pixels: Vec<u8>,
}

impl Canvas {
    /// A picture of one colour.
    pub fn new(width: u32, height: u32, colour: [u8; 3]) -> Canvas {
        Canvas { width, height, pixels: colour.repeat(width as usize * height as usize) }
    }

    /// Colours one pixel; those outside are left out.
    pub fn set(&mut self, x: u32, y: u32, colour: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = 3 * (y as usize * self.width as usize + x as usize);
            self.pixels[at..at + 3].copy_from_slice(&colour);
        }
    }

    /// Colours a rectangle.
    pub fn fill(&mut self, (x, y): (u32, u32), (width, height): (u32, u32), colour: [u8; 3]) {
        for j in y..y + height {
            for i in x..x + width {
                self.set(i, j, colour);
            }
        }
    }

    /// The picture as a PNG, the same bytes every time.
    pub fn to_png(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let encoder =
            png::PngEncoder::new_with_quality(&mut out, png::CompressionType::Default, png::FilterType::Adaptive);
        encoder
            .write_image(&self.pixels, self.width, self.height, ExtendedColorType::Rgb8)
            .expect("a vector takes every byte of a picture of the right size");
        out
    }
}

/// Black over red and yellow to white.
pub fn heat(value: f32) -> [u8; 3] {
    [3.0, 1.6, 0.6].map(|gain| {
        let start = if gain > 2.0 {
            0.0
        } else if gain > 1.0 {
            0.28
        } else {
            0.6
        };
        let channel = ((value - start).max(0.0) / (1.0 - start)).powf(1.0 / gain);
        (255.0 * channel.min(1.0)) as u8
    })
}

/// A hue of the wheel, 0 to 1, at middling brightness.
pub fn colour_wheel(hue: f32) -> [u8; 3] {
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|shift| {
        let wave = (std::f32::consts::TAU * (hue + shift)).cos();
        (120.0 + 85.0 * wave) as u8
    })
}
