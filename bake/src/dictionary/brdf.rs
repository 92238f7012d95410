//! From the slope distribution of a pixel to radiance. f32, plain functions, as in WGSL.
//!
//! Paper: section 6.2, Eq. 13 to 16, and algorithm 1. Masking and shadowing are those of V-cavities, which need no
//! knowledge of the distribution but that it is even. Fresnel is Schlick's.

use super::eval::{GlintMaterial, PixelOnSurface, SlopeSum, patch_sdf};
use super::tables::Tables;
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

/// A pixel's BRDF and what of it is left to the base material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchBrdf {
    /// BRDF, by colour, already weighted by the coverage.
    pub value: Vec3,
    /// Share of the footprint that glints.
    pub coverage: f32,
    /// Cells visited.
    pub cells: u32,
}

/// BRDF of a pixel (Eq. 14) for unit directions to the viewer and the light, in the tangent frame. Zero if either is
/// not above the surface.
pub fn patch_brdf(
    tables: &Tables,
    material: &GlintMaterial,
    f0: Vec3,
    pixel: PixelOnSurface,
    view: Vec3,
    light: Vec3,
) -> PatchBrdf {
    if !(view.z > 0.0 && light.z > 0.0) {
        return PatchBrdf { value: Vec3::ZERO, coverage: 0.0, cells: 0 };
    }
    let sum = view + light;
    let half = sum / sum.length().max(1.0e-20);
    let slopes: SlopeSum = patch_sdf(tables, material, pixel, normal_to_slope(half));
    let d = sdf_to_ndf(slopes.sdf, half.z);
    let g = masking(view, half) * masking(light, half);
    let denominator = 4.0 * view.z.max(MIN_COSINE) * light.z.max(MIN_COSINE);
    let value = fresnel(f0, view.dot(half)) * d * (g / denominator);
    PatchBrdf { value, coverage: slopes.coverage, cells: slopes.cells }
}
