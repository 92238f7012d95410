//! A footprint as an ellipse.

use crate::footprint::Footprint;
use glam::{Mat2, Vec2};

/// Least standard deviation: below it positions have no digits left.
const LEAST_TEXELS: f32 = 1.0 / 8192.0;

/// A Gaussian by its principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// Centre.
    pub mean: Vec2,
    /// Unit vector along the major axis.
    pub axis: Vec2,
    /// Standard deviation along the major axis.
    pub major: f32,
    /// Standard deviation across it.
    pub minor: f32,
}

/// A footprint as an ellipse. A point is one of the least size.
pub(crate) fn ellipse(footprint: &Footprint) -> Ellipse {
    let (minor, major, axis) = footprint.principal();
    let [minor, major] = [minor, major].map(|sigma| (sigma as f32).max(LEAST_TEXELS));
    Ellipse { mean: footprint.mean.as_vec2(), axis: axis.as_vec2(), major, minor }
}

impl Ellipse {
    /// The ellipse in coordinates x' = m · x + offset. The minor axis follows from the area, which keeps its digits.
    pub(crate) fn transformed(&self, m: Mat2, offset: Vec2) -> Ellipse {
        let p = m * self.axis * self.major;
        let q = m * self.axis.perp() * self.minor;
        let half_gap = Vec2::new(0.5 * (p.x * p.x + q.x * q.x - p.y * p.y - q.y * q.y), p.x * p.y + q.x * q.y);
        let h = half_gap.length();
        let major = (0.5 * (p.length_squared() + q.length_squared()) + h).sqrt();
        let twice_axis = if half_gap.x >= 0.0 {
            Vec2::new(h + half_gap.x, half_gap.y)
        } else {
            Vec2::new(half_gap.y.abs(), (h - half_gap.x).copysign(half_gap.y))
        };
        Ellipse {
            mean: m * self.mean + offset,
            axis: twice_axis.normalize_or(Vec2::X),
            minor: (m.determinant() * self.major * self.minor).abs() / major,
            major,
        }
    }

    /// With a minor axis that the major one is at most `max_ratio` times.
    pub(crate) fn shortened(&self, max_ratio: f32) -> Ellipse {
        Ellipse { minor: self.minor.max(self.major / max_ratio), ..*self }
    }

    /// The ellipse whose semi-axes are `reach` standard deviations and `margin`, as one of standard deviations.
    pub(crate) fn within(&self, reach: f32, margin: f32) -> Ellipse {
        Ellipse { major: reach * self.major + margin, minor: reach * self.minor + margin, ..*self }
    }

    /// Half the height of the ellipse of one standard deviation.
    pub(crate) fn half_height(&self) -> f32 {
        let e = self.axis;
        ((e.y * self.major).powi(2) + (e.x * self.minor).powi(2)).sqrt()
    }

    /// The range of x at height y of the ellipse of one standard deviation; empty where it does not reach.
    pub(crate) fn span_x(&self, y: f32) -> [f32; 2] {
        let e = self.axis;
        let (p, q) = (1.0 / (self.major * self.major), 1.0 / (self.minor * self.minor));
        let a = e.x * e.x * p + e.y * e.y * q;
        let b = e.x * e.y * (p - q);
        let dy = y - self.mean.y;
        let inner = a - dy * dy * p * q;
        if inner < 0.0 {
            return [1e30, -1e30];
        }
        let half = inner.sqrt() / a;
        let middle = self.mean.x - b / a * dy;
        [middle - half, middle + half]
    }
}
