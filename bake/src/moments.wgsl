// Mean and covariance of the projected normals under a footprint, and what follows from them: the rough surface that light from all
// around sees, and directions to sample a glinting one in. Twin of moments.rs, which has the reasons.

#import brdf

// Part of the samples that are even over the disk.
const GLINT_MOMENTS_EVEN: f32 = 0.1;
// Factor on the covariance of the other samples.
const GLINT_MOMENTS_WIDER: f32 = 1.5;
// Least cosine of a mean normal.
const GLINT_MOMENTS_LEAST_COSINE: f32 = 0.05;

// Mean and covariance of projected normals.
struct GlintMoments {
    // Mean, within the unit disk.
    mean: vec2f,
    // Covariance xx, xy, yy.
    covariance: vec3f,
}

// A rough surface whose micro-normals have the same mean and covariance.
struct GlintRoughNormal {
    // Unit mean normal in the tangent frame.
    normal: vec3f,
    // Unit vector across the normal along which the surface is roughest.
    axis: vec3f,
    // Roughness alpha along that axis and across it, as Beckmann's, at most 1.
    alpha: vec2f,
}

// Weighted moments of parts; weights sum to 1.
struct GlintMomentSums {
    // Of means.
    mean: vec2f,
    // Of second moments xx, xy, yy.
    second: vec3f,
}

// Adds a part with its weight.
fn glint_moments_add(sums: ptr<function, GlintMomentSums>, weight: f32, part: GlintMoments) {
    let m = part.mean;
    (*sums).mean += weight * m;
    (*sums).second += weight * (part.covariance + vec3f(m.x * m.x, m.x * m.y, m.y * m.y));
}

// Moments of the whole, whose variance is at least `least` along every axis.
fn glint_moments_whole(sums: GlintMomentSums, least: f32) -> GlintMoments {
    let m = sums.mean;
    let covariance = sums.second - vec3f(m.x * m.x, m.x * m.y, m.y * m.y);
    let xx = max(covariance.x, least);
    let yy = max(covariance.z, least);
    // A correlation of 1 would have no width across.
    let most = sqrt(max((xx - 0.5 * least) * (yy - 0.5 * least), 0.0));
    return GlintMoments(m, vec3f(xx, clamp(covariance.y, -most, most), yy));
}

// The rough surface of these moments.
fn glint_rough_normal(moments: GlintMoments) -> GlintRoughNormal {
    let least = GLINT_MOMENTS_LEAST_COSINE;
    let far = sqrt(dot(moments.mean, moments.mean));
    let length = min(far, sqrt(1.0 - least * least));
    let radial = select(vec2f(1.0, 0.0), moments.mean / max(far, 1.0e-20), far > 0.0);
    let across = vec2f(-radial.y, radial.x);
    let cosine = sqrt(1.0 - length * length);
    let xx = moments.covariance.x;
    let xy = moments.covariance.y;
    let yy = moments.covariance.z;
    let rr = (radial.x * radial.x * xx + 2.0 * radial.x * radial.y * xy + radial.y * radial.y * yy) / (cosine * cosine);
    let rt = (radial.x * across.x * xx + (radial.x * across.y + radial.y * across.x) * xy + radial.y * across.y * yy) / cosine;
    let tt = across.x * across.x * xx + 2.0 * across.x * across.y * xy + across.y * across.y * yy;
    let middle = 0.5 * (rr + tt);
    let half_gap = vec2f(0.5 * (rr - tt), rt);
    let gap = sqrt(dot(half_gap, half_gap));
    // Half the angle of the gap: along the larger variance.
    let doubled = select(vec2f(half_gap.y, gap - half_gap.x), vec2f(gap + half_gap.x, half_gap.y), half_gap.x >= 0.0);
    let doubled_length = sqrt(dot(doubled, doubled));
    let along = select(vec2f(1.0, 0.0), doubled / max(doubled_length, 1.0e-20), doubled_length > 0.0);
    let tilted = vec3f(radial * cosine, -length);
    let level = vec3f(across, 0.0);
    let variances = max(vec2f(middle + gap, middle - gap), vec2f(0.0));
    return GlintRoughNormal(
        vec3f(radial * length, cosine),
        tilted * along.x + level * along.y,
        min(sqrt(2.0 * variances), vec2f(1.0)),
    );
}

// A direction that light may come from, for a random number from 0 to 1 in each of three dimensions; its density is
// glint_moments_pdf. A length of 0 means that this sample has none.
fn glint_moments_sample(moments: GlintMoments, view: vec3f, random: vec3f) -> vec3f {
    let angle = 6.2831853 * random.y;
    let round = vec2f(cos(angle), sin(angle));
    var s = sqrt(random.x) * round;
    if random.z >= GLINT_MOMENTS_EVEN {
        let c = GLINT_MOMENTS_WIDER * moments.covariance;
        let radius = sqrt(-2.0 * log(max(1.0 - random.x, 1.0e-12)));
        let first = sqrt(c.x);
        let second = sqrt(max(c.z - c.y * c.y / c.x, 0.0));
        s = moments.mean + radius * vec2f(first * round.x, c.y / first * round.x + second * round.y);
    }
    let height = 1.0 - dot(s, s);
    if height <= 0.0 {
        return vec3f(0.0);
    }
    let half = vec3f(s, sqrt(height));
    let cosine = dot(view, half);
    let light = 2.0 * cosine * half - view;
    return select(vec3f(0.0), light, cosine > 0.0 && light.z > 0.0);
}

// Density over solid angle of glint_moments_sample at the unit direction `light`, given a unit direction `view`.
fn glint_moments_pdf(moments: GlintMoments, view: vec3f, light: vec3f) -> f32 {
    let half = glint_half_vector(view, light);
    if light.z <= 0.0 || half.z <= 0.0 {
        return 0.0;
    }
    let c = GLINT_MOMENTS_WIDER * moments.covariance;
    let d = half.xy - moments.mean;
    let determinant = max(c.x * c.z - c.y * c.y, 1.0e-20);
    let squared = (c.z * d.x * d.x - 2.0 * c.y * d.x * d.y + c.x * d.y * d.y) / determinant;
    let gaussian = exp(-0.5 * squared) / (6.2831853 * sqrt(determinant));
    let even = GLINT_MOMENTS_EVEN;
    return ((1.0 - even) * gaussian + even / 3.14159265) * half.z / (4.0 * max(dot(view, half), 1.0e-6));
}
