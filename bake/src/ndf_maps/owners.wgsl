// A surface of examples placed at random: sub-regions, their owners, and what they show under a footprint. Xing et al. 2024, section
// 6.3, Fig. 3; twin of owners.rs, which has what deviates from the paper.

#import ndf_maps::view

// Width in which neighbouring sub-regions fade into each other, in edges of one.
const GLINT_NDF_FADE: f32 = 1.0;
// From where to where shares of transforms come in, by a footprint's minor axis in edges of the example. From there on what owners
// show counts by its difference from the whole example.
const GLINT_NDF_SHARES_FROM: vec2f = vec2f(0.16, 0.2);
// From where to where what owners show goes out: Gaussians so wide see all of an example that goes on beyond its edge.
const GLINT_NDF_OWNERS_UNTIL: vec2f = vec2f(0.35, 0.5);
// Variance along an axis of a sub-region with the borders in which it fades, in squares of its edge.
const GLINT_NDF_REGION_VARIANCE: f32 = 0.133333;
// Entries of a palette at most, in groups of four.
const GLINT_NDF_GROUPS: u32 = 4u;

// Shares of the palette's entries.
struct GlintNdfShares {
    groups: array<vec4f, 4>,
}

// From 0 to 1 over a range.
fn glint_ndf_ramp(x: f32, range: vec2f) -> f32 {
    return clamp((x - range.x) / (range.y - range.x), 0.0, 1.0);
}

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

// Adds to the share of one palette entry.
fn glint_ndf_add_share(shares: ptr<function, GlintNdfShares>, class_index: u32, weight: f32) {
    let own = vec4u(class_index) == vec4u(0u, 1u, 2u, 3u) + 4u * vec4u(class_index / 4u);
    let added = select(vec4f(0.0), vec4f(weight), own);
    for (var group = 0u; group < GLINT_NDF_GROUPS; group++) {
        (*shares).groups[group] += select(vec4f(0.0), added, group == class_index / 4u);
    }
}

// The probes of an ellipse, `weight` together: at each, what its owners show there. Takes `less` of each owner's weight off the share
// of its palette entry.
fn glint_ndf_owned_windows(
    material: GlintNdfMaterial,
    e: GlintWindowsEllipse,
    cells: GlintNdfCells,
    weight: f32,
    less: f32,
    shares: ptr<function, GlintNdfShares>,
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
                var blend = glint_ndf_blend(material, probes.variance * abs(glint_windows_determinant(position)));
                // Probes go over to the coarser level one after another.
                blend.coarser = clamp((blend.coarser * probes.total - before) / part, 0.0, 1.0);
                let seen = place + glint_ndf_pull(owner, probes.variance) - owner.centre;
                let local = glint_windows_apply(position, seen) + owner.offset;
                let share = weight * part / probes.total * owner.weight;
                if less > 0.0 {
                    glint_ndf_add_share(shares, owner.class_index, -less * share);
                }
                let mass = share * abs(glint_windows_determinant(normal));
                let shown = glint_ndf_windows(material, local, blend, mass, glint_windows_apply(normal, s));
                sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
            }
        }
        before += part;
        k = glint_ndf_next_probe(k);
    }
    return sum;
}

// The patches that an ellipse's owners show, `weight` together. Takes `less` of each owner's weight off the share of its palette entry.
fn glint_ndf_owned_patches(
    material: GlintNdfMaterial,
    e: GlintWindowsEllipse,
    cells: GlintNdfCells,
    weight: f32,
    less: f32,
    settings: GlintNdfSettings,
    shares: ptr<function, GlintNdfShares>,
    s: vec2f,
) -> GlintNdfSum {
    var sum = GlintNdfSum(0.0, 0.0);
    var owners = glint_ndf_owners_at(material, cells, e.mean, e.major * e.minor);
    for (var o = 0u; o < 4u; o++) {
        let owner = owners[o];
        if owner.weight > 0.0 {
            let at = material.palette_records + 2u * owner.class_index;
            let position = bitcast<vec4f>(glint_ndf_record(material.layer, at));
            let normal = bitcast<vec4f>(glint_ndf_record(material.layer, at + 1u));
            var from_centre = e;
            from_centre.mean -= owner.centre;
            let local = glint_windows_transformed(from_centre, position, owner.offset);
            if less > 0.0 {
                glint_ndf_add_share(shares, owner.class_index, -less * weight * owner.weight);
            }
            let mass = weight * owner.weight * abs(glint_windows_determinant(normal));
            let shown = glint_ndf_patches(material, local, settings, mass, glint_windows_apply(normal, s));
            sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
        }
    }
    return sum;
}

// Adds `weight` times the palette entry of a sub-region, by its index.
fn glint_ndf_region_class(material: GlintNdfMaterial, region: vec2i, weight: f32, shares: ptr<function, GlintNdfShares>) {
    let texel = glint_ndf_noise_texel(material.layer, vec2u(region) & vec2u(2u * material.cells - 1u));
    glint_ndf_add_share(shares, texel.z & 0xffu, weight);
}

// Adds `weight` times the shares of the palette's entries in one texel of the class texture.
fn glint_ndf_class_window(
    material: GlintNdfMaterial,
    mip: u32,
    at: vec2i,
    weight: f32,
    shares: ptr<function, GlintNdfShares>,
) {
    let size = (2u * material.cells) >> mip;
    let texel = glint_ndf_class_texel(material.layer, vec2u(at) & vec2u(size - 1u), mip);
    (*shares).groups[0] += weight * unpack4x8unorm(texel.x);
    (*shares).groups[1] += weight * unpack4x8unorm(texel.y);
    (*shares).groups[2] += weight * unpack4x8unorm(texel.z);
    (*shares).groups[3] += weight * unpack4x8unorm(texel.w);
}

// Adds `weight` times the shares of the palette's entries in what a round Gaussian of a variance (texels^2) sees around a place
// relative to the base cell.
//
// Sub-regions that are read linearly are seen through a variance of 1/6, in squares of their edge, and mip m of the class texture through
// 4^(m + 1) / 6; two in shares 1 - c and c have every variance between theirs.
fn glint_ndf_class_shares(
    material: GlintNdfMaterial,
    cells: GlintNdfCells,
    place: vec2f,
    variance: f32,
    weight: f32,
    shares: ptr<function, GlintNdfShares>,
) {
    let edge = 0.5 * material.cell_texels;
    let last = firstTrailingBit(2u * material.cells) + 1u;
    let size = max(6.0 * (variance / (edge * edge) + GLINT_NDF_REGION_VARIANCE), 1.0);
    // The exponent of 4.
    let exponent = ((bitcast<u32>(size) >> 23u) - 127u) / 2u;
    let level = min(exponent, last);
    let coarser = select((size * bitcast<f32>((127u - 2u * level) << 23u) - 1.0) / 3.0, 0.0, level == last);
    let at = 2.0 * vec2f(vec2u(cells.base) & vec2u(material.cells - 1u)) + place / edge - 0.5;
    for (var k = 0u; k < 2u; k++) {
        let part = weight * select(1.0 - coarser, coarser, k == 1u);
        if part > 0.0 {
            let mip = max(level + k, 1u) - 1u;
            let within = at * bitcast<f32>((127u - mip) << 23u);
            let texel = floor(within);
            let f = within - texel;
            let first = vec2i(texel);
            for (var corner = 0; corner < 4; corner++) {
                let step = vec2i(corner & 1, corner >> 1u);
                let share = select(1.0 - f.x, f.x, step.x == 1) * select(1.0 - f.y, f.y, step.y == 1);
                if level + k == 0u {
                    glint_ndf_region_class(material, first + step, part * share, shares);
                } else {
                    glint_ndf_class_window(material, mip, first + step, part * share, shares);
                }
            }
        }
    }
}

// Adds, `weight` together, the shares that the palette's entries have in what the probes of an ellipse see.
fn glint_ndf_probed_shares(
    material: GlintNdfMaterial,
    e: GlintWindowsEllipse,
    cells: GlintNdfCells,
    weight: f32,
    shares: ptr<function, GlintNdfShares>,
) {
    let probes = glint_ndf_probes(e);
    var seen = GlintNdfShares(array<vec4f, 4>(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0)));
    var k = 0.0;
    for (var i = 0; i < 2 * GLINT_NDF_MAX_PROBES; i++) {
        let part = glint_ndf_weight(probes, k);
        if part <= 0.0 {
            break;
        }
        let place = e.mean + e.axis * (k * probes.step);
        glint_ndf_class_shares(material, cells, place, probes.variance, part, &seen);
        k = glint_ndf_next_probe(k);
    }
    // Eight bits do not sum to one.
    let total = dot(seen.groups[0] + seen.groups[1] + seen.groups[2] + seen.groups[3], vec4f(1.0));
    for (var group = 0u; group < GLINT_NDF_GROUPS; group++) {
        (*shares).groups[group] += weight / total * seen.groups[group];
    }
}

// What a footprint sees: windows and patches of owners, and the whole example under each transform.
fn glint_ndf_stochastic(
    material: GlintNdfMaterial,
    footprint: GlintFootprint,
    settings: GlintNdfSettings,
    s: vec2f,
) -> GlintNdfSum {
    let cells = glint_ndf_cells_around(material, footprint.mean);
    var seen = glint_windows_shortened(glint_windows_ellipse(footprint), settings.max_ratio);
    seen.mean = cells.mean;
    let in_example = seen.minor * material.most_texels;
    let size = in_example / f32(max(material.size.x, material.size.y));
    let in_shares = glint_ndf_ramp(size, GLINT_NDF_SHARES_FROM);
    let in_owners = 1.0 - glint_ndf_ramp(size, GLINT_NDF_OWNERS_UNTIL);
    let in_patches = in_owners * glint_ndf_patches_share(in_example, material.finest_variance);
    let in_windows = in_owners - in_patches;
    var shares = GlintNdfShares(array<vec4f, 4>(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0)));
    var sum = GlintNdfSum(0.0, 0.0);
    if in_shares > 0.0 {
        glint_ndf_probed_shares(material, seen, cells, in_shares, &shares);
    }
    if in_windows > 0.0 {
        sum = glint_ndf_owned_windows(material, seen, cells, in_windows, in_shares, &shares, s);
    }
    if in_patches > 0.0 {
        let shown = glint_ndf_owned_patches(material, seen, cells, in_patches, in_shares, settings, &shares, s);
        sum = GlintNdfSum(sum.density + shown.density, sum.terms + shown.terms);
    }
    if in_shares > 0.0 {
        let node = glint_ndf_record(material.layer, material.levels - 1u).z;
        for (var k = 0u; k < material.palette; k++) {
            let share = shares.groups[k / 4u][k % 4u];
            if share != 0.0 {
                let normal = bitcast<vec4f>(glint_ndf_record(material.layer, material.palette_records + 2u * k + 1u));
                let density = glint_ndf_node_density(material, node, glint_windows_apply(normal, s));
                sum.density += share * abs(glint_windows_determinant(normal)) * density;
                sum.terms += 1.0;
            }
        }
    }
    // Of what owners show the whole example may be taken off.
    return GlintNdfSum(max(sum.density, 0.0), sum.terms);
}
