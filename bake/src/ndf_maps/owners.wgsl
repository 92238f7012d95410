// A surface of examples placed at random: sub-regions, their owners, and what they show under a footprint. Xing et al. 2024, section
// 6.3, Fig. 3; twin of owners.rs, which has what deviates from the paper.

#import ndf_maps::view

// Width in which neighbouring sub-regions fade into each other, in edges of one.
const GLINT_NDF_FADE: f32 = 1.0;
// Where probes of owners go over to sums over sub-regions, by their minor axis, and those to shares of transforms, by the geometric
// mean of both axes: from and to, in edges of a sub-region.
const GLINT_NDF_REGIONS_FROM: vec2f = vec2f(0.15, 0.25);
const GLINT_NDF_CLASSES_FROM: vec2f = vec2f(0.8, 1.2);
// Variance along an axis of a sub-region with the borders in which it fades, in squares of its edge.
const GLINT_NDF_REGION_VARIANCE: f32 = 0.1333;
// Sub-regions count up to this many standard deviations of the footprint that is widened by them.
const GLINT_NDF_REGIONS_REACH: f32 = 2.828427;
// Sub-regions under one footprint, at most.
const GLINT_NDF_MAX_REGIONS: i32 = 4096;
// Largest palette, in groups of four.
const GLINT_NDF_MAX_GROUPS: u32 = 8u;

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

// Whose example sub-regions show, and how much of a place.
struct GlintNdfOwner {
    class_index: u32,
    // Centre on the surface, relative to the base cell.
    centre: vec2f,
    // Example point that lies at the centre.
    offset: vec2f,
    // Its part of the place.
    weight: f32,
    // How that changes along the surface, per texel.
    gradient: vec2f,
}

fn glint_ndf_unorm_pair(bits: u32) -> vec2f {
    return vec2f(f32(bits & 0xffffu), f32(bits >> 16u)) / 65535.0;
}

// Owner of a sub-region, by its index from the base cell's first one on, with the part `weight` of a place.
fn glint_ndf_owner_of(
    material: GlintNdfMaterial,
    cells: GlintNdfCells,
    region: vec2i,
    weight: f32,
    gradient: vec2f,
) -> GlintNdfOwner {
    let at = vec2u(2 * cells.base + region) & vec2u(2u * material.cells - 1u);
    let owner = glint_ndf_noise_texel(material.layer, at);
    let neighbour = i32(owner.z >> 16u);
    let row = (neighbour * 11) >> 5u;
    let cell = (region >> vec2u(1u)) + vec2i(neighbour - 3 * row - 1, row - 1);
    return GlintNdfOwner(
        owner.z & 0xffu,
        (vec2f(cell) + glint_ndf_unorm_pair(owner.x)) * material.cell_texels,
        glint_ndf_unorm_pair(owner.y) * vec2f(material.size),
        weight,
        gradient,
    );
}

// Owner `into` with what another one has of the place, if they are the same, and none for that one.
fn glint_ndf_merge(owners: ptr<function, array<GlintNdfOwner, 4>>, into: u32, other: u32) {
    let same = (*owners)[other].weight > 0.0 && all((*owners)[into].centre == (*owners)[other].centre);
    if same {
        (*owners)[into].weight += (*owners)[other].weight;
        (*owners)[into].gradient += (*owners)[other].gradient;
        (*owners)[other].weight = 0.0;
    }
}

// The owners of the four sub-regions around a place relative to the base cell, as a round Gaussian of a variance (texels^2) there sees
// them. One that owns several has the weight of all in the first, and none in the others.
fn glint_ndf_owners_at(
    material: GlintNdfMaterial,
    cells: GlintNdfCells,
    place: vec2f,
    variance: f32,
) -> array<GlintNdfOwner, 4> {
    let edge = 0.5 * material.cell_texels;
    let at = place / edge - 0.5;
    let cell = floor(at);
    let part = at - cell;
    let region = vec2i(cell);
    // Weights that begin and end level, so that their gradients, too, have no jumps.
    let fade = min(sqrt(GLINT_NDF_FADE * GLINT_NDF_FADE + 20.0 * variance / (edge * edge)), 1.0);
    let t = clamp((part - 0.5) / fade + 0.5, vec2f(0.0), vec2f(1.0));
    let f = t * t * (3.0 - 2.0 * t);
    let g = 1.0 - f;
    let d = 6.0 * t * (1.0 - t) / (fade * edge);
    var owners = array<GlintNdfOwner, 4>(
        glint_ndf_owner_of(material, cells, region, g.x * g.y, vec2f(-d.x * g.y, -g.x * d.y)),
        glint_ndf_owner_of(material, cells, region + vec2i(1, 0), f.x * g.y, vec2f(d.x * g.y, -f.x * d.y)),
        glint_ndf_owner_of(material, cells, region + vec2i(0, 1), g.x * f.y, vec2f(-d.x * f.y, g.x * d.y)),
        glint_ndf_owner_of(material, cells, region + vec2i(1, 1), f.x * f.y, vec2f(d.x * f.y, f.x * d.y)),
    );
    glint_ndf_merge(&owners, 0u, 1u);
    glint_ndf_merge(&owners, 0u, 2u);
    glint_ndf_merge(&owners, 1u, 2u);
    glint_ndf_merge(&owners, 0u, 3u);
    glint_ndf_merge(&owners, 1u, 3u);
    glint_ndf_merge(&owners, 2u, 3u);
    return owners;
}

// How far a round Gaussian of a variance (texels^2) times the owner's weight lies from the Gaussian itself.
fn glint_ndf_pull(owner: GlintNdfOwner, variance: f32) -> vec2f {
    return owner.gradient * (variance / owner.weight);
}

// The probes of an ellipse, `weight` together: at each, what its owners show there.
fn glint_ndf_owned_windows(
    material: GlintNdfMaterial,
    e: GlintNdfEllipse,
    cells: GlintNdfCells,
    weight: f32,
    s: vec2f,
) -> GlintNdfSum {
    let probes = glint_ndf_probes(e);
    var sum = GlintNdfSum(0.0, 0.0);
    var before = 0.0;
    var k = 0.0;
    for (var i = 0; i < 2 * GLINT_NDF_MAX_PROBES; i++) {
        let part = glint_ndf_weight(probes, k);
        if part <= 0.0 {
            break;
        }
        let place = e.mean + e.axis * (k * probes.step);
        var owners = glint_ndf_owners_at(material, cells, place, probes.variance);
        for (var o = 0u; o < 4u; o++) {
            let owner = owners[o];
            if owner.weight > 0.0 {
                let at = material.palette_records + 2u * owner.class_index;
                let position = bitcast<vec4f>(glint_ndf_record(material.layer, at));
                let normal = bitcast<vec4f>(glint_ndf_record(material.layer, at + 1u));
                var blend = glint_ndf_blend(material, probes.variance * abs(glint_ndf_determinant(position)));
                // Probes go over to the coarser level one after another.
                blend.coarser = clamp((blend.coarser * probes.total - before) / part, 0.0, 1.0);
                let seen = place + glint_ndf_pull(owner, probes.variance) - owner.centre;
                let local = glint_ndf_apply(position, seen) + owner.offset;
                let share = weight * part / probes.total * owner.weight * abs(glint_ndf_determinant(normal));
                let shown = glint_ndf_windows(material, local, blend, share, glint_ndf_apply(normal, s));
                sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
            }
        }
        before += part;
        k = glint_ndf_next_probe(k);
    }
    return sum;
}

// What the sub-regions under an ellipse show, `weight` together: of each what lies around the middle of its product with the footprint.
fn glint_ndf_regions(
    material: GlintNdfMaterial,
    e: GlintNdfEllipse,
    cells: GlintNdfCells,
    weight: f32,
    s: vec2f,
) -> GlintNdfSum {
    let edge = 0.5 * material.cell_texels;
    let own = GLINT_NDF_REGION_VARIANCE * edge * edge;
    let side = vec2f(-e.axis.y, e.axis.x);
    let major2 = e.major * e.major + own;
    let minor2 = e.minor * e.minor + own;
    // What a footprint sees of a sub-region has the variance of their product, here the mean of both axes.
    let variance = 0.5 * own * (e.major * e.major / major2 + e.minor * e.minor / minor2);
    let reach = GLINT_NDF_REGIONS_REACH / edge;
    let mean = e.mean / edge - 0.5;
    let within = GlintNdfEllipse(mean, e.axis, reach * sqrt(major2), reach * sqrt(minor2));
    let half = glint_ndf_half_height(within);
    var y = ceil(mean.y - half);
    var span = glint_ndf_span_x(within, y);
    var x = ceil(span.x);
    var sum = GlintNdfSum(0.0, 0.0);
    var total = 0.0;
    // One loop, not two: pixels in step wait for the most sub-regions of one of them once.
    for (var visit = 0; visit < GLINT_NDF_MAX_REGIONS; visit++) {
        if x <= span.y {
            let middle = (vec2f(x, y) + 0.5) * edge;
            let away = middle - e.mean;
            let along = dot(away, e.axis);
            let across = dot(away, side);
            let q = along * along / major2 + across * across / minor2;
            let t = max(1.0 - q / (GLINT_NDF_REGIONS_REACH * GLINT_NDF_REGIONS_REACH), 0.0);
            let share = t * t;
            let owner = glint_ndf_owner_of(material, cells, vec2i(i32(x), i32(y)), share, vec2f(0.0));
            let at = material.palette_records + 2u * owner.class_index;
            let position = bitcast<vec4f>(glint_ndf_record(material.layer, at));
            let normal = bitcast<vec4f>(glint_ndf_record(material.layer, at + 1u));
            let seen = middle - e.axis * (along * own / major2) - side * (across * own / minor2) - owner.centre;
            let local = glint_ndf_apply(position, seen) + owner.offset;
            var blend = glint_ndf_blend(material, variance * abs(glint_ndf_determinant(position)));
            // Every fourth sub-region goes over to the coarser level after the other.
            let index = 2 * cells.base + vec2i(i32(x), i32(y));
            let turn = f32((index.x + 2 * index.y) & 3);
            blend.coarser = clamp(4.0 * blend.coarser - turn, 0.0, 1.0);
            let part = share * abs(glint_ndf_determinant(normal));
            let shown = glint_ndf_windows(material, local, blend, part, glint_ndf_apply(normal, s));
            sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
            total += share;
            x += 1.0;
        } else {
            y += 1.0;
            if !(y <= mean.y + half) {
                break;
            }
            span = glint_ndf_span_x(within, y);
            x = ceil(span.x);
        }
    }
    sum.density *= weight / max(total, 1.0e-30);
    return sum;
}

// Shares of four palette entries in one texel of the class texture.
fn glint_ndf_class_shares(material: GlintNdfMaterial, mip: u32, group: u32, block: vec2i) -> vec4f {
    let size = material.cells >> mip;
    return glint_ndf_class_texel(material.layer, vec2u(block) & vec2u(size - 1u), group, mip);
}

// The whole example under every transform, by the share of sub-regions that use it, `weight` together.
fn glint_ndf_classes(
    material: GlintNdfMaterial,
    e: GlintNdfEllipse,
    cells: GlintNdfCells,
    weight: f32,
    s: vec2f,
) -> GlintNdfSum {
    let groups = min((material.palette + 3u) / 4u, GLINT_NDF_MAX_GROUPS);
    // Blocks that are read linearly have a standard deviation of half their edge.
    let last = f32(firstTrailingBit(material.cells));
    let lod = clamp(log2(2.0 * sqrt(e.major * e.minor) / material.cell_texels), 0.0, last);
    let base = vec2f(vec2u(cells.base) & vec2u(material.cells - 1u)) + e.mean / material.cell_texels;
    let node = glint_ndf_record(material.layer, material.levels - 1u).z;
    var sum = GlintNdfSum(0.0, 0.0);
    var total = 0.0;
    // Four classes at a time, so that none needs an array.
    for (var group = 0u; group < groups; group++) {
        var shares = vec4f(0.0);
        for (var k = 0u; k < 2u; k++) {
            let mip = floor(lod) + f32(k);
            let part = select(1.0 - fract(lod), fract(lod), k == 1u);
            if part > 0.0 {
                let at = base * exp2(-mip) - 0.5;
                let cell = floor(at);
                let f = at - cell;
                let block = vec2i(cell);
                let m = u32(mip);
                shares += part * ((1.0 - f.x) * (1.0 - f.y) * glint_ndf_class_shares(material, m, group, block)
                    + f.x * (1.0 - f.y) * glint_ndf_class_shares(material, m, group, block + vec2i(1, 0))
                    + (1.0 - f.x) * f.y * glint_ndf_class_shares(material, m, group, block + vec2i(0, 1))
                    + f.x * f.y * glint_ndf_class_shares(material, m, group, block + vec2i(1, 1)));
            }
        }
        for (var k = 4u * group; k < min(material.palette, 4u * group + 4u); k++) {
            let low = select(shares.x, shares.y, (k & 1u) == 1u);
            let high = select(shares.z, shares.w, (k & 1u) == 1u);
            let share = select(low, high, (k & 2u) == 2u);
            if share > 0.0 {
                let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * k + 1u));
                let density = glint_ndf_node_density(material, node, glint_ndf_apply(normal, s));
                sum.density += share * abs(glint_ndf_determinant(normal)) * density;
                sum.terms += 1.0;
                total += share;
            }
        }
    }
    sum.density *= weight / max(total, 1.0e-30);
    return sum;
}

// What a footprint sees: sub-regions, patches, or shares of transforms.
fn glint_ndf_stochastic(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let cells = glint_ndf_cells_around(material, footprint.mean);
    var seen = glint_ndf_shortened(glint_ndf_ellipse(footprint), settings.max_ratio);
    seen.mean = cells.mean;
    let size = seen.minor / (0.5 * material.cell_texels);
    let classes = GLINT_NDF_CLASSES_FROM;
    // Sub-regions are as many as its area.
    let wide = sqrt(seen.major * seen.minor) / (0.5 * material.cell_texels);
    let in_classes = clamp((wide - classes.x) / (classes.y - classes.x), 0.0, 1.0);
    let regions = GLINT_NDF_REGIONS_FROM;
    let in_regions = clamp((size - regions.x) / (regions.y - regions.x), 0.0, 1.0) * (1.0 - in_classes);
    let in_patches = (1.0 - in_classes - in_regions)
        * glint_ndf_patches_share(seen.minor * material.most_texels, material.finest_variance);
    let in_windows = 1.0 - in_classes - in_regions - in_patches;
    var sum = GlintNdfSum(0.0, 0.0);
    if in_windows > 0.0 {
        sum = glint_ndf_owned_windows(material, seen, cells, in_windows, s);
    }
    if in_patches > 0.0 {
        var owners = glint_ndf_owners_at(material, cells, seen.mean, seen.major * seen.minor);
        for (var o = 0u; o < 4u; o++) {
            let owner = owners[o];
            if owner.weight > 0.0 {
                let at = material.palette_records + 2u * owner.class_index;
                let position = bitcast<vec4f>(glint_ndf_record(material.layer, at));
                let normal = bitcast<vec4f>(glint_ndf_record(material.layer, at + 1u));
                var from_centre = seen;
                from_centre.mean -= owner.centre;
                let local = glint_ndf_transformed(from_centre, position, owner.offset);
                let share = in_patches * owner.weight * abs(glint_ndf_determinant(normal));
                let shown = glint_ndf_patches(material, local, settings, share, glint_ndf_apply(normal, s));
                sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
            }
        }
    }
    if in_regions > 0.0 {
        let shown = glint_ndf_regions(material, seen, cells, in_regions, s);
        sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
    }
    if in_classes > 0.0 {
        let shown = glint_ndf_classes(material, seen, cells, in_classes, s);
        sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
    }
    return sum;
}
