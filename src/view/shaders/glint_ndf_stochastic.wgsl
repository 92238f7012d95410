// A surface of examples placed at random: sub-regions and their owners, and shares of transforms for wide footprints. Xing et al.
// 2024, section 6.3, Fig. 3; twin of glint-bake-core ndf_maps/{surface,placement}.rs.

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

// Noise texel of a cell relative to the base.
fn glint_ndf_noise(material: GlintNdfMaterial, cells: GlintNdfCells, cell: vec2i) -> vec4u {
    let at = vec2u(cells.base + cell) & vec2u(material.cells - 1u);
    return glint_ndf_noise_texel(material.noise_records + at.y * material.cells + at.x);
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

// Owner of a sub-region.
fn glint_ndf_owner_of(material: GlintNdfMaterial, cells: GlintNdfCells, region: vec2i) -> GlintNdfOwner {
    let quadrant = vec2u(region & vec2i(1));
    let own = glint_ndf_noise(material, cells, region >> vec2u(1u));
    let neighbour = i32((own.z >> (16u + 4u * (quadrant.x + 2u * quadrant.y))) & 0xfu);
    let cell = (region >> vec2u(1u)) + vec2i(neighbour % 3 - 1, neighbour / 3 - 1);
    let owner = glint_ndf_noise(material, cells, cell);
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
        if detail.level >= 0 && !at_point {
            return GlintNdfRegions(GlintNdfSum(0.0, 0.0, 0.0), false);
        }
        return GlintNdfRegions(glint_ndf_boxes(material, view, local_s, detail.edge, at_point), false);
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

// Shares of four palette entries in one texel of the class texture.
fn glint_ndf_class_shares(material: GlintNdfMaterial, mip_words: u32, size: u32, layer: u32, block: vec2i) -> vec4f {
    let at = vec2u(block) & vec2u(size - 1u);
    let word = material.class_words + mip_words + layer * size * size + at.y * size + at.x;
    return unpack4x8unorm(glint_ndf_word(word));
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
    let layers = min((material.palette + 3u) / 4u, GLINT_NDF_MAX_LAYERS);
    var mip = 0u;
    var mip_words = 0u;
    var size = material.cells;
    var block = material.cell_texels;
    for (var k = 0u; k < 31u; k++) {
        let coarser = size > 1u
            && (2.0 * block <= settings.tile_sigmas * ellipse.minor || glint_ndf_pieces(ellipse, block) > most);
        if !coarser {
            break;
        }
        mip_words += size * size * layers;
        size /= 2u;
        mip += 1u;
        block *= 2.0;
    }
    var shares: array<vec4f, 8>;
    if size == 1u {
        for (var layer = 0u; layer < layers; layer++) {
            shares[layer] = glint_ndf_class_shares(material, mip_words, 1u, layer, vec2i(0));
        }
    } else {
        // The block that holds the base cell, and where it begins.
        let first = cells.base >> vec2u(mip);
        let origin = vec2f((first << vec2u(mip)) - cells.base) * material.cell_texels;
        var widened = glint_ndf_widened(ellipse, block);
        widened.mean -= origin;
        // At a smaller reach a footprint might lie between the middles of its blocks.
        widened.reach = GLINT_NDF_REACH;
        let reach = glint_ndf_reach_y(widened);
        let rows = glint_ndf_cells(0.0, block, widened.mean.y - reach, widened.mean.y + reach);
        for (var j = rows.x; j < rows.y; j++) {
            let y = glint_ndf_cell_centre(0.0, block, j);
            let span = glint_ndf_span_x(widened, y);
            let columns = glint_ndf_cells(0.0, block, span.x, span.y);
            for (var i = columns.x; i < columns.y; i++) {
                let centre = vec2f(glint_ndf_cell_centre(0.0, block, i), y);
                let weight = glint_ndf_gaussian(widened, centre) * block * block;
                for (var layer = 0u; layer < layers; layer++) {
                    let share = glint_ndf_class_shares(material, mip_words, size, layer, first + vec2i(i, j));
                    shares[layer] += weight * share;
                }
            }
        }
    }
    let top = glint_ndf_top_tile(material);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    for (var k = 0u; k < min(material.palette, 4u * GLINT_NDF_MAX_LAYERS); k++) {
        let four = shares[k / 4u];
        let low = select(four.x, four.y, (k & 1u) == 1u);
        let high = select(four.z, four.w, (k & 1u) == 1u);
        let weight = select(low, high, (k & 2u) == 2u);
        if weight > 0.0 {
            let normal = bitcast<vec4f>(glint_ndf_record(material.palette_records + 2u * k + 1u));
            let density = glint_ndf_tile_density(material, top, glint_ndf_apply(normal, s));
            sum.density += weight * abs(glint_ndf_determinant(normal)) * density;
            sum.share += weight;
            sum.terms += 1.0;
        }
    }
    return sum;
}

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
    let tiles = glint_ndf_regions(material, ellipse, cells, settings, s, false, false);
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
