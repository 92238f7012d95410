//! GGX with height-correlated Smith masking and Schlick's Fresnel factor at run time: what the LTC tables of area lights stand
//! for, for lights that are points or directions. f32, as in WGSL.
//!
//! Walter et al. 2007 (D), Heitz 2014 (masking).

use crate::brdf::{fresnel, half_vector};
use glam::Vec3;
use std::f32::consts::PI;

/// Λ of Smith's masking for a direction of cosine `z` over a surface of roughness `alpha`.
pub fn ggx_lambda(z: f32, alpha: f32) -> f32 {
    let tan2 = (1.0 - z * z).max(0.0) / (z * z);
    let x = alpha * alpha * tan2;
    // (√(1 + x) − 1) / 2 without cancellation.
    0.5 * x / (1.0 + (1.0 + x).sqrt())
}

/// BRDF, by colour, times the cosine of the light over the unit `normal`, for unit vectors; 0 unless both directions are above
/// the facet.
pub fn ggx_cosine(normal: Vec3, view: Vec3, light: Vec3, alpha: f32, f0: Vec3) -> Vec3 {
    let cos_v = normal.dot(view);
    let cos_l = normal.dot(light);
    if !(cos_v > 0.0 && cos_l > 0.0) {
        return Vec3::ZERO;
    }
    let half = half_vector(view, light);
    let cos_h = normal.dot(half);
    // sin² from the cross product: 1 − cos² would lose it near the peak.
    let across = normal.cross(half);
    let a2 = alpha * alpha;
    let t = cos_h * cos_h * a2 + across.dot(across);
    let d = a2 / (PI * t * t);
    let g = 1.0 / (1.0 + ggx_lambda(cos_v, alpha) + ggx_lambda(cos_l, alpha));
    fresnel(f0, view.dot(half)) * (d * g / (4.0 * cos_v))
}
