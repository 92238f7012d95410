//! Smooth microfacet surfaces of Beckmann or GGX slopes, whose roughness may differ between the tangent axes, with height-correlated Smith
//! masking and Schlick's Fresnel factor: what counted facets converge to. f32; twin: `microfacet.wgsl`.
//!
//! Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces" (distributions, Λ of Beckmann's, section 5.2); Heitz 2014,
//! "Understanding the Masking-Shadowing Function" (anisotropic Λ by the roughness along a direction, section 5.4.1).

use crate::brdf::{fresnel, half_vector};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// [`SmoothSurface::normal_target`] of Beckmann slopes.
pub const BECKMANN: u32 = 0;
/// [`SmoothSurface::normal_target`] of GGX slopes.
pub const GGX: u32 = 1;
/// Least cosine of directions to the surface's normal, and roughness.
const LEAST: f32 = 1e-3;
/// Least square of the cosine of a direction and the half vector.
const LEAST_SQUARE: f32 = 1e-4;

/// A smooth microfacet surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothSurface {
    /// Squares of the roughness α along both tangent axes, 1e-6 to 1.
    pub alpha2: Vec2,
    /// [`BECKMANN`] or [`GGX`].
    pub normal_target: u32,
}

/// Distribution of normals D at the unit vector `m` with m.z > 0: ∫ D(m) m.z dm = 1.
pub fn microfacet_ndf(surface: SmoothSurface, m: Vec3) -> f32 {
    let v = Vec2::new(m.x, m.y);
    let across = v.dot(v / surface.alpha2);
    let z2 = (m.z * m.z).max(LEAST * LEAST * LEAST);
    let area = PI * (surface.alpha2.x * surface.alpha2.y).sqrt();
    if surface.normal_target == GGX {
        let sum = z2 + across;
        1.0 / (area * sum * sum)
    } else {
        (-across / z2).exp() / (area * z2 * z2)
    }
}

/// Λ of Smith's masking for the unit direction `w` with w.z > 0.
pub fn microfacet_lambda(surface: SmoothSurface, w: Vec3) -> f32 {
    let v = Vec2::new(w.x, w.y);
    let z = w.z.max(LEAST);
    // Square of roughness times tangent, along w.
    let x = v.dot(v * surface.alpha2) / (z * z);
    if surface.normal_target == GGX {
        // (√(1 + x) − 1) / 2 without cancellation.
        return 0.5 * x / (1.0 + (1.0 + x).sqrt());
    }
    // The rational form of 1 / t, times t² above and below.
    let t = x.sqrt();
    if t > 0.625 { (x - 1.259 * t + 0.396) / (3.535 * t + 2.181) } else { 0.0 }
}

/// Cosine of the unit direction `w` times 1 + 2 Λ of GGX: √(w.z² + α² w.x² + …).
fn ggx_stretched(surface: SmoothSurface, w: Vec3) -> f32 {
    (surface.alpha2.x * w.x * w.x + surface.alpha2.y * w.y * w.y + w.z * w.z).sqrt()
}

/// What of the light that facets reflect from `light` to `view` (unit vectors) leaves the surface, over four times the view's cosine; 0 unless both
/// are above the surface.
pub fn microfacet_masked(surface: SmoothSurface, view: Vec3, light: Vec3) -> f32 {
    if !(view.z > 0.0 && light.z > 0.0) {
        return 0.0;
    }
    if surface.normal_target == GGX {
        // 1 + Λ + Λ is half the sum of both stretched cosines over the cosines.
        let sum = light.z * ggx_stretched(surface, view) + view.z * ggx_stretched(surface, light);
        return 0.5 * light.z / sum.max(f32::MIN_POSITIVE);
    }
    let masked = 1.0 + microfacet_lambda(surface, view) + microfacet_lambda(surface, light);
    1.0 / (masked * 4.0 * view.z.max(LEAST))
}

/// The surface whose lobe is as wide as that of one that sees a light of `solid_angle` steradians from `view`, with the half vector's cosine `cos_h`.
///
/// A cone of half angle γ is reflected by normals in an ellipse: γ / 2 along the plane of incidence and γ / (2 h·o) across. GGX's mean over
/// a disk of radius r around its peak is the peak of roughness √(α² + r²): 1 / (π (α² + r²)); Beckmann's, a Gaussian, has the disk's variance more, r² / 2.
pub fn microfacet_under_cone(surface: SmoothSurface, view: Vec3, solid_angle: f32, cos_h: f32) -> SmoothSurface {
    let width = if surface.normal_target == GGX { 1.0 } else { 0.5 };
    let along = width * solid_angle * (0.25 / PI);
    let across = along / (cos_h * cos_h).max(LEAST_SQUARE);
    let flat = Vec2::new(view.x, view.y);
    let inverse = 1.0 / flat.dot(flat).max(1e-12);
    let share = flat * flat * inverse;
    SmoothSurface { alpha2: surface.alpha2 + Vec2::splat(across) - share * (across - along), ..surface }
}

/// BRDF, by colour, times the cosine of `light`, for unit vectors; 0 unless both are above the surface.
pub fn microfacet_cosine(surface: SmoothSurface, f0: Vec3, view: Vec3, light: Vec3) -> Vec3 {
    let half = half_vector(view, light);
    fresnel(f0, view.dot(half)) * (microfacet_ndf(surface, half) * microfacet_masked(surface, view, light))
}

/// Whole facet area over surface area of one roughness, ∫ D(m) dm, as the square `alpha2` of the roughness has it: GGX's in closed form, 1 + α² atanh(β)/β,
/// β = √(1 − α²); Beckmann's 1 + α √π/2 · exp(1/α²) erfc(1/α) by a form that is off by at most 2e-4.
fn round_facet_area(normal_target: u32, alpha2: f32) -> f32 {
    if normal_target == GGX {
        let a2 = alpha2.clamp(1e-12, 0.9999);
        let beta = (1.0 - a2).sqrt();
        // atanh(β) = ½ ln((1 + β)² / α²), which keeps its digits at small α.
        return 1.0 + a2 * ((1.0 + beta) * (1.0 + beta) / a2).ln() * 0.5 / beta;
    }
    1.0 + alpha2 / (1.0 + (1.0 + alpha2 * (2.0 - 0.313 * alpha2.sqrt())).sqrt())
}

/// Whole facet area over surface area, D_H = ∫ D(m) dm (Kneiphof and Klein 2025, section 3.2), 1 to 2: the mean of that of the roughness along
/// every direction, whose square goes as a cosine of twice the angle (Gauss–Chebyshev quadrature).
pub fn microfacet_area(surface: SmoothSurface) -> f32 {
    const NODES: [f32; 4] = [0.980_785_3, 0.831_469_6, 0.555_570_2, 0.195_090_3];
    let Vec2 { x, y } = surface.alpha2;
    let (mean, difference) = (0.5 * (x + y), 0.5 * (x - y));
    let mut sum = 0.0;
    for node in NODES {
        sum += round_facet_area(surface.normal_target, mean + difference * node);
        sum += round_facet_area(surface.normal_target, mean - difference * node);
    }
    sum * 0.125
}

/// Density over solid angle, 1/sr, of the directions that the normals of [`mirror_normal`] mirror `view` to.
pub fn mirror_pdf(surface: SmoothSurface, view: Vec3, light: Vec3) -> f32 {
    let half = half_vector(view, light);
    let density = microfacet_ndf(surface, half);
    if surface.normal_target == GGX {
        // Visible normals: D(h) G₁(o) (h·o) / o.z, over 4 h·o.
        return density / ((1.0 + microfacet_lambda(surface, view)) * 4.0 * view.z.max(1e-6));
    }
    density * half.z / (4.0 * view.dot(half).max(1e-6))
}

/// Normal of a facet of `surface` that `view` is mirrored at, for two uniform numbers in [0, 1): of GGX a visible one, by a cap of a sphere (Dupuy and
/// Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", Listing 3), of Beckmann one by its slopes, which are Gaussian.
pub fn mirror_normal(surface: SmoothSurface, view: Vec3, random: Vec2) -> Vec3 {
    let alpha = Vec2::new(surface.alpha2.x.sqrt(), surface.alpha2.y.sqrt());
    let (sine, cosine) = (TAU * random.x).sin_cos();
    if surface.normal_target == GGX {
        let flat = Vec2::new(view.x, view.y) * alpha;
        let stretched = flat.extend(view.z).normalize();
        let z = (1.0 - random.y) * (1.0 + stretched.z) - stretched.z;
        let across = (1.0 - z * z).clamp(0.0, 1.0).sqrt();
        let cap = stretched + Vec3::new(across * cosine, across * sine, z);
        return (Vec2::new(cap.x, cap.y) * alpha).extend(cap.z).normalize();
    }
    let slope = alpha * Vec2::new(cosine, sine) * (-(1.0 - random.y).max(1e-30).ln()).sqrt();
    slope.extend(1.0).normalize()
}
