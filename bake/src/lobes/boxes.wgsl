// The filtered map, and boxes of it under a footprint: of a texel or less, one bilinear patch each. Tan et al. 2022, sections
// 5.1.2 and 5.2. Twin of boxes.rs, whose boxes are lobes like others. Here what boxes of one size have in common is found once, since
// most of what a picture costs are boxes. Accessors: those of lobes::eval.

#import lobes::eval

// A footprint that boxes of one size are seen by. What is the same for all of them is here: a box costs little more than the
// look-up of its patch.
struct GlintLobesBoxFilter {
    // The axes over the standard deviations of the footprint and a box together.
    along: vec2f,
    across: vec2f,
    // The axes times the standard deviations of what a footprint sees of a box around its centre, in the normals' stored numbers.
    within_along: vec2f,
    within_across: vec2f,
    // How far a box's mean is drawn to the footprint, in standard deviations of what it sees of the box.
    pull: vec2f,
    // Share of a box at the footprint's centre.
    share: f32,
    // Standard deviation of normals over a box's twist, in the normals' stored numbers.
    twist: f32,
}

// Stored numbers of a texel's normal.
fn glint_lobes_codes(word: u32) -> vec2f {
    return vec2f(f32(bitcast<i32>(word << 16u) >> 16u), f32(bitcast<i32>(word) >> 16u));
}

// A bilinear patch from its texels, at the fraction `f`.
fn glint_lobes_bilinear(s00: vec2f, s10: vec2f, s01: vec2f, s11: vec2f, f: vec2f) -> GlintLobesPatch {
    let top = s00 + (s10 - s00) * f.x;
    let bottom = s01 + (s11 - s01) * f.x;
    let twist = s11 - s10 - s01 + s00;
    let along = s10 - s00 + twist * f.y;
    return GlintLobesPatch(top + (bottom - top) * f.y, mat2x2f(along, bottom - top), twist);
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

// Projected normal of texel (i, j), which lies less than the map's size beyond its edges.
fn glint_lobes_texel(map: GlintLobesMap, i: i32, j: i32) -> vec2f {
    let at = glint_lobes_wrapped(map, vec2i(i, j));
    let scale = glint_lobes_normals_scale(map);
    return glint_lobes_codes(glint_lobes_normals_pair(u32(at.y) * map.width + u32(at.x)).x) * scale.x + scale.y;
}

// Stored numbers of a texel in xy and of the one below it in zw; `again` takes the texel for both.
fn glint_lobes_pair(index: u32, again: bool) -> vec4f {
    let pair = glint_lobes_normals_pair(index);
    return vec4f(glint_lobes_codes(pair.x), glint_lobes_codes(select(pair.y, pair.x, again)));
}

// The bilinear patch from texel `at` on, which lies less than the map's size beyond its edges, at the fraction `f`. A nearest
// texel has no slopes.
fn glint_lobes_patch(map: GlintLobesMap, at: vec2i, f: vec2f) -> GlintLobesPatch {
    let place = glint_lobes_wrapped(map, at);
    let beside = glint_lobes_wrapped(map, at + vec2i(1, 0)).x;
    let row = u32(place.y) * map.width;
    // Above the first row of a clamped map lies that row once more.
    let again = map.wrap == GLINT_WRAP_CLAMP && at.y < 0;
    let left = glint_lobes_pair(row + u32(place.x), again);
    let right = glint_lobes_pair(row + u32(beside), again);
    let codes = glint_lobes_bilinear(left.xy, right.xy, left.zw, right.zw, f);
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

// Texels from one copy of the map to the next. Beyond a clamped sample of a surface lies its edge, with no copies.
fn glint_lobes_repeat(map: GlintLobesMap) -> vec2f {
    let none = map.wrap == GLINT_WRAP_CLAMP && map.step_texels != 0u;
    return select(vec2f(f32(map.width), f32(map.height)), vec2f(0.0), none);
}

fn glint_lobes_box_filter(map: GlintLobesMap, frame: GlintLobesFrame, edge: f32) -> GlintLobesBoxFilter {
    let scale = glint_lobes_normals_scale(map).x;
    // Variance of a box's places along any axis.
    let variance = edge * edge / 12.0;
    let sigma = sqrt(variance);
    let wide = inverseSqrt(vec2f(frame.major * frame.major, frame.minor * frame.minor) + variance);
    let across = vec2f(-frame.axis.y, frame.axis.x);
    let within = sigma * scale * vec2f(frame.major, frame.minor) * wide;
    return GlintLobesBoxFilter(
        frame.axis * wide.x,
        across * wide.y,
        frame.axis * within.x,
        across * within.y,
        sigma / vec2f(frame.major, frame.minor),
        edge * edge * frame.major * frame.minor * wide.x * wide.y,
        variance * scale,
    );
}

// Density and share of a box of the filtered map, over those that are the same for all boxes, and 1 if the mass inside the disk
// may be less than 1, when the density is left out. Exact moments, as glint_lobes_box_lobe has them. `scale` and `linear` are
// those of glint_lobes_boxes. `d` is from the box's middle to the footprint's; `left` and `right` the stored numbers of texels
// beside it, the upper in xy and the lower in zw; `f` where the box lies between them.
fn glint_lobes_box(
    box: GlintLobesBoxFilter,
    query: GlintLobesQuery,
    scale: vec2f,
    linear: f32,
    d: vec2f,
    left: vec4f,
    right: vec4f,
    f: vec2f,
) -> vec3f {
    let beside = (right - left) * linear;
    let mid = left + beside * f.x;
    let down = (mid.zw - mid.xy) * linear;
    let normal = mid.xy + down * f.y;
    let twist = beside.zw - beside.xy;
    let along = beside.xy + twist * f.y;
    let w = vec2f(dot(box.along, d), dot(box.across, d));
    let a = along * box.within_along.x + down * box.within_along.y;
    let b = along * box.within_across.x + down * box.within_across.y;
    let pull = w * box.pull;
    let mean = normal * scale.x + scale.y + a * pull.x + b * pull.y;
    let rest = twist * box.twist;
    let intrinsic = query.roughness * query.roughness;
    let xx = intrinsic + (rest.x * rest.x + a.x * a.x + b.x * b.x);
    let xy = rest.x * rest.y + a.x * a.y + b.x * b.y;
    let yy = intrinsic + (rest.y * rest.y + a.y * a.y + b.y * b.y);
    let share = exp(-0.5 * dot(w, w));
    let peak = inverseSqrt(max(xx * yy - xy * xy, intrinsic * max(xx, yy)));
    let e = query.s - mean;
    let far = (yy * e.x * e.x - 2.0 * xy * e.x * e.y + xx * e.y * e.y) * peak * peak;
    let cut = glint_lobes_near_rim(mean, vec3f(xx, xy, yy));
    let near = far <= GLINT_LOBES_CUT;
    return vec3f(
        select(0.0, share * peak * exp(-0.5 * far), near && !cut), share, select(0.0, 1.0, near && cut),
    );
}

// Density of those boxes that need the mass inside the disk: few, and it takes long. The loops over boxes end where one does.
fn glint_lobes_cut_boxes(map: GlintLobesMap, query: GlintLobesQuery, edge: f32, reach: f32) -> f32 {
    let frame = query.frame;
    let size = vec2f(f32(map.width), f32(map.height));
    // Boxes of a bilinear map begin at texel centres, where its patches do.
    let origin = select(0.5, 0.0, map.nearest == 1u);
    let ellipse = glint_lobes_ellipse(frame, reach);
    let top = ellipse.top;
    var j = i32(floor((frame.mean.y - top - origin) / edge));
    let last = min(i32(floor((frame.mean.y + top - origin) / edge)), j + i32(GLINT_LOBES_MOST_STEPS));
    var row = glint_lobes_row(ellipse, origin, edge, origin + f32(j) * edge);
    var sum = 0.0;
    while j <= last {
        var given = GlintConditionalLobe();
        while j <= last && !given.cut {
            let y = origin + (f32(j) + 0.5) * edge;
            while row.x <= row.y && !given.cut {
                let place = vec2f(origin + (f32(row.x) + 0.5) * edge, y);
                let copy = floor(place / size) * glint_lobes_repeat(map);
                let centre = place - copy;
                let lobe = glint_lobes_box_lobe(glint_lobes_surface_at(map, centre), vec2f(edge));
                given = glint_lobes_conditional(query, lobe, frame.mean - centre - copy);
                row.x += 1;
            }
            if !given.cut {
                j += 1;
                row = glint_lobes_row(ellipse, origin, edge, origin + f32(j) * edge);
            }
        }
        if given.cut {
            sum += given.density / glint_lobes_inside_disk(given.mean, given.covariance);
        }
    }
    return sum;
}

// Density and share of boxes of `edge` texels under the footprint on the repeated map. A box reads the texels on its right and
// has those on its left from the one before it.
fn glint_lobes_boxes(map: GlintLobesMap, query: GlintLobesQuery, edge: f32, reach: f32) -> vec2f {
    let frame = query.frame;
    let size = vec2f(f32(map.width), f32(map.height));
    let clamped = map.wrap == GLINT_WRAP_CLAMP;
    let repeat = glint_lobes_repeat(map);
    let nearest = map.nearest == 1u;
    let linear = select(1.0, 0.0, nearest);
    // Boxes of a bilinear map begin at texel centres, where its patches do.
    let origin = select(0.5, 0.0, nearest);
    let half = 0.5 * edge;
    let per_edge = 1.0 / edge;
    let per_size = 1.0 / size;
    let most = f32(GLINT_LOBES_MOST_STEPS);
    let scale = glint_lobes_normals_scale(map);
    let ellipse = glint_lobes_ellipse(frame, reach);
    let box = glint_lobes_box_filter(map, frame, edge);
    let first = floor((frame.mean.y - ellipse.top - origin) * per_edge);
    let rows = i32(min(floor((frame.mean.y + ellipse.top - origin) * per_edge) - first + 1.0, most));
    var y = origin + half + edge * first;
    var sum = vec3f(0.0);
    for (var j = 0; j < rows; j++) {
        let span = glint_lobes_ellipse_span(ellipse, y - half, y + half);
        let ends = floor((span - origin) * per_edge);
        let columns = i32(select(0.0, min(ends.y - ends.x + 1.0, most), span.x <= span.y));
        var x = origin + half + edge * ends.x;
        let place = vec2f(x, y);
        let p = place - floor(place * per_size) * repeat - origin;
        let cell = floor(p);
        let texel = glint_lobes_wrapped(map, vec2i(cell));
        let again = clamped && cell.y < 0.0;
        let row = u32(texel.y) * map.width;
        // Where the box lies in the map, and between the texels beside it; the first one has none before it.
        var u = p.x;
        var passed = 2.0;
        var left = vec4f(0.0);
        var right = glint_lobes_pair(row + u32(texel.x), again);
        for (var i = 0; i < columns; i++) {
            let column = floor(u);
            let f = u - column;
            left = select(left, right, f <= passed);
            passed = f;
            var beside = column + linear;
            beside -= select(0.0, size.x, beside >= size.x && !clamped);
            right = glint_lobes_pair(row + u32(clamp(beside, 0.0, size.x - 1.0)), again);
            // Before the first column of a clamped map lies that column once more; nearest texels are those of the box.
            left = select(left, right, nearest || (clamped && column < 0.0));
            sum += glint_lobes_box(box, query, scale, linear, frame.mean - vec2f(x, y), left, right, vec2f(f, p.y - cell.y));
            x += edge;
            u += edge;
            u -= select(0.0, repeat.x, u + origin >= size.x);
        }
        y += edge;
    }
    let read = sum.xy * box.share * vec2f(GLINT_LOBES_PEAK, 1.0);
    if glint_lobes_rim && sum.z > 0.0 {
        return read + vec2f(glint_lobes_cut_boxes(map, query, edge, reach), 0.0);
    }
    return read;
}
