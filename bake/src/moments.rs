//! Mean and covariance of the projected normals under a footprint, and what follows from them: the rough surface that light from all
//! around sees, and directions to sample a glinting one in.
//!
//! A density D over the disk of projected normals s integrates to 1 (Xing et al. 2024, section 5), so that its mean and covariance are
//! those of the micro-normals that a footprint sees. `docs/methods/ndf-maps.md`, *Mean normal and roughness*, has the derivations.

use crate::brdf::half_vector;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Part of the samples that are even over the disk, so that nothing that the covariance misses weighs much.
const EVEN: f32 = 0.1;
/// Factor on the covariance of the other samples: a density with several peaks has more in its tails than a Gaussian.
const WIDER: f32 = 1.5;
/// Least cosine of a mean normal.
const LEAST_COSINE: f32 = 0.05;

/// Mean and covariance of projected normals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Mean, within the unit disk.
    pub mean: Vec2,
    /// Covariance xx, xy, yy.
    pub covariance: Vec3,
}

/// A rough surface whose micro-normals have the same mean and covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughNormal {
    /// Unit mean normal in the tangent frame.
    pub normal: Vec3,
    /// Unit vector across the normal along which the surface is roughest.
    pub axis: Vec3,
    /// Roughness α along that axis and across it: √2 times the standard deviation of slopes, as Beckmann's, at most 1.
    pub alpha: Vec2,
}

/// Weighted moments of parts; weights sum to 1.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MomentSums {
    /// Of means.
    pub mean: Vec2,
    /// Of second moments xx, xy, yy.
    pub second: Vec3,
}

impl MomentSums {
    /// Adds a part with its weight.
    pub(crate) fn moments_add(&mut self, weight: f32, part: Moments) {
        let Vec2 { x, y } = part.mean;
        self.mean += weight * part.mean;
        self.second += weight * (part.covariance + Vec3::new(x * x, x * y, y * y));
    }

    /// Moments of the whole, whose variance is at least `least` along every axis.
    pub(crate) fn moments_whole(&self, least: f32) -> Moments {
        let Vec2 { x, y } = self.mean;
        let covariance = self.second - Vec3::new(x * x, x * y, y * y);
        let (xx, yy) = (covariance.x.max(least), covariance.z.max(least));
        // A correlation of 1 would have no width across.
        let most = ((xx - 0.5 * least) * (yy - 0.5 * least)).max(0.0).sqrt();
        Moments { mean: self.mean, covariance: Vec3::new(xx, covariance.y.clamp(-most, most), yy) }
    }
}

/// The rough surface of these moments. Beyond the mean normal a step along the disk's radius is 1 / cosine as long on the surface that is
/// normal to it, and one across the radius as long as in the disk.
pub fn rough_normal(moments: Moments) -> RoughNormal {
    let length = moments.mean.length().min((1.0 - LEAST_COSINE * LEAST_COSINE).sqrt());
    let radial = moments.mean.normalize_or(Vec2::X);
    let across = radial.perp();
    let cosine = (1.0 - length * length).sqrt();
    let [xx, xy, yy] = moments.covariance.to_array();
    let turned = |a: Vec2, b: Vec2| a.x * b.x * xx + (a.x * b.y + a.y * b.x) * xy + a.y * b.y * yy;
    let rr = turned(radial, radial) / (cosine * cosine);
    let rt = turned(radial, across) / cosine;
    let tt = turned(across, across);
    let middle = 0.5 * (rr + tt);
    let half_gap = Vec2::new(0.5 * (rr - tt), rt);
    let gap = half_gap.length();
    // Half the angle of the gap: along the larger variance.
    let along = if half_gap.x >= 0.0 {
        Vec2::new(gap + half_gap.x, half_gap.y)
    } else {
        Vec2::new(half_gap.y, gap - half_gap.x)
    };
    let along = along.normalize_or(Vec2::X);
    let tilted = Vec3::new(radial.x * cosine, radial.y * cosine, -length);
    let level = Vec3::new(across.x, across.y, 0.0);
    let roughness = |variance: f32| (2.0 * variance.max(0.0)).sqrt().min(1.0);
    RoughNormal {
        normal: Vec3::new(radial.x * length, radial.y * length, cosine),
        axis: tilted * along.x + level * along.y,
        alpha: Vec2::new(roughness(middle + gap), roughness(middle - gap)),
    }
}

/// A direction that light may come from, for a random number from 0 to 1 in each of three dimensions; its density is [`moments_pdf`]. A
/// length of 0 means that this sample has none: its half vector lies outside the disk or turns away.
pub fn moments_sample(moments: Moments, view: Vec3, random: Vec3) -> Vec3 {
    let (sin, cos) = (TAU * random.y).sin_cos();
    let s = if random.z < EVEN {
        random.x.sqrt() * Vec2::new(cos, sin)
    } else {
        let Vec3 { x: xx, y: xy, z: yy } = WIDER * moments.covariance;
        let radius = (-2.0 * (1.0 - random.x).max(1e-12).ln()).sqrt();
        let first = xx.sqrt();
        let second = (yy - xy * xy / xx).max(0.0).sqrt();
        moments.mean + radius * Vec2::new(first * cos, xy / first * cos + second * sin)
    };
    let height = 1.0 - s.length_squared();
    if height <= 0.0 {
        return Vec3::ZERO;
    }
    let half = Vec3::new(s.x, s.y, height.sqrt());
    let cosine = view.dot(half);
    let light = 2.0 * cosine * half - view;
    if cosine > 0.0 && light.z > 0.0 { light } else { Vec3::ZERO }
}

/// Density over solid angle of [`moments_sample`] at the unit direction `light`, given a unit direction `view`: a Gaussian and an even
/// part over projected half vectors s, ds = cos θ_h dω_h and dω_h = dω / (4 v·h). Its integral is below 1 by the samples without a direction.
pub fn moments_pdf(moments: Moments, view: Vec3, light: Vec3) -> f32 {
    let half = half_vector(view, light);
    if light.z <= 0.0 || half.z <= 0.0 {
        return 0.0;
    }
    let Vec3 { x: xx, y: xy, z: yy } = WIDER * moments.covariance;
    let d = Vec2::new(half.x, half.y) - moments.mean;
    let determinant = (xx * yy - xy * xy).max(1e-20);
    let squared = (yy * d.x * d.x - 2.0 * xy * d.x * d.y + xx * d.y * d.y) / determinant;
    let gaussian = (-0.5 * squared).exp() / (TAU * determinant.sqrt());
    ((1.0 - EVEN) * gaussian + EVEN / PI) * half.z / (4.0 * view.dot(half).max(1e-6))
}
