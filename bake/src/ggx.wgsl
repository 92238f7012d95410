// GGX with height-correlated Smith masking and Schlick's Fresnel factor at run time: what the LTC tables of area lights stand
// for, for lights that are points or directions. Twin of ggx.rs.
// Walter et al. 2007 (D), Heitz 2014 (masking).

#import brdf

// Lambda of Smith's masking for a direction of cosine `z` over a surface of roughness `alpha`.
fn glint_ggx_lambda(z: f32, alpha: f32) -> f32 {
    let tan2 = max(1.0 - z * z, 0.0) / (z * z);
    let x = alpha * alpha * tan2;
    // (sqrt(1 + x) - 1) / 2 without cancellation.
    return 0.5 * x / (1.0 + sqrt(1.0 + x));
}

// BRDF, by colour, times the cosine of the light over the unit `normal`, for unit vectors; 0 unless both directions are above
// the facet.
fn glint_ggx_cosine(normal: vec3f, view: vec3f, light: vec3f, alpha: f32, f0: vec3f) -> vec3f {
    let cos_v = dot(normal, view);
    let cos_l = dot(normal, light);
    if !(cos_v > 0.0 && cos_l > 0.0) {
        return vec3f(0.0);
    }
    let half = glint_half_vector(view, light);
    let cos_h = dot(normal, half);
    // sin^2 from the cross product: 1 - cos^2 would lose it near the peak.
    let across = cross(normal, half);
    let a2 = alpha * alpha;
    let t = cos_h * cos_h * a2 + dot(across, across);
    let d = a2 / (3.14159265 * t * t);
    let g = 1.0 / (1.0 + glint_ggx_lambda(cos_v, alpha) + glint_ggx_lambda(cos_l, alpha));
    return glint_fresnel(f0, dot(view, half)) * (d * g / (4.0 * cos_v));
}
