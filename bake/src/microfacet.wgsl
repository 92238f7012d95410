// Smooth microfacet surfaces of Beckmann or GGX slopes, whose roughness may differ between the tangent axes, with height-correlated Smith
// masking and Schlick's Fresnel factor: what counted facets converge to. Twin of microfacet.rs.
// Walter et al. 2007 (distributions, lambda of Beckmann's); Heitz 2014 (anisotropic lambda).

#import brdf

const GLINT_MICROFACET_GGX: u32 = 1u;
// Least cosine of directions to the surface's normal, and roughness.
const GLINT_MICROFACET_LEAST: f32 = 1.0e-3;

// A smooth microfacet surface.
struct GlintSmoothSurface {
    // Roughness along both tangent axes, 1e-3 to 1.
    alpha: vec2f,
    // 0 Beckmann, 1 GGX.
    normal_target: u32,
}

// Distribution of normals at the unit vector `m` with m.z > 0.
fn glint_microfacet_ndf(surface: GlintSmoothSurface, m: vec3f) -> f32 {
    let v = m.xy / surface.alpha;
    let across = dot(v, v);
    let z2 = max(m.z * m.z, GLINT_MICROFACET_LEAST * GLINT_MICROFACET_LEAST * GLINT_MICROFACET_LEAST);
    let area = 3.14159265 * surface.alpha.x * surface.alpha.y;
    if surface.normal_target == GLINT_MICROFACET_GGX {
        let sum = z2 + across;
        return 1.0 / (area * sum * sum);
    }
    return exp(-across / z2) / (area * z2 * z2);
}

// Lambda of Smith's masking for the unit direction `w` with w.z > 0.
fn glint_microfacet_lambda(surface: GlintSmoothSurface, w: vec3f) -> f32 {
    let v = w.xy * surface.alpha;
    let z = max(w.z, GLINT_MICROFACET_LEAST);
    let x = dot(v, v) / (z * z);
    if surface.normal_target == GLINT_MICROFACET_GGX {
        // (sqrt(1 + x) - 1) / 2 without cancellation.
        return 0.5 * x / (1.0 + sqrt(1.0 + x));
    }
    let a = inverseSqrt(max(x, 1.0e-12));
    let rough = (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a);
    return select(rough, 0.0, a >= 1.6);
}

// What of the light that facets reflect from `light` to `view` (unit vectors) leaves the surface, over four times the view's cosine; 0 unless both
// are above the surface.
fn glint_microfacet_masked(surface: GlintSmoothSurface, view: vec3f, light: vec3f) -> f32 {
    if !(view.z > 0.0 && light.z > 0.0) {
        return 0.0;
    }
    let masked = 1.0 + glint_microfacet_lambda(surface, view) + glint_microfacet_lambda(surface, light);
    return 1.0 / (masked * 4.0 * max(view.z, GLINT_MICROFACET_LEAST));
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
    let squares = surface.alpha * surface.alpha;
    let mean = 0.5 * (squares.x + squares.y);
    let difference = 0.5 * (squares.x - squares.y);
    var sum = 0.0;
    for (var k = 0u; k < 4u; k++) {
        sum += glint_round_facet_area(surface.normal_target, mean + difference * nodes[k]);
        sum += glint_round_facet_area(surface.normal_target, mean - difference * nodes[k]);
    }
    return sum * 0.125;
}
