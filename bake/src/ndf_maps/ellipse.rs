//! A footprint as an ellipse, and what lies under it: cells of a grid, tiles of the repeating example.

use crate::footprint::Footprint;
use glam::Vec2;
use glint_formats::ndf_maps::Level;

/// Tiles lie within this many standard deviations of the footprint's centre; 0.6 % of its mass is farther out.
pub const REACH: f32 = 3.2;
/// Finest boxes: below this edge positions have no digits left.
pub const FINEST_TEXELS: f32 = 1.0 / 4096.0;

/// A Gaussian by its principal axes.
#[derive(Clone, Copy, Debug)]
pub struct Ellipse {
    pub mean: Vec2,
    pub major_axis: Vec2,
    pub minor: f32,
    pub major: f32,
}

impl Ellipse {
    pub fn new(footprint: &Footprint) -> Ellipse {
        let (minor, major, axis) = footprint.principal();
        // A point is a footprint of the finest box's size.
        let [minor, major] = [minor, major].map(|sigma| (sigma as f32).max(0.5 * FINEST_TEXELS));
        Ellipse { mean: footprint.mean.as_vec2(), major_axis: axis.as_vec2(), minor, major }
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

    /// Half the height of the ellipse of `REACH` standard deviations.
    pub fn reach_y(&self) -> f32 {
        let e = self.major_axis;
        REACH * ((e.y * self.major).powi(2) + (e.x * self.minor).powi(2)).sqrt()
    }

    /// The ellipse's range of x at height y, if it reaches there.
    pub fn span_x(&self, y: f32) -> Option<(f32, f32)> {
        let e = self.major_axis;
        let (p, q) = (1.0 / (self.major * self.major), 1.0 / (self.minor * self.minor));
        let a = e.x * e.x * p + e.y * e.y * q;
        let b = e.x * e.y * (p - q);
        let dy = y - self.mean.y;
        let inner = REACH * REACH * a - dy * dy * p * q;
        if inner < 0.0 {
            return None;
        }
        let half = inner.sqrt() / a;
        let middle = self.mean.x - b / a * dy;
        Some((middle - half, middle + half))
    }
}

/// Calls `visit(i, j)` for the cells of a grid of `edge` whose centres lie in the ellipse and in the box `low … high`.
pub fn for_each_cell(ellipse: &Ellipse, edge: f32, (low, high): (Vec2, Vec2), mut visit: impl FnMut(i32, i32)) {
    let index = |x: f32| (x / edge - 0.5).ceil() as i32;
    let reach = ellipse.reach_y();
    for j in index((ellipse.mean.y - reach).max(low.y))..index((ellipse.mean.y + reach).min(high.y)) {
        let y = (j as f32 + 0.5) * edge;
        if let Some((x0, x1)) = ellipse.span_x(y) {
            for i in index(x0.max(low.x))..index(x1.min(high.x)) {
                visit(i, j);
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
    let slot = |k: i32, n: u32, length: f32| {
        let start = k.div_euclid(n as i32) as f32 * length + k.rem_euclid(n as i32) as f32 * edge;
        let end = (start + edge).min((k.div_euclid(n as i32) + 1) as f32 * length);
        (0.5 * (start + end), end - start)
    };
    let first = |x: f32, n: u32, length: f32| {
        let period = (x / length).floor();
        period as i32 * n as i32 + (((x - period * length) / edge) as i32).min(n as i32 - 1)
    };
    let reach = ellipse.reach_y();
    let (y0, y1) = ((ellipse.mean.y - reach).max(low.y), (ellipse.mean.y + reach).min(high.y));
    for j in first(y0, level.tiles_y, size.y)..=first(y1, level.tiles_y, size.y) {
        let (y, tall) = slot(j, level.tiles_y, size.y);
        let Some((x0, x1)) = ellipse.span_x(y) else { continue };
        for i in first(x0.max(low.x), level.tiles_x, size.x)..=first(x1.min(high.x), level.tiles_x, size.x) {
            let (x, wide) = slot(i, level.tiles_x, size.x);
            let index = [i.rem_euclid(level.tiles_x as i32) as u32, j.rem_euclid(level.tiles_y as i32) as u32];
            visit(Slot {
                tile: level.first_tile + index[1] * level.tiles_x + index[0],
                index,
                centre: Vec2::new(x, y),
                size: Vec2::new(wide, tall),
            });
        }
    }
}
