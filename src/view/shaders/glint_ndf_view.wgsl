// What a part of the surface shows of one placed example under a footprint: which tiles or boxes, and their sum. Xing et al.
// 2024, section 6.3; twin of glint-bake-core ndf_maps/{surface,ellipse}.rs.

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

// The largest power of two up to x > 0.
fn glint_ndf_power_below(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0x7f800000u);
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
    // Edges are powers of two: the largest up to tile_sigmas, then coarser ones until they are few.
    let finest = f32(glint_ndf_record(material.level_records).x);
    var edge = glint_ndf_power_below(settings.tile_sigmas * ellipse.minor);
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
        let record = glint_ndf_record(material.level_records + level);
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

fn glint_ndf_tiles(
    material: GlintNdfMaterial,
    view: GlintNdfView,
    settings: GlintNdfSettings,
    s: vec2f,
    level: u32,
    low: vec2f,
    high: vec2f,
) -> GlintNdfSum {
    let record = glint_ndf_record(material.level_records + level);
    let edge = f32(record.x);
    let size = vec2f(material.size);
    let widened = glint_ndf_widened(view.ellipse, edge);
    let reach = glint_ndf_reach_y(widened);
    let y0 = max(widened.mean.y - reach, low.y);
    let y1 = min(widened.mean.y + reach, high.y);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    var row = glint_ndf_slot_at(y0, record.z, size.y, edge);
    for (var j = 0; j < GLINT_NDF_MAX_STEPS; j++) {
        let start_y = row.period + f32(row.index) * edge;
        if !(start_y <= y1) {
            break;
        }
        let end_y = min(start_y + edge, row.period + size.y);
        let span = glint_ndf_span_x(widened, 0.5 * (start_y + end_y));
        let x0 = max(span.x, low.x);
        let x1 = min(span.y, high.x);
        var column = glint_ndf_slot_at(x0, record.y, size.x, edge);
        for (var i = 0; i < GLINT_NDF_MAX_STEPS; i++) {
            if !(column.period + f32(column.index) * edge <= x1) {
                break;
            }
            let period = vec2f(column.period, row.period);
            let index = vec2u(column.index, row.index);
            sum = glint_ndf_add(sum, glint_ndf_visible_tile(material, view, settings, s, level, period, index));
            column = glint_ndf_next_slot(column, record.y, size.x);
        }
        row = glint_ndf_next_slot(row, record.z, size.y);
    }
    return sum;
}

// Boxes of `edge`, each one lobe; those of a whole texel are the bilinear cells.
fn glint_ndf_boxes(
    material: GlintNdfMaterial,
    view: GlintNdfView,
    s: vec2f,
    edge: f32,
    low: vec2f,
    high: vec2f,
) -> GlintNdfSum {
    let widened = glint_ndf_widened(view.ellipse, edge);
    let reach = glint_ndf_reach_y(widened);
    let rows = glint_ndf_cells(-0.5, edge, max(widened.mean.y - reach, low.y), min(widened.mean.y + reach, high.y));
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    for (var j = rows.x; j < rows.y; j++) {
        let y = glint_ndf_cell_centre(-0.5, edge, j);
        let span = glint_ndf_span_x(widened, y);
        let columns = glint_ndf_cells(-0.5, edge, max(span.x, low.x), min(span.y, high.x));
        for (var i = columns.x; i < columns.y; i++) {
            let centre = vec2f(glint_ndf_cell_centre(-0.5, edge, i), y);
            let weight = edge * edge * glint_ndf_gaussian(widened, centre) * glint_ndf_visible(view, centre, edge);
            if weight > 0.0 {
                let gradient = glint_ndf_log_gradient(view.ellipse, centre);
                sum.density += weight * view.jacobian * glint_ndf_lobe_density(material, centre, edge, gradient, s);
                sum.share += weight;
                sum.terms += 1.0;
            }
        }
    }
    return sum;
}

// What is visible of one placed example, in tiles or lobes.
fn glint_ndf_view_sum(
    material: GlintNdfMaterial,
    view: GlintNdfView,
    settings: GlintNdfSettings,
    detail: GlintNdfDetail,
    s: vec2f,
) -> GlintNdfSum {
    let edge = detail.edge;
    // Box in example texels that holds the centres of all pieces that the sub-region may show.
    let reach = view.extent * (view.half + 0.5 * edge * view.scale);
    let low = view.middle - reach;
    let high = view.middle + reach;
    if detail.level < 0 {
        return glint_ndf_boxes(material, view, s, edge, low, high);
    }
    return glint_ndf_tiles(material, view, settings, s, u32(detail.level), low + 0.5 * edge, high - 0.5 * edge);
}

// The example point `local` as one lobe of no extent, seen through a palette entry.
fn glint_ndf_point(material: GlintNdfMaterial, class_index: u32, local: vec2f, surface_s: vec2f) -> GlintNdfSum {
    let to_local = bitcast<vec4f>(glint_ndf_record(material.palette_records + 2u * class_index + 1u));
    let s = glint_ndf_apply(to_local, surface_s);
    let density = glint_ndf_lobe_density(material, local, 0.0, vec2f(0.0), s);
    return GlintNdfSum(abs(glint_ndf_determinant(to_local)) * density, 1.0, 1.0);
}

fn glint_ndf_top_tile(material: GlintNdfMaterial) -> u32 {
    return glint_ndf_record(material.level_records + material.levels - 1u).w;
}
