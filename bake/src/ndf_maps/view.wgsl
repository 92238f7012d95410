// What one placed example shows under a footprint: windows of two levels around probes, and patches of the map below the finest.
// Twin of view.rs, which has the reasons.

#import ndf_maps::eval

// Patches go over to windows from this part of the finest windows' variance on.
const GLINT_NDF_PATCHES_UNTIL: f32 = 0.7;
// Patches whose middles lie so far, in texels, beyond the reach of a footprint lie in it with a part: half a diagonal.
const GLINT_NDF_PATCH_MARGIN: f32 = 0.71;
// Patches of one footprint, at most.
const GLINT_NDF_MAX_PATCHES: i32 = 4096;
// Distance of probes in standard deviations of the minor axis, and of what the major axis has more.
const GLINT_NDF_PROBE_STEP: vec2f = vec2f(2.2, 1.5);
// What is taken off the probes' weights, so that those at the ends come in without a jump.
const GLINT_NDF_PROBE_TAIL: f32 = 0.02;
// Where the major axis begins to be seen by more than one probe and where it is by all: what its variance has more, relative to the
// minor axis.
const GLINT_NDF_PROBES_FROM: vec2f = vec2f(0.1, 0.3);
// Probes on one side, at most; a ratio of axes of 16 has 20.
const GLINT_NDF_MAX_PROBES: i32 = 64;

// Round Gaussians along a footprint's major axis that together are about the footprint.
struct GlintNdfProbes {
    // Distance of neighbours in texels.
    step: f32,
    // 1 over the square of the distance where they end.
    inverse_reach2: f32,
    // Weight of all but the middle one.
    side: f32,
    // Sum of weights.
    total: f32,
    // Variance of each, texels^2.
    variance: f32,
}

// Weight of the one `k` steps away.
fn glint_ndf_weight(probes: GlintNdfProbes, k: f32) -> f32 {
    if k == 0.0 {
        return 1.0;
    }
    let x = k * probes.step;
    let t = max(1.0 - x * x * probes.inverse_reach2, 0.0);
    return probes.side * max(t * t - GLINT_NDF_PROBE_TAIL, 0.0);
}

// The probes of a footprint.
fn glint_ndf_probes(e: GlintWindowsEllipse) -> GlintNdfProbes {
    let minor2 = e.minor * e.minor;
    let more = max(e.major * e.major - minor2, 0.0);
    let step = min(GLINT_NDF_PROBE_STEP.x * e.minor, GLINT_NDF_PROBE_STEP.y * sqrt(more));
    let range = GLINT_NDF_PROBES_FROM;
    let side = clamp((more / minor2 - range.x) / (range.y - range.x), 0.0, 1.0);
    var probes = GlintNdfProbes(step, 1.0 / max(7.0 * more, 1.0e-30), side, 1.0, minor2);
    var second = 0.0;
    for (var i = 1; i <= GLINT_NDF_MAX_PROBES; i++) {
        let k = f32(i);
        let weight = glint_ndf_weight(probes, k);
        if weight <= 0.0 {
            break;
        }
        probes.total += 2.0 * weight;
        second += 2.0 * weight * (k * step) * (k * step);
    }
    probes.variance += 0.5 * max(more - second / probes.total, 0.0);
    return probes;
}

// The probe after the one `k` steps away: from the middle outward, on both sides.
fn glint_ndf_next_probe(k: f32) -> f32 {
    return select(1.0 - k, -k, k > 0.0);
}

// A level, and the share of the next one.
struct GlintNdfBlend {
    level: u32,
    coarser: f32,
}

// Part of a footprint that patches show, from its minor axis in texels of the example.
fn glint_ndf_patches_share(minor: f32, finest_variance: f32) -> f32 {
    return clamp((1.0 - minor * minor / finest_variance) / (1.0 - GLINT_NDF_PATCHES_UNTIL), 0.0, 1.0);
}

// The levels whose windows have a variance (texels^2) between them.
fn glint_ndf_blend(material: GlintNdfMaterial, variance: f32) -> GlintNdfBlend {
    let top = material.levels - 1u;
    let ratio = variance / material.finest_variance;
    if !(ratio > 1.0) {
        return GlintNdfBlend(0u, 0.0);
    }
    // A level has twice the variance of the one before: the exponent of the ratio.
    let level = (bitcast<u32>(ratio) >> 23u) - 127u;
    if level >= top {
        return GlintNdfBlend(top, 0.0);
    }
    return GlintNdfBlend(level, ratio * bitcast<f32>((127u - level) << 23u) - 1.0);
}

// Three nodes and their shares.
struct GlintNdfCorners {
    nodes: vec3u,
    shares: vec3f,
}

// The three nodes of a level around the example point `place`, the corners of its triangle, and their shares.
fn glint_ndf_corners(material: GlintNdfMaterial, level: u32, place: vec2f) -> GlintNdfCorners {
    let record = glint_ndf_record(material.layer, level);
    let nodes = vec2f(record.xy);
    // One row alone is not shifted.
    let shifted = select(0.5, 0.0, record.y == 1u);
    var at = place / vec2f(material.size) * nodes;
    at.y = select(at.y, 0.0, record.y == 1u);
    at.x -= 0.5 * at.y;
    let cell = floor(at);
    let f = at - cell;
    let upper = f.x + f.y < 1.0;
    let corner = select(cell + 1.0, cell, upper);
    let weights = select(
        vec3f(f.x + f.y - 1.0, 1.0 - f.y, 1.0 - f.x), vec3f(1.0 - f.x - f.y, f.x, f.y), upper,
    );
    // Columns and rows of the corners. Around the example once along y is half as many columns as rows along x.
    let y = vec3f(corner.y, cell.y, cell.y + 1.0);
    let around = floor((y + 0.5) / nodes.y);
    let x = vec3f(corner.x, cell.x + 1.0, cell.x) + shifted * nodes.y * around;
    let i = vec3u(x - floor((x + 0.5) / nodes.x) * nodes.x);
    let j = vec3u(y - around * nodes.y);
    return GlintNdfCorners(record.z + j * record.x + i, weights);
}

// The three nodes of a level around the example point `place`.
fn glint_ndf_triangle(
    material: GlintNdfMaterial,
    level: u32,
    place: vec2f,
    s: vec2f,
) -> f32 {
    let found = glint_ndf_corners(material, level, place);
    return found.shares.x * glint_ndf_node_density(material, found.nodes.x, s)
        + found.shares.y * glint_ndf_node_density(material, found.nodes.y, s)
        + found.shares.z * glint_ndf_node_density(material, found.nodes.z, s);
}

// The windows around the example point `place` that stand for a round Gaussian: those of a level and `coarser` of the next.
fn glint_ndf_windows(material: GlintNdfMaterial, place: vec2f, blend: GlintNdfBlend, weight: f32, s: vec2f) -> GlintNdfSum {
    var sum = GlintNdfSum(0.0, 0.0);
    if blend.coarser < 1.0 {
        sum.density += (1.0 - blend.coarser) * glint_ndf_triangle(material, blend.level, place, s);
        sum.terms += 3.0;
    }
    if blend.coarser > 0.0 {
        sum.density += blend.coarser * glint_ndf_triangle(material, blend.level + 1u, place, s);
        sum.terms += 3.0;
    }
    sum.density *= weight;
    return sum;
}

// The patches of the map under an ellipse, `weight` together.
fn glint_ndf_patches(
    material: GlintNdfMaterial,
    e: GlintWindowsEllipse,
    settings: GlintNdfSettings,
    weight: f32,
    s: vec2f,
) -> GlintNdfSum {
    let size = vec2f(material.size);
    // The patch of the texels (i - 1, j - 1) to (i, j) has its middle at (i, j).
    let within = glint_windows_within(e, settings.reach, GLINT_NDF_PATCH_MARGIN);
    let half = glint_windows_half_height(within);
    var y = ceil(within.mean.y - half);
    var span = glint_windows_span_x(within, y);
    var x = ceil(span.x);
    var sum = GlintNdfSum(0.0, 0.0);
    // One loop, not two: pixels in step wait for the most patches of one of them once.
    for (var visit = 0; visit < GLINT_NDF_MAX_PATCHES; visit++) {
        if x <= span.y {
            let at = vec2f(x, y);
            let texel = at - floor((at + 0.5) / size) * size;
            var footprint = e;
            footprint.mean = e.mean - (at - 0.5);
            let corners = glint_ndf_normal_texel(material.layer, vec2u(texel));
            sum.density += glint_ndf_patch_density(material, corners, footprint, s);
            sum.terms += 1.0;
            x += 1.0;
        } else {
            y += 1.0;
            if !(y <= within.mean.y + half) {
                break;
            }
            span = glint_windows_span_x(within, y);
            x = ceil(span.x);
        }
    }
    sum.density *= weight;
    return sum;
}
