//! Slope distribution and BRDF of a pixel at run time. f32, plain functions, as in WGSL.
//!
//! Paper: sections 5 and 6, Eq. 7 to 16, algorithms 1 to 3. Deviations:
//! - Order of the transforms: the half vector's slope is first scaled, then rotated. Scaling last (as algorithm 3
//!   prints it) converges to a rotated target when α_x ≠ α_y; this order converges to the target.
//! - GGX. The radial map r_B = α √ln(1 + r²/α²) takes the circle that holds a given share of GGX to the circle that
//!   holds the same share of Beckmann. The dictionary is read at the mapped slope and multiplied by the map's Jacobian,
//!   1 / (1 + r²/α²). Mass and symmetry are kept exactly, and where a cell converges to Beckmann it now converges to
//!   GGX, for one logarithm and no further look-up. Lobes in the tail become wider, as their facets do in the scale
//!   mixture that GGX is.
//! - A cell's colour fades to the mean of the colours as the number of lit facets k grows, by 1/√k, which is how the
//!   colour of k independent facets would vary. In the paper one colour fills a cell of any size, and the smooth
//!   limit has none.
//! - A cell is turned by at most 45°, not by any angle. Marginals are even and both are picked alike, so a quarter turn only
//!   exchanges the two, and the distribution over cells is the same.
//! - Density randomisation takes its normal number from two uniform ones, so its tails are bounded.
//! - The weight of a cell is (1 − r²)² inside the footprint's ellipse, within 0.04 of (exp(−2 r²) − exp(−2)) / (1 − exp(−2));
//!   the paper has exp(−2 r²) inside r = 1. A cell enters and leaves with weight zero, and slowly.
//! - Cells of the finer level are one to two pixels wide; the paper's are half of that. Half as many lie under a footprint.
//! - The weight has the variance of a square pixel where cells are small, and is never narrower than a Gaussian of 0.39 cells
//!   (Heckbert's reconstruction filter). Every footprint, of zero area too, then covers a cell centre, and magnified cells
//!   blend. The two widths pass into each other by the fourth powers' sum, not by the squares': what cells blur by
//!   themselves the pixel need not blur again.
//! - Rows of cells and the span of each row come from the ellipse, so each cell inside is visited once and none outside.
//!   The authors walk the bounding box and stop after 100 cells, which loses weight. The number of cells is bounded by
//!   the clamped anisotropy alone, see [`super::quality::max_cells`]. Rows and columns are one loop, not two: pixels that run
//!   side by side then wait for the one with most cells, not in each row for its longest.
//!
//! Lengths are in cells of level 0; one surface unit has 2^(levels − 1) of them a side.

use super::baked::Tables;
use crate::brdf::{facet_brdf, half_vector, normal_to_slope, sdf_to_ndf};
use crate::footprint::{PixelOnSurface, pixel_axes};
use crate::hash::{CellState, cell_state_in_row, draw_bits, draw_uniform, row_key};
use glam::{IVec2, Vec2, Vec3};

/// Target: Beckmann.
pub const TARGET_BECKMANN: u32 = 0;
/// Target: GGX.
pub const TARGET_GGX: u32 = 1;

const PI: f32 = std::f32::consts::PI;
const DRAW_COVERAGE: u32 = 0;
const DRAW_DENSITY_RADIUS: u32 = 1;
const DRAW_DENSITY_ANGLE: u32 = 2;
const DRAW_COLOUR: u32 = 3;
/// Coarsest level of the cell hierarchy. Pixels wider than half a cell of that level count as that wide.
pub const MAX_CELL_LEVEL: u32 = 24;
/// Largest ratio of the axes that can be asked for.
pub const MAX_ANISOTROPY: f32 = 16.0;
/// Squared radius, in pixels, of the footprint: the weight's variance along an axis is an eighth of it, a square pixel's 1/12.
pub const PIXEL_RADIUS2: f32 = 2.0 / 3.0;
/// Least squared radius in cells: beyond ½, so that a centre lies within wherever the footprint is.
pub const RECONSTRUCTION_RADIUS2: f32 = 0.6;

/// What a material asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct DictionaryMaterial {
    /// Roughness α_x, α_y along the tangent axes, 1e-3 to 1 (larger works too).
    pub alpha: Vec2,
    /// [`TARGET_BECKMANN`] or [`TARGET_GGX`].
    pub normal_target: u32,
    /// Facets ρ on one unit of surface area, 0 to 1e16 and beyond.
    pub density: f32,
    /// Share β of the surface that glints, 0 to 1.
    pub relative_area: f32,
    /// Density randomisation ζ: standard deviation of a cell's level.
    pub density_randomisation: f32,
    /// Largest ratio γ of the footprint's axes, 1 to [`MAX_ANISOTROPY`].
    pub max_anisotropy: f32,
    /// Surfaces with different seeds have different glints.
    pub seed: u32,
    /// Glint colours, linear RGB; none means white.
    pub colours: Vec<Vec3>,
    /// Mean of the colours, white if there are none.
    pub mean_colour: Vec3,
}

/// A sum of weighted slope distributions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeSum {
    /// Density over slopes, by colour.
    pub sdf: Vec3,
    /// Share of the footprint that glints; the base material belongs on the rest.
    pub coverage: f32,
    /// Cells visited.
    pub cells: u32,
}

/// Pixel footprint on the surface: an ellipse, and its level of detail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFootprint {
    /// Squared radius along the major axis, cells².
    pub major2: f32,
    /// Squared radius along the minor axis, cells².
    pub minor2: f32,
    /// Cosine and sine of twice the major axis's angle; zero if there is none.
    pub direction: Vec2,
    /// Level at which a pixel is half a cell wide, in 0 to [`MAX_CELL_LEVEL`].
    pub lod: f32,
}

/// The footprint in cells of one level: an ellipse around `centre`, which is relative to the corner of the base cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelWindow {
    /// Column and row of the base cell.
    pub base: IVec2,
    /// Centre of the footprint from the corner of the base cell, 0 to 1.
    pub centre: Vec2,
    /// Columns by which the middle of a row moves with each row.
    pub shear: f32,
    /// Inverse of the squared radius along y, 1/cells².
    pub inverse_yy: f32,
    /// Squared half length of the row through the centre, cells².
    pub half2: f32,
    /// Inverse of that, 1/cells².
    pub inverse_half2: f32,
    /// First row that may hold a cell centre, relative to the base cell.
    pub first_row: i32,
    /// Last such row.
    pub last_row: i32,
}

/// The part of a row that lies in the footprint's ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowSpan {
    /// Column, relative to the base cell, whose centre would be the middle of the row.
    pub middle: f32,
    /// 1 − r² in the middle, r the elliptic radius; 0 if the row is outside.
    pub rim: f32,
    /// First column whose centre lies in the ellipse, relative to the base cell.
    pub first: i32,
    /// Last such column; none if it is below the first.
    pub last: i32,
}

/// A slope as all cells see it: what of a look-up does not depend on the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeQuery {
    /// Slope in the dictionary's plane, before the cell's rotation.
    pub in_dict: Vec2,
    /// Squared slope in units of the dictionary's roughness.
    pub q_dict: f32,
    /// From the dictionary's density to that of the material.
    pub jacobian: f32,
    /// The smooth target.
    pub smooth_sdf: f32,
    /// Whether the slope lies beyond the tables however it is turned, so that cells below the smooth level have density 0.
    pub outside: bool,
}

/// Slope distribution of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellSdf {
    /// Density over slopes, by colour.
    pub sdf: Vec3,
    /// 1 or 0 as the cell glints or not.
    pub covered: f32,
}

/// A pixel's BRDF and what of it is left to the base material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchBrdf {
    /// BRDF, by colour, already weighted by the coverage.
    pub value: Vec3,
    /// Share of the footprint that glints.
    pub coverage: f32,
    /// Cells visited.
    pub cells: u32,
}

/// Footprint of the derivatives of the surface position along the two screen axes, in cells of level 0 a pixel. The minor radius
/// grows until the axes are at most `max_anisotropy` (1 to [`MAX_ANISOTROPY`]) apart, so the pixel is blurred rather
/// than cut.
pub fn pixel_footprint(d_dx: Vec2, d_dy: Vec2, max_anisotropy: f32) -> PixelFootprint {
    let axes = pixel_axes(d_dx, d_dy);
    let (mut major2, mut minor2) = (axes.major2, axes.minor2);
    let ratio = max_anisotropy.clamp(1.0, MAX_ANISOTROPY);
    minor2 = minor2.max(major2 / (ratio * ratio)).min(major2);

    let coarsest = ((MAX_CELL_LEVEL - 1) as f32).exp2();
    let shrink = (coarsest * coarsest / minor2.max(1.0e-30)).min(1.0);
    major2 *= shrink;
    minor2 *= shrink;
    let mut direction = Vec2::ZERO;
    if axes.gap > 0.0 {
        direction = axes.difference / axes.gap;
    }
    PixelFootprint {
        major2: PIXEL_RADIUS2 * major2,
        minor2: PIXEL_RADIUS2 * minor2,
        direction,
        lod: 0.5 * (4.0 * minor2).max(1.0).log2(),
    }
}

/// Squared radius of the weight in cells², of a footprint whose squared radius is `radius2`.
pub fn widened(radius2: f32) -> f32 {
    (radius2 * radius2 + RECONSTRUCTION_RADIUS2 * RECONSTRUCTION_RADIUS2).sqrt()
}

/// The footprint around `position` (in cells of level 0) at a whole level.
pub fn level_window(footprint: PixelFootprint, position: Vec2, level: u32) -> LevelWindow {
    let scale = (-(level as f32)).exp2();
    let limit = 1.0e9;
    let p = Vec2::new((position.x * scale).clamp(-limit, limit), (position.y * scale).clamp(-limit, limit));
    let base = Vec2::new(p.x.floor(), p.y.floor());
    let centre = Vec2::new(p.x - base.x, p.y - base.y);
    let major2 = widened(footprint.major2 * scale * scale);
    let minor2 = widened(footprint.minor2 * scale * scale);
    let mean = 0.5 * (major2 + minor2);
    let spread = 0.5 * (major2 - minor2);
    let xx = mean + spread * footprint.direction.x;
    let xy = spread * footprint.direction.y;
    let yy = mean - spread * footprint.direction.x;
    let reach = yy.sqrt();
    let inverse_yy = 1.0 / yy;
    let shear = xy * inverse_yy;
    let half2 = (xx - xy * shear).max(RECONSTRUCTION_RADIUS2);
    LevelWindow {
        base: base.as_ivec2(),
        centre,
        shear,
        inverse_yy,
        half2,
        inverse_half2: 1.0 / half2,
        first_row: (centre.y - reach - 0.5).ceil() as i32,
        last_row: (centre.y + reach - 0.5).floor() as i32,
    }
}

/// The columns of `row`, counted from the base cell, whose centres lie in the ellipse.
pub fn row_span(window: LevelWindow, row: i32) -> RowSpan {
    let dy = row as f32 + 0.5 - window.centre.y;
    let middle = window.centre.x - 0.5 + window.shear * dy;
    let rim = (1.0 - dy * dy * window.inverse_yy).max(0.0);
    let half = (rim * window.half2).sqrt();
    RowSpan { middle, rim, first: (middle - half).ceil() as i32, last: (middle + half).floor() as i32 }
}

/// Weight, not yet normalised, of a cell of a row by its column, counted from the base cell. Zero at the rim and beyond.
pub fn cell_weight(window: LevelWindow, span: RowSpan, column: i32) -> f32 {
    let dx = column as f32 - span.middle;
    let inside = (span.rim - dx * dx * window.inverse_half2).max(0.0);
    inside * inside
}

/// ln(1 + x) / x for x ≥ 0, accurate for small x too.
pub fn log1p_over_x(x: f32) -> f32 {
    if x > 0.3 {
        return (1.0 + x).ln() / x;
    }
    let d = 1.0 / (2.0 + x);
    let s = x * d;
    let s2 = s * s;
    2.0 * d * (1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0))))
}

/// Slope in units of the roughness, with its squared length kept finite.
pub fn scaled_slope(material: &DictionaryMaterial, slope: Vec2) -> Vec2 {
    let limit = 1.0e12;
    Vec2::new((slope.x / material.alpha.x).clamp(-limit, limit), (slope.y / material.alpha.y).clamp(-limit, limit))
}

/// The smooth target at a slope.
pub fn smooth_sdf(material: &DictionaryMaterial, slope: Vec2) -> f32 {
    let v = scaled_slope(material, slope);
    let q = v.x * v.x + v.y * v.y;
    let area = PI * material.alpha.x * material.alpha.y;
    if material.normal_target == TARGET_GGX {
        return 1.0 / (area * (1.0 + q) * (1.0 + q));
    }
    (-q).exp() / area
}

/// Marginal P(x) at a level below `levels`, for x ≥ 0: linear filtering with clamp to edge, zero beyond the domain.
pub fn marginal(tables: &Tables, index: u32, level: u32, x: f32) -> f32 {
    if x >= tables.domain {
        return 0.0;
    }
    let place = (x * tables.inv_spacing - 0.5).clamp(0.0, (tables.entries - 1) as f32);
    tables.filtered(level * tables.marginals + index, place)
}

/// Level for n facets a cell, n given by its logarithm to base 2, before rounding: ½ log₂ n.
pub fn facet_level(tables: &Tables, material: &DictionaryMaterial, cell_level: u32) -> f32 {
    let cells_above = (tables.levels - 1) as f32 - cell_level as f32;
    0.5 * material.density.max(1.0e-30).log2() - cells_above
}

/// Cosine and sine, within 1.1e-5, of the angle between −π/4 and π/4 that a random word stands for.
pub fn cell_rotation(bits: u32) -> Vec2 {
    let angle = (bits >> 8) as f32 * (0.5 * PI / 16_777_216.0) - 0.25 * PI;
    let s = angle * angle;
    let cosine = 0.999_990_04 + s * (-0.499_708_16 + s * 0.040_398_57);
    let sine = angle * (0.999_995 + s * (-0.166_601_62 + s * 0.008_121_56));
    Vec2::new(cosine, sine)
}

/// Index below `count` from the upper 16 bits of a random word.
pub fn pick(count: u32, bits: u32) -> u32 {
    ((bits >> 16) * count) >> 16
}

/// Colour of a cell's glint, of a material that has colours: the cell's own colour while a facet or less is lit, the mean of all where many are.
pub fn colour(tables: &Tables, material: &DictionaryMaterial, bits: u32, level: u32, q_dict: f32) -> Vec3 {
    let own = material.colours[pick(material.colours.len() as u32, bits) as usize];
    let density = (-q_dict).exp() / (PI * tables.alpha_dict * tables.alpha_dict);
    let lit = (2.0 * (level as f32 + 1.0)).exp2() * tables.lobe_area * density;
    let share = 1.0 / lit.max(1.0).sqrt();
    material.mean_colour + (own - material.mean_colour) * share
}

/// The query for a slope of a material.
pub fn slope_query(tables: &Tables, material: &DictionaryMaterial, slope: Vec2) -> SlopeQuery {
    let v = scaled_slope(material, slope);
    let q = v.x * v.x + v.y * v.y;
    let mut stretch = tables.alpha_dict;
    let mut jacobian = tables.alpha_dict * tables.alpha_dict / (material.alpha.x * material.alpha.y);
    let mut q_dict = q;
    if material.normal_target == TARGET_GGX {
        let ratio = log1p_over_x(q);
        stretch *= ratio.sqrt();
        q_dict = q * ratio;
        jacobian /= 1.0 + q;
    }
    let in_dict = v * stretch;
    // The larger component of what is turned is its length over √2 at least; rounding takes less than is added.
    let farthest = 1.414_4 * tables.domain;
    let outside = in_dict.x * in_dict.x + in_dict.y * in_dict.y >= farthest * farthest;
    SlopeQuery { in_dict, q_dict, jacobian, smooth_sdf: smooth_sdf(material, slope), outside }
}

/// Slope distribution of one cell (Eq. 11): `state` is that of the cell's coherent index (Eq. 8), its first
/// cell of level 0.
pub fn cell_sdf(
    tables: &Tables,
    material: &DictionaryMaterial,
    state: CellState,
    facet_level: f32,
    query: &SlopeQuery,
) -> CellSdf {
    if material.relative_area < 1.0 && draw_uniform(state, DRAW_COVERAGE) >= material.relative_area {
        return CellSdf { sdf: Vec3::ZERO, covered: 0.0 };
    }
    let mut wished = facet_level;
    if material.density_randomisation > 0.0 {
        let radius = (-2.0 * (1.0 - draw_uniform(state, DRAW_DENSITY_RADIUS)).ln()).sqrt();
        let normal = radius * (2.0 * PI * draw_uniform(state, DRAW_DENSITY_ANGLE)).cos();
        wished += material.density_randomisation * normal;
    }
    let level = (wished + 0.5).floor().clamp(0.0, tables.levels as f32) as u32;
    if level == tables.levels {
        return CellSdf { sdf: material.mean_colour * query.smooth_sdf, covered: 1.0 };
    }

    let turn = cell_rotation(state.a);
    let px = turn.x * query.in_dict.x + turn.y * query.in_dict.y;
    let py = turn.x * query.in_dict.y - turn.y * query.in_dict.x;
    let i = pick(tables.marginals, state.b);
    let j = pick(tables.marginals, state.b << 16);
    let sdf = marginal(tables, i, level, px.abs()) * marginal(tables, j, level, py.abs()) * query.jacobian;
    if material.colours.is_empty() {
        return CellSdf { sdf: Vec3::splat(sdf), covered: 1.0 };
    }
    let colour = colour(tables, material, draw_bits(state, DRAW_COLOUR), level, query.q_dict);
    CellSdf { sdf: colour * sdf, covered: 1.0 }
}

/// Slope distribution of the footprint at one whole level (algorithm 2), its weights normalised.
pub fn level_sdf(
    tables: &Tables,
    material: &DictionaryMaterial,
    footprint: PixelFootprint,
    position: Vec2,
    level: u32,
    query: &SlopeQuery,
) -> SlopeSum {
    let count_level = facet_level(tables, material, level);
    // The normal number of a cell's density is within 5.8.
    let spread = 6.0 * material.density_randomisation;
    let last = tables.levels as f32 - 0.5;
    if material.relative_area >= 1.0 && count_level - spread >= last {
        return SlopeSum { sdf: material.mean_colour * query.smooth_sdf, coverage: 1.0, cells: 0 };
    }
    if material.relative_area >= 1.0 && query.outside && count_level + spread < last {
        return SlopeSum { sdf: Vec3::ZERO, coverage: 1.0, cells: 0 };
    }
    let window = level_window(footprint, position, level);
    let mut sdf = Vec3::ZERO;
    let mut coverage = 0.0;
    let mut total = 0.0;
    let mut cells = 0;
    let mut row = window.first_row - 1;
    let mut span = RowSpan { middle: 0.0, rim: 0.0, first: 0, last: -1 };
    let mut column = 0;
    let mut y = 0;
    let mut key = 0;
    loop {
        if column > span.last {
            row += 1;
            if row > window.last_row {
                break;
            }
            span = row_span(window, row);
            column = span.first;
            y = (window.base.y.wrapping_add(row) as u32) << level;
            key = row_key(y, material.seed);
        }
        // A row near the rim may hold no centre.
        if column <= span.last {
            let weight = cell_weight(window, span, column);
            let x = (window.base.x.wrapping_add(column) as u32) << level;
            let state = cell_state_in_row(x, y, key, material.seed);
            let cell = cell_sdf(tables, material, state, count_level, query);
            sdf += cell.sdf * weight;
            coverage += cell.covered * weight;
            total += weight;
            cells += 1;
            column += 1;
        }
    }
    SlopeSum { sdf: sdf / total, coverage: coverage / total, cells }
}

/// Slope distribution of a pixel (Eq. 12) at the slope of the half vector.
pub fn patch_sdf(tables: &Tables, material: &DictionaryMaterial, pixel: PixelOnSurface, slope: Vec2) -> SlopeSum {
    let cells_per_unit = ((tables.levels - 1) as f32).exp2();
    let footprint = pixel_footprint(pixel.d_dx * cells_per_unit, pixel.d_dy * cells_per_unit, material.max_anisotropy);
    let fine = footprint.lod.floor().min((MAX_CELL_LEVEL - 1) as f32);
    let blend = footprint.lod - fine;
    let position = pixel.position * cells_per_unit;
    let query = slope_query(tables, material, slope);
    let a = level_sdf(tables, material, footprint, position, fine as u32, &query);
    let b = level_sdf(tables, material, footprint, position, fine as u32 + 1, &query);
    SlopeSum {
        sdf: a.sdf + (b.sdf - a.sdf) * blend,
        coverage: a.coverage + (b.coverage - a.coverage) * blend,
        cells: a.cells + b.cells,
    }
}

/// BRDF of a pixel (Eq. 14, algorithm 1) for unit directions to the viewer and the light, in the tangent frame. Zero if either
/// is not above the surface.
pub fn patch_brdf(
    tables: &Tables,
    material: &DictionaryMaterial,
    f0: Vec3,
    pixel: PixelOnSurface,
    view: Vec3,
    light: Vec3,
) -> PatchBrdf {
    let half = half_vector(view, light);
    let sum = patch_sdf(tables, material, pixel, normal_to_slope(half));
    let value = facet_brdf(sdf_to_ndf(sum.sdf, half.z), f0, view, light);
    PatchBrdf { value, coverage: sum.coverage, cells: sum.cells }
}
