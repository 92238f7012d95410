// Which lobes a footprint sees on the repeated map: boxes of the map, cells of the stored levels, or all of the last one, and the
// mixture of two levels. Tan et al. 2022, section 5.2, Eq. 9. Twin of query.rs. Accessors: those of lobes::eval.

#import lobes::boxes

// Sum of shares below which f32 cannot tell what a footprint sees; the last level is the best that is known then.
const GLINT_LOBES_LEAST_SHARE: f32 = 1.0e-30;
// Half of a cell's mean width, over its edge.
const GLINT_LOBES_HALF_WIDTH: f32 = 0.45;
// Cells a footprint may visit, over pi and less h^2 (see glint_lobes_lod), at least.
const GLINT_LOBES_LEAST_BUDGET: f32 = 0.05;

// Choice between speed and accuracy. Standard deviations are those of the footprint, edges those of cells and boxes, both in texels.
struct GlintLobesSettings {
    // Minor standard deviation over a stored level's edge from which on that level is read, at first without the next one.
    cell_sigmas: f32,
    // Minor standard deviation over the finest stored edge up to which boxes alone are read.
    boxes_until: f32,
    // Minor standard deviation over the finest stored edge from which on no boxes are read; above boxes_until.
    cells_from: f32,
    // Edge of the largest boxes over the minor standard deviation.
    box_sigmas: f32,
    // Cells of a level that a footprint visits, about.
    max_cells: f32,
    // Boxes that a footprint visits, about.
    max_boxes: f32,
    // Standard deviations that a footprint reaches where boxes are read.
    reach: f32,
    // Standard deviations that a footprint reaches where cells are read, whose lobes reach beyond them.
    cells_reach: f32,
    // Part of the way from a stored level to the next over which both are read, above 0 to 1.
    blend: f32,
}

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

// Those that a bake measures its error with.
fn glint_lobes_default() -> GlintLobesSettings {
    return GlintLobesSettings(0.7, 0.25, 0.375, 0.25, 32.0, 1024.0, 3.0, 3.0, 0.5);
}

// Few lobes, for pictures: about two cells of the map's lobes, or some twenty boxes, a footprint.
fn glint_lobes_realtime() -> GlintLobesSettings {
    return GlintLobesSettings(0.18, 0.22, 0.24, 1.1, 2.0, 48.0, 1.8, 1.1, 0.15);
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

// Range of x of an ellipse over a row of cells that begins at `start`; all of the level's for `whole`, x > y if there are none.
fn glint_lobes_cells_span(
    ellipse: GlintLobesEllipse,
    size: vec2f,
    start: f32,
    edge: f32,
    row: GlintLobesSlot,
    all: vec2f,
    whole: bool,
) -> vec2f {
    let under = glint_lobes_ellipse_span(ellipse, start, min(start + edge, (row.copy + 1.0) * size.y));
    return select(under, vec2f(ellipse.mean.x - all.x, ellipse.mean.x + all.x), whole);
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

// Level up to which a footprint reads cells of a map: from where it would visit half of the last level's on, all of them alike come in,
// which serve it alone where it would visit as many as there are.
fn glint_lobes_most_level(map: GlintLobesMap, frame: GlintLobesFrame, settings: GlintLobesSettings) -> f32 {
    // The last level of a surface is the whole.
    if map.step_texels != 0u {
        return f32(map.levels + 1u);
    }
    let last = glint_lobes_level(map.levels - 1u);
    let reach = settings.cells_reach / f32(last.cell_texels);
    let h = GLINT_LOBES_HALF_WIDTH;
    let visited = GLINT_LOBES_PI * (reach * frame.major + h) * (reach * frame.minor + h);
    let share = 1.0 + log2(visited / f32(last.cells_x * last.cells_y));
    return f32(map.levels) + clamp(share, 0.0, 1.0);
}

// The two levels that serve a footprint, and how they are mixed (Eq. 9).
fn glint_lobes_lod(map: GlintLobesMap, frame: GlintLobesFrame, settings: GlintLobesSettings) -> GlintLobesLod {
    let finest = f32(glint_lobes_level(0u).cell_texels);
    // Cells of edge c = sigma / cell_sigmas that the footprint's ellipse touches: about pi (r a + h c) (r b + h c) / c^2 with
    // its half axes r a, r b and h c half a cell's mean width. Solved for the sigma at which they are `max_cells`.
    let a = settings.reach * frame.major;
    let b = settings.reach * frame.minor;
    let h = GLINT_LOBES_HALF_WIDTH;
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
    let stored = min(clamp(cells, 1.0, most), glint_lobes_most_level(map, frame, settings));
    let lambda = select(stored, boxes, boxes < 1.0);
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

// Density of those lobes of a cell that need the mass inside the disk: few, and it takes long. The loop over lobes ends where one
// does.
fn glint_lobes_cut_lobes(
    map: GlintLobesMap,
    query: GlintLobesQuery,
    level: GlintLobesLevel,
    first: u32,
    d: vec2f,
) -> f32 {
    var sum = 0.0;
    var k = 0u;
    while k < map.lobes_per_cell {
        var given = GlintConditionalLobe();
        while k < map.lobes_per_cell && !given.cut {
            let lobe = glint_lobes_lobe(map, level, first + k);
            given = glint_lobes_conditional(query, lobe, d - lobe.position);
            k += 1u;
        }
        if given.cut {
            sum += given.density / glint_lobes_inside_disk(given.mean, given.covariance);
        }
    }
    return sum;
}

// Density and share of the lobes of a cell whose first lobe is `first` and whose corner lies at `corner`. No lobe waits for
// the one before it.
fn glint_lobes_cell(
    map: GlintLobesMap,
    query: GlintLobesQuery,
    level: GlintLobesLevel,
    first: u32,
    corner: vec2f,
) -> vec2f {
    let d = query.frame.mean - corner;
    var sum = vec3f(0.0);
    for (var k = 0u; k < map.lobes_per_cell; k++) {
        let lobe = glint_lobes_lobe(map, level, first + k);
        let given = glint_lobes_conditional(query, lobe, d - lobe.position);
        sum += vec3f(select(given.density, 0.0, given.cut), given.share, select(0.0, 1.0, given.cut));
    }
    if glint_lobes_rim && sum.z > 0.0 {
        sum.x += glint_lobes_cut_lobes(map, query, level, first, d);
    }
    return sum.xy;
}

// Density and share of a stored level's cells under the footprint on the repeated map. `whole` sees each of the level's cells
// once, as a footprint does that sees every place alike.
fn glint_lobes_cells(
    map: GlintLobesMap,
    query: GlintLobesQuery,
    level: GlintLobesLevel,
    reach: f32,
    whole: bool,
) -> vec2f {
    var size = vec2f(f32(map.width), f32(map.height));
    let edge = f32(level.cell_texels);
    var placed = query;
    if whole {
        size = vec2f(f32(level.cells_x), f32(level.cells_y)) * edge;
        placed.frame.mean = 0.5 * size;
        placed.along = vec2f(0.0);
        placed.across = vec2f(0.0);
    }
    let frame = placed.frame;
    // From a little inside the first cell to a little inside the last.
    let all = 0.5 * size - 0.25;
    let ellipse = glint_lobes_ellipse(frame, reach);
    let top = select(ellipse.top, all.y, whole);
    var sum = vec2f(0.0);
    // One loop over rows and columns: of pixels that run in step few have their longest rows together.
    var row = glint_lobes_first_slot(frame.mean.y - top, size.y, edge, level.cells_y);
    var start = row.copy * size.y + f32(row.index) * edge;
    var span = glint_lobes_cells_span(ellipse, size, start, edge, row, all, whole);
    var slot = glint_lobes_first_slot(span.x, size.x, edge, level.cells_x);
    for (var i = 0u; i < GLINT_LOBES_MOST_STEPS && start <= frame.mean.y + top; i++) {
        if slot.copy * size.x + f32(slot.index) * edge <= span.y {
            let corner = vec2f(f32(slot.index), f32(row.index)) * edge + vec2f(slot.copy, row.copy) * size;
            let first = level.first_lobe + (row.index * level.cells_x + slot.index) * map.lobes_per_cell;
            sum += glint_lobes_cell(map, placed, level, first, corner);
        }
        slot = glint_lobes_next_slot(slot, level.cells_x);
        if !(slot.copy * size.x + f32(slot.index) * edge <= span.y) {
            row = glint_lobes_next_slot(row, level.cells_y);
            start = row.copy * size.y + f32(row.index) * edge;
            span = glint_lobes_cells_span(ellipse, size, start, edge, row, all, whole);
            slot = glint_lobes_first_slot(span.x, size.x, edge, level.cells_x);
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
    settings: GlintLobesSettings,
) -> vec2f {
    if level == 0u {
        return glint_lobes_boxes(map, query, box_edge, settings.reach);
    }
    let stored = glint_lobes_level(min(level, map.levels) - 1u);
    return glint_lobes_cells(map, query, stored, settings.cells_reach, level > map.levels);
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
        let sum = glint_lobes_level_sum(map, query, level, lod.box_edge, settings);
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
