// Dictionary of 1D marginal slope distributions: slope distribution and BRDF of a pixel.
// Chermain et al. 2020, "Procedural Physically based BRDF for Real-Time Rendering of Glints", sections 5 and 6, Eq. 7 to 16.
// Twin of eval.rs, where deviations from the paper are derived.
//
// Accessors that the including program defines:
//   fn glint_dictionary_filtered(row: u32, place: f32) -> f32
//       row `level * marginals + marginal` of the table (section SDTB) at `place` entries from the centre of its first one, from
//       0 to entries - 1, linearly filtered
//   fn glint_dictionary_colour(index: u32) -> vec3f          glint colour, linear RGB; called only if material.colours > 0

#import brdf
#import footprint
#import hash

const GLINT_TARGET_BECKMANN: u32 = 0u;
const GLINT_TARGET_GGX: u32 = 1u;
// Coarsest level of the cell hierarchy.
const GLINT_MAX_CELL_LEVEL: u32 = 24u;
const GLINT_MAX_ANISOTROPY: f32 = 16.0;
// Squared radius, in pixels, of the footprint: its weight has a square pixel's variance.
const GLINT_PIXEL_RADIUS2: f32 = 0.6666667;
// Least squared radius in cells.
const GLINT_RECONSTRUCTION_RADIUS2: f32 = 0.6;
const GLINT_PI: f32 = 3.14159265;

const GLINT_DRAW_COVERAGE: u32 = 0u;
const GLINT_DRAW_DENSITY_RADIUS: u32 = 1u;
const GLINT_DRAW_DENSITY_ANGLE: u32 = 2u;
const GLINT_DRAW_COLOUR: u32 = 3u;

// Shape of the tables: section SDUB.
struct GlintDictionaryTables {
    marginals: u32,
    // This level itself is the smooth target.
    levels: u32,
    entries: u32,
    // Roughness of the target of the tables.
    alpha_dict: f32,
    // Slope at which the tables end.
    domain: f32,
    // entries / domain.
    inv_spacing: f32,
    // Slope area that a lobe fills, 4 pi lobe_std^2.
    lobe_area: f32,
    unused: u32,
}

struct GlintDictionaryMaterial {
    // Roughness along the tangent axes, 1e-3 to 1.
    alpha: vec2f,
    // GLINT_TARGET_BECKMANN or GLINT_TARGET_GGX.
    normal_target: u32,
    // Facets on one unit of surface area.
    density: f32,
    // Share of the surface that glints, 0 to 1.
    relative_area: f32,
    // Standard deviation of a cell's level.
    density_randomisation: f32,
    // Largest ratio of the footprint's axes, 1 to 16.
    max_anisotropy: f32,
    seed: u32,
    // Number of glint colours; 0 means white.
    colours: u32,
    // Mean of the colours, white if there are none.
    mean_colour: vec3f,
}

// A sum of weighted slope distributions.
struct GlintSlopeSum {
    // Density over slopes, by colour.
    sdf: vec3f,
    // Share of the footprint that glints.
    coverage: f32,
    // Cells visited.
    cells: u32,
}

// An ellipse, its squared radii in cells^2.
struct GlintPixelFootprint {
    major2: f32,
    minor2: f32,
    // Cosine and sine of twice the major axis's angle; zero if there is none.
    direction: vec2f,
    // Level at which a pixel is half a cell wide.
    lod: f32,
}

// The footprint in cells of one level: an ellipse around `centre`, relative to the corner of the base cell.
struct GlintLevelWindow {
    base: vec2i,
    centre: vec2f,
    // Columns by which the middle of a row moves with each row.
    shear: f32,
    // Inverse of the squared radius along y.
    inverse_yy: f32,
    // Squared half length of the row through the centre.
    half2: f32,
    // Inverse of that.
    inverse_half2: f32,
    first_row: i32,
    last_row: i32,
}

// The part of a row that lies in the footprint's ellipse. Columns are relative to the base cell.
struct GlintRowSpan {
    // Column whose centre would be the middle of the row.
    middle: f32,
    // 1 - r^2 in the middle, r the elliptic radius; 0 if the row is outside.
    rim: f32,
    // First and last column whose centres lie in the ellipse; none if the last is below the first.
    first: i32,
    last: i32,
}

// A slope as all cells see it.
struct GlintSlopeQuery {
    // Slope in the dictionary's plane, before the cell's rotation.
    in_dict: vec2f,
    // Squared slope in units of the dictionary's roughness.
    q_dict: f32,
    // From the dictionary's density to that of the material.
    jacobian: f32,
    // The smooth target.
    smooth_sdf: f32,
    // Whether cells below the smooth level have density 0, however they are turned.
    outside: bool,
}

// Slope distribution of one cell.
struct GlintCellSdf {
    // Density over slopes, by colour.
    sdf: vec3f,
    // 1 or 0 as the cell glints or not.
    covered: f32,
}

// A pixel's BRDF and what of it is left to the base material.
struct GlintPatchBrdf {
    // BRDF, by colour, already weighted by the coverage.
    value: vec3f,
    // Share of the footprint that glints.
    coverage: f32,
    // Cells visited.
    cells: u32,
}

// Footprint of the derivatives of the surface position along the screen axes, in cells of level 0 a pixel.
fn glint_pixel_footprint(d_dx: vec2f, d_dy: vec2f, max_anisotropy: f32) -> GlintPixelFootprint {
    let axes = glint_pixel_axes(d_dx, d_dy);
    var major2 = axes.major2;
    var minor2 = axes.minor2;
    let ratio = clamp(max_anisotropy, 1.0, GLINT_MAX_ANISOTROPY);
    minor2 = min(max(minor2, major2 / (ratio * ratio)), major2);

    let coarsest = exp2(f32(GLINT_MAX_CELL_LEVEL - 1u));
    let shrink = min(coarsest * coarsest / max(minor2, 1.0e-30), 1.0);
    major2 *= shrink;
    minor2 *= shrink;
    var direction = vec2f(0.0);
    if axes.gap > 0.0 {
        direction = axes.difference / axes.gap;
    }
    return GlintPixelFootprint(
        GLINT_PIXEL_RADIUS2 * major2,
        GLINT_PIXEL_RADIUS2 * minor2,
        direction,
        0.5 * log2(max(4.0 * minor2, 1.0)),
    );
}

// Squared radius of the weight in cells^2, of a footprint whose squared radius is `radius2`.
fn glint_widened(radius2: f32) -> f32 {
    return sqrt(radius2 * radius2 + GLINT_RECONSTRUCTION_RADIUS2 * GLINT_RECONSTRUCTION_RADIUS2);
}

// The footprint around `position` (in cells of level 0) at a whole level.
fn glint_level_window(footprint: GlintPixelFootprint, position: vec2f, level: u32) -> GlintLevelWindow {
    let scale = exp2(-f32(level));
    let limit = vec2f(1.0e9);
    let p = clamp(position * scale, -limit, limit);
    let base = floor(p);
    let centre = p - base;
    let major2 = glint_widened(footprint.major2 * scale * scale);
    let minor2 = glint_widened(footprint.minor2 * scale * scale);
    let mean = 0.5 * (major2 + minor2);
    let spread = 0.5 * (major2 - minor2);
    let xx = mean + spread * footprint.direction.x;
    let xy = spread * footprint.direction.y;
    let yy = mean - spread * footprint.direction.x;
    let reach = sqrt(yy);
    let inverse_yy = 1.0 / yy;
    let shear = xy * inverse_yy;
    let half2 = max(xx - xy * shear, GLINT_RECONSTRUCTION_RADIUS2);
    return GlintLevelWindow(
        vec2i(base),
        centre,
        shear,
        inverse_yy,
        half2,
        1.0 / half2,
        i32(ceil(centre.y - reach - 0.5)),
        i32(floor(centre.y + reach - 0.5)),
    );
}

// The columns of a row whose centres lie in the ellipse.
fn glint_row_span(window: GlintLevelWindow, row: i32) -> GlintRowSpan {
    let dy = f32(row) + 0.5 - window.centre.y;
    let middle = window.centre.x - 0.5 + window.shear * dy;
    let rim = max(1.0 - dy * dy * window.inverse_yy, 0.0);
    let half = sqrt(rim * window.half2);
    return GlintRowSpan(middle, rim, i32(ceil(middle - half)), i32(floor(middle + half)));
}

// Weight, not yet normalised, of a cell of a row by its column.
fn glint_cell_weight(window: GlintLevelWindow, span: GlintRowSpan, column: i32) -> f32 {
    let dx = f32(column) - span.middle;
    let inside = max(span.rim - dx * dx * window.inverse_half2, 0.0);
    return inside * inside;
}

// ln(1 + x) / x for x >= 0, accurate for small x too.
fn glint_log1p_over_x(x: f32) -> f32 {
    if x > 0.3 {
        return log(1.0 + x) / x;
    }
    let d = 1.0 / (2.0 + x);
    let s = x * d;
    let s2 = s * s;
    return 2.0 * d * (1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0))));
}

// Slope in units of the roughness, with its squared length kept finite.
fn glint_scaled_slope(material: GlintDictionaryMaterial, slope: vec2f) -> vec2f {
    let limit = vec2f(1.0e12);
    return clamp(slope / material.alpha, -limit, limit);
}

// The smooth target at a slope.
fn glint_smooth_sdf(material: GlintDictionaryMaterial, slope: vec2f) -> f32 {
    let v = glint_scaled_slope(material, slope);
    let q = v.x * v.x + v.y * v.y;
    let area = GLINT_PI * material.alpha.x * material.alpha.y;
    if material.normal_target == GLINT_TARGET_GGX {
        return 1.0 / (area * (1.0 + q) * (1.0 + q));
    }
    return exp(-q) / area;
}

// Marginal P(x) at a level below `levels`, for x >= 0: linear filtering with clamp to edge, zero beyond the domain.
fn glint_marginal(tables: GlintDictionaryTables, index: u32, level: u32, x: f32) -> f32 {
    if x >= tables.domain {
        return 0.0;
    }
    let place = clamp(x * tables.inv_spacing - 0.5, 0.0, f32(tables.entries - 1u));
    return glint_dictionary_filtered(level * tables.marginals + index, place);
}

// Level for n facets a cell before rounding, 1/2 log2 n.
fn glint_facet_level(tables: GlintDictionaryTables, material: GlintDictionaryMaterial, cell_level: u32) -> f32 {
    let cells_above = f32(tables.levels - 1u) - f32(cell_level);
    return 0.5 * log2(max(material.density, 1.0e-30)) - cells_above;
}

// Cosine and sine, within 1.1e-5, of the angle between -pi/4 and pi/4 that a random word stands for.
fn glint_cell_rotation(bits: u32) -> vec2f {
    let angle = f32(bits >> 8u) * (0.5 * GLINT_PI / 16777216.0) - 0.25 * GLINT_PI;
    let s = angle * angle;
    let cosine = 0.99999004 + s * (-0.49970816 + s * 0.04039857);
    let sine = angle * (0.999995 + s * (-0.16660162 + s * 0.00812156));
    return vec2f(cosine, sine);
}

// Index below `count` from the upper 16 bits of a random word.
fn glint_pick(count: u32, bits: u32) -> u32 {
    return ((bits >> 16u) * count) >> 16u;
}

// Colour of a cell's glint, of a material that has colours: its own while a facet or less is lit, the mean of all where many are.
fn glint_colour(
    tables: GlintDictionaryTables,
    material: GlintDictionaryMaterial,
    bits: u32,
    level: u32,
    q_dict: f32,
) -> vec3f {
    let own = glint_dictionary_colour(glint_pick(material.colours, bits));
    let density = exp(-q_dict) / (GLINT_PI * tables.alpha_dict * tables.alpha_dict);
    let lit = exp2(2.0 * (f32(level) + 1.0)) * tables.lobe_area * density;
    let share = inverseSqrt(max(lit, 1.0));
    return material.mean_colour + (own - material.mean_colour) * share;
}

// The query for a slope of a material.
fn glint_slope_query(
    tables: GlintDictionaryTables,
    material: GlintDictionaryMaterial,
    slope: vec2f,
) -> GlintSlopeQuery {
    let v = glint_scaled_slope(material, slope);
    let q = v.x * v.x + v.y * v.y;
    var stretch = tables.alpha_dict;
    var jacobian = tables.alpha_dict * tables.alpha_dict / (material.alpha.x * material.alpha.y);
    var q_dict = q;
    if material.normal_target == GLINT_TARGET_GGX {
        let ratio = glint_log1p_over_x(q);
        stretch *= sqrt(ratio);
        q_dict = q * ratio;
        jacobian /= 1.0 + q;
    }
    let in_dict = v * stretch;
    let farthest = 1.4144 * tables.domain;
    let outside = in_dict.x * in_dict.x + in_dict.y * in_dict.y >= farthest * farthest;
    return GlintSlopeQuery(in_dict, q_dict, jacobian, glint_smooth_sdf(material, slope), outside);
}

// Slope distribution of one cell (Eq. 11). `state` is that of the cell's first cell of level 0 (Eq. 8).
fn glint_cell_sdf(
    tables: GlintDictionaryTables,
    material: GlintDictionaryMaterial,
    state: GlintCellState,
    facet_level: f32,
    query: GlintSlopeQuery,
) -> GlintCellSdf {
    if material.relative_area < 1.0 {
        if glint_draw_uniform(state, GLINT_DRAW_COVERAGE) >= material.relative_area {
            return GlintCellSdf(vec3f(0.0), 0.0);
        }
    }
    var wished = facet_level;
    if material.density_randomisation > 0.0 {
        let radius = sqrt(-2.0 * log(1.0 - glint_draw_uniform(state, GLINT_DRAW_DENSITY_RADIUS)));
        let normal = radius * cos(2.0 * GLINT_PI * glint_draw_uniform(state, GLINT_DRAW_DENSITY_ANGLE));
        wished += material.density_randomisation * normal;
    }
    let level = u32(clamp(floor(wished + 0.5), 0.0, f32(tables.levels)));
    if level == tables.levels {
        return GlintCellSdf(material.mean_colour * query.smooth_sdf, 1.0);
    }

    let turn = glint_cell_rotation(state.a);
    let px = turn.x * query.in_dict.x + turn.y * query.in_dict.y;
    let py = turn.x * query.in_dict.y - turn.y * query.in_dict.x;
    let i = glint_pick(tables.marginals, state.b);
    let j = glint_pick(tables.marginals, state.b << 16u);
    let sdf = glint_marginal(tables, i, level, abs(px)) * glint_marginal(tables, j, level, abs(py)) * query.jacobian;
    if material.colours == 0u {
        return GlintCellSdf(vec3f(sdf), 1.0);
    }
    let colour = glint_colour(tables, material, glint_draw_bits(state, GLINT_DRAW_COLOUR), level, query.q_dict);
    return GlintCellSdf(colour * sdf, 1.0);
}

// Slope distribution of the footprint at one whole level (algorithm 2), its weights normalised.
fn glint_level_sdf(
    tables: GlintDictionaryTables,
    material: GlintDictionaryMaterial,
    footprint: GlintPixelFootprint,
    position: vec2f,
    level: u32,
    query: GlintSlopeQuery,
) -> GlintSlopeSum {
    let count_level = glint_facet_level(tables, material, level);
    let spread = 6.0 * material.density_randomisation;
    let last = f32(tables.levels) - 0.5;
    if material.relative_area >= 1.0 && count_level - spread >= last {
        return GlintSlopeSum(material.mean_colour * query.smooth_sdf, 1.0, 0u);
    }
    if material.relative_area >= 1.0 && query.outside && count_level + spread < last {
        return GlintSlopeSum(vec3f(0.0), 1.0, 0u);
    }
    let window = glint_level_window(footprint, position, level);
    var sdf = vec3f(0.0);
    var coverage = 0.0;
    var total = 0.0;
    var cells = 0u;
    var row = window.first_row - 1;
    var span = GlintRowSpan(0.0, 0.0, 0, -1);
    var column = 0;
    var y = 0u;
    var key = 0u;
    // One loop, in which pixels side by side wait for the one with most cells, not in each row for its longest.
    loop {
        if column > span.last {
            row += 1;
            if row > window.last_row {
                break;
            }
            span = glint_row_span(window, row);
            column = span.first;
            y = u32(window.base.y + row) << level;
            key = glint_row_key(y, material.seed);
        }
        // A row near the rim may hold no centre.
        if column <= span.last {
            let weight = glint_cell_weight(window, span, column);
            let x = u32(window.base.x + column) << level;
            let state = glint_cell_state_in_row(x, y, key, material.seed);
            let cell = glint_cell_sdf(tables, material, state, count_level, query);
            sdf += cell.sdf * weight;
            coverage += cell.covered * weight;
            total += weight;
            cells += 1u;
            column += 1;
        }
    }
    return GlintSlopeSum(sdf / total, coverage / total, cells);
}

// Slope distribution of a pixel (Eq. 12) at the slope of the half vector.
fn glint_patch_sdf(
    tables: GlintDictionaryTables,
    material: GlintDictionaryMaterial,
    pixel: GlintPixelOnSurface,
    slope: vec2f,
) -> GlintSlopeSum {
    let cells_per_unit = exp2(f32(tables.levels - 1u));
    let footprint =
        glint_pixel_footprint(pixel.d_dx * cells_per_unit, pixel.d_dy * cells_per_unit, material.max_anisotropy);
    let fine = min(floor(footprint.lod), f32(GLINT_MAX_CELL_LEVEL - 1u));
    let blend = footprint.lod - fine;
    let position = pixel.position * cells_per_unit;
    let query = glint_slope_query(tables, material, slope);
    let a = glint_level_sdf(tables, material, footprint, position, u32(fine), query);
    let b = glint_level_sdf(tables, material, footprint, position, u32(fine) + 1u, query);
    return GlintSlopeSum(
        a.sdf + (b.sdf - a.sdf) * blend,
        a.coverage + (b.coverage - a.coverage) * blend,
        a.cells + b.cells,
    );
}

// BRDF of a pixel (Eq. 14, algorithm 1) for unit directions to the viewer and the light, in the tangent frame. Zero if either
// is not above the surface.
fn glint_patch_brdf(
    tables: GlintDictionaryTables,
    material: GlintDictionaryMaterial,
    f0: vec3f,
    pixel: GlintPixelOnSurface,
    view: vec3f,
    light: vec3f,
) -> GlintPatchBrdf {
    let half = glint_half_vector(view, light);
    let sum = glint_patch_sdf(tables, material, pixel, glint_normal_to_slope(half));
    let value = glint_facet_brdf(glint_sdf_to_ndf(sum.sdf, half.z), f0, view, light);
    return GlintPatchBrdf(value, sum.coverage, sum.cells);
}
