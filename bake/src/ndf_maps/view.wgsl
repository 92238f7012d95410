// What a part of the surface shows of one placed example under a footprint: which tiles or boxes, and their sum. Xing et al. 2024,
// section 6.3; twin of view.rs. The CPU walks tiles by two loops in each other; here one loop steps from tile to tile, so that
// pixels in step wait for each other once.

#import ndf_maps::ellipse
#import ndf_maps::eval

// Edge, in example texels, of the boxes that are seen as lobes, at most.
const GLINT_NDF_LOBE_TEXELS: f32 = 1.0;
// Pieces under a footprint that is widened by their own size, at most, relative to max_terms.
const GLINT_NDF_MOST_OF_TERMS: f32 = 4.0;
// A tile that a sub-region cuts is split from this share on, relative to an even share of max_terms.
const GLINT_NDF_SPLIT_FROM: f32 = 2.0;
const GLINT_NDF_MAX_SPLITS: u32 = 6u;

// What is visible of one placed example, and how the footprint lies on it; tiled examples are visible everywhere.
struct GlintNdfView {
    // The footprint in example texels.
    ellipse: GlintNdfEllipse,
    // The sub-region's middle in example texels.
    middle: vec2f,
    to_surface: vec4f,
    // Surface texels an example texel, by area.
    scale: f32,
    // Half the sub-region's edge in surface texels.
    half: f32,
    // Half the box, in example texels, around a sub-region of half edge 1.
    extent: vec2f,
    // |determinant| of the matrix from projected normals on the surface to those in the example.
    jacobian: f32,
}

// How much of a piece of `edge` around x lies in the sub-region, as if it were a box along the surface's axes.
fn glint_ndf_visible(view: GlintNdfView, x: vec2f, edge: f32) -> f32 {
    let size = edge * view.scale;
    let d = abs(glint_ndf_apply(view.to_surface, x - view.middle));
    let inside = clamp((vec2f(view.half + 0.5 * size) - d) / size, vec2f(0.0), vec2f(1.0));
    return inside.x * inside.y;
}

// Whether pieces of `edge` are few enough.
fn glint_ndf_few(ellipse: GlintNdfEllipse, settings: GlintNdfSettings, least: f32, edge: f32) -> bool {
    return edge >= least && glint_ndf_pieces(ellipse, edge) <= GLINT_NDF_MOST_OF_TERMS * f32(settings.max_terms);
}

struct GlintNdfDetail {
    // Level of the tiles; -1 for boxes.
    level: i32,
    // Edge of the tiles or boxes in example texels.
    edge: f32,
}

// The coarsest tiles or boxes that resolve a footprint in the example. Tiles of a level are twice as large as those before.
fn glint_ndf_detail(
    material: GlintNdfMaterial,
    ellipse: GlintNdfEllipse,
    settings: GlintNdfSettings,
) -> GlintNdfDetail {
    // Long thin footprints take coarser pieces rather than more than max_terms of them.
    let area = max(ellipse.minor, GLINT_NDF_FINEST_TEXELS) * ellipse.major;
    let least = 2.0 * GLINT_NDF_REACH * sqrt(area / f32(settings.max_terms));
    // Edges are powers of two: the largest up to tile_sigmas, by its exponent, then coarser ones until they are few.
    let finest = f32(glint_ndf_record(material.layer, 0u).x);
    var edge = bitcast<f32>(bitcast<u32>(settings.tile_sigmas * ellipse.minor) & 0x7f800000u);
    if edge < finest && glint_ndf_few(ellipse, settings, least, GLINT_NDF_LOBE_TEXELS) {
        edge = GLINT_NDF_LOBE_TEXELS;
        for (var k = 0; k < 12; k++) {
            let finer = edge > settings.lobe_sigmas * ellipse.minor
                && glint_ndf_few(ellipse, settings, least, 0.5 * edge);
            if !finer {
                break;
            }
            edge *= 0.5;
        }
        return GlintNdfDetail(-1, edge);
    }
    edge = max(edge, finest);
    var level = min(i32(round(log2(edge / finest))), i32(material.levels) - 1);
    edge = finest * exp2(f32(level));
    while level + 1 < i32(material.levels) && !glint_ndf_few(ellipse, settings, least, edge) {
        level += 1;
        edge *= 2.0;
    }
    return GlintNdfDetail(level, edge);
}

// A tile by how much of it the sub-region shows; one that is cut is split in its four children first, as often as `splits`
// allows. Tiles are visited depth first, by their indices: the next one follows from the one before.
fn glint_ndf_visible_tile(
    material: GlintNdfMaterial,
    view: GlintNdfView,
    settings: GlintNdfSettings,
    s: vec2f,
    top: u32,
    period: vec2f,
    index: vec2u,
) -> GlintNdfSum {
    let splits = min(settings.splits, GLINT_NDF_MAX_SPLITS);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    var level = top;
    var depth = 0u;
    var at = index;
    for (var visit = 0u; visit < 8192u; visit++) {
        let record = glint_ndf_record(material.layer, level);
        var split = false;
        if all(at < record.yz) {
            let low = period + vec2f(at) * f32(record.x);
            let size = min(low + f32(record.x), period + vec2f(material.size)) - low;
            let centre = low + 0.5 * size;
            let edge = max(size.x, size.y);
            let visible = glint_ndf_visible(view, centre, edge);
            if visible > 0.0 {
                let weight =
                    size.x * size.y * glint_ndf_gaussian(glint_ndf_widened(view.ellipse, edge), centre) * visible;
                split = visible < 1.0 && depth < splits && level > 0u
                    && weight * f32(settings.max_terms) >= GLINT_NDF_SPLIT_FROM;
                if !split {
                    let tile = record.w + at.y * record.y + at.x;
                    sum.density += weight * view.jacobian * glint_ndf_tile_density(material, tile, s);
                    sum.share += weight;
                    sum.terms += 1.0;
                }
            }
        }
        if split {
            level -= 1u;
            depth += 1u;
            at *= 2u;
        } else {
            // Up to where a child is left.
            let up = min(countTrailingZeros(~(at.x & at.y)), depth);
            at = at >> vec2u(up);
            level += up;
            depth -= up;
            if depth == 0u {
                break;
            }
            if (at.x & 1u) == 0u {
                at.x += 1u;
            } else {
                at = vec2u(at.x - 1u, at.y + 1u);
            }
        }
    }
    return sum;
}

// A walk over a level's tiles, row by row.
struct GlintNdfWalk {
    // The next tile.
    row: GlintNdfSlot,
    column: GlintNdfSlot,
    // Where its row ends.
    x1: f32,
    // Whether there was one: its corners and index.
    found: bool,
    low: vec2f,
    high: vec2f,
    index: vec2u,
}

// What a walk keeps to: tiles of a level that the sub-region may show, in a box, and that the widened footprint reaches.
struct GlintNdfRange {
    level: vec4u,
    low: vec2f,
    high: vec2f,
    // The ellipse's middle, and how it moves along x a step of y.
    mean: vec2f,
    lean: f32,
    // The square of half the ellipse's width in its middle, and what that loses a square step of y.
    width2: f32,
    loss: f32,
}

fn glint_ndf_range(view: GlintNdfView, level: vec4u) -> GlintNdfRange {
    let edge = f32(level.x);
    let e = glint_ndf_widened(view.ellipse, edge);
    let p = 1.0 / (e.major * e.major);
    let q = 1.0 / (e.minor * e.minor);
    let a = 1.0 / (e.axis.x * e.axis.x * p + e.axis.y * e.axis.y * q);
    let b = e.axis.x * e.axis.y * (p - q);
    let reach = glint_ndf_reach_y(e);
    let shown = view.extent * (view.half + 0.5 * edge * view.scale) - 0.5 * edge;
    var low = view.middle - shown;
    var high = view.middle + shown;
    low.y = max(low.y, e.mean.y - reach);
    high.y = min(high.y, e.mean.y + reach);
    return GlintNdfRange(level, low, high, e.mean, -b * a, e.reach * e.reach * a, (p * a) * (q * a));
}

// At the first tile of its row.
fn glint_ndf_begin_row(material: GlintNdfMaterial, range: GlintNdfRange, walk: GlintNdfWalk) -> GlintNdfWalk {
    let edge = f32(range.level.x);
    let start = walk.row.period + f32(walk.row.index) * edge;
    let y = 0.5 * (start + min(start + edge, walk.row.period + f32(material.size.y))) - range.mean.y;
    let half2 = range.width2 - range.loss * y * y;
    let half = sqrt(max(half2, 0.0));
    let middle = range.mean.x + range.lean * y;
    var begun = walk;
    begun.column = glint_ndf_slot_at(max(middle - half, range.low.x), range.level.y, f32(material.size.x), edge);
    // The ellipse may miss the row.
    begun.x1 = select(-1.0e30, min(middle + half, range.high.x), half2 >= 0.0);
    return begun;
}

// Steps on to the next tile that the sub-region shows.
fn glint_ndf_next_tile(
    material: GlintNdfMaterial,
    view: GlintNdfView,
    range: GlintNdfRange,
    walk: GlintNdfWalk,
) -> GlintNdfWalk {
    let edge = f32(range.level.x);
    let size = vec2f(material.size);
    var next = walk;
    next.found = false;
    for (var i = 0; i < GLINT_NDF_MAX_STEPS; i++) {
        let period = vec2f(next.column.period, next.row.period);
        let index = vec2u(next.column.index, next.row.index);
        let start = period + vec2f(index) * edge;
        if !(start.y <= range.high.y) {
            break;
        }
        let end = min(start + edge, period + size);
        let d = abs(glint_ndf_apply(view.to_surface, 0.5 * (start + end) - view.middle));
        let shows = view.half + 0.5 * max(end.x - start.x, end.y - start.y) * view.scale;
        next.found = start.x <= next.x1 && all(d < vec2f(shows));
        next.low = start;
        next.high = end;
        next.index = index;
        next.column = glint_ndf_next_slot(next.column, range.level.y, size.x);
        var ends = false;
        if !(next.column.period + f32(next.column.index) * edge <= next.x1) {
            next.row = glint_ndf_next_slot(next.row, range.level.z, size.y);
            next = glint_ndf_begin_row(material, range, next);
            ends = !(next.row.period + f32(next.row.index) * edge <= range.high.y);
        }
        if next.found || ends {
            break;
        }
    }
    return next;
}

// Tiles of a level.
fn glint_ndf_tiles(
    material: GlintNdfMaterial,
    view: GlintNdfView,
    settings: GlintNdfSettings,
    s: vec2f,
    level: u32,
) -> GlintNdfSum {
    let record = glint_ndf_record(material.layer, level);
    let range = glint_ndf_range(view, record);
    var walk: GlintNdfWalk;
    walk.row = glint_ndf_slot_at(range.low.y, record.z, f32(material.size.y), f32(record.x));
    walk = glint_ndf_begin_row(material, range, walk);
    walk = glint_ndf_next_tile(material, view, range, walk);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    // The walk is ahead of the sum: pixels in step have each found a tile, or none is left to any.
    for (var i = 0; i < GLINT_NDF_MAX_STEPS * GLINT_NDF_MAX_STEPS; i++) {
        if !walk.found {
            break;
        }
        if settings.splits == 0u {
            let extent = walk.high - walk.low;
            let centre = 0.5 * (walk.low + walk.high);
            let edge = max(extent.x, extent.y);
            let weight = extent.x * extent.y * glint_ndf_widened_gaussian(view.ellipse, edge, centre)
                * glint_ndf_visible(view, centre, edge);
            let tile = record.w + walk.index.y * record.y + walk.index.x;
            sum.density += weight * view.jacobian * glint_ndf_tile_density(material, tile, s);
            sum.share += weight;
            sum.terms += select(0.0, 1.0, weight > 0.0);
        } else {
            let period = walk.low - vec2f(walk.index) * f32(record.x);
            sum = glint_ndf_add(sum, glint_ndf_visible_tile(material, view, settings, s, level, period, walk.index));
        }
        walk = glint_ndf_next_tile(material, view, range, walk);
        if !walk.found {
            break;
        }
    }
    return sum;
}

// Boxes of `edge`, each one lobe; those of a whole texel are the bilinear cells. Or the footprint's centre alone, as one lobe of no
// extent.
fn glint_ndf_boxes(
    material: GlintNdfMaterial,
    view: GlintNdfView,
    s: vec2f,
    boxes: f32,
    at_point: bool,
) -> GlintNdfSum {
    let edge = select(boxes, 0.0, at_point);
    // Box in example texels that holds the centres of all boxes that the sub-region may show.
    let extent = view.extent * (view.half + 0.5 * edge * view.scale);
    let low = view.middle - extent;
    let high = view.middle + extent;
    let widened = glint_ndf_widened(view.ellipse, edge);
    let reach = glint_ndf_reach_y(widened);
    var rows = glint_ndf_cells(-0.5, boxes, max(widened.mean.y - reach, low.y), min(widened.mean.y + reach, high.y));
    rows = select(rows, vec2i(0, 1), at_point);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    var j = rows.x;
    loop {
        if j >= rows.y {
            break;
        }
        let y = glint_ndf_cell_centre(-0.5, boxes, j);
        let span = glint_ndf_span_x(widened, y);
        var columns = glint_ndf_cells(-0.5, boxes, max(span.x, low.x), min(span.y, high.x));
        columns = select(columns, vec2i(0, 1), at_point);
        var i = columns.x;
        loop {
            if i >= columns.y {
                break;
            }
            let cell = vec2f(glint_ndf_cell_centre(-0.5, boxes, i), y);
            let centre = select(cell, view.ellipse.mean, at_point);
            var weight = boxes * boxes * glint_ndf_gaussian(widened, centre) * glint_ndf_visible(view, centre, boxes);
            weight = select(weight, 1.0, at_point);
            if weight > 0.0 {
                let gradient = glint_ndf_log_gradient(view.ellipse, centre);
                sum.density += weight * view.jacobian * glint_ndf_lobe_density(material, centre, edge, gradient, s);
                sum.share += weight;
                sum.terms += 1.0;
            }
            i += 1;
            if i >= columns.y {
                break;
            }
        }
        j += 1;
        if j >= rows.y {
            break;
        }
    }
    return sum;
}

// The example point `local` as one lobe of no extent, seen through a palette entry.
fn glint_ndf_point(material: GlintNdfMaterial, class_index: u32, local: vec2f, surface_s: vec2f) -> GlintNdfSum {
    let to_local = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * class_index + 1u));
    let s = glint_ndf_apply(to_local, surface_s);
    let density = glint_ndf_lobe_density(material, local, 0.0, vec2f(0.0), s);
    return GlintNdfSum(abs(glint_ndf_determinant(to_local)) * density, 1.0, 1.0);
}

fn glint_ndf_top_tile(material: GlintNdfMaterial) -> u32 {
    return glint_ndf_record(material.layer, material.levels - 1u).w;
}
