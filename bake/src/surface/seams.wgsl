// A block of a synthesised surface that follows every seam: one of the two ways to read a surface, for surface::eval.
// Tan et al. 2022, section 5.2: a block that lies clear of seams is one cell of the
// sample, moved. Where seams cross, the cells of all patches that show a corner of the block are read, and of each the quarters
// of lobes that lie where the surface shows that patch. Smaller blocks are read by blocks of the finest level, and those by
// boxes of a texel.

#import surface::query

// Density and share of a block, if it could be read as a whole.
struct GlintSurfaceBlock {
    found: bool,
    sum: vec2f,
}

// Cells of the patches that a block shows at its corners; none if one of them is not in the sample.
struct GlintSurfaceCells {
    count: u32,
    sources: array<vec2i, 4>,
}

// Bits 0, 2, 4 ... of a number as a number of their own.
fn glint_even_bits(v: u32) -> i32 {
    var bits = v & 0x55555555u;
    bits = (bits | (bits >> 1u)) & 0x33333333u;
    bits = (bits | (bits >> 2u)) & 0x0f0f0f0fu;
    bits = (bits | (bits >> 4u)) & 0x00ff00ffu;
    return i32((bits | (bits >> 8u)) & 0xffffu);
}

// Cells of `edge` texels of the patches that the block at surface texel `at` shows at its corners.
fn glint_surface_cells_at_corners(q: GlintSurfaceQuery, at: vec2i, edge: i32, step: i32) -> GlintSurfaceCells {
    var cells: GlintSurfaceCells;
    let size = vec2i(i32(q.map.width), i32(q.map.height));
    for (var corner = 0; corner < 4; corner++) {
        let within = vec2i(corner & 1, corner >> 1u) * (edge - 1);
        let shown = glint_synthesis_source_texel(q.synthesis, at.x + within.x, at.y + within.y);
        var cell = shown - within;
        if q.map.wrap == GLINT_WRAP_REPEAT {
            cell = vec2i(glint_floor_div(cell.x, size.x).y, glint_floor_div(cell.y, size.y).y);
        } else if any(cell < vec2i(0)) || any(cell + edge > size) {
            cells.count = 0u;
            return cells;
        }
        if any(cell % step != vec2i(0)) {
            cells.count = 0u;
            return cells;
        }
        var known = false;
        for (var k = 0u; k < cells.count; k++) {
            known = known || all(cells.sources[k] == cell);
        }
        if !known {
            cells.sources[cells.count] = cell;
            cells.count += 1u;
        }
    }
    return cells;
}

// Density and share of one lobe at the query's normal.
fn glint_surface_lobe(query: GlintLobesQuery, lobe: GlintLobe, d: vec2f) -> vec2f {
    let given = glint_lobes_conditional(query, lobe, d);
    var inside = 1.0;
    if given.cut {
        inside = glint_lobes_inside_disk(given.mean, given.covariance);
    }
    return vec2f(given.density / inside, given.share);
}

// Density and share of boxes of `edge` texels under the footprint. The mass inside the disk takes long and few boxes need it: the
// loops over the others end where one does.
fn glint_surface_boxes(q: GlintSurfaceQuery, edge: f32) -> vec2f {
    let frame = q.point.frame;
    let reach = q.settings.lobes.reach;
    // Boxes of a bilinear map begin at texel centres, where its patches do.
    let origin = select(0.5, 0.0, q.map.nearest == 1u);
    let ellipse = glint_lobes_ellipse(frame, reach);
    let top = ellipse.top;
    var j = i32(floor((frame.mean.y - top - origin) / edge));
    let last = min(i32(floor((frame.mean.y + top - origin) / edge)), j + i32(GLINT_LOBES_MOST_STEPS));
    var row = glint_lobes_row(ellipse, origin, edge, origin + f32(j) * edge);
    var sum = vec2f(0.0);
    while j <= last {
        var given = GlintConditionalLobe();
        while j <= last && !given.cut {
            while row.x <= row.y && !given.cut {
                let centre = origin + (vec2f(f32(row.x), f32(j)) + 0.5) * edge;
                let lobe = glint_lobes_box_lobe(glint_surface_patch_at(q, centre), vec2f(edge));
                given = glint_lobes_conditional(q.point, lobe, frame.mean - centre);
                sum += vec2f(select(given.density, 0.0, given.cut), given.share);
                row.x += 1;
            }
            if !given.cut {
                j += 1;
                row = glint_lobes_row(ellipse, origin, edge, origin + f32(j) * edge);
            }
        }
        if given.cut {
            sum.x += given.density / glint_lobes_inside_disk(given.mean, given.covariance);
        }
    }
    return sum;
}

// Offset of a quarter of a lobe from its mean, by its signs along the columns of the factor. Four quarters have the lobe's
// moments.
fn glint_surface_quarter_offset(lobe: GlintLobe, signs: vec2f) -> vec2f {
    let d = signs * 0.8660254;
    return vec2f(lobe.factor.x * d.x, lobe.factor.y * d.x + lobe.factor.z * d.y);
}

// The part of a lobe that is made of `count` of its quarters, whose signs sum to `signs`.
fn glint_surface_part_of(lobe: GlintLobe, count: f32, signs: vec2f) -> GlintLobe {
    let mean = signs / max(count, 1.0);
    let d = glint_surface_quarter_offset(lobe, mean);
    // A quarter of the variance lies within quarters, the rest between their means.
    let narrow = sqrt(1.0 - 0.75 * mean * mean);
    return GlintLobe(
        0.25 * count * lobe.weight,
        lobe.position + d,
        lobe.normal + lobe.jacobian * d,
        lobe.factor * narrow.xxy,
        lobe.jacobian,
        lobe.residual,
    );
}

// Density and share of the lobes of the cell at sample texel `source` where the block `at` lies; if `owned`, of the parts of
// them that the surface shows there.
fn glint_surface_cell(
    q: GlintSurfaceQuery,
    level: GlintLobesLevel,
    source: vec2i,
    at: vec2i,
    owned: bool,
) -> vec2f {
    let step = glint_surface_step(q.map, level.cell_texels);
    let place = vec2u(source) / step;
    let first = level.first_lobe + (place.y * level.cells_x + place.x) * q.map.lobes_per_cell;
    let corner = vec2f(at);
    let size = vec2i(i32(q.map.width), i32(q.map.height));
    let last = vec2i(i32(level.cell_texels) - 1);
    var sum = vec2f(0.0);
    for (var k = 0u; k < q.map.lobes_per_cell; k++) {
        var lobe = glint_lobes_lobe(q.map, level, first + k);
        if lobe.weight <= 0.0 {
            continue;
        }
        if owned {
            var count = 0.0;
            var signs = vec2f(0.0);
            for (var quarter = 0; quarter < 4; quarter++) {
                let sign = vec2f(f32(quarter & 1), f32(quarter >> 1u)) * 2.0 - 1.0;
                let middle = lobe.position + glint_surface_quarter_offset(lobe, sign);
                let texel = clamp(vec2i(middle), vec2i(0), last);
                let on_surface = q.origin + at + texel;
                let found = glint_synthesis_source_texel(q.synthesis, on_surface.x, on_surface.y);
                if all(found == (source + texel) % size) {
                    count += 1.0;
                    signs += sign;
                }
            }
            if count == 0.0 {
                continue;
            }
            lobe = glint_surface_part_of(lobe, count, signs);
        }
        sum += glint_surface_lobe(q.point, lobe, q.point.frame.mean - corner - lobe.position);
    }
    return sum;
}

// A block by cells of its own edge, if `owned` where seams cross too.
fn glint_surface_whole_block(q: GlintSurfaceQuery, level_index: u32, at: vec2i, owned: bool) -> GlintSurfaceBlock {
    let level = glint_lobes_level(level_index);
    let edge = i32(level.cell_texels);
    let step = i32(glint_surface_step(q.map, level.cell_texels));
    let on_surface = q.origin + at;
    let block = glint_synthesis_block_source(q.synthesis, on_surface.x, on_surface.y, edge, step);
    if !block.found && !owned {
        return GlintSurfaceBlock(false, vec2f(0.0));
    }
    var cells: GlintSurfaceCells;
    if block.found {
        cells.count = 1u;
        cells.sources[0] = block.source;
    } else {
        cells = glint_surface_cells_at_corners(q, on_surface, edge, step);
    }
    var sum = vec2f(0.0);
    for (var k = 0u; k < cells.count; k++) {
        sum += glint_surface_cell(q, level, cells.sources[k], at, !block.found);
    }
    return GlintSurfaceBlock(cells.count > 0u, sum);
}

// The same, halved along each axis over which its normals spread so far that they are no Gaussian: cells beside it hold lobes
// of fewer normals.
fn glint_surface_halved(q: GlintSurfaceQuery, centre: vec2f, size: vec2f) -> vec2f {
    let place = glint_surface_patch_at(q, centre);
    let most = q.settings.box_range * q.point.roughness;
    let ranges = vec2f(length(place.jacobian[0]) * size.x, length(place.jacobian[1]) * size.y);
    // Larger footprints see many boxes: there only the wider range is halved.
    let least = select(max(ranges.x, ranges.y), 0.0, q.point.frame.major <= q.settings.halves_until);
    let columns = select(1, 2, ranges.x > most && ranges.x >= least);
    let rows = select(1, 2, ranges.y > most && ranges.y >= least);
    let part = size / vec2f(f32(columns), f32(rows));
    var sum = vec2f(0.0);
    for (var j = 0; j < rows; j++) {
        for (var i = 0; i < columns; i++) {
            let d = part * (vec2f(f32(i), f32(j)) + 0.5) - 0.5 * size;
            let here = place.normal + place.jacobian * d + place.twist * (d.x * d.y);
            let slopes = place.jacobian + mat2x2f(place.twist * d.y, place.twist * d.x);
            let lobe = glint_lobes_box_lobe(GlintLobesPatch(here, slopes, place.twist), part);
            sum += glint_surface_lobe(q.point, lobe, q.point.frame.mean - centre - d);
        }
    }
    return sum;
}

// Density and share of the boxes of a block of `edge` texels. Those of a bilinear map lie between texel centres; at the
// block's border they are half as wide.
fn glint_surface_texels(q: GlintSurfaceQuery, at: vec2i, edge: i32) -> vec2f {
    let shift = select(0.5, 0.0, q.map.nearest == 1u);
    let last = select(edge, edge - 1, q.map.nearest == 1u);
    let most = vec2f(f32(edge));
    var sum = vec2f(0.0);
    for (var j = 0; j <= last; j++) {
        for (var i = 0; i <= last; i++) {
            let k = vec2f(f32(i), f32(j)) - shift;
            let low = max(k, vec2f(0.0));
            let high = min(k + 1.0, most);
            sum += glint_surface_halved(q, vec2f(at) + 0.5 * (low + high), high - low);
        }
    }
    return sum;
}

// Density and share of the block of a level's edge whose first texel lies `at` from the origin: as one block where that can be
// read, else by its quarters and theirs, down to the finest level.
fn glint_surface_block(q: GlintSurfaceQuery, level: u32, block_place: vec2i, whole: bool) -> vec2f {
    let of_level = glint_lobes_level(level);
    let at = block_place * i32(of_level.cell_texels);
    if whole {
        let cell = vec2u(block_place);
        let first = of_level.first_lobe + (cell.y * of_level.cells_x + cell.x) * q.map.lobes_per_cell;
        return glint_lobes_cell(q.map, q.point, of_level, first, vec2f(at));
    }
    let finest = i32(glint_lobes_level(0u).cell_texels);
    let frame = q.point.frame;
    let large = sqrt(frame.minor * frame.major) >= q.settings.owned_sigma;
    let owned = f32(of_level.cell_texels) >= q.settings.owned_from || large;
    var sum = vec2f(0.0);
    // Blocks of the finest level in the order of their quarters: those of a larger block follow each other.
    var block = 0u;
    while block < (1u << (2u * level)) {
        let place = at + finest * vec2i(glint_even_bits(block), glint_even_bits(block >> 1u));
        var size = level;
        if block != 0u {
            size = countTrailingZeros(block) / 2u;
        }
        var read = GlintSurfaceBlock(false, vec2f(0.0));
        loop {
            read = glint_surface_whole_block(q, size, place, owned && size > 0u);
            if read.found || size == 0u {
                break;
            }
            size -= 1u;
        }
        if !read.found {
            read.sum = glint_surface_texels(q, place, finest);
        }
        sum += read.sum;
        block += 1u << (2u * size);
    }
    return sum;
}
