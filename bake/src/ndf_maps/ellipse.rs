//! A footprint as an ellipse, and what lies under it: cells of a grid, tiles of the repeating example.

use crate::footprint::Footprint;
use glam::{Mat2, Vec2};
use glint_formats::ndf_maps::Level;

/// Pieces lie within this many standard deviations of the footprint's centre unless settings say otherwise; 2 % of
/// its mass is farther out.
pub const REACH: f32 = 2.8;
/// Finest boxes: below this edge positions have no digits left.
pub const FINEST_TEXELS: f32 = 1.0 / 4096.0;

/// A Gaussian by its principal axes.
#[derive(Clone, Copy, Debug)]
pub struct Ellipse {
    pub mean: Vec2,
    pub major_axis: Vec2,
    pub minor: f32,
    pub major: f32,
    /// Pieces lie within this many standard deviations of the mean.
    pub reach: f32,
}

impl Ellipse {
    pub fn new(footprint: &Footprint, reach: f32) -> Ellipse {
        let (minor, major, axis) = footprint.principal();
        // A point is a footprint of the finest box's size.
        let [minor, major] = [minor, major].map(|sigma| (sigma as f32).max(0.5 * FINEST_TEXELS));
        Ellipse { mean: footprint.mean.as_vec2(), major_axis: axis.as_vec2(), minor, major, reach }
    }

    /// The ellipse in coordinates x' = m · x + offset. The minor axis follows from the area, which keeps its digits.
    pub fn transformed(&self, m: Mat2, offset: Vec2) -> Ellipse {
        let p = m * self.major_axis * self.major;
        let q = m * self.major_axis.perp() * self.minor;
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
            major_axis: twice_axis.normalize_or(Vec2::X),
            minor: (m.determinant() * self.major * self.minor).abs() / major,
            major,
            reach: self.reach,
        }
    }

    /// Widened by a box of edge `edge`.
    pub fn widened(&self, edge: f32) -> Ellipse {
        let extra = edge * edge / 12.0;
        Ellipse {
            minor: (self.minor * self.minor + extra).sqrt(),
            major: (self.major * self.major + extra).sqrt(),
            ..*self
        }
    }

    /// Pieces of `edge` in the box around the ellipse that is widened by them.
    pub fn pieces(&self, edge: f32) -> f32 {
        let widened = self.widened(edge);
        (2.0 * REACH * widened.minor / edge) * (2.0 * REACH * widened.major / edge)
    }

    /// Density at x.
    pub fn density(&self, x: Vec2) -> f32 {
        let d = x - self.mean;
        let along = d.dot(self.major_axis) / self.major;
        let across = d.perp_dot(self.major_axis) / self.minor;
        (-0.5 * (along * along + across * across)).exp() / (2.0 * std::f32::consts::PI * self.minor * self.major)
    }

    /// Gradient of the density's logarithm at x.
    pub fn log_gradient(&self, x: Vec2) -> Vec2 {
        let d = x - self.mean;
        let across = self.major_axis.perp();
        self.major_axis * (-d.dot(self.major_axis) / (self.major * self.major))
            + across * (-d.dot(across) / (self.minor * self.minor))
    }

    /// Half the height of the ellipse of its reach.
    pub fn reach_y(&self) -> f32 {
        let e = self.major_axis;
        self.reach * ((e.y * self.major).powi(2) + (e.x * self.minor).powi(2)).sqrt()
    }

    /// The ellipse's range of x at height y, if it reaches there.
    pub fn span_x(&self, y: f32) -> Option<(f32, f32)> {
        let e = self.major_axis;
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
pub struct Grid {
    pub origin: f32,
    pub edge: f32,
}

impl Grid {
    fn centre(&self, index: i32) -> f32 {
        self.origin + (index as f32 + 0.5) * self.edge
    }

    /// First cell whose centre is not below x.
    fn from(&self, x: f32) -> i32 {
        ((x - self.origin) / self.edge - 0.5).ceil() as i32
    }
}

/// Calls `visit(i, j, centre)` for the cells of a grid whose centres lie in the ellipse and in the box `low … high`.
pub fn for_each_cell(ellipse: &Ellipse, grid: Grid, (low, high): (Vec2, Vec2), mut visit: impl FnMut(i32, i32, Vec2)) {
    let reach = ellipse.reach_y();
    for j in grid.from((ellipse.mean.y - reach).max(low.y))..grid.from((ellipse.mean.y + reach).min(high.y)) {
        let y = grid.centre(j);
        if let Some((x0, x1)) = ellipse.span_x(y) {
            for i in grid.from(x0.max(low.x))..grid.from(x1.min(high.x)) {
                visit(i, j, Vec2::new(grid.centre(i), y));
            }
        }
    }
}

pub const EVERYWHERE: (Vec2, Vec2) = (Vec2::NEG_INFINITY, Vec2::INFINITY);

/// A tile where it lies on the repeating example, in example texels.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    pub tile: u32,
    /// Column and row of the tile in its level.
    pub index: [u32; 2],
    pub centre: Vec2,
    pub size: Vec2,
}

impl Slot {
    pub fn area(&self) -> f32 {
        self.size.x * self.size.y
    }

    /// The tiles of the next finer level that this tile of `level` is made of.
    pub fn children(&self, level: &Level, finer: &Level) -> impl Iterator<Item = Slot> {
        let low = self.centre - 0.5 * self.size;
        let edge = Vec2::splat(0.5 * level.tile_texels as f32);
        let (finer, index, size) = (*finer, self.index, self.size);
        (0..4u32).filter_map(move |k| {
            let at = Vec2::new((k % 2) as f32, (k / 2) as f32) * edge;
            let child = (size - at).min(edge);
            let (x, y) = (2 * index[0] + k % 2, 2 * index[1] + k / 2);
            (child.min_element() > 0.0).then(|| Slot {
                tile: finer.first_tile + y * finer.tiles_x + x,
                index: [x, y],
                centre: low + at + 0.5 * child,
                size: child,
            })
        })
    }
}

/// Calls `visit` for a level's tiles over the repeating example of `size`, within the ellipse and the box. Slot k of an
/// axis lies in period k div tiles; the last tile of a period may be cut.
pub fn for_each_tile(
    ellipse: &Ellipse,
    level: &Level,
    size: Vec2,
    (low, high): (Vec2, Vec2),
    mut visit: impl FnMut(Slot),
) {
    let edge = level.tile_texels as f32;
    let reach = ellipse.reach_y();
    let (y0, y1) = ((ellipse.mean.y - reach).max(low.y), (ellipse.mean.y + reach).min(high.y));
    for row in slots(y0, y1, level.tiles_y, size.y, edge) {
        let Some((x0, x1)) = ellipse.span_x(row.centre) else { continue };
        for column in slots(x0.max(low.x), x1.min(high.x), level.tiles_x, size.x, edge) {
            visit(Slot {
                tile: level.first_tile + row.index * level.tiles_x + column.index,
                index: [column.index, row.index],
                centre: Vec2::new(column.centre, row.centre),
                size: Vec2::new(column.size, row.size),
            });
        }
    }
}

/// A tile's place on one axis.
struct AxisSlot {
    index: u32,
    centre: f32,
    size: f32,
}

/// The slots of `count` tiles of `edge`, repeated every `length`, that hold the points from `from` to `to`.
fn slots(from: f32, to: f32, count: u32, length: f32, edge: f32) -> impl Iterator<Item = AxisSlot> {
    let mut period = (from / length).floor() * length;
    let mut index = (((from - period) / edge) as u32).min(count - 1);
    std::iter::from_fn(move || {
        let start = period + index as f32 * edge;
        if start > to {
            return None;
        }
        let end = (start + edge).min(period + length);
        let slot = AxisSlot { index, centre: 0.5 * (start + end), size: end - start };
        index += 1;
        if index == count {
            index = 0;
            period += length;
        }
        Some(slot)
    })
}
