// A small box of the example as one lobe: its normals fill a parallelogram evenly, convolved with the intrinsic roughness. Xing et
// al. 2024, Eq. 1; twin of `LobeTerm` in glint-bake-core ndf_maps/eval.rs.

#import ndf_maps::material
#import erf

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
