// Smooth microfacet surfaces of Beckmann or GGX slopes, whose roughness may differ between the tangent axes, with height-correlated Smith
// masking and Schlick's Fresnel factor: what counted facets converge to. Twin of microfacet.rs.
// Walter et al. 2007 (distributions, lambda of Beckmann's); Heitz 2014 (anisotropic lambda).

#import brdf

const GLINT_MICROFACET_GGX: u32 = 1u;
// Least normal number.
const GLINT_MICROFACET_LEAST_NORMAL: f32 = 1.1754944e-38;
// Least cosine of directions to the surface's normal, and roughness.
const GLINT_MICROFACET_LEAST: f32 = 1.0e-3;
// Least square of the cosine of a direction and the half vector.
const GLINT_MICROFACET_LEAST_SQUARE: f32 = 1.0e-4;

// A smooth microfacet surface.
struct GlintSmoothSurface {
    // Squares of the roughness along both tangent axes, 1e-6 to 1.
    alpha2: vec2f,
    // 0 Beckmann, 1 GGX.
    normal_target: u32,
}

// Distribution of normals at the unit vector `m` with m.z > 0.
fn glint_microfacet_ndf(surface: GlintSmoothSurface, m: vec3f) -> f32 {
    let across = dot(m.xy, m.xy / surface.alpha2);
    let z2 = max(m.z * m.z, GLINT_MICROFACET_LEAST * GLINT_MICROFACET_LEAST * GLINT_MICROFACET_LEAST);
    let area = 3.14159265 * sqrt(surface.alpha2.x * surface.alpha2.y);
    if surface.normal_target == GLINT_MICROFACET_GGX {
        let sum = z2 + across;
        return 1.0 / (area * sum * sum);
    }
    return exp(-across / z2) / (area * z2 * z2);
}

// Lambda of Smith's masking for the unit direction `w` with w.z > 0.
fn glint_microfacet_lambda(surface: GlintSmoothSurface, w: vec3f) -> f32 {
    let z = max(w.z, GLINT_MICROFACET_LEAST);
    let x = dot(w.xy, w.xy * surface.alpha2) / (z * z);
    if surface.normal_target == GLINT_MICROFACET_GGX {
        // (sqrt(1 + x) - 1) / 2 without cancellation.
        return 0.5 * x / (1.0 + sqrt(1.0 + x));
    }
    // The rational form of 1 / t, times t^2 above and below.
    let t = sqrt(x);
    return select(0.0, (x - 1.259 * t + 0.396) / (3.535 * t + 2.181), t > 0.625);
}

// Cosine of the unit direction `w` times 1 + 2 lambda of GGX.
fn glint_ggx_stretched(surface: GlintSmoothSurface, w: vec3f) -> f32 {
    return sqrt(dot(surface.alpha2, w.xy * w.xy) + w.z * w.z);
}

// What of the light that facets reflect from `light` to `view` (unit vectors) leaves the surface, over four times the view's cosine; 0 unless both
// are above the surface.
fn glint_microfacet_masked(surface: GlintSmoothSurface, view: vec3f, light: vec3f) -> f32 {
    if !(view.z > 0.0 && light.z > 0.0) {
        return 0.0;
    }
    if surface.normal_target == GLINT_MICROFACET_GGX {
        // 1 + lambda + lambda is half the sum of both stretched cosines over the cosines.
        let sum = light.z * glint_ggx_stretched(surface, view) + view.z * glint_ggx_stretched(surface, light);
        return 0.5 * light.z / max(sum, GLINT_MICROFACET_LEAST_NORMAL);
    }
    let masked = 1.0 + glint_microfacet_lambda(surface, view) + glint_microfacet_lambda(surface, light);
    return 1.0 / (masked * 4.0 * max(view.z, GLINT_MICROFACET_LEAST));
}

// The surface whose lobe is as wide as that of one that sees a light of `solid_angle` from `view`, with the half vector's cosine
// `cos_h`.
fn glint_microfacet_under_cone(surface: GlintSmoothSurface, view: vec3f, solid_angle: f32, cos_h: f32) -> GlintSmoothSurface {
    let width = select(0.5, 1.0, surface.normal_target == GLINT_MICROFACET_GGX);
    let along = width * solid_angle * 0.079577472;
    let across = along / max(cos_h * cos_h, GLINT_MICROFACET_LEAST_SQUARE);
    let inverse = 1.0 / max(dot(view.xy, view.xy), 1.0e-12);
    let share = view.xy * view.xy * inverse;
    return GlintSmoothSurface(surface.alpha2 + vec2f(across) - share * (across - along), surface.normal_target);
}

// BRDF, by colour, times the cosine of `light`, for unit vectors; 0 unless both are above the surface.
fn glint_microfacet_cosine(surface: GlintSmoothSurface, f0: vec3f, view: vec3f, light: vec3f) -> vec3f {
    let half = glint_half_vector(view, light);
    let density = glint_microfacet_ndf(surface, half);
    return glint_fresnel(f0, dot(view, half)) * (density * glint_microfacet_masked(surface, view, light));
}

// Whole facet area over surface area of one roughness, whose square is `alpha2`.
fn glint_round_facet_area(normal_target: u32, alpha2: f32) -> f32 {
    if normal_target == GLINT_MICROFACET_GGX {
        let a2 = clamp(alpha2, 1.0e-12, 0.9999);
        let beta = sqrt(1.0 - a2);
        return 1.0 + a2 * log((1.0 + beta) * (1.0 + beta) / a2) * 0.5 / beta;
    }
    return 1.0 + alpha2 / (1.0 + sqrt(1.0 + alpha2 * (2.0 - 0.313 * sqrt(alpha2))));
}

// Whole facet area over surface area, 1 to 2: the mean over directions of that of the roughness along them.
fn glint_microfacet_area(surface: GlintSmoothSurface) -> f32 {
    let nodes = vec4f(0.9807853, 0.8314696, 0.5555702, 0.1950903);
    let mean = 0.5 * (surface.alpha2.x + surface.alpha2.y);
    let difference = 0.5 * (surface.alpha2.x - surface.alpha2.y);
    var sum = 0.0;
    for (var k = 0u; k < 4u; k++) {
        sum += glint_round_facet_area(surface.normal_target, mean + difference * nodes[k]);
        sum += glint_round_facet_area(surface.normal_target, mean - difference * nodes[k]);
    }
    return sum * 0.125;
}

// Density over solid angle, 1/sr, of the directions that the normals of glint_mirror_normal mirror `view` to.
fn glint_mirror_pdf(surface: GlintSmoothSurface, view: vec3f, light: vec3f) -> f32 {
    let half = glint_half_vector(view, light);
    let density = glint_microfacet_ndf(surface, half);
    if surface.normal_target == GLINT_MICROFACET_GGX {
        return density / ((1.0 + glint_microfacet_lambda(surface, view)) * 4.0 * max(view.z, 1.0e-6));
    }
    return density * half.z / (4.0 * max(dot(view, half), 1.0e-6));
}

// Normal of a facet of `surface` that `view` is mirrored at, for two uniform numbers in [0, 1): of GGX a visible one, by a cap of a sphere (Dupuy and
// Benyoub 2023), of Beckmann one by its slopes, which are Gaussian.
fn glint_mirror_normal(surface: GlintSmoothSurface, view: vec3f, random: vec2f) -> vec3f {
    let alpha = sqrt(surface.alpha2);
    let sine = sin(6.2831853 * random.x);
    let cosine = cos(6.2831853 * random.x);
    if surface.normal_target == GLINT_MICROFACET_GGX {
        let stretched = normalize(vec3f(view.xy * alpha, view.z));
        let z = (1.0 - random.y) * (1.0 + stretched.z) - stretched.z;
        let across = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
        let cap = stretched + vec3f(across * cosine, across * sine, z);
        return normalize(vec3f(cap.xy * alpha, cap.z));
    }
    let slope = alpha * vec2f(cosine, sine) * sqrt(-log(max(1.0 - random.y, 1.0e-30)));
    return normalize(vec3f(slope, 1.0));
}
