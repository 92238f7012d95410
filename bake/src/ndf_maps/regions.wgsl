// A surface of examples placed at random: sub-regions, their owners, and all that they show under a footprint. Xing et al. 2024,
// section 6.3, Fig. 3; twin of glint-bake-core ndf_maps/{surface,placement}.rs.

#import ndf_maps::view

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
    let regions = 2u * material.cells;
    let at = vec2u(2 * cells.base + region) & vec2u(regions - 1u);
    let owner = glint_ndf_noise_texel(material.noise_records + at.y * regions + at.x);
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
    let position = bitcast<vec4f>(glint_ndf_record(material.palette_records + 2u * owner.class_index));
    let normal = bitcast<vec4f>(glint_ndf_record(material.palette_records + 2u * owner.class_index + 1u));
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
    let position = bitcast<vec4f>(glint_ndf_record(material.palette_records + 2u * owner.class_index));
    return GlintNdfShown(owner.class_index, glint_ndf_apply(position, place - owner.centre) + owner.offset);
}
