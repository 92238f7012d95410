//! One lobe under a footprint, f32, as a shader would do it.
//!
//! Tan et al. 2022, Eq. 6: ∫ G_P(u) L(u, s) du is a Gaussian in s. Its covariance, σ_r² I + R + J (Σ_uu⁻¹ + Σ_P⁻¹)⁻¹ Jᵀ, is
//! here a sum of outer products over a determinant that is a sum of squares: nothing is subtracted, so that neither a flat
//! lobe nor a footprint a thousand times longer than wide loses digits.

use super::quantise::Lobe;
use crate::footprint::Footprint;
use glam::{Mat2, Vec2};

/// A footprint by its principal axes, in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Centre.
    pub mean: Vec2,
    /// Unit vector along the major axis.
    pub axis: Vec2,
    /// Standard deviation along the major axis.
    pub major: f32,
    /// Standard deviation along the minor axis.
    pub minor: f32,
}

/// Footprints are taken to be at least this wide, in texels: below it positions have no digits left.
pub const LEAST_SIGMA: f32 = 1.0 / 4096.0;

impl Frame {
    /// Axes of a footprint.
    pub fn new(footprint: &Footprint) -> Frame {
        let (minor, major, axis) = footprint.principal();
        let [minor, major] = [minor, major].map(|sigma| (sigma as f32).max(LEAST_SIGMA));
        Frame { mean: footprint.mean.as_vec2(), axis: axis.as_vec2(), major, minor }
    }

    /// `d` along the major and the minor axis, in standard deviations.
    fn whitened(&self, d: Vec2) -> Vec2 {
        Vec2::new(d.dot(self.axis) / self.major, self.axis.perp_dot(d) / self.minor)
    }
}

/// What a lobe gives to a footprint: a Gaussian over the disk of normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenLobe {
    /// Share of the footprint, to be divided by the sum of all shares.
    pub share: f32,
    /// Mean projected normal.
    pub mean: Vec2,
    /// Inverse covariance: xx, xy, yy.
    pub inverse: [f32; 3],
    /// Density at the mean of a share of 1.
    pub peak: f32,
}

/// What `lobe` gives to a footprint whose centre lies `d` from the lobe's position; intrinsic roughness `roughness`.
pub fn seen(lobe: &Lobe, d: Vec2, frame: &Frame, roughness: f32) -> SeenLobe {
    // Columns of the spread's factor, in standard deviations of the footprint, and what they are in normals.
    let (f, g) = (frame.whitened(lobe.spread.x_axis), frame.whitened(lobe.spread.y_axis));
    let slopes = lobe.jacobian * lobe.spread;
    let d = frame.whitened(d);
    // M = I + Fᵀ Σ_P⁻¹ F has rows (f, g) · columns; det M and adj M are sums of squares and outer products.
    let (p, q) = (Vec2::new(f.x, g.x), Vec2::new(f.y, g.y));
    let area = p.perp_dot(q);
    let det = 1.0 + p.length_squared() + q.length_squared() + area * area;
    let across = [f.perp_dot(d), g.perp_dot(d)];
    let distance = (d.length_squared() + across[0] * across[0] + across[1] * across[1]) / det;
    let toward = p * d.x + q * d.y + (p.perp() * d.y - q.perp() * d.x) * area;
    let terms = [slopes.x_axis, slopes.y_axis, slopes * p.perp(), slopes * q.perp()];
    let outer = terms.map(|t| [t.x * t.x, t.x * t.y, t.y * t.y]);
    let sum = |k: usize| (outer[0][k] + outer[1][k] + outer[2][k] + outer[3][k]) / det;
    let r = lobe.residual;
    let intrinsic = roughness * roughness;
    let xx = intrinsic + r.x_axis.x * r.x_axis.x + r.y_axis.x * r.y_axis.x + sum(0);
    let xy = r.x_axis.x * r.x_axis.y + r.y_axis.x * r.y_axis.y + sum(1);
    let yy = intrinsic + r.x_axis.y * r.x_axis.y + r.y_axis.y * r.y_axis.y + sum(2);
    let share = lobe.weight * libm::expf(-0.5 * distance) / det.sqrt();
    seen_gaussian(share, lobe.normal + slopes * toward / det, [xx, xy, yy], intrinsic)
}

/// What `lobe` gives to a footprint that sees every place alike: all of it.
pub fn seen_whole(lobe: &Lobe, roughness: f32) -> SeenLobe {
    seen_gaussian(lobe.weight, lobe.normal, whole_covariance(lobe, roughness), roughness * roughness)
}

/// Mass of a whole lobe inside the disk of normals.
pub fn mass_inside(lobe: &Lobe, roughness: f32) -> f32 {
    inside_disk(lobe.normal, whole_covariance(lobe, roughness))
}

/// Mass inside the disk of a Gaussian of the intrinsic roughness alone around the projected normal `s`.
pub fn facet_mass_inside(s: Vec2, roughness: f32) -> f32 {
    let intrinsic = roughness * roughness;
    inside_disk(s, [intrinsic, 0.0, intrinsic])
}

/// Covariance of a whole lobe's normals: xx, xy, yy.
fn whole_covariance(lobe: &Lobe, roughness: f32) -> [f32; 3] {
    let slopes = lobe.jacobian * lobe.spread;
    let outer = |m: &Mat2| {
        let (a, b) = (m.x_axis, m.y_axis);
        [a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y]
    };
    let (rest, sloped) = (outer(&lobe.residual), outer(&slopes));
    let intrinsic = roughness * roughness;
    [intrinsic + rest[0] + sloped[0], rest[1] + sloped[1], intrinsic + rest[2] + sloped[2]]
}

/// A Gaussian over the disk whose covariance has at least the eigenvalue `intrinsic`.
fn seen_gaussian(share: f32, mean: Vec2, [xx, xy, yy]: [f32; 3], intrinsic: f32) -> SeenLobe {
    // Rounding may take the determinant of a long thin Gaussian below what it can be.
    let det = (xx * yy - xy * xy).max(intrinsic * xx.max(yy));
    let inside = inside_disk(mean, [xx, xy, yy]);
    SeenLobe {
        share,
        mean,
        inverse: [yy / det, -xy / det, xx / det],
        peak: 1.0 / (2.0 * std::f32::consts::PI * det.sqrt() * inside),
    }
}

impl SeenLobe {
    /// Density at `s`, times the share.
    pub fn density(&self, s: Vec2) -> f32 {
        let d = s - self.mean;
        let q = self.inverse[0] * d.x * d.x + 2.0 * self.inverse[1] * d.x * d.y + self.inverse[2] * d.y * d.y;
        if q > CUT { 0.0 } else { self.share * self.peak * libm::expf(-0.5 * q) }
    }
}

/// Squared distance, in standard deviations, beyond which a lobe is nothing.
const CUT: f32 = 30.0;

/// Mass of a Gaussian inside the disk: 1 unless it is wide or near the rim, else a sum over strips across the line from the
/// disk's middle through its mean, each strip's chord by its conditional Gaussian.
fn inside_disk(mean: Vec2, [xx, xy, yy]: [f32; 3]) -> f32 {
    const STRIPS: i32 = 12;
    let radius = mean.length();
    let to_rim = 1.0 - radius;
    if to_rim > 0.0 && to_rim * to_rim > 25.0 * (xx + yy) {
        return 1.0;
    }
    let out = if radius > 0.0 { mean / radius } else { Vec2::X };
    let along = out.x * out.x * xx + 2.0 * out.x * out.y * xy + out.y * out.y * yy;
    let cross = out.x * out.y * (yy - xx) + (out.x * out.x - out.y * out.y) * xy;
    let rest = (out.y * out.y * xx - 2.0 * out.x * out.y * xy + out.x * out.x * yy - cross * cross / along).max(1e-12);
    let low = (radius - 4.5 * along.sqrt()).max(-1.0);
    let step = (1.0 - low) / STRIPS as f32;
    let (across, beside) = (1.0 / (2.0 * along).sqrt(), 1.0 / (2.0 * rest).sqrt());
    let mut sum = 0.0;
    let mut below = libm::erff((low - radius) * across);
    for k in 0..STRIPS {
        let x = low + (k as f32 + 0.5) * step;
        let above = libm::erff((x + 0.5 * step - radius) * across);
        let chord = (1.0 - x * x).max(0.0).sqrt();
        let middle = cross / along * (x - radius);
        sum += (above - below) * (libm::erff((chord - middle) * beside) + libm::erff((chord + middle) * beside));
        below = above;
    }
    (0.25 * sum).max(1e-3)
}

/// Lobe of a box of the filtered map, `size` texels wide and high: exact moments, see [`super::seeds`].
pub fn box_lobe(normal: Vec2, jacobian: Mat2, twist: Vec2, size: Vec2) -> Lobe {
    const PER_EDGE: f32 = 0.288_675_13; // 1 / √12
    Lobe {
        weight: size.x * size.y,
        position: Vec2::ZERO,
        normal,
        spread: Mat2::from_diagonal(size * PER_EDGE),
        jacobian,
        residual: Mat2::from_cols(twist * (size.x * size.y / 12.0), Vec2::ZERO),
    }
}

/// Signs of a lobe's quarters along the columns of its spread.
pub const QUARTERS: [Vec2; 4] =
    [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::new(-1.0, 1.0), Vec2::new(1.0, 1.0)];

/// From a lobe's mean to that of a quarter. Four quarters have the lobe's moments, as the quarters of a box have.
pub fn quarter_offset(lobe: &Lobe, signs: Vec2) -> Vec2 {
    lobe.spread * (signs * APART)
}

const APART: f32 = 0.866_025_4; // √3 / 2

/// The part of a lobe that is made of some of its quarters: weight, mean and spread along both columns are theirs.
pub fn part_of(lobe: &Lobe, quarters: [bool; 4]) -> Lobe {
    let (mut count, mut signs) = (0.0, Vec2::ZERO);
    for k in 0..4 {
        if quarters[k] {
            count += 1.0;
            signs += QUARTERS[k];
        }
    }
    let mean = if count > 0.0 { signs / count } else { Vec2::ZERO };
    let d = quarter_offset(lobe, mean);
    // A quarter of the variance lies within quarters, the rest between their means.
    let narrow = |m: f32| (1.0 - 0.75 * m * m).sqrt();
    Lobe {
        weight: 0.25 * count * lobe.weight,
        position: lobe.position + d,
        normal: lobe.normal + lobe.jacobian * d,
        spread: Mat2::from_cols(lobe.spread.x_axis * narrow(mean.x), lobe.spread.y_axis * narrow(mean.y)),
        ..*lobe
    }
}
