// Multi-scale NDF maps of tiny examples on a covered surface: the density of normals under a footprint.
// Xing et al. 2024, "A Tiny Example Based Procedural Model for Real-Time Glinty Appearance Rendering", sections 5 and 6.3,
// Eq. 1. Twin of glint-bake-core ndf_maps/{eval,surface,placement}.rs, where deviations from the paper are derived. The CPU
// lists the tiles and lobes of a footprint and then sums; here the sum is taken on the way, in the same order.
//
// Accessors that the including program defines:
//   fn glint_ndf_record(at: u32) -> vec4u   sixteen bytes of the tables: levels, tiles, palette, noise
//   fn glint_ndf_word(at: u32) -> u32       four bytes of the texels: density, normals, classes, reach. One word before and
//                                           after a section may be asked for; what is there does not matter
// Both read little-endian sections as they lie in the pack; GlintNdfMaterial says where each begins. Several materials may
// share the two buffers.

const GLINT_NDF_SQRT_U8: u32 = 0u;
const GLINT_NDF_F16: u32 = 1u;
const GLINT_NDF_PAPER_F32: u32 = 2u;
const GLINT_NDF_REPEAT: u32 = 0u;
const GLINT_NDF_CLAMP: u32 = 1u;

// Edge, in example texels, of the boxes that are seen as lobes, at most.
const GLINT_NDF_LOBE_TEXELS: f32 = 1.0;
// Sub-regions of a stochastic surface that a footprint visits, at most.
const GLINT_NDF_MAX_REGIONS: f32 = 64.0;
// From this minor axis on (in sub-regions), where top tiles are enough, one tells all of a sub-region.
const GLINT_NDF_WHOLE_REGION_SIGMA: f32 = 0.5;
// From this minor axis on (in example edges) the top tile is enough for tiled examples.
const GLINT_NDF_TOP_TILE_SIGMA: f32 = 0.5;
// Pieces under a footprint that is widened by their own size, at most, relative to max_terms.
const GLINT_NDF_MOST_OF_TERMS: f32 = 4.0;
// A tile that a sub-region cuts is split from this share on, relative to an even share of max_terms.
const GLINT_NDF_SPLIT_FROM: f32 = 2.0;
const GLINT_NDF_MAX_SPLITS: u32 = 6u;
// From this minor axis on (in cells) a stochastic surface is seen as shares of transforms.
const GLINT_NDF_CLASS_SIGMA_CELLS: f32 = 1.0;
// Largest palette, in groups of four.
const GLINT_NDF_MAX_LAYERS: u32 = 8u;
// Cells of the reach mask along an axis of [-1, 1]^2.
const GLINT_NDF_REACH_CELLS: u32 = 128u;

// One material: sections NMPP and PLPP, and where the others begin.
struct GlintNdfMaterial {
    // Example, in texels.
    size: vec2u,
    // What lies beyond the example's edge: GLINT_NDF_REPEAT or GLINT_NDF_CLAMP.
    wrap: u32,
    // GLINT_NDF_SQRT_U8, _F16 or _PAPER_F32.
    storage: u32,
    // Standard deviation of the lobe of a normal, in the projected-normal disk.
    intrinsic_roughness: f32,
    levels: u32,
    palette: u32,
    // Cells of the stochastic placement along an axis, a power of two; 0 means tiled.
    cells: u32,
    // Edge of a cell in surface texels.
    cell_texels: f32,
    // First record of: the levels, one each: tile_texels, tiles_x, tiles_y, first_tile.
    level_records: u32,
    // The tiles (section NMTI), two each.
    tile_records: u32,
    // The palette (section PLPL), two each.
    palette_records: u32,
    // The noise map (section PLNO), one a cell.
    noise_records: u32,
    // First word of: the density (section NMDE).
    density_words: u32,
    // The normals (section NMNO), one each.
    normal_words: u32,
    // The classes (section PLCL).
    class_words: u32,
    // The reach mask, see glint_ndf_reaches.
    reach_words: u32,
}

// Choice between speed and accuracy at run time.
struct GlintNdfSettings {
    // Largest tile, or block of cells, in standard deviations of the footprint's minor axis.
    tile_sigmas: f32,
    // Largest box that is seen as one lobe, likewise.
    lobe_sigmas: f32,
    // Tiles or lobes in the area of the footprint's ellipse, at most, but for those that sub-regions cut.
    max_terms: u32,
    // How often a tile that a sub-region shows only in part is split, 0 to GLINT_NDF_MAX_SPLITS.
    splits: u32,
}

// A sum over pieces of a footprint, not yet divided by its share.
struct GlintNdfSum {
    // Density times share.
    density: f32,
    share: f32,
    // Tiles and lobes visited.
    terms: f32,
}

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

struct GlintNdfNormal {
    // Projected normal and its derivatives along the example's axes, per texel.
    s: vec2f,
    du: vec2f,
    dv: vec2f,
}

fn glint_ndf_add(a: GlintNdfSum, b: GlintNdfSum) -> GlintNdfSum {
    return GlintNdfSum(a.density + b.density, a.share + b.share, a.terms + b.terms);
}

// ---- One tile ----

// Quadratic B-splines at p, in node distances from node 0: weights of the nodes floor(p + 1/2) - 1 and the next two.
fn glint_ndf_spline(p: f32) -> vec3f {
    let f = p - floor(p + 0.5);
    return vec3f(0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f));
}

// Density texels `at`, at + 1 and at + 2, relative to their tile's scale.
fn glint_ndf_texels(material: GlintNdfMaterial, at: i32) -> vec3f {
    if material.storage == GLINT_NDF_SQRT_U8 {
        let word = at >> 2u;
        let shift = u32(at & 3) * 8u;
        var bits = glint_ndf_word(material.density_words + u32(max(word, 0))) >> shift;
        if shift > 8u {
            bits |= glint_ndf_word(material.density_words + u32(word + 1)) << (32u - shift);
        }
        let root = vec3f(f32(bits & 255u), f32((bits >> 8u) & 255u), f32((bits >> 16u) & 255u)) / 255.0;
        return root * root;
    }
    if material.storage == GLINT_NDF_F16 {
        let word = at >> 1u;
        let a = unpack2x16float(glint_ndf_word(material.density_words + u32(max(word, 0))));
        let b = unpack2x16float(glint_ndf_word(material.density_words + u32(word + 1)));
        return select(vec3f(a, b.x), vec3f(a.y, b), (at & 1) == 1);
    }
    let first = material.density_words + u32(max(at, 0));
    return vec3f(
        bitcast<f32>(glint_ndf_word(first)),
        bitcast<f32>(glint_ndf_word(material.density_words + u32(at + 1))),
        bitcast<f32>(glint_ndf_word(material.density_words + u32(at + 2))),
    );
}

// Weighted sum of those of the three density texels from `at` on that lie inside the tile.
fn glint_ndf_row(material: GlintNdfMaterial, at: i32, weights: vec3f, inside: vec3<bool>) -> f32 {
    if !any(inside) {
        return 0.0;
    }
    // What lies beyond the tile may be no number.
    let v = select(vec3f(0.0), glint_ndf_texels(material, at), inside);
    return weights.x * v.x + weights.y * v.y + weights.z * v.z;
}

// Density of one tile at the example's projected normal `s`: quadratic splines over decoded texels (bilinear for the paper's
// storage), 0 outside the box.
fn glint_ndf_tile_density(material: GlintNdfMaterial, tile: u32, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    let place = bitcast<vec4f>(glint_ndf_record(material.tile_records + 2u * tile));
    let texels = glint_ndf_record(material.tile_records + 2u * tile + 1u);
    let size = vec2i(vec2u(texels.z & 0xffffu, texels.z >> 16u));
    let p = (s - place.xy) * place.zw;
    if !(all(p >= vec2f(-1.5)) && all(p <= vec2f(size) + 0.5)) {
        return 0.0;
    }
    var first = vec2i(floor(p + 0.5)) - 1;
    var across = glint_ndf_spline(p.x);
    var down = glint_ndf_spline(p.y);
    if material.storage == GLINT_NDF_PAPER_F32 {
        let cell = floor(p);
        let f = p - cell;
        first = vec2i(cell);
        across = vec3f(1.0 - f.x, f.x, 0.0);
        down = vec3f(1.0 - f.y, f.y, 0.0);
    }
    let columns = first.x + vec3i(0, 1, 2);
    let inside = columns >= vec3i(0) & columns < vec3i(size.x);
    let start = i32(texels.y) + first.y * size.x + first.x;
    let sum = down.x * glint_ndf_row(material, start, across, inside & vec3<bool>(first.y >= 0 && first.y < size.y))
        + down.y
            * glint_ndf_row(material, start + size.x, across, inside & vec3<bool>(first.y >= -1 && first.y + 1 < size.y))
        + down.z
            * glint_ndf_row(material, start + 2 * size.x, across, inside & vec3<bool>(first.y >= -2 && first.y + 2 < size.y));
    return bitcast<f32>(texels.x) * sum;
}

// ---- One lobe: a small box of the example, whose normals fill a parallelogram evenly ----

// Projected normal of texel (i, j), at most one texel outside the example.
fn glint_ndf_normal(material: GlintNdfMaterial, at: vec2i) -> vec2f {
    let size = vec2i(material.size);
    var texel = clamp(at, vec2i(0), size - 1);
    if material.wrap == GLINT_NDF_REPEAT {
        texel = select(select(at, at - size, at >= size), at + size, at < vec2i(0));
    }
    return unpack2x16snorm(glint_ndf_word(material.normal_words + u32(texel.y * size.x + texel.x)));
}

// Bilinear projected normal and its derivatives at `u` (example texels); the example repeats as a whole.
fn glint_ndf_normal_and_jacobian(material: GlintNdfMaterial, u: vec2f) -> GlintNdfNormal {
    let size = vec2f(material.size);
    let p = clamp(u - floor(u / size) * size, vec2f(0.0), size) - 0.5;
    let cell = floor(p);
    let f = p - cell;
    let at = vec2i(cell);
    let s00 = glint_ndf_normal(material, at);
    let s10 = glint_ndf_normal(material, at + vec2i(1, 0));
    let s01 = glint_ndf_normal(material, at + vec2i(0, 1));
    let s11 = glint_ndf_normal(material, at + vec2i(1, 1));
    let top = s00 + (s10 - s00) * f.x;
    let bottom = s01 + (s11 - s01) * f.x;
    return GlintNdfNormal(
        top + (bottom - top) * f.y, (s10 - s00) * (1.0 - f.y) + (s11 - s01) * f.y, bottom - top,
    );
}

// erf by Abramowitz and Stegun 7.1.26, absolute error 1.5e-7.
fn glint_ndf_erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.3275911 * abs(x));
    let poly = t * (0.2548296 + t * (-0.28449674 + t * (1.4214137 + t * (-1.4531521 + t * 1.0614054))));
    return select(-1.0, 1.0, x >= 0.0) * (1.0 - poly * exp(-x * x));
}

fn glint_ndf_normal_cdf(x: f32) -> f32 {
    return 0.5 * (1.0 + glint_ndf_erf(x * 0.70710678));
}

// A box of half width `half` and area 1, convolved with the unit Gaussian, at x.
fn glint_ndf_smoothed_box(x: f32, half: f32) -> f32 {
    // Below this width a box is a Gaussian to 1e-4, and the difference of two error functions loses digits.
    if half < 0.05 {
        return exp(-0.5 * x * x) / 2.5066283;
    }
    return (glint_ndf_normal_cdf(x + half) - glint_ndf_normal_cdf(x - half)) / (2.0 * half);
}

// Where in a box of half width `half` (as -1 to 1) a point most likely comes from that was seen at x after a unit Gaussian.
fn glint_ndf_place_in_box(x: f32, half: f32) -> f32 {
    return clamp(x * half / (half * half + 3.0), -1.0, 1.0);
}

// Mean of exp(t x) over x in -1 to 1.
fn glint_ndf_mean_exp(t: f32) -> f32 {
    let q = t * t;
    if q < 1.0 {
        return 1.0 + q / 6.0 * (1.0 + q / 20.0 * (1.0 + q / 42.0));
    }
    return (exp(t) - exp(-t)) / (2.0 * t);
}

// Mass on the disk's side of the rim next to `s`, as if that were straight.
fn glint_ndf_inside_rim(s: vec2f, a: vec2f, b: vec2f, sigma: f32) -> f32 {
    let radius = sqrt(dot(s, s));
    var outward = vec2f(1.0, 0.0);
    if radius > 0.0 {
        outward = s / radius;
    }
    let along_a = dot(outward, a);
    let along_b = dot(outward, b);
    let variance = sigma * sigma + (along_a * along_a + along_b * along_b) / 12.0;
    return glint_ndf_normal_cdf((1.0 - radius) / sqrt(variance));
}

// Mass inside the disk of a lobe around `s` with these edges: the mean over four pieces of the longer one.
fn glint_ndf_inside_disk(s: vec2f, long: vec2f, short: vec2f, sigma: f32) -> f32 {
    if sqrt(dot(s, s)) + 0.5 * (sqrt(dot(long, long)) + sqrt(dot(short, short))) + 5.0 * sigma < 1.0 {
        return 1.0;
    }
    let piece = long * 0.25;
    let sum = glint_ndf_inside_rim(s - 1.5 * piece, piece, short, sigma)
        + glint_ndf_inside_rim(s - 0.5 * piece, piece, short, sigma)
        + glint_ndf_inside_rim(s + 0.5 * piece, piece, short, sigma)
        + glint_ndf_inside_rim(s + 1.5 * piece, piece, short, sigma);
    return max(sum * 0.25, 1.0e-3);
}

// Density at the example's projected normal `s` of the box of edge `edge` (example texels) around `centre`, over the example's
// disk: its parallelogram of normals, tilted by how the footprint's logarithm changes over the box (`gradient`, per texel),
// convolved with the intrinsic lobe. What would leave the disk is put back.
fn glint_ndf_lobe_density(
    material: GlintNdfMaterial,
    centre: vec2f,
    edge: f32,
    gradient: vec2f,
    s: vec2f,
) -> f32 {
    // Beyond this many standard deviations the lobe is nothing.
    let cut = 5.0;
    // Largest tilt: a footprint that needs more is far thinner than its boxes.
    let most = vec2f(20.0);
    let sigma = material.intrinsic_roughness;
    let normal = glint_ndf_normal_and_jacobian(material, centre);
    let a = normal.du * edge;
    let b = normal.dv * edge;
    let a_is_long = dot(a, a) >= dot(b, b);
    let long = select(b, a, a_is_long);
    let short = select(a, b, a_is_long);
    let length = sqrt(dot(long, long));
    var along = vec2f(1.0, 0.0);
    if length > 0.0 {
        along = long / length;
    }
    let height = along.x * short.y - along.y * short.x;
    let half = vec2f(0.5 * length, 0.5 * abs(height)) / sigma;
    let offset = s - normal.s;
    let x = vec2f(dot(along, offset), along.x * offset.y - along.y * offset.x) * (1.0 / sigma);
    if abs(x.y) > half.y + cut {
        return 0.0;
    }
    var shear = 0.0;
    // Edges that are nearly parallel have no height to shear over.
    if abs(height) > 1.0e-3 * length {
        shear = dot(along, short) / height;
    }
    let on = x.x - shear * clamp(x.y, -half.y, half.y);
    if abs(on) > half.x + cut {
        return 0.0;
    }
    var tilt = select(gradient.yx, gradient, a_is_long) * (0.5 * edge);
    tilt = clamp(vec2f(tilt.x, tilt.y * select(-1.0, 1.0, height >= 0.0)), -most, most);
    // The places in the box that are inferred spread less than the box where the lobe blurs it.
    let inferred = tilt * half / sqrt(half * half + 3.0);
    let normalised = glint_ndf_inside_disk(normal.s, long, short, sigma)
        * glint_ndf_mean_exp(inferred.x) * glint_ndf_mean_exp(inferred.y);
    let tilted = tilt.x * glint_ndf_place_in_box(on, half.x) + tilt.y * glint_ndf_place_in_box(x.y, half.y);
    return exp(tilted) * glint_ndf_smoothed_box(on, half.x) * glint_ndf_smoothed_box(x.y, half.y)
        / (sigma * sigma * normalised);
}

// ---- The pieces of one placed example under the footprint ----

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

// ---- Tiled examples ----

fn glint_ndf_top_tile(material: GlintNdfMaterial) -> u32 {
    return glint_ndf_record(material.level_records + material.levels - 1u).w;
}

// m x modulo `period` (a whole number), nearest to 0; exact up to the last sum however large x is, by products of halves.
fn glint_ndf_product_within(m: f32, x: f32, period: f32) -> f32 {
    let mh = glint_upper_half(m);
    let xh = glint_upper_half(x);
    return (glint_ndf_rest_of(mh * xh, period) + glint_ndf_rest_of(mh * (x - xh), period))
        + (glint_ndf_rest_of((m - mh) * xh, period) + glint_ndf_rest_of((m - mh) * (x - xh), period));
}

// x modulo `period`, nearest to 0.
fn glint_ndf_rest_of(x: f32, period: f32) -> f32 {
    let exact = glint_keep(x);
    return glint_keep(exact - glint_keep(round(exact / period) * period));
}

// The point of a tiled example that lies at a surface position, within the example.
fn glint_ndf_tiled_place(material: GlintNdfMaterial, position: vec4f, place: vec2f) -> vec2f {
    let size = vec2f(material.size);
    let local = vec2f(
        glint_ndf_product_within(position.x, place.x, size.x) + glint_ndf_product_within(position.y, place.y, size.x),
        glint_ndf_product_within(position.z, place.x, size.y) + glint_ndf_product_within(position.w, place.y, size.y),
    );
    return local - floor(local / size) * size;
}

fn glint_ndf_tiled(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let position = bitcast<vec4f>(glint_ndf_record(material.palette_records));
    let normal = bitcast<vec4f>(glint_ndf_record(material.palette_records + 1u));
    let size = vec2f(material.size);
    let within = glint_ndf_tiled_place(material, position, footprint.mean);
    let ellipse = glint_ndf_transformed(glint_ndf_ellipse(footprint), position, within);
    let jacobian = abs(glint_ndf_determinant(normal));
    let local_s = glint_ndf_apply(normal, s);
    let detail = glint_ndf_detail(material, ellipse, settings);
    let wide = ellipse.minor >= GLINT_NDF_TOP_TILE_SIGMA * max(size.x, size.y);
    if wide || detail.level == i32(material.levels) - 1 {
        return GlintNdfSum(jacobian * glint_ndf_tile_density(material, glint_ndf_top_tile(material), local_s), 1.0, 1.0);
    }
    // A sub-region without end.
    let view =
        GlintNdfView(ellipse, within, vec4f(1.0, 0.0, 0.0, 1.0), 1.0, 1.0e20, vec2f(1.0), jacobian);
    let sum = glint_ndf_view_sum(material, view, settings, detail, local_s);
    if sum.share > 0.0 {
        return sum;
    }
    return glint_ndf_point(material, 0u, within, s);
}

// ---- Stochastic placement ----

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
    return glint_ndf_record(material.noise_records + at.y * material.cells + at.x);
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

// What a sub-region, by its index and middle, shows of its owner under the footprint.
fn glint_ndf_region(
    material: GlintNdfMaterial,
    footprint: GlintNdfEllipse,
    cells: GlintNdfCells,
    region: vec2i,
    middle: vec2f,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
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
    if detail.level == i32(material.levels) - 1 && footprint.minor >= GLINT_NDF_WHOLE_REGION_SIGMA * edge {
        let weight = edge * edge * glint_ndf_gaussian(glint_ndf_widened(footprint, edge), middle);
        let density = glint_ndf_tile_density(material, glint_ndf_top_tile(material), local_s);
        return GlintNdfSum(weight * jacobian * density, weight, 1.0);
    }
    let view = GlintNdfView(
        ellipse,
        glint_ndf_apply(position, middle - owner.centre) + owner.offset,
        glint_ndf_inverse(position),
        1.0 / sqrt(abs(glint_ndf_determinant(position))),
        0.5 * edge,
        abs(position.xz) + abs(position.yw),
        jacobian,
    );
    return glint_ndf_view_sum(material, view, settings, detail, local_s);
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
    var ellipse = glint_ndf_ellipse(footprint);
    ellipse.mean = cells.mean;
    let region = 0.5 * material.cell_texels;
    let regions = 4.0 * GLINT_NDF_REACH * GLINT_NDF_REACH * ellipse.major * max(ellipse.minor, region) / (region * region);
    let many = regions > min(GLINT_NDF_MAX_REGIONS, f32(settings.max_terms));
    if ellipse.minor >= GLINT_NDF_CLASS_SIGMA_CELLS * material.cell_texels || many {
        return glint_ndf_classes(material, ellipse, cells, settings, s);
    }
    // A sub-region counts when its centre is near the footprint, widened so that a point reaches its corners.
    let widened = glint_ndf_widened(ellipse, region * 1.2);
    let reach = glint_ndf_reach_y(widened);
    let rows = glint_ndf_cells(0.0, region, widened.mean.y - reach, widened.mean.y + reach);
    var sum = GlintNdfSum(0.0, 0.0, 0.0);
    for (var j = rows.x; j < rows.y; j++) {
        let y = glint_ndf_cell_centre(0.0, region, j);
        let span = glint_ndf_span_x(widened, y);
        let columns = glint_ndf_cells(0.0, region, span.x, span.y);
        for (var i = columns.x; i < columns.y; i++) {
            let middle = vec2f(glint_ndf_cell_centre(0.0, region, i), y);
            sum = glint_ndf_add(sum, glint_ndf_region(material, ellipse, cells, vec2i(i, j), middle, settings, s));
        }
    }
    if sum.share > 0.0 {
        return sum;
    }
    let shown = glint_ndf_shown_at(material, cells, ellipse.mean);
    return glint_ndf_point(material, shown.class_index, shown.local, s);
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

// ---- The answers ----

// The density over the disk of projected normals, at `s`, of what lies under a footprint (surface texels); 0 outside the disk.
// Also the number of tiles and lobes that it took.
fn glint_ndf_density(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    if dot(s, s) > 1.0 {
        return GlintNdfSum(0.0, 1.0, 0.0);
    }
    var sum: GlintNdfSum;
    if material.cells == 0u {
        sum = glint_ndf_tiled(material, footprint, settings, s);
    } else {
        sum = glint_ndf_stochastic(material, footprint, settings, s);
    }
    return GlintNdfSum(sum.density / sum.share, sum.share, sum.terms);
}

// Whether any footprint sees normals near `s`: a bit a cell of 128 x 128 over [-1, 1]^2, set where a texel other than zero of
// some tile under some transform of the palette reaches. False means that glint_ndf_density is 0, but for lobes' tails that
// the tiles' storage rounds to nothing. The mask is not in the pack; whoever uploads it makes it.
fn glint_ndf_reaches(material: GlintNdfMaterial, s: vec2f) -> bool {
    let half = 0.5 * f32(GLINT_NDF_REACH_CELLS);
    let cell = vec2u(clamp((s + 1.0) * half, vec2f(0.0), vec2f(2.0 * half - 1.0)));
    let bit = cell.y * GLINT_NDF_REACH_CELLS + cell.x;
    return ((glint_ndf_word(material.reach_words + bit / 32u) >> (bit % 32u)) & 1u) == 1u;
}

// The density at `s` by its definition, at one point of the surface (texels): the Gaussian of the intrinsic roughness around
// the micro-normal that shows there. Its mean over points under a footprint is what glint_ndf_density approximates.
fn glint_ndf_density_at_point(material: GlintNdfMaterial, place: vec2f, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    if material.cells == 0u {
        let position = bitcast<vec4f>(glint_ndf_record(material.palette_records));
        return glint_ndf_point(material, 0u, glint_ndf_tiled_place(material, position, place), s).density;
    }
    let cells = glint_ndf_cells_around(material, place);
    let shown = glint_ndf_shown_at(material, cells, cells.mean);
    return glint_ndf_point(material, shown.class_index, shown.local, s).density;
}
