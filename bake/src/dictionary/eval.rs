//! Slope distribution of a pixel at run time. f32, plain functions, as in WGSL.
//!
//! Paper: sections 5 and 6.1, Eq. 7 to 12, algorithms 2 and 3. Deviations:
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

use super::cells::{MAX_CELL_LEVEL, PixelFootprint, cell_weight, level_window, pixel_footprint, row_span};
use super::tables::Tables;
use crate::brdf::{facet_brdf, half_vector, normal_to_slope, sdf_to_ndf};
use crate::hash::{CellState, cell_state_in_row, draw_bits, draw_uniform, row_key};
use glam::{Vec2, Vec3};

/// Target: Beckmann.
pub const TARGET_BECKMANN: u32 = 0;
/// Target: GGX.
pub const TARGET_GGX: u32 = 1;

const PI: f32 = std::f32::consts::PI;
const DRAW_COVERAGE: u32 = 0;
const DRAW_DENSITY_RADIUS: u32 = 1;
const DRAW_DENSITY_ANGLE: u32 = 2;
const DRAW_COLOUR: u32 = 3;

/// What a material asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct GlintMaterial {
    /// Roughness α_x, α_y along the tangent axes, 1e-3 to 1 (larger works too).
    pub alpha: Vec2,
    /// [`TARGET_BECKMANN`] or [`TARGET_GGX`].
    pub target: u32,
    /// Facets ρ on one unit of surface area, 0 to 1e16 and beyond.
    pub density: f32,
    /// Share β of the surface that glints, 0 to 1.
    pub relative_area: f32,
    /// Density randomisation ζ: standard deviation of a cell's level.
    pub density_randomisation: f32,
    /// Largest ratio γ of the footprint's axes, 1 to [`super::cells::MAX_ANISOTROPY`].
    pub max_anisotropy: f32,
    /// Surfaces with different seeds have different glints.
    pub seed: u32,
    /// Glint colours, linear RGB; none means white.
    pub colours: Vec<Vec3>,
    /// Mean of the colours, white if there are none.
    pub mean_colour: Vec3,
}

/// Where a pixel lies on the surface, in surface units (those of the density).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelOnSurface {
    /// Surface position at the pixel's centre.
    pub position: Vec2,
    /// Its derivative along the screen's x axis, a pixel.
    pub d_dx: Vec2,
    /// Its derivative along the screen's y axis, a pixel.
    pub d_dy: Vec2,
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
pub fn scaled_slope(material: &GlintMaterial, slope: Vec2) -> Vec2 {
    let limit = 1.0e12;
    Vec2::new((slope.x / material.alpha.x).clamp(-limit, limit), (slope.y / material.alpha.y).clamp(-limit, limit))
}

/// The smooth target at a slope.
pub fn smooth_sdf(material: &GlintMaterial, slope: Vec2) -> f32 {
    let v = scaled_slope(material, slope);
    let q = v.x * v.x + v.y * v.y;
    let area = PI * material.alpha.x * material.alpha.y;
    if material.target == TARGET_GGX {
        return 1.0 / (area * (1.0 + q) * (1.0 + q));
    }
    (-q).exp() / area
}

/// Marginal P(x) at a level below `levels`, for x ≥ 0: linear filtering with clamp to edge, zero beyond the domain.
pub fn marginal(tables: &Tables, index: u32, level: u32, x: f32) -> f32 {
    if x >= tables.domain {
        return 0.0;
    }
    let t = (x * tables.inv_spacing - 0.5).clamp(0.0, (tables.entries - 1) as f32);
    let low = t.floor();
    let f = t - low;
    let row = (level * tables.marginals + index) * tables.entries;
    let b0 = low as u32;
    let b1 = (b0 + 1).min(tables.entries - 1);
    let v0 = tables.texels[(row + b0) as usize];
    let v1 = tables.texels[(row + b1) as usize];
    v0 + (v1 - v0) * f
}

/// Level for n facets a cell, n given by its logarithm to base 2, before rounding: ½ log₂ n.
pub fn facet_level(tables: &Tables, material: &GlintMaterial, cell_level: u32) -> f32 {
    let cells_above = (tables.levels - 1) as f32 - cell_level as f32;
    0.5 * material.density.max(1.0e-30).log2() - cells_above
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
    pub smooth: f32,
}

/// The query for a slope of a material.
pub fn slope_query(tables: &Tables, material: &GlintMaterial, slope: Vec2) -> SlopeQuery {
    let v = scaled_slope(material, slope);
    let q = v.x * v.x + v.y * v.y;
    let mut stretch = tables.alpha_dict;
    let mut jacobian = tables.alpha_dict * tables.alpha_dict / (material.alpha.x * material.alpha.y);
    let mut q_dict = q;
    if material.target == TARGET_GGX {
        let ratio = log1p_over_x(q);
        stretch *= ratio.sqrt();
        q_dict = q * ratio;
        jacobian /= 1.0 + q;
    }
    SlopeQuery { in_dict: v * stretch, q_dict, jacobian, smooth: smooth_sdf(material, slope) }
}

/// Slope distribution of one cell (Eq. 11): density by colour, and 1 or 0 as the cell glints or not. `state` is that of
/// the cell's coherent index (Eq. 8), its first cell of level 0.
pub fn cell_sdf(
    tables: &Tables,
    material: &GlintMaterial,
    state: CellState,
    facet_level: f32,
    query: &SlopeQuery,
) -> (Vec3, f32) {
    if material.relative_area < 1.0 && draw_uniform(state, DRAW_COVERAGE) >= material.relative_area {
        return (Vec3::ZERO, 0.0);
    }
    let mut wished = facet_level;
    if material.density_randomisation > 0.0 {
        let radius = (-2.0 * (1.0 - draw_uniform(state, DRAW_DENSITY_RADIUS)).ln()).sqrt();
        let normal = radius * (2.0 * PI * draw_uniform(state, DRAW_DENSITY_ANGLE)).cos();
        wished += material.density_randomisation * normal;
    }
    let level = (wished + 0.5).floor().clamp(0.0, tables.levels as f32) as u32;
    if level == tables.levels {
        return (material.mean_colour * query.smooth, 1.0);
    }

    let turn = cell_rotation(state.a);
    let px = turn.x * query.in_dict.x + turn.y * query.in_dict.y;
    let py = turn.x * query.in_dict.y - turn.y * query.in_dict.x;
    let i = pick(tables.marginals, state.b);
    let j = pick(tables.marginals, state.b << 16);
    let sdf = marginal(tables, i, level, px.abs()) * marginal(tables, j, level, py.abs()) * query.jacobian;
    if material.colours.is_empty() {
        return (Vec3::splat(sdf), 1.0);
    }
    (glint_colour(tables, material, draw_bits(state, DRAW_COLOUR), level, query.q_dict) * sdf, 1.0)
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
pub fn glint_colour(tables: &Tables, material: &GlintMaterial, bits: u32, level: u32, q_dict: f32) -> Vec3 {
    let own = material.colours[pick(material.colours.len() as u32, bits) as usize];
    let density = (-q_dict).exp() / (PI * tables.alpha_dict * tables.alpha_dict);
    let lit = (2.0 * (level as f32 + 1.0)).exp2() * tables.lobe_area * density;
    let share = 1.0 / lit.max(1.0).sqrt();
    material.mean_colour + (own - material.mean_colour) * share
}

/// Slope distribution of the footprint at one whole level (algorithm 2), its weights normalised.
pub fn level_sdf(
    tables: &Tables,
    material: &GlintMaterial,
    footprint: PixelFootprint,
    position: Vec2,
    level: u32,
    query: &SlopeQuery,
) -> SlopeSum {
    let count_level = facet_level(tables, material, level);
    if count_level - 6.0 * material.density_randomisation >= tables.levels as f32 - 0.5 && material.relative_area >= 1.0
    {
        return SlopeSum { sdf: material.mean_colour * query.smooth, coverage: 1.0, cells: 0 };
    }
    let window = level_window(footprint, position, level);
    let mut sdf = Vec3::ZERO;
    let mut coverage = 0.0;
    let mut total = 0.0;
    let mut cells = 0;
    for row in window.first_row..=window.last_row {
        let (first, last) = row_span(window, row);
        let y = (window.base_y.wrapping_add(row) as u32) << level;
        let key = row_key(y, material.seed);
        for column in first..=last {
            let weight = cell_weight(window, column, row);
            let x = (window.base_x.wrapping_add(column) as u32) << level;
            let state = cell_state_in_row(x, y, key, material.seed);
            let (cell, covered) = cell_sdf(tables, material, state, count_level, query);
            sdf += cell * weight;
            coverage += covered * weight;
            total += weight;
            cells += 1;
        }
    }
    SlopeSum { sdf: sdf / total, coverage: coverage / total, cells }
}

/// Slope distribution of a pixel (Eq. 12) at the slope of the half vector.
pub fn patch_sdf(tables: &Tables, material: &GlintMaterial, pixel: PixelOnSurface, slope: Vec2) -> SlopeSum {
    let cells_per_unit = ((tables.levels - 1) as f32).exp2();
    let d_dx = pixel.d_dx * cells_per_unit;
    let d_dy = pixel.d_dy * cells_per_unit;
    let footprint = pixel_footprint(d_dx, d_dy, material.max_anisotropy);
    let fine = footprint.lod.floor().min((MAX_CELL_LEVEL - 1) as f32);
    let blend = footprint.lod - fine;
    let cell_position = pixel.position * cells_per_unit;
    let query = slope_query(tables, material, slope);
    let a = level_sdf(tables, material, footprint, cell_position, fine as u32, &query);
    let b = level_sdf(tables, material, footprint, cell_position, fine as u32 + 1, &query);
    SlopeSum {
        sdf: a.sdf + (b.sdf - a.sdf) * blend,
        coverage: a.coverage + (b.coverage - a.coverage) * blend,
        cells: a.cells + b.cells,
    }
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

/// BRDF of a pixel (Eq. 14, algorithm 1) for unit directions to the viewer and the light, in the tangent frame. Zero if either
/// is not above the surface.
pub fn patch_brdf(
    tables: &Tables,
    material: &GlintMaterial,
    f0: Vec3,
    pixel: PixelOnSurface,
    view: Vec3,
    light: Vec3,
) -> PatchBrdf {
    if !(view.z > 0.0 && light.z > 0.0) {
        return PatchBrdf { value: Vec3::ZERO, coverage: 0.0, cells: 0 };
    }
    let half = half_vector(view, light);
    let slopes = patch_sdf(tables, material, pixel, normal_to_slope(half));
    let value = facet_brdf(sdf_to_ndf(slopes.sdf, half.z), f0, view, light);
    PatchBrdf { value, coverage: slopes.coverage, cells: slopes.cells }
}
