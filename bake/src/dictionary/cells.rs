//! Cells under a pixel footprint: clamped anisotropy, level of detail, and the weight of each cell. f32, as in WGSL.
//!
//! Paper: section 6.1, Eq. 12, and algorithm 1, lines 3 to 7. The footprint is the ellipse of the two screen
//! derivatives with weight exp(−2 r²) inside r = 1. Deviations:
//! - The weight is (1 − r²)², within 0.04 of (exp(−2 r²) − exp(−2)) / (1 − exp(−2)): a cell enters and leaves with weight
//!   zero, and slowly.
//! - At each level the footprint is widened by a Gaussian of 0.4 cells (Heckbert's reconstruction filter). Every
//!   footprint, of zero area too, then covers a cell centre, and magnified cells blend.
//! - Rows of cells and the span of each row come from the ellipse, so each cell inside is visited once and none outside.
//!   The authors walk the bounding box and stop after 100 cells, which loses weight. The number of cells is bounded by
//!   the clamped anisotropy alone, see [`max_cells`].
//!
//! Lengths are in cells of level 0; one surface unit has 2^(levels − 1) of them a side.

use glam::{Vec2, Vec3};

/// Coarsest level of the cell hierarchy. A minor radius beyond 2^`MAX_CELL_LEVEL` cells counts as that long.
pub const MAX_CELL_LEVEL: u32 = 24;
/// Largest ratio of the axes that can be asked for.
pub const MAX_ANISOTROPY: f32 = 16.0;
/// Squared radius, in cells, that the reconstruction filter adds: (2 · 0.4)².
pub const RECONSTRUCTION_RADIUS2: f32 = 0.64;

/// Pixel footprint on the surface: symmetric matrix of squared radii, and its level of detail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFootprint {
    /// Squared radii, in cells²: (xx, xy, yy).
    pub xx: f32,
    /// See `xx`.
    pub xy: f32,
    /// See `xx`.
    pub yy: f32,
    /// Level at which the minor radius is one cell, in 0 to [`MAX_CELL_LEVEL`].
    pub lod: f32,
}

/// Footprint of the derivatives of the surface position along the two screen axes, in cells a pixel. The minor radius
/// grows until the axes are at most `max_anisotropy` (1 to [`MAX_ANISOTROPY`]) apart, so the pixel is blurred rather
/// than cut.
pub fn pixel_footprint(d_dx: Vec2, d_dy: Vec2, max_anisotropy: f32) -> PixelFootprint {
    // Far beyond what the coarsest level can tell apart, and its fourth power is still a finite float.
    let limit = 1.0e8;
    let dx = Vec2::new(d_dx.x.clamp(-limit, limit), d_dx.y.clamp(-limit, limit));
    let dy = Vec2::new(d_dy.x.clamp(-limit, limit), d_dy.y.clamp(-limit, limit));
    let a = dx.x * dx.x + dy.x * dy.x;
    let b = dx.x * dx.y + dy.x * dy.y;
    let c = dx.y * dx.y + dy.y * dy.y;
    let half_difference = 0.5 * (a - c);
    let half_gap = (half_difference * half_difference + b * b).sqrt();
    let mut major2 = 0.5 * (a + c) + half_gap;
    let cross = dx.x * dy.y - dx.y * dy.x;
    let mut minor2 = cross * cross / major2.max(1.0e-30);
    let ratio = max_anisotropy.clamp(1.0, MAX_ANISOTROPY);
    minor2 = minor2.max(major2 / (ratio * ratio)).min(major2);

    let coarsest = (MAX_CELL_LEVEL as f32).exp2();
    let shrink = (coarsest * coarsest / minor2.max(1.0e-30)).min(1.0);
    major2 *= shrink;
    minor2 *= shrink;
    let mut direction = Vec2::ZERO;
    if half_gap > 0.0 {
        direction = Vec2::new(half_difference / half_gap, b / half_gap);
    }
    let mean = 0.5 * (major2 + minor2);
    let spread = 0.5 * (major2 - minor2);
    PixelFootprint {
        xx: mean + spread * direction.x,
        xy: spread * direction.y,
        yy: mean - spread * direction.x,
        lod: 0.5 * minor2.max(1.0).log2(),
    }
}

/// The footprint in cells of one level: an ellipse around `centre`, which is relative to the corner of the base cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelWindow {
    /// Column of the base cell.
    pub base_x: i32,
    /// Row of the base cell.
    pub base_y: i32,
    /// Centre of the footprint from the corner of the base cell, 0 to 1.
    pub centre: Vec2,
    /// Squared radius along y in cells².
    pub yy: f32,
    /// Inverse of the matrix of squared radii: (xx, xy, yy).
    pub inverse: Vec3,
    /// First row that may hold a cell centre, relative to the base cell.
    pub first_row: i32,
    /// Last such row.
    pub last_row: i32,
}

/// The footprint around `position` (in cells of level 0) at a whole level.
pub fn level_window(footprint: PixelFootprint, position: Vec2, level: u32) -> LevelWindow {
    let scale = (-(level as f32)).exp2();
    let limit = 1.0e9;
    let p = Vec2::new((position.x * scale).clamp(-limit, limit), (position.y * scale).clamp(-limit, limit));
    let base = Vec2::new(p.x.floor(), p.y.floor());
    let centre = Vec2::new(p.x - base.x, p.y - base.y);
    let scale2 = scale * scale;
    let xx = footprint.xx * scale2 + RECONSTRUCTION_RADIUS2;
    let xy = footprint.xy * scale2;
    let yy = footprint.yy * scale2 + RECONSTRUCTION_RADIUS2;
    let reach = yy.sqrt();
    let det = (xx * yy - xy * xy).max(RECONSTRUCTION_RADIUS2 * RECONSTRUCTION_RADIUS2);
    LevelWindow {
        base_x: base.x as i32,
        base_y: base.y as i32,
        centre,
        yy,
        inverse: Vec3::new(yy, -xy, xx) / det,
        first_row: (centre.y - reach - 0.5).ceil() as i32,
        last_row: (centre.y + reach - 0.5).floor() as i32,
    }
}

/// First and last column, relative to the base cell, whose centres lie in the ellipse in `row`; the span is empty if
/// the first is larger.
pub fn row_span(window: LevelWindow, row: i32) -> (i32, i32) {
    let dy = row as f32 + 0.5 - window.centre.y;
    let mid = window.centre.x - window.inverse.y / window.inverse.x * dy;
    let half = ((1.0 - dy * dy / window.yy).max(0.0) / window.inverse.x).sqrt();
    ((mid - half - 0.5).ceil() as i32, (mid + half - 0.5).floor() as i32)
}

/// Weight, not yet normalised, of a cell by its place relative to the base cell. Zero at the rim and beyond.
pub fn cell_weight(window: LevelWindow, column: i32, row: i32) -> f32 {
    let dx = column as f32 + 0.5 - window.centre.x;
    let dy = row as f32 + 0.5 - window.centre.y;
    let r2 = window.inverse.x * dx * dx + 2.0 * window.inverse.y * dx * dy + window.inverse.z * dy * dy;
    let inside = (1.0 - r2).max(0.0);
    inside * inside
}

/// Bound on the cells of one query, both levels together: area plus perimeter of the largest ellipse of each level.
pub fn max_cells(max_anisotropy: f32) -> u32 {
    let ratio = max_anisotropy.clamp(1.0, MAX_ANISOTROPY);
    let mut bound = 0.0;
    for minor in [2.0f32, 1.0] {
        let short = (minor * minor + RECONSTRUCTION_RADIUS2).sqrt();
        let long = (minor * minor * ratio * ratio + RECONSTRUCTION_RADIUS2).sqrt();
        bound += std::f32::consts::PI * (short + 0.75) * (long + 0.75);
    }
    bound.ceil() as u32
}
