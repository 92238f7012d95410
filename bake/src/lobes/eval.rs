//! One lobe under a footprint, f32, as `eval.wgsl` has it.
//!
//! Tan et al. 2022, Eq. 6: ∫ G_P(u) L(u, s) du is a Gaussian in s. Its covariance, σ_r² I + R + J (Σ_uu⁻¹ + Σ_P⁻¹)⁻¹ Jᵀ, is
//! here a sum of outer products over a determinant that is a sum of squares: nothing is subtracted, so that neither a flat
//! lobe nor a footprint a thousand times longer than wide loses digits.
//!
//! The shader sums densities at the one normal that it asks for. Here lobes are handed on, for any normal.

use super::baked::BakedLobes;
use crate::footprint::Footprint;
use glam::{DVec2, Mat2, Vec2, Vec3};

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

/// What lobes are seen by: a footprint and the intrinsic roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Query {
    /// The footprint.
    pub frame: Frame,
    /// The major axis over its standard deviation: its product with an offset is in standard deviations. Zero, like
    /// [`Query::across`], for a footprint that sees every place alike.
    pub along: Vec2,
    /// The minor axis over its standard deviation.
    pub across: Vec2,
    /// Intrinsic roughness σ_r, a standard deviation of projected normals.
    pub roughness: f32,
}

/// A lobe: a 4D Gaussian over position and projected normal, without the intrinsic roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lobe {
    /// Weight in texels; 0 is no lobe.
    pub weight: f32,
    /// Mean position from the cell's corner, in texels.
    pub position: Vec2,
    /// Mean projected normal.
    pub normal: Vec2,
    /// Lower triangular factor F of the covariance of positions Σ_uu = F Fᵀ, in texels.
    pub factor: Mat2,
    /// Jacobian ∂s/∂u per texel.
    pub jacobian: Mat2,
    /// Residual covariance of normals, which the Jacobian leaves: xx, xy, yy.
    pub residual: Vec3,
}

/// An ellipse around a footprint, for the ranges of x that it has at some heights. At height y above the middle its own middle
/// lies at `slope` y, and half its width is `narrow` √(`top`² − y²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ellipse {
    /// Centre, in texels.
    pub mean: Vec2,
    /// Half its height, in texels.
    pub top: f32,
    /// Middle over the height that it is at.
    pub slope: f32,
    /// Half the width over √(`top`² − y²).
    pub narrow: f32,
    /// Height at which its right end lies; the left end lies at its negative.
    pub widest: f32,
}

/// What a lobe gives to a footprint: a Gaussian over the disk of normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConditionalLobe {
    /// Share of the footprint, to be divided by the sum of all shares.
    pub share: f32,
    /// Mean projected normal.
    pub mean: Vec2,
    /// Inverse covariance: xx, xy, yy.
    pub inverse: [f32; 3],
    /// Density at the mean of a share of 1, over the mass inside the disk.
    pub peak: f32,
    /// Mass inside the disk of normals.
    pub inside: f32,
}

/// A bilinear patch of the filtered map at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Projected normal.
    pub normal: Vec2,
    /// Jacobian ∂s/∂u per texel.
    pub jacobian: Mat2,
    /// Twist ∂²s/∂u∂v per squared texel.
    pub twist: Vec2,
}

/// Footprints are taken to be at least this wide, in texels: below it positions have no digits left.
pub(crate) const LEAST_SIGMA: f32 = 1.0 / 4096.0;
/// Squared distance, in standard deviations, beyond which a lobe is nothing.
pub(crate) const CUT: f32 = 30.0;

/// Axes of a footprint.
pub fn frame(footprint: &Footprint) -> Frame {
    let (minor, major, axis) = footprint.principal();
    let [minor, major] = [minor, major].map(|sigma| (sigma as f32).max(LEAST_SIGMA));
    Frame { mean: footprint.mean.as_vec2(), axis: axis.as_vec2(), major, minor }
}

impl BakedLobes {
    /// Axes of a footprint, its centre moved by whole periods into the map, where positions have the most digits.
    pub(super) fn frame_in_map(&self, footprint: &Footprint) -> Frame {
        let size = DVec2::new(self.params.width as f64, self.params.height as f64);
        let mean = footprint.mean - (footprint.mean / size).floor() * size;
        frame(&Footprint { mean, ..*footprint })
    }
}

/// A query from its parts.
pub(crate) fn query(frame: Frame, roughness: f32) -> Query {
    Query { frame, along: frame.axis / frame.major, across: frame.axis.perp() / frame.minor, roughness }
}

fn variance_y(frame: &Frame) -> f32 {
    let a = frame.axis.y * frame.major;
    let b = frame.axis.x * frame.minor;
    a * a + b * b
}

/// The ellipse of `reach` standard deviations.
pub(crate) fn ellipse(frame: &Frame, reach: f32) -> Ellipse {
    let yy = variance_y(frame);
    let a = frame.axis.x * frame.major;
    let b = frame.axis.y * frame.minor;
    let xx = a * a + b * b;
    let xy = frame.axis.x * frame.axis.y * (frame.major * frame.major - frame.minor * frame.minor);
    Ellipse {
        mean: frame.mean,
        top: reach * yy.sqrt(),
        slope: xy / yy,
        narrow: frame.major * frame.minor / yy,
        widest: reach * xy / xx.sqrt(),
    }
}

/// Range of x of an ellipse between two heights; none if they miss it.
pub(crate) fn ellipse_span(ellipse: &Ellipse, low: f32, high: f32) -> Option<(f32, f32)> {
    let top = ellipse.top;
    let y0 = (low - ellipse.mean.y).max(-top);
    let y1 = (high - ellipse.mean.y).min(top);
    if y0 > y1 {
        return None;
    }
    // Both sides are extreme where the ellipse is, or at an end of the range.
    let ends = [-ellipse.widest, ellipse.widest].map(|y| y.clamp(y0, y1));
    let half = ends.map(|y| ellipse.narrow * (top * top - y * y).max(0.0).sqrt());
    let middle = ends.map(|y| ellipse.mean.x + ellipse.slope * y);
    Some((middle[0] - half[0], middle[1] + half[1]))
}

/// First and last box of a row of boxes of `edge` texels, the row's low edge at `y`, under an ellipse; boxes begin at `origin`.
/// The last is less than the first if there is none.
pub(crate) fn row(ellipse: &Ellipse, origin: f32, edge: f32, y: f32) -> (i32, i32) {
    let Some((low, high)) = ellipse_span(ellipse, y, y + edge) else { return (1, 0) };
    let [first, last] = [low, high].map(|x| ((x - origin) / edge).floor() as i32);
    (first, last)
}

/// Lower triangular factor F of a covariance F Fᵀ of these standard deviations.
pub(super) fn factor(sigmas: Vec2, correlation: f32) -> Mat2 {
    let rest = (1.0 - correlation * correlation).max(0.0).sqrt();
    Mat2::from_cols(Vec2::new(sigmas.x, correlation * sigmas.y), Vec2::new(0.0, rest * sigmas.y))
}

/// Covariance of these standard deviations: xx, xy, yy.
pub(super) fn covariance(sigmas: Vec2, correlation: f32) -> Vec3 {
    Vec3::new(sigmas.x * sigmas.x, correlation * sigmas.x * sigmas.y, sigmas.y * sigmas.y)
}

/// Whether a Gaussian may have mass beyond the rim of the disk: five standard deviations from it there is less than 4e-6. A row's
/// sum stands for the largest variance.
pub(super) fn near_rim(mean: Vec2, covariance: Vec3) -> bool {
    let to_rim = 1.0 - mean.length();
    !(to_rim > 0.0 && to_rim * to_rim > 25.0 * (covariance.x.max(covariance.z) + covariance.y.abs()))
}

/// Mass inside the disk of a Gaussian that is wide or near the rim: a sum over strips across the line from the disk's middle
/// through its mean, each strip's chord by its conditional Gaussian.
pub(super) fn inside_disk(mean: Vec2, covariance: Vec3) -> f32 {
    const STRIPS: i32 = 12;
    let (xx, xy, yy) = (covariance.x, covariance.y, covariance.z);
    let radius = mean.length();
    let out = if radius > 0.0 { mean / radius } else { Vec2::X };
    let along = out.x * out.x * xx + 2.0 * out.x * out.y * xy + out.y * out.y * yy;
    let cross = out.x * out.y * (yy - xx) + (out.x * out.x - out.y * out.y) * xy;
    let rest = (out.y * out.y * xx - 2.0 * out.x * out.y * xy + out.x * out.x * yy - cross * cross / along).max(1e-12);
    let low = (radius - 4.5 * along.sqrt()).max(-1.0);
    let step = (1.0 - low) / STRIPS as f32;
    let across = 1.0 / (2.0 * along).sqrt();
    let beside = 1.0 / (2.0 * rest).sqrt();
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

/// A Gaussian over the disk whose covariance (xx, xy, yy) has at least the eigenvalue `intrinsic`.
fn conditional_gaussian(share: f32, mean: Vec2, covariance: Vec3, intrinsic: f32) -> ConditionalLobe {
    let (xx, xy, yy) = (covariance.x, covariance.y, covariance.z);
    // Rounding may take the determinant of a long thin Gaussian below what it can be.
    let det = (xx * yy - xy * xy).max(intrinsic * xx.max(yy));
    let inside = if near_rim(mean, covariance) { inside_disk(mean, covariance) } else { 1.0 };
    let peak = 1.0 / (2.0 * std::f32::consts::PI * det.sqrt() * inside);
    ConditionalLobe { share, mean, inverse: [yy / det, -xy / det, xx / det], peak, inside }
}

/// What `lobe` gives to a footprint whose centre lies `d` from the lobe's position (Eq. 6).
pub(crate) fn conditional(query: &Query, lobe: &Lobe, d: Vec2) -> ConditionalLobe {
    // Columns of the factor of positions, in standard deviations of the footprint, and what they are in normals.
    let p = Vec2::new(query.along.dot(lobe.factor.x_axis), query.along.dot(lobe.factor.y_axis));
    let q = Vec2::new(query.across.dot(lobe.factor.x_axis), query.across.dot(lobe.factor.y_axis));
    let a = lobe.jacobian * lobe.factor.x_axis;
    let b = lobe.jacobian * lobe.factor.y_axis;
    let w = Vec2::new(query.along.dot(d), query.across.dot(d));
    // M = I + Fᵀ Σ_P⁻¹ F is I + p pᵀ + q qᵀ; det M and adj M are sums of squares and outer products.
    let area = p.perp_dot(q);
    let det = 1.0 + p.length_squared() + q.length_squared() + area * area;
    let part = 1.0 / det;
    let across = p * w.y - q * w.x;
    let distance = (w.length_squared() + across.length_squared()) * part;
    let toward = (p * w.x + q * w.y + across.perp() * area) * part;
    let u = b * p.x - a * p.y;
    let v = b * q.x - a * q.y;
    let intrinsic = query.roughness * query.roughness;
    let xx = intrinsic + lobe.residual.x + (a.x * a.x + b.x * b.x + u.x * u.x + v.x * v.x) * part;
    let xy = lobe.residual.y + (a.x * a.y + b.x * b.y + u.x * u.y + v.x * v.y) * part;
    let yy = intrinsic + lobe.residual.z + (a.y * a.y + b.y * b.y + u.y * u.y + v.y * v.y) * part;
    let mean = lobe.normal + a * toward.x + b * toward.y;
    let share = lobe.weight * libm::expf(-0.5 * distance) * part.sqrt();
    conditional_gaussian(share, mean, Vec3::new(xx, xy, yy), intrinsic)
}

/// Lobe of a box of the filtered map, `size` texels wide and high: exact moments of positions and normals over the box.
pub(crate) fn box_lobe(place: &Patch, size: Vec2) -> Lobe {
    const PER_EDGE: f32 = 0.288_675_13; // 1 / √12
    let rest = place.twist * (size.x * size.y / 12.0);
    Lobe {
        weight: size.x * size.y,
        position: Vec2::ZERO,
        normal: place.normal,
        factor: Mat2::from_diagonal(size * PER_EDGE),
        jacobian: place.jacobian,
        residual: Vec3::new(rest.x * rest.x, rest.x * rest.y, rest.y * rest.y),
    }
}

impl ConditionalLobe {
    /// Density at `s`, times the share; 0 farther than √30 standard deviations from the mean.
    pub fn density(&self, s: Vec2) -> f32 {
        let d = s - self.mean;
        let q = self.inverse[0] * d.x * d.x + 2.0 * self.inverse[1] * d.x * d.y + self.inverse[2] * d.y * d.y;
        if q > CUT { 0.0 } else { self.share * self.peak * libm::expf(-0.5 * q) }
    }
}
