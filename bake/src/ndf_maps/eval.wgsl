// Evaluation of NDF maps: the density of one tile as it is stored, and of one lobe. Xing et al. 2024, "A Tiny Example Based Procedural
// Model for Real-Time Glinty Appearance Rendering", section 5 and Eq. 1. Twin of eval.rs. The CPU lists the tiles and lobes of a
// footprint and then sums; shaders take the sum on the way, in the same order.
//
// Accessors that the including program defines; `layer` is that of the material, which is 0 in programs of one:
//   fn glint_ndf_record(layer: u32, at: u32) -> vec4u                  record `at` of section NMUB, see GlintNdfMaterial
//   fn glint_ndf_tile(layer: u32, at: u32) -> vec4u                    element of the table NMTI; any value if it is not there
//   fn glint_ndf_density_block(layer: u32, at: u32) -> vec3u           element of the table NMDE of blocks: three rows of three 8-bit
//                                                                      texels, the lowest bits first, see glint_ndf_block_density
//   fn glint_ndf_density_word(layer: u32, at: u32) -> u32              element of the table NMDE of words; one before and one after
//                                                                      may be asked for, what is there does not matter
//   fn glint_ndf_normal_texel(layer: u32, at: vec2i) -> u32            texel of NMNO
//   fn glint_ndf_noise_texel(layer: u32, at: vec2u) -> vec4u           texel of PLNO; any value for tiled materials
//   fn glint_ndf_class_texel(layer: u32, at: vec2u, group: u32, mip: u32) -> vec4f    texel of PLCL, of the texture's layer `group`;
//                                                                      any value for tiled materials

#import erf

const GLINT_NDF_SQRT_U8: u32 = 0u;
const GLINT_NDF_F16: u32 = 1u;
const GLINT_NDF_PAPER_F32: u32 = 2u;
const GLINT_NDF_REPEAT: u32 = 0u;
const GLINT_NDF_CLAMP: u32 = 1u;

// One material: the first 64 bytes of section NMUB. Records are the rest of that section, four u32 each; the levels come first, one
// record a level: tile_texels, tiles_x, tiles_y, first_tile.
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
    // First record of: the palette, two an entry: position_to_local, normal_to_local, each a matrix by rows.
    palette_records: u32,
    // The reach mask, see glint_ndf_reaches.
    reach_records: u32,
    // The tiles, two each; those of a table begin at 0.
    tile_records: u32,
    // 1 where section NMDE holds blocks (8-bit storage only), 0 where it holds words.
    blocks: u32,
    // 1 where the tiles are among the records, 0 where they have a table, section NMTI.
    few_tiles: u32,
    // Example texels a surface texel, by area, under the transform of the palette that has most.
    most_texels: f32,
    // 0 in the pack. A program of several materials tells its accessors by this which of them is meant.
    layer: u32,
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
    // Pieces lie within this many standard deviations of the footprint's centre, each widened by its size; what lies farther out is
    // left out: 2 % of the mass at 2.8, 14 % at 2.
    reach: f32,
    // Places along the minor axis where a stochastic surface is seen, each as one tile; 0 for all tiles of all sub-regions.
    probes: u32,
}

// A sum over pieces of a footprint, not yet divided by its share.
struct GlintNdfSum {
    // Density times share.
    density: f32,
    share: f32,
    // Tiles and lobes visited.
    terms: f32,
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
        var bits = glint_ndf_density_word(material.layer, u32(max(word, 0))) >> shift;
        if shift > 8u {
            bits |= glint_ndf_density_word(material.layer, u32(word + 1)) << (32u - shift);
        }
        let root = vec3f(f32(bits & 255u), f32((bits >> 8u) & 255u), f32((bits >> 16u) & 255u)) / 255.0;
        return root * root;
    }
    if material.storage == GLINT_NDF_F16 {
        let word = at >> 1u;
        let a = unpack2x16float(glint_ndf_density_word(material.layer, u32(max(word, 0))));
        let b = unpack2x16float(glint_ndf_density_word(material.layer, u32(word + 1)));
        return select(vec3f(a, b.x), vec3f(a.y, b), (at & 1) == 1);
    }
    return vec3f(
        bitcast<f32>(glint_ndf_density_word(material.layer, u32(max(at, 0)))),
        bitcast<f32>(glint_ndf_density_word(material.layer, u32(at + 1))),
        bitcast<f32>(glint_ndf_density_word(material.layer, u32(at + 2))),
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

// Of a tile in blocks, at p (in texels from its first one): each place of the splines has its three by three texels together, those
// beyond the tile as zeros, so that one load has them all. A tile of w x h texels has (w + 2) (h + 2) blocks, by rows, from `first`
// on; the block at (i, j) begins at texel (i - 2, j - 2).
fn glint_ndf_block_density(layer: u32, first: u32, size: vec2i, p: vec2f) -> f32 {
    let node = floor(p + 0.5);
    let f = p - node;
    let at = clamp(vec2i(node) + 1, vec2i(0), size + 1);
    let rows = glint_ndf_density_block(layer, first + u32(at.y * (size.x + 2) + at.x));
    let low = (0.5 - f) * (0.5 - f);
    let high = (0.5 + f) * (0.5 + f);
    let middle = 1.5 - 2.0 * f * f;
    let across = vec3f(low.x, middle.x, high.x);
    let top = vec3f(f32(rows.x & 255u), f32((rows.x >> 8u) & 255u), f32(rows.x >> 16u));
    let centre = vec3f(f32(rows.y & 255u), f32((rows.y >> 8u) & 255u), f32(rows.y >> 16u));
    let bottom = vec3f(f32(rows.z & 255u), f32((rows.z >> 8u) & 255u), f32(rows.z >> 16u));
    // Texels are squares of n / 255; both splines are halves of these weights.
    return (low.y * dot(across, top * top) + middle.y * dot(across, centre * centre) + high.y * dot(across, bottom * bottom))
        * (0.25 / 65025.0);
}

// Density of one tile at the example's projected normal `s`: quadratic splines over decoded texels (bilinear for the paper's
// storage), 0 outside the box.
fn glint_ndf_tile_density(material: GlintNdfMaterial, tile: u32, s: vec2f) -> f32 {
    if dot(s, s) > 1.0 {
        return 0.0;
    }
    let at = material.tile_records + 2u * tile;
    var place: vec4f;
    var texels: vec4u;
    if material.few_tiles == 1u {
        place = bitcast<vec4f>(glint_ndf_record(material.layer, at));
        texels = glint_ndf_record(material.layer, at + 1u);
    } else {
        place = bitcast<vec4f>(glint_ndf_tile(material.layer, at));
        texels = glint_ndf_tile(material.layer, at + 1u);
    }
    let size = vec2i(vec2u(texels.z & 0xffffu, texels.z >> 16u));
    let p = (s - place.xy) * place.zw;
    if !(all(p >= vec2f(-1.5)) && all(p <= vec2f(size) + 0.5)) {
        return 0.0;
    }
    if material.blocks == 1u {
        return bitcast<f32>(texels.x) * glint_ndf_block_density(material.layer, texels.y, size, p);
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

// Projected normal of texel (i, j), at most one texel outside the example.
fn glint_ndf_normal(material: GlintNdfMaterial, at: vec2i) -> vec2f {
    let size = vec2i(material.size);
    var texel = clamp(at, vec2i(0), size - 1);
    if material.wrap == GLINT_NDF_REPEAT {
        texel = select(select(at, at - size, at >= size), at + size, at < vec2i(0));
    }
    return unpack2x16snorm(glint_ndf_normal_texel(material.layer, texel));
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

fn glint_ndf_normal_cdf(x: f32) -> f32 {
    return 0.5 * (1.0 + glint_erf(x * 0.70710678));
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
