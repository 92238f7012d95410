// A surface of examples placed at random: sub-regions, their owners, and what they show under a footprint. Xing et al. 2024, section
// 6.3, Fig. 3; twin of regions.rs, which has what deviates from the paper.

#import ndf_maps::view

// Sub-regions of a stochastic surface that a footprint visits, at most.
const GLINT_NDF_MAX_REGIONS: f32 = 64.0;
// From this minor axis on (in sub-regions), where top tiles are enough, one tells all of a sub-region.
const GLINT_NDF_WHOLE_REGION_SIGMA: f32 = 0.5;
// From this minor axis on (in cells) a stochastic surface is seen as shares of transforms.
const GLINT_NDF_CLASS_SIGMA_CELLS: f32 = 1.0;
// Largest palette, in groups of four.
const GLINT_NDF_MAX_GROUPS: u32 = 8u;
// Places lie within this many standard deviations of the footprint's centre; with their tiles they spread as it does.
const GLINT_NDF_PROBE_REACH: f32 = 1.5;
// Edge of their tiles, at most, and their distance along the major axis, relative to that along the minor axis.
const GLINT_NDF_PROBE_TILE: f32 = 1.35;

// The grid as a footprint sees it: positions are relative to the corner of the base cell.
struct GlintNdfCells {
    base: vec2i,
    // The footprint's centre.
    mean: vec2f,
}

// x - k edge, exact in the products.
fn glint_ndf_rest(x: f32, k: f32, edge: f32) -> f32 {
    let kh = glint_upper_half(k);
    let eh = glint_upper_half(edge);
    let kl = k - kh;
    let el = edge - eh;
    let halves = glint_keep(glint_keep(x - glint_keep(kh * eh)) - glint_keep(kl * eh));
    return glint_keep(glint_keep(halves - glint_keep(kh * el)) - glint_keep(kl * el));
}

fn glint_ndf_cells_around(material: GlintNdfMaterial, mean: vec2f) -> GlintNdfCells {
    let limit = vec2f(1.0e9);
    let place = clamp(mean, -limit, limit);
    let cell = floor(place / material.cell_texels);
    let rest = vec2f(
        glint_ndf_rest(place.x, cell.x, material.cell_texels),
        glint_ndf_rest(place.y, cell.y, material.cell_texels),
    );
    return GlintNdfCells(vec2i(cell), rest);
}

struct GlintNdfOwner {
    class_index: u32,
    // Centre on the surface, relative to the base cell.
    centre: vec2f,
    // Example point that lies at the centre.
    offset: vec2f,
}

fn glint_ndf_unorm_pair(bits: u32) -> vec2f {
    return vec2f(f32(bits & 0xffffu), f32(bits >> 16u)) / 65535.0;
}

// Owner of a sub-region, by its index from the base cell's first one on.
fn glint_ndf_owner_of(material: GlintNdfMaterial, cells: GlintNdfCells, region: vec2i) -> GlintNdfOwner {
    let at = vec2u(2 * cells.base + region) & vec2u(2u * material.cells - 1u);
    let owner = glint_ndf_noise_texel(material.layer, at);
    let neighbour = i32(owner.z >> 16u);
    let row = (neighbour * 11) >> 5u;
    let cell = (region >> vec2u(1u)) + vec2i(neighbour - 3 * row - 1, row - 1);
    return GlintNdfOwner(
        owner.z & 0xffu,
        (vec2f(cell) + glint_ndf_unorm_pair(owner.x)) * material.cell_texels,
        glint_ndf_unorm_pair(owner.y) * vec2f(material.size),
    );
}

// What a sub-region, by its index and middle, shows of its owner under the footprint, if it shows it as `boxes` or as tiles.
fn glint_ndf_region(
    material: GlintNdfMaterial,
    footprint: GlintNdfEllipse,
    cells: GlintNdfCells,
    region: vec2i,
    middle: vec2f,
    settings: GlintNdfSettings,
    s: vec2f,
    boxes: bool,
    at_point: bool,
) -> GlintNdfRegions {
    let owner = glint_ndf_owner_of(material, cells, region);
    let position = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * owner.class_index));
    let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * owner.class_index + 1u));
    var from_centre = footprint;
    from_centre.mean = footprint.mean - owner.centre;
    let ellipse = glint_ndf_transformed(from_centre, position, owner.offset);
    let local_s = glint_ndf_apply(normal, s);
    let jacobian = abs(glint_ndf_determinant(normal));
    let detail = glint_ndf_detail(material, ellipse, settings);
    let edge = 0.5 * material.cell_texels;
    let view = GlintNdfView(
        ellipse,
        glint_ndf_apply(position, middle - owner.centre) + owner.offset,
        glint_ndf_inverse(position),
        inverseSqrt(abs(glint_ndf_determinant(position))),
        0.5 * edge,
        abs(position.xz) + abs(position.yw),
        jacobian,
    );
    if boxes {
        if detail.level >= 0 && !at_point && settings.probes == 0u {
            return GlintNdfRegions(GlintNdfSum(0.0, 0.0, 0.0), false);
        }
        // Where places are seen, not tiles, all that comes here is seen as boxes.
        let edge = select(detail.edge, GLINT_NDF_LOBE_TEXELS, detail.level >= 0);
        return GlintNdfRegions(glint_ndf_boxes(material, view, local_s, edge, at_point), false);
    }
    if detail.level < 0 {
        return GlintNdfRegions(GlintNdfSum(0.0, 0.0, 0.0), true);
    }
    if detail.level == i32(material.levels) - 1 && footprint.minor >= GLINT_NDF_WHOLE_REGION_SIGMA * edge {
        let weight = edge * edge * glint_ndf_widened_gaussian(footprint, edge, middle);
        let density = glint_ndf_tile_density(material, glint_ndf_top_tile(material), local_s);
        return GlintNdfRegions(GlintNdfSum(weight * jacobian * density, weight, 1.0), false);
    }
    return GlintNdfRegions(glint_ndf_tiles(material, view, settings, local_s, u32(detail.level)), false);
}

// What sub-regions near a footprint show, those that are seen as boxes or those as tiles; or what the one at its centre shows there.
struct GlintNdfRegions {
    sum: GlintNdfSum,
    // Whether, when tiles were asked for, there are some that are seen as boxes.
    boxes: bool,
}

fn glint_ndf_regions(
    material: GlintNdfMaterial,
    ellipse: GlintNdfEllipse,
    cells: GlintNdfCells,
    settings: GlintNdfSettings,
    s: vec2f,
    boxes: bool,
    at_point: bool,
) -> GlintNdfRegions {
    let region = 0.5 * material.cell_texels;
    // A sub-region counts when its centre is near the footprint, widened so that a point reaches its corners.
    let widened = glint_ndf_widened(ellipse, region * 1.2);
    let reach = glint_ndf_reach_y(widened);
    let shown = vec2i(floor(ellipse.mean / region));
    var rows = glint_ndf_cells(0.0, region, widened.mean.y - reach, widened.mean.y + reach);
    rows = select(rows, vec2i(shown.y, shown.y + 1), at_point);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    var left = false;
    // Loops test at their ends, too: adapters that run many pixels at a time in step save the round that finds nothing.
    var j = rows.x;
    loop {
        if j >= rows.y {
            break;
        }
        let y = glint_ndf_cell_centre(0.0, region, j);
        let span = glint_ndf_span_x(widened, y);
        var columns = glint_ndf_cells(0.0, region, span.x, span.y);
        columns = select(columns, vec2i(shown.x, shown.x + 1), at_point);
        var i = columns.x;
        loop {
            if i >= columns.y {
                break;
            }
            let middle = vec2f(glint_ndf_cell_centre(0.0, region, i), y);
            let found = glint_ndf_region(material, ellipse, cells, vec2i(i, j), middle, settings, s, boxes, at_point);
            sum = glint_ndf_add(sum, found.sum);
            left = left || found.boxes;
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
    return GlintNdfRegions(sum, left);
}

struct GlintNdfShown {
    class_index: u32,
    // Example texels, not yet within the example.
    local: vec2f,
}

// What shows at a surface position relative to the base cell.
fn glint_ndf_shown_at(material: GlintNdfMaterial, cells: GlintNdfCells, place: vec2f) -> GlintNdfShown {
    let owner = glint_ndf_owner_of(material, cells, vec2i(floor(place / (0.5 * material.cell_texels))));
    let position = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * owner.class_index));
    return GlintNdfShown(owner.class_index, glint_ndf_apply(position, place - owner.centre) + owner.offset);
}

// Shares of four palette entries in one texel of the class texture.
fn glint_ndf_class_shares(material: GlintNdfMaterial, mip: u32, size: u32, group: u32, block: vec2i) -> vec4f {
    return glint_ndf_class_texel(material.layer, vec2u(block) & vec2u(size - 1u), group, mip);
}

// The top tile under every transform, by the share of cells that use it.
fn glint_ndf_classes(
    material: GlintNdfMaterial,
    ellipse: GlintNdfEllipse,
    cells: GlintNdfCells,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let most = GLINT_NDF_MOST_OF_TERMS * f32(settings.max_terms);
    let groups = min((material.palette + 3u) / 4u, GLINT_NDF_MAX_GROUPS);
    var mip = 0u;
    var size = material.cells;
    var block = material.cell_texels;
    for (var k = 0u; k < 31u; k++) {
        let coarser = size > 1u
            && (2.0 * block <= settings.tile_sigmas * ellipse.minor || glint_ndf_pieces(ellipse, block) > most);
        if !coarser {
            break;
        }
        size /= 2u;
        mip += 1u;
        block *= 2.0;
    }
    let whole = size == 1u;
    // The block that holds the base cell, and where it begins.
    let first = cells.base >> vec2u(mip);
    let origin = vec2f((first << vec2u(mip)) - cells.base) * material.cell_texels;
    var widened = glint_ndf_widened(ellipse, block);
    widened.mean -= origin;
    // At a smaller reach a footprint might lie between the middles of its blocks.
    widened.reach = GLINT_NDF_REACH;
    let reach = glint_ndf_reach_y(widened);
    var rows = glint_ndf_cells(0.0, block, widened.mean.y - reach, widened.mean.y + reach);
    rows = select(rows, vec2i(0, 1), whole);
    let top = glint_ndf_top_tile(material);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    // Four classes at a time, so that none needs an array.
    for (var group = 0u; group < groups; group++) {
        var shares = vec4f(0.0);
        for (var j = rows.x; j < rows.y; j++) {
            let y = glint_ndf_cell_centre(0.0, block, j);
            let span = glint_ndf_span_x(widened, y);
            var columns = glint_ndf_cells(0.0, block, span.x, span.y);
            columns = select(columns, vec2i(0, 1), whole);
            for (var i = columns.x; i < columns.y; i++) {
                let centre = vec2f(glint_ndf_cell_centre(0.0, block, i), y);
                let weight = select(glint_ndf_gaussian(widened, centre) * block * block, 1.0, whole);
                shares += weight * glint_ndf_class_shares(material, mip, size, group, first + vec2i(i, j));
            }
        }
        for (var k = 4u * group; k < min(material.palette, 4u * group + 4u); k++) {
            let low = select(shares.x, shares.y, (k & 1u) == 1u);
            let high = select(shares.z, shares.w, (k & 1u) == 1u);
            let weight = select(low, high, (k & 2u) == 2u);
            if weight > 0.0 {
                let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * k + 1u));
                let density = glint_ndf_tile_density(material, top, glint_ndf_apply(normal, s));
                sum.density += weight * abs(glint_ndf_determinant(normal)) * density;
                sum.share += weight;
                sum.terms += 1.0;
            }
        }
    }
    return sum;
}

// Tiles that show at places under a footprint.
fn glint_ndf_probes(
    material: GlintNdfMaterial,
    ellipse: GlintNdfEllipse,
    cells: GlintNdfCells,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let most = f32(settings.max_terms);
    let extent = 2.0 * GLINT_NDF_PROBE_REACH * vec2f(ellipse.major, ellipse.minor);
    let step = max(min(extent.y / f32(settings.probes), material.cell_texels), sqrt(extent.x * extent.y / most));
    // A quarter of a step more is no reason for another place.
    let steps = extent / vec2f(GLINT_NDF_PROBE_TILE * step, step);
    let count = clamp(ceil(steps - 0.25), vec2f(1.0), vec2f(most));
    // Tiles of a level are twice as large as those before.
    let finest = f32(glint_ndf_record(material.layer, 0u).x);
    let times = max(GLINT_NDF_PROBE_TILE * step / finest, 1.0);
    let level = min((bitcast<u32>(times) >> 23u) - 127u, material.levels - 1u);
    let record = glint_ndf_record(material.layer, level);
    let per_texel = 1.0 / f32(record.x);
    let last = record.yz - 1u;
    let size = vec2f(material.size);
    let per_size = 1.0 / size;
    let per_region = 2.0 / material.cell_texels;
    let along = ellipse.axis * ellipse.major;
    let across = vec2f(-ellipse.axis.y, ellipse.axis.x) * ellipse.minor;
    let gap = 2.0 * GLINT_NDF_PROBE_REACH / count;
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    // One loop, not two, and its test at the end: pixels in step wait for the most places of one of them once.
    var at = vec2f(0.0);
    loop {
        let t = (at + 0.5) * gap - GLINT_NDF_PROBE_REACH;
        let weight = exp(-0.5 * dot(t, t));
        let place = ellipse.mean + along * t.x + across * t.y;
        let owner = glint_ndf_owner_of(material, cells, vec2i(floor(place * per_region)));
        let position = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * owner.class_index));
        let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * owner.class_index + 1u));
        let x = glint_ndf_apply(position, place - owner.centre) + owner.offset;
        let local = x - floor(x * per_size) * size;
        let index = min(vec2u(max(local, vec2f(0.0)) * per_texel), last);
        let tile = record.w + index.y * record.y + index.x;
        let density = glint_ndf_tile_density(material, tile, glint_ndf_apply(normal, s));
        sum.density += weight * abs(glint_ndf_determinant(normal)) * density;
        sum.share += weight;
        sum.terms += 1.0;
        at.x += 1.0;
        if at.x >= count.x {
            at = vec2f(0.0, at.y + 1.0);
        }
        if at.y >= count.y {
            break;
        }
    }
    return sum;
}

// What a footprint sees: sub-regions, places, or shares of transforms.
fn glint_ndf_stochastic(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let cells = glint_ndf_cells_around(material, footprint.mean);
    var ellipse = glint_ndf_ellipse(footprint, settings.reach);
    ellipse.mean = cells.mean;
    let region = 0.5 * material.cell_texels;
    let regions = 4.0 * GLINT_NDF_REACH * GLINT_NDF_REACH * ellipse.major * max(ellipse.minor, region) / (region * region);
    let many = regions > min(GLINT_NDF_MAX_REGIONS, f32(settings.max_terms));
    if ellipse.minor >= GLINT_NDF_CLASS_SIGMA_CELLS * material.cell_texels || many {
        return glint_ndf_classes(material, ellipse, cells, settings, s);
    }
    var tiles = GlintNdfRegions(GlintNdfSum(0.0, 0.0, 0.0), true);
    if settings.probes > 0u {
        // As the example of most texels sees it, so that those seen as boxes are few.
        var seen = ellipse;
        seen.major *= material.most_texels;
        seen.minor *= material.most_texels;
        if glint_ndf_detail(material, seen, settings).level >= 0 {
            return glint_ndf_probes(material, ellipse, cells, settings, s);
        }
    } else {
        tiles = glint_ndf_regions(material, ellipse, cells, settings, s, false, false);
    }
    var sum = tiles.sum;
    if tiles.boxes || !(sum.share > 0.0) {
        var at_point = !tiles.boxes;
        for (var k = 0; k < 2; k++) {
            sum = glint_ndf_add(sum, glint_ndf_regions(material, ellipse, cells, settings, s, true, at_point).sum);
            // None has a share: the place alone.
            if sum.share > 0.0 {
                break;
            }
            at_point = true;
        }
    }
    return sum;
}
