//! The source of an environment: an equirectangular image of linear radiance, each pixel constant over its part of the
//! sphere.
//!
//! Directions are right-handed, +Y up. Seen from inside, the middle of the image is −Z and what lies right of it is +X:
//! longitude λ = 2π (u − ½), latitude π (½ − v), direction (cos lat · sin λ, sin lat, −cos lat · cos λ).

use crate::error::{BakeError, Result};
use glam::DVec3;
use std::f64::consts::PI;

/// Brightest channel that is taken; its square still fits a float with room for sums.
const MAX_RADIANCE: f32 = 1e12;
/// By how many columns an image may miss twice its rows; odd sizes need one or two.
const ASPECT_SLACK: u32 = 2;
/// Luminance of linear RGB with the primaries of Rec. 709.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Luminance of a linear colour.
#[inline]
pub fn luminance(rgb: [f64; 3]) -> f64 {
    LUMINANCE[0] * rgb[0] + LUMINANCE[1] * rgb[1] + LUMINANCE[2] * rgb[2]
}

/// What was mended in an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageReport {
    /// Pixels with a negative channel, which was taken as 0.
    pub negative_pixels: u64,
    /// The first of them, column and row.
    pub first_negative: Option<(u32, u32)>,
}

/// A validated environment: finite radiance that is not negative, row-major from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentImage {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB radiance.
    pub pixels: Vec<[f32; 3]>,
    /// What was mended.
    pub report: ImageReport,
}

impl EnvironmentImage {
    /// Checks radiance. Negative channels become 0 and are counted.
    ///
    /// # Errors
    /// [`BakeError::BadInput`] names the first pixel that is NaN, infinite or above 1e12, or says why the
    /// size is none of a whole sphere.
    pub fn new(width: u32, height: u32, mut pixels: Vec<[f32; 3]>) -> Result<EnvironmentImage> {
        check_size(width, height)?;
        if pixels.len() as u64 != u64::from(width) * u64::from(height) {
            let found = pixels.len();
            return Err(BakeError::BadInput(format!("expected {width} × {height} pixels, found {found}")));
        }
        let mut report = ImageReport::default();
        for (i, pixel) in pixels.iter_mut().enumerate() {
            let place = (i as u32 % width, i as u32 / width);
            for (c, value) in pixel.iter_mut().enumerate() {
                if !value.is_finite() || *value > MAX_RADIANCE {
                    let (x, y) = place;
                    let channel = ["red", "green", "blue"][c];
                    return Err(BakeError::BadInput(format!(
                        "pixel ({x}, {y}) has {channel} {value}; expected finite radiance up to {MAX_RADIANCE:e}: paint \
                         it over or export the image again"
                    )));
                }
            }
            if pixel.iter().any(|value| *value < 0.0) {
                report.negative_pixels += 1;
                report.first_negative = report.first_negative.or(Some(place));
                // Not max: it would keep the sign of −0.
                *pixel = pixel.map(|value| if value > 0.0 { value } else { 0.0 });
            }
        }
        Ok(EnvironmentImage { width, height, pixels, report })
    }

    /// Luminance of a pixel.
    #[inline]
    pub fn luminance(&self, pixel: usize) -> f64 {
        let [r, g, b] = self.pixels[pixel];
        luminance([f64::from(r), f64::from(g), f64::from(b)])
    }

    /// Brightest luminance of a pixel.
    pub fn max_luminance(&self) -> f64 {
        (0..self.pixels.len()).map(|i| self.luminance(i)).fold(0.0, f64::max)
    }

    /// Solid angle of a pixel of row y, in steradians. A row's pixels are equal.
    pub(super) fn solid_angle_sr(&self, y: u32) -> f64 {
        let [top, bottom] = [y, y + 1].map(|row| self.sine(f64::from(row)));
        (top - bottom) * 2.0 * PI / f64::from(self.width)
    }

    /// Sine of the latitude at a row, which may lie between two.
    pub(super) fn sine(&self, row: f64) -> f64 {
        libm::sin(PI * (0.5 - row / f64::from(self.height)))
    }

    /// Mean radiance over the sphere.
    pub fn mean(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (y, row) in self.pixels.chunks_exact(self.width as usize).enumerate() {
            let share = self.solid_angle_sr(y as u32) / (4.0 * PI);
            for c in 0..3 {
                sum[c] += share * row.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>();
            }
        }
        sum
    }

    /// The same radiance in pixels of 1/factor the size.
    pub(super) fn divided(&self, factor: u32) -> EnvironmentImage {
        let (width, height) = (self.width * factor, self.height * factor);
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            let row = &self.pixels[(y / factor * self.width) as usize..][..self.width as usize];
            pixels.extend((0..width).map(|x| row[(x / factor) as usize]));
        }
        EnvironmentImage { width, height, pixels, report: self.report }
    }
}

/// Longitude of a column, which may lie between two.
pub(super) fn longitude(column: f64, width: u32) -> f64 {
    2.0 * PI * (column / f64::from(width) - 0.5)
}

/// Direction at longitude `lambda` and sine of latitude `sine`.
pub fn direction(lambda: f64, sine: f64) -> DVec3 {
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    DVec3::new(cosine * libm::sin(lambda), sine, -cosine * libm::cos(lambda))
}

fn check_size(width: u32, height: u32) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(BakeError::BadInput(format!("the image is {width} × {height}; expected at least 1 × 1 pixels")));
    }
    if width.abs_diff(2 * height) > ASPECT_SLACK {
        return Err(BakeError::BadInput(format!(
            "the image is {width} × {height}; expected an equirectangular image of the whole sphere, which has twice as \
             many columns as rows: convert cube maps and crosses first, pad or crop panoramas to 360° × 180°, resize \
             others to {} × {height}",
            2 * height
        )));
    }
    Ok(())
}
