//! Compares what a shader reads with sums over the source: look-ups in random directions at random roughnesses, so that what lies
//! between stored texels and stored roughnesses is in it.
//!
//! Roughness α is spread evenly in its logarithm from [`LEAST_ALPHA`] to 1. Every other look-up is in a direction of its own; the
//! rest look towards the brightest pixel of the source, as far beside it as the lobe of α says by chance. Errors are those of luminance. Next to a sun the root mean square error over the mean is that of the few look-ups that hit its core,
//! where a texel is 10⁵ times the mean; the root mean square of relative errors counts every look-up alike. Both are kept.

use super::baked::Environment;
use super::eval::{environment_filtered, environment_radiance, environment_roughness};
use super::image::{EnvironmentImage, direction, longitude, luminance};
use super::reference::{filtered, with_small_pixels};
use crate::rng::{ItemRng, Purpose};
use glam::DVec3;
use glint_formats::environment::{MeasuredReads, SHARP};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Least roughness that is read.
pub const LEAST_ALPHA: f64 = 0.01;

/// A look-up and what it should give.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    /// Direction, of unit length.
    pub direction: DVec3,
    /// GGX roughness α, a number of f32.
    pub alpha: f64,
    /// Luminance as the reference has it.
    pub exact: f64,
}

impl Read {
    /// Luminance that a shader reads.
    pub fn found(&self, environment: &Environment) -> f64 {
        let direction = self.direction.as_vec3();
        let roughness = environment_roughness(environment, self.alpha as f32);
        let filtered = environment_filtered(environment, direction, &roughness);
        let [r, g, b, _] = filtered;
        luminance(environment_radiance(environment, direction, &roughness, [r, g, b]).map(f64::from))
    }
}

/// `count` look-ups of roughness α from `low` to `high`, for the kernel of `environment`.
pub fn random(
    image: &EnvironmentImage,
    environment: &Environment,
    (low, high): (f64, f64),
    seed: u64,
    count: u32,
) -> Vec<Read> {
    let light = brightest(image);
    let fine = with_small_pixels(image);
    let read = |k: u32| {
        let mut rng = ItemRng::new(seed, Purpose::EnvironmentReads, k);
        let alpha = f64::from((low * libm::pow(high / low, rng.unit())) as f32);
        let direction = if k.is_multiple_of(2) {
            direction(2.0 * PI * rng.unit(), 2.0 * rng.unit() - 1.0)
        } else {
            near(light, alpha, &mut rng)
        };
        Read { direction, alpha, exact: filtered(&fine, environment.params.kernel, direction, alpha).luminance }
    };
    (0..count).into_par_iter().map(read).collect()
}

/// Direction of the middle of the brightest pixel.
fn brightest(image: &EnvironmentImage) -> DVec3 {
    let pixel = (0..image.pixels.len() as u32)
        .max_by(|&a, &b| image.luminance(a as usize).total_cmp(&image.luminance(b as usize)))
        .unwrap_or(0);
    let (x, y) = (pixel % image.width, pixel / image.width);
    let sine = 0.5 * (image.sine(f64::from(y)) + image.sine(f64::from(y + 1)));
    direction(longitude(f64::from(x) + 0.5, image.width), sine)
}

/// A direction beside `light`, as likely as GGX times cosine weighs the light for it: with t = 1 − cosine, GGX's part of the distribution
/// function is (a + b) t / (a + b t), and the cosine is a chance.
fn near(light: DVec3, alpha: f64, rng: &mut ItemRng) -> DVec3 {
    let a = alpha * alpha;
    let b = 0.5 * (1.0 - a);
    let cosine = loop {
        let u = rng.unit();
        let cosine = 1.0 - u * a / (a + b - u * b);
        if rng.unit() < cosine {
            break cosine;
        }
    };
    let (x, turn) = (light.any_orthonormal_vector(), 2.0 * PI * rng.unit());
    let across = x * libm::cos(turn) + light.cross(x) * libm::sin(turn);
    (light * cosine + across * (1.0 - cosine * cosine).max(0.0).sqrt()).normalize()
}

/// Error of look-ups below [`SHARP`], and of the others.
pub fn errors_of(environment: &Environment, reads: &[Read]) -> [MeasuredReads; 2] {
    let of = |sharp: bool| {
        let pairs = reads.iter().filter(|read| (read.alpha < SHARP) == sharp);
        let pairs: Vec<(f64, f64)> = pairs.map(|read| (read.found(environment), read.exact)).collect();
        error_of(&pairs)
    };
    [of(true), of(false)]
}

/// Error of pairs of what is read and what is exact.
pub fn error_of(pairs: &[(f64, f64)]) -> MeasuredReads {
    let mean = pairs.iter().map(|pair| pair.1).sum::<f64>() / pairs.len().max(1) as f64;
    if mean <= 0.0 {
        return MeasuredReads { count: pairs.len() as u32, ..MeasuredReads::default() };
    }
    let root =
        |square: &dyn Fn(&(f64, f64)) -> f64| (pairs.iter().map(square).sum::<f64>() / pairs.len() as f64).sqrt();
    let share = |&(found, exact): &(f64, f64)| (found - exact).abs() / exact.max(1e-12 * mean);
    MeasuredReads {
        count: pairs.len() as u32,
        relative: root(&|pair| share(pair).powi(2)),
        of_mean: root(&|pair| (pair.0 - pair.1).powi(2)) / mean,
        worst: pairs.iter().map(share).fold(0.0, f64::max),
    }
}
