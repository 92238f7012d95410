// From a distribution of normals to radiance, as all methods have it. Twin of brdf.rs.
//
// Masking and shadowing are those of V-cavities (Chermain et al. 2020, Eq. 16), which need no knowledge of the
// distribution but that it is even. Fresnel is Schlick's. Directions are unit vectors in the tangent frame, z the normal.

// Half vectors nearer to the horizon than this cosine count as this far from it.
const GLINT_MIN_COSINE: f32 = 1.0e-6;

// Slope of a normal with z > 0 (Eq. 1).
fn glint_normal_to_slope(normal: vec3f) -> vec2f {
    return -normal.xy / max(normal.z, GLINT_MIN_COSINE);
}

// Density over normals of a density over slopes (Eq. 13).
fn glint_sdf_to_ndf(sdf: vec3f, cosine: f32) -> vec3f {
    let z = max(cosine, GLINT_MIN_COSINE);
    let z2 = z * z;
    return sdf / (z2 * z2);
}

// V-cavity masking of direction `w` by facets of normal `m` (Eq. 16).
fn glint_masking(w: vec3f, m: vec3f) -> f32 {
    let wm = dot(w, m);
    if wm <= 0.0 {
        return 0.0;
    }
    return clamp(2.0 * m.z * w.z / wm, 0.0, 1.0);
}

// Schlick's Fresnel factor.
fn glint_fresnel(f0: vec3f, cosine: f32) -> vec3f {
    let c = clamp(1.0 - cosine, 0.0, 1.0);
    let c2 = c * c;
    return f0 + (vec3f(1.0) - f0) * (c2 * c2 * c);
}

// Half vector of two unit vectors; any vector if they are opposite.
fn glint_half_vector(view: vec3f, light: vec3f) -> vec3f {
    let sum = view + light;
    return sum / max(length(sum), 1.0e-20);
}

// BRDF of facets with density `ndf` at the half vector (Eq. 14). Zero if a direction is not above the surface.
fn glint_facet_brdf(ndf: vec3f, f0: vec3f, view: vec3f, light: vec3f) -> vec3f {
    if !(view.z > 0.0 && light.z > 0.0) {
        return vec3f(0.0);
    }
    let half = glint_half_vector(view, light);
    let g = glint_masking(view, half) * glint_masking(light, half);
    let denominator = 4.0 * max(view.z, GLINT_MIN_COSINE) * max(light.z, GLINT_MIN_COSINE);
    return glint_fresnel(f0, dot(view, half)) * ndf * (g / denominator);
}
