// GGX with height-correlated Smith masking and Schlick's Fresnel factor: what the LTC tables stand for, for lights that are
// points or directions.
// Walter et al. 2007 (D), Heitz 2014 (masking). Twin of brdf_cosine in glint-bake-core area_light/reference.rs.

// Smith's masking term of a direction of cosine `z`.
fn glint_ggx_lambda(z: f32, alpha: f32) -> f32 {
    let tan2 = max(1.0 - z * z, 0.0) / (z * z);
    let x = alpha * alpha * tan2;
    // (sqrt(1 + x) - 1) / 2 without cancellation.
    return 0.5 * x / (1.0 + sqrt(1.0 + x));
}

// BRDF times the cosine of the light over `normal`, for unit vectors; 0 unless both directions are above the facet.
fn glint_ggx_cosine(normal: vec3f, view: vec3f, light: vec3f, alpha: f32, f0: vec3f) -> vec3f {
    let cos_v = dot(normal, view);
    let cos_l = dot(normal, light);
    if !(cos_v > 0.0 && cos_l > 0.0) {
        return vec3f(0.0);
    }
    let sum = view + light;
    let half = sum / max(length(sum), 1.0e-20);
    let cos_h = dot(normal, half);
    // sin^2 from the cross product: 1 - cos^2 would lose it near the peak.
    let across = cross(normal, half);
    let a2 = alpha * alpha;
    let t = cos_h * cos_h * a2 + dot(across, across);
    let d = a2 / (3.14159265 * t * t);
    let g = 1.0 / (1.0 + glint_ggx_lambda(cos_v, alpha) + glint_ggx_lambda(cos_l, alpha));
    let c = clamp(1.0 - dot(view, half), 0.0, 1.0);
    let c2 = c * c;
    let fresnel = f0 + (vec3f(1.0) - f0) * (c2 * c2 * c);
    return fresnel * (d * g / (4.0 * cos_v));
}
