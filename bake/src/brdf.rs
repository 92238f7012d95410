//! From a distribution of normals to radiance, as all methods have it. f32, plain functions, as in WGSL.
//!
//! Paper: Chermain et al. 2020, "Procedural Physically based BRDF for Real-Time Rendering of Glints", section 6.2, Eq. 1 and
//! 13 to 16. Masking and shadowing are those of V-cavities, which need no knowledge of the distribution but that it is even.
//! Fresnel is Schlick's. Directions are unit vectors in the tangent frame, z the normal.

use glam::{Vec2, Vec3};

/// Half vectors nearer to the horizon than this cosine count as this far from it.
pub const MIN_COSINE: f32 = 1.0e-6;

/// Slope of a normal with z > 0 (Eq. 1).
pub fn normal_to_slope(normal: Vec3) -> Vec2 {
    let z = normal.z.max(MIN_COSINE);
    Vec2::new(-normal.x / z, -normal.y / z)
}

/// Density over normals of a density over slopes (Eq. 13).
pub fn sdf_to_ndf(sdf: Vec3, cosine: f32) -> Vec3 {
    let z = cosine.max(MIN_COSINE);
    let z2 = z * z;
    sdf / (z2 * z2)
}

/// V-cavity masking of direction `w` by facets of normal `m` (Eq. 16).
pub fn masking(w: Vec3, m: Vec3) -> f32 {
    let wm = w.dot(m);
    if wm <= 0.0 {
        return 0.0;
    }
    (2.0 * m.z * w.z / wm).clamp(0.0, 1.0)
}

/// Schlick's Fresnel factor.
pub fn fresnel(f0: Vec3, cosine: f32) -> Vec3 {
    let c = (1.0 - cosine).clamp(0.0, 1.0);
    let c2 = c * c;
    f0 + (Vec3::ONE - f0) * (c2 * c2 * c)
}

/// Half vector of two unit vectors; any vector if they are opposite.
pub fn half_vector(view: Vec3, light: Vec3) -> Vec3 {
    let sum = view + light;
    sum / sum.length().max(1.0e-20)
}

/// BRDF, by colour, of facets with density `ndf` at the half vector (Eq. 14), for unit directions to the viewer and the light.
/// Zero if either is not above the surface.
pub fn facet_brdf(ndf: Vec3, f0: Vec3, view: Vec3, light: Vec3) -> Vec3 {
    if !(view.z > 0.0 && light.z > 0.0) {
        return Vec3::ZERO;
    }
    let half = half_vector(view, light);
    let g = masking(view, half) * masking(light, half);
    let denominator = 4.0 * view.z.max(MIN_COSINE) * light.z.max(MIN_COSINE);
    fresnel(f0, view.dot(half)) * ndf * (g / denominator)
}
