//! A footprint as an ellipse, and the pieces under it: cells of a grid, places of tiles on the repeating example.

use crate::footprint::Footprint;
use glam::{Mat2, Vec2};
use std::ops::Range;

/// Pieces lie within this many standard deviations of the footprint's centre unless settings say otherwise; 2 % of
/// its mass is farther out.
pub(super) const REACH: f32 = 2.8;
/// Finest boxes: below this edge positions have no digits left.
pub(super) const FINEST_TEXELS: f32 = 1.0 / 4096.0;

/// A Gaussian by its principal axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ellipse {
    /// Centre.
    pub mean: Vec2,
    /// Unit vector along the major axis.
    pub axis: Vec2,
    /// Standard deviation along the major axis.
    pub major: f32,
    /// Standard deviation across it.
    pub minor: f32,
    /// Pieces lie within this many standard deviations of the mean.
    pub reach: f32,
}

/// A footprint as an ellipse. A point is a footprint of the finest box's size.
pub(super) fn ellipse(footprint: &Footprint, reach: f32) -> Ellipse {
    let (minor, major, axis) = footprint.principal();
    let [minor, major] = [minor, major].map(|sigma| (sigma as f32).max(0.5 * FINEST_TEXELS));
    Ellipse { mean: footprint.mean.as_vec2(), axis: axis.as_vec2(), major, minor, reach }
}

impl Ellipse {
    /// The ellipse in coordinates x' = m · x + offset. The minor axis follows from the area, which keeps its digits.
    pub(super) fn transformed(&self, m: Mat2, offset: Vec2) -> Ellipse {
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
            reach: self.reach,
        }
    }

    /// Widened by a box of edge `edge`.
    pub(super) fn widened(&self, edge: f32) -> Ellipse {
        let extra = edge * edge / 12.0;
        Ellipse {
            minor: (self.minor * self.minor + extra).sqrt(),
            major: (self.major * self.major + extra).sqrt(),
            ..*self
        }
    }

    /// Pieces of `edge` in the box around the ellipse that is widened by them.
    pub(super) fn pieces(&self, edge: f32) -> f32 {
        let widened = self.widened(edge);
        (2.0 * REACH * widened.minor / edge) * (2.0 * REACH * widened.major / edge)
    }

    /// Density at x, 1 / texel².
    pub(super) fn gaussian(&self, x: Vec2) -> f32 {
        let d = x - self.mean;
        let along = d.dot(self.axis) / self.major;
        let across = d.perp_dot(self.axis) / self.minor;
        (-0.5 * (along * along + across * across)).exp() / (2.0 * std::f32::consts::PI * self.minor * self.major)
    }

    /// Density at x of the ellipse widened by a box of edge `edge`.
    pub(super) fn widened_gaussian(&self, edge: f32, x: Vec2) -> f32 {
        self.widened(edge).gaussian(x)
    }

    /// Gradient of the density's logarithm at x.
    pub(super) fn log_gradient(&self, x: Vec2) -> Vec2 {
        let d = x - self.mean;
        let across = self.axis.perp();
        self.axis * (-d.dot(self.axis) / (self.major * self.major))
            + across * (-d.dot(across) / (self.minor * self.minor))
    }

    /// Half the height of the ellipse of its reach.
    pub(super) fn reach_y(&self) -> f32 {
        let e = self.axis;
        self.reach * ((e.y * self.major).powi(2) + (e.x * self.minor).powi(2)).sqrt()
    }

    /// The ellipse's range of x at height y, if it reaches there.
    pub(super) fn span_x(&self, y: f32) -> Option<(f32, f32)> {
        let e = self.axis;
        let (p, q) = (1.0 / (self.major * self.major), 1.0 / (self.minor * self.minor));
        let a = e.x * e.x * p + e.y * e.y * q;
        let b = e.x * e.y * (p - q);
        let dy = y - self.mean.y;
        let inner = self.reach * self.reach * a - dy * dy * p * q;
        if inner < 0.0 {
            return None;
        }
        let half = inner.sqrt() / a;
        let middle = self.mean.x - b / a * dy;
        Some((middle - half, middle + half))
    }
}

/// Cells of one edge; `origin` is a corner of cell (0, 0).
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// A corner of cell (0, 0), on both axes.
    pub origin: f32,
    /// Edge of a cell.
    pub edge: f32,
}

impl Grid {
    /// First cell whose centre is not below x.
    fn cell_from(&self, x: f32) -> i32 {
        ((x - self.origin) / self.edge - 0.5).ceil() as i32
    }

    /// The cells of an axis with centres from `low` to `high`.
    fn cells(&self, low: f32, high: f32) -> Range<i32> {
        self.cell_from(low)..self.cell_from(high)
    }

    fn cell_centre(&self, index: i32) -> f32 {
        self.origin + (index as f32 + 0.5) * self.edge
    }
}

/// Calls `visit(i, j, centre)` for the cells of a grid whose centres lie in the ellipse and in the box `low … high`.
pub(super) fn for_each_cell(
    ellipse: &Ellipse,
    grid: Grid,
    (low, high): (Vec2, Vec2),
    mut visit: impl FnMut(i32, i32, Vec2),
) {
    let reach = ellipse.reach_y();
    for j in grid.cells((ellipse.mean.y - reach).max(low.y), (ellipse.mean.y + reach).min(high.y)) {
        let y = grid.cell_centre(j);
        if let Some((x0, x1)) = ellipse.span_x(y) {
            for i in grid.cells(x0.max(low.x), x1.min(high.x)) {
                visit(i, j, Vec2::new(grid.cell_centre(i), y));
            }
        }
    }
}

/// A box without end.
pub(super) const EVERYWHERE: (Vec2, Vec2) = (Vec2::NEG_INFINITY, Vec2::INFINITY);

/// A tile's place on one axis of the repeating example.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    /// Where the example's period begins.
    pub period: f32,
    /// Index of the tile.
    pub index: u32,
}

/// The slot that holds x, of `count` tiles of `edge` repeated every `length`.
pub(super) fn slot_at(x: f32, count: u32, length: f32, edge: f32) -> Slot {
    let period = (x / length).floor() * length;
    Slot { period, index: (((x - period) / edge) as u32).min(count - 1) }
}

/// The slot after `slot`.
pub(super) fn next_slot(slot: Slot, count: u32, length: f32) -> Slot {
    if slot.index + 1 == count {
        return Slot { period: slot.period + length, index: 0 };
    }
    Slot { index: slot.index + 1, ..slot }
}
