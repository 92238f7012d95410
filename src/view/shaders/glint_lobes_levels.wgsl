// Which lobes a footprint sees on the repeated map: boxes of the map, cells of the stored levels, or all of the last one, and the
// mixture of two levels. Tan et al. 2022, section 5.2, Eq. 9; twin of glint-bake-core lobes/query.rs. Accessors: see
// glint_lobes.wgsl.

// Sum of shares below which f32 cannot tell what a footprint sees; the last level is the best that is known then.
const GLINT_LOBES_LEAST_SHARE: f32 = 1.0e-30;
// Cells a footprint may visit, over pi and less h^2 (see glint_lobes_lod), at least.
const GLINT_LOBES_LEAST_BUDGET: f32 = 0.05;

// Two neighbouring levels: 0 boxes of `box_edge` texels, then the stored ones, then the whole map.
struct GlintLobesLod {
    finer: u32,
    // Weight of the level finer + 1.
    fraction: f32,
    box_edge: f32,
}

// A cell's place on one axis of the repeated map.
struct GlintLobesSlot {
    index: u32,
    // Copy of the map.
    copy: f32,
}

// A texel of the map that lies less than the map's size beyond its edges; wrapped or clamped.
fn glint_lobes_wrapped(map: GlintLobesMap, texel: vec2i) -> vec2i {
    let size = vec2i(i32(map.width), i32(map.height));
    let moved = texel + select(vec2i(0), size, texel < vec2i(0)) - select(vec2i(0), size, texel >= size);
    return clamp(select(texel, moved, map.wrap == GLINT_WRAP_REPEAT), vec2i(0), size - 1);
}

// Factor and offset of stored numbers of normals.
fn glint_lobes_normals_scale(map: GlintLobesMap) -> vec2f {
    return select(vec2f(2.0 / 255.0, -1.0), vec2f(1.0 / 32767.0, 0.0), map.normals == GLINT_LOBES_SNORM16);
}

// Stored numbers of a texel's normal.
fn glint_lobes_codes(word: u32) -> vec2f {
    return vec2f(f32(bitcast<i32>(word << 16u) >> 16u), f32(bitcast<i32>(word) >> 16u));
}

// Projected normal of texel (i, j), which lies less than the map's size beyond its edges.
fn glint_lobes_texel(map: GlintLobesMap, i: i32, j: i32) -> vec2f {
    let at = glint_lobes_wrapped(map, vec2i(i, j));
    let scale = glint_lobes_normals_scale(map);
    return glint_lobes_codes(glint_lobes_normals_pair(u32(at.y) * map.width + u32(at.x)).x) * scale.x + scale.y;
}

// A bilinear patch from its texels, at the fraction `f`.
fn glint_lobes_bilinear(s00: vec2f, s10: vec2f, s01: vec2f, s11: vec2f, f: vec2f) -> GlintLobesPatch {
    let top = s00 + (s10 - s00) * f.x;
    let bottom = s01 + (s11 - s01) * f.x;
    let twist = s11 - s10 - s01 + s00;
    let along = s10 - s00 + twist * f.y;
    return GlintLobesPatch(top + (bottom - top) * f.y, mat2x2f(along, bottom - top), twist);
}

// The bilinear patch from texel `at` on, which lies less than the map's size beyond its edges, at the fraction `f`. A nearest
// texel has no slopes.
fn glint_lobes_patch(map: GlintLobesMap, at: vec2i, f: vec2f) -> GlintLobesPatch {
    let place = glint_lobes_wrapped(map, at);
    let beside = glint_lobes_wrapped(map, at + vec2i(1, 0)).x;
    let row = u32(place.y) * map.width;
    let left = glint_lobes_normals_pair(row + u32(place.x));
    let right = glint_lobes_normals_pair(row + u32(beside));
    // Above the first row of a clamped map lies that row once more.
    let again = map.wrap == GLINT_WRAP_CLAMP && at.y < 0;
    let codes = glint_lobes_bilinear(
        glint_lobes_codes(left.x),
        glint_lobes_codes(right.x),
        glint_lobes_codes(select(left.y, left.x, again)),
        glint_lobes_codes(select(right.y, right.x, again)),
        f,
    );
    let scale = glint_lobes_normals_scale(map);
    let slope = select(scale.x, 0.0, map.nearest == 1u);
    return GlintLobesPatch(codes.normal * scale.x + scale.y, codes.jacobian * slope, codes.twist * slope);
}

// Projected normal, Jacobian and twist of the filtered map at a place in it.
fn glint_lobes_surface_at(map: GlintLobesMap, u: vec2f) -> GlintLobesPatch {
    let nearest = map.nearest == 1u;
    let p = select(u - 0.5, u, nearest);
    let cell = floor(p);
    return glint_lobes_patch(map, vec2i(cell), select(p - cell, vec2f(0.0), nearest));
}

// Edge of the boxes that a footprint is resolved in: a power of two, at most a texel.
fn glint_lobes_box_edge(map: GlintLobesMap, frame: GlintLobesFrame, settings: GlintLobesSettings) -> f32 {
    // The seam of a clamped map cuts through whole-texel boxes.
    let clamped = map.step_texels == 0u && map.wrap == GLINT_WRAP_CLAMP && map.nearest == 0u;
    var edge = select(1.0, 0.5, clamped);
    let a = settings.reach * frame.major;
    let b = settings.reach * frame.minor;
    for (var k = 0; k < 16; k++) {
        let half = 0.5 * edge;
        if !(edge > settings.box_sigmas * frame.minor && edge > 2.0 * GLINT_LOBES_LEAST_SIGMA)
            || GLINT_LOBES_PI * (a + half) * (b + half) > settings.max_boxes * half * half {
            break;
        }
        edge = half;
    }
    return edge;
}

// The two levels that serve a footprint, and how they are mixed (Eq. 9).
fn glint_lobes_lod(map: GlintLobesMap, frame: GlintLobesFrame, settings: GlintLobesSettings) -> GlintLobesLod {
    let finest = f32(glint_lobes_level(0u).cell_texels);
    // Cells of edge c = sigma / cell_sigmas that the footprint's ellipse touches: about pi (r a + h c) (r b + h c) / c^2 with
    // its half axes r a, r b and h c half a cell's mean width. Solved for the sigma at which they are `max_cells`.
    let a = settings.reach * frame.major;
    let b = settings.reach * frame.minor;
    let h = 0.45;
    // A map narrower than the finest cells cuts them short, and as many times more of them lie under a footprint.
    let allowed = settings.max_cells * min(f32(map.width) / finest, 1.0) * min(f32(map.height) / finest, 1.0);
    let budget = max(allowed / GLINT_LOBES_PI - h * h, GLINT_LOBES_LEAST_BUDGET);
    let edge = (h * (a + b) + sqrt(h * h * (a + b) * (a + b) + 4.0 * budget * a * b)) / (2.0 * budget);
    let sigma = max(frame.minor, edge * settings.cell_sigmas);
    let cells = 1.0 + log2(sigma / (finest * settings.cell_sigmas));
    // Boxes end by the footprint's size, or where there would be more of them than allowed, be they whole texels.
    let by_size = log2(sigma / (finest * settings.boxes_until)) / log2(settings.cells_from / settings.boxes_until);
    let by_count = 1.0 + log2(GLINT_LOBES_PI * (a + h) * (b + h) / settings.max_boxes) / settings.blend;
    let boxes = clamp(max(by_size, by_count), 0.0, 1.0);
    let most = f32(map.levels + 1u);
    let lambda = select(clamp(cells, 1.0, most), boxes, boxes < 1.0);
    let finer = min(floor(lambda), f32(map.levels));
    var fraction = lambda - finer;
    var box_edge = 1.0;
    if finer == 0.0 {
        box_edge = glint_lobes_box_edge(map, frame, settings);
    } else {
        // The finer of two stored levels serves alone at first: nearer to the map, and only one level is read.
        fraction = max(1.0 - (1.0 - fraction) / settings.blend, 0.0);
    }
    return GlintLobesLod(u32(finer), fraction, box_edge);
}

// The first of the cells of `edge` texels, `count` of them in every `length`, that touch what lies above `low`.
fn glint_lobes_first_slot(low: f32, length: f32, edge: f32, count: u32) -> GlintLobesSlot {
    let copy = floor(low / length);
    return GlintLobesSlot(min(u32(max((low - copy * length) / edge, 0.0)), count - 1u), copy);
}

fn glint_lobes_next_slot(slot: GlintLobesSlot, count: u32) -> GlintLobesSlot {
    if slot.index + 1u >= count {
        return GlintLobesSlot(0u, slot.copy + 1.0);
    }
    return GlintLobesSlot(slot.index + 1u, slot.copy);
}

// Density and share of the lobes of a cell whose first lobe is `first` and whose corner lies at `corner`. The mass inside the
// disk takes long and few lobes need it: it stands outside the loop over the others, which ends where one does.
fn glint_lobes_cell(
    map: GlintLobesMap,
    query: GlintLobesQuery,
    level: GlintLobesLevel,
    first: u32,
    corner: vec2f,
) -> vec2f {
    let d = query.frame.mean - corner;
    var sum = vec2f(0.0);
    var k = 0u;
    while k < map.lobes_per_cell {
        var seen = GlintSeenLobe();
        while k < map.lobes_per_cell && !seen.cut {
            let lobe = glint_lobes_lobe(map, level, first + k);
            seen = glint_lobes_seen(query, lobe, d - lobe.position);
            sum += vec2f(select(seen.density, 0.0, seen.cut), seen.share);
            k += 1u;
        }
        if seen.cut {
            sum.x += seen.density / glint_lobes_inside_disk(seen.mean, seen.covariance);
        }
    }
    return sum;
}

// Density and share of a stored level's cells under the footprint on the repeated map. `whole` sees each of the level's cells
// once, as a footprint does that sees every place alike.
fn glint_lobes_cells(
    map: GlintLobesMap,
    given: GlintLobesQuery,
    level: GlintLobesLevel,
    reach: f32,
    whole: bool,
) -> vec2f {
    var size = vec2f(f32(map.width), f32(map.height));
    let edge = f32(level.cell_texels);
    var query = given;
    if whole {
        size = vec2f(f32(level.cells_x), f32(level.cells_y)) * edge;
        query.frame.mean = 0.5 * size;
        query.along = vec2f(0.0);
        query.across = vec2f(0.0);
    }
    let frame = query.frame;
    // From a little inside the first cell to a little inside the last.
    let all = 0.5 * size - 0.25;
    let top = select(glint_lobes_reach_y(frame, reach), all.y, whole);
    var sum = vec2f(0.0);
    var row = glint_lobes_first_slot(frame.mean.y - top, size.y, edge, level.cells_y);
    for (var j = 0u; j < GLINT_LOBES_MOST_STEPS; j++) {
        let start = row.copy * size.y + f32(row.index) * edge;
        if !(start <= frame.mean.y + top) {
            break;
        }
        let end = min(start + edge, (row.copy + 1.0) * size.y);
        let under = glint_lobes_span_x(frame, reach, start, end);
        let span = select(under, vec2f(frame.mean.x - all.x, frame.mean.x + all.x), whole);
        if span.x <= span.y {
            var slot = glint_lobes_first_slot(span.x, size.x, edge, level.cells_x);
            for (var i = 0u; i < GLINT_LOBES_MOST_STEPS; i++) {
                let left = slot.copy * size.x + f32(slot.index) * edge;
                if !(left <= span.y) {
                    break;
                }
                let displacement = vec2f(slot.copy, row.copy) * size;
                let corner = vec2f(f32(slot.index), f32(row.index)) * edge + displacement;
                let first = level.first_lobe + (row.index * level.cells_x + slot.index) * map.lobes_per_cell;
                sum += glint_lobes_cell(map, query, level, first, corner);
                slot = glint_lobes_next_slot(slot, level.cells_x);
            }
        }
        row = glint_lobes_next_slot(row, level.cells_y);
    }
    return sum;
}

// Density and share of boxes of `edge` texels under the footprint on the repeated map; as in a cell, the loops end where a box
// needs the mass inside the disk.
fn glint_lobes_boxes(map: GlintLobesMap, query: GlintLobesQuery, edge: f32, reach: f32) -> vec2f {
    let frame = query.frame;
    let size = vec2f(f32(map.width), f32(map.height));
    // Boxes of a bilinear map begin at texel centres, where its patches do.
    let origin = select(0.5, 0.0, map.nearest == 1u);
    let top = glint_lobes_reach_y(frame, reach);
    var j = i32(floor((frame.mean.y - top - origin) / edge));
    let last = min(i32(floor((frame.mean.y + top - origin) / edge)), j + i32(GLINT_LOBES_MOST_STEPS));
    var row = glint_lobes_row(frame, reach, origin, edge, origin + f32(j) * edge);
    var sum = vec2f(0.0);
    while j <= last {
        var seen = GlintSeenLobe();
        while j <= last && !seen.cut {
            let y = origin + (f32(j) + 0.5) * edge;
            while row.x <= row.y && !seen.cut {
                let place = vec2f(origin + (f32(row.x) + 0.5) * edge, y);
                let copy = floor(place / size) * size;
                let centre = place - copy;
                let lobe = glint_lobes_box_lobe(glint_lobes_surface_at(map, centre), vec2f(edge));
                seen = glint_lobes_seen(query, lobe, frame.mean - centre - copy);
                sum += vec2f(select(seen.density, 0.0, seen.cut), seen.share);
                row.x += 1;
            }
            if !seen.cut {
                j += 1;
                row = glint_lobes_row(frame, reach, origin, edge, origin + f32(j) * edge);
            }
        }
        if seen.cut {
            sum.x += seen.density / glint_lobes_inside_disk(seen.mean, seen.covariance);
        }
    }
    return sum;
}

// Density and share of a level: 0 boxes, then the stored ones, then the whole map.
fn glint_lobes_level_sum(
    map: GlintLobesMap,
    query: GlintLobesQuery,
    level: u32,
    box_edge: f32,
    reach: f32,
) -> vec2f {
    if level == 0u {
        return glint_lobes_boxes(map, query, box_edge, reach);
    }
    let stored = glint_lobes_level(min(level, map.levels) - 1u);
    return glint_lobes_cells(map, query, stored, reach, level > map.levels);
}

// P-NDF at the query's normal of a footprint on the repeated map: density over the disk, 0 outside it. The frame is that of
// glint_lobes_frame_in_map.
fn glint_lobes_p_ndf(map: GlintLobesMap, query: GlintLobesQuery, settings: GlintLobesSettings) -> f32 {
    if !(dot(query.s, query.s) <= 1.0) {
        return 0.0;
    }
    let lod = glint_lobes_lod(map, query.frame, settings);
    let whole = map.levels + 1u;
    let last = select(lod.finer, lod.finer + 1u, lod.fraction > 0.0);
    var density = 0.0;
    var at = select(lod.finer, last, lod.fraction >= 1.0);
    var level = at;
    while at <= last {
        let sum = glint_lobes_level_sum(map, query, level, lod.box_edge, settings.reach);
        if !(sum.y >= GLINT_LOBES_LEAST_SHARE) && level < whole {
            level = whole;
            continue;
        }
        density += select(1.0 - lod.fraction, lod.fraction, at > lod.finer) * sum.x / max(sum.y, GLINT_LOBES_LEAST_SHARE);
        at += 1u;
        level = at;
    }
    return density;
}
