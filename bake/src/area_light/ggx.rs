//! GGX with height-correlated Smith masking, in the tangent frame: what the LTC tables are fitted to.
//!
//! Walter et al. 2007 (D), Heitz 2014 (Λ), Heitz 2018 (sampling of visible normals). f64; only square roots and the
//! four operations, so that fits have the same bits everywhere.

use glam::{DVec2, DVec3};

/// Λ of Smith's masking for a direction of cosine `z` over a surface of roughness α.
pub fn lambda(z: f64, alpha: f64) -> f64 {
    let z2 = z * z;
    let tan2 = (1.0 - z2).max(0.0) / z2;
    let a2t2 = alpha * alpha * tan2;
    // ½ (√(1 + x) − 1) without cancellation.
    0.5 * a2t2 / (1.0 + (1.0 + a2t2).sqrt())
}

/// BRDF without Fresnel factor, times the cosine of the light; 0 unless both directions are above the surface.
pub fn brdf_cosine(view: DVec3, light: DVec3, alpha: f64) -> f64 {
    if !(view.z > 0.0 && light.z > 0.0) {
        return 0.0;
    }
    let half = (view + light).normalize();
    let g2 = 1.0 / (1.0 + lambda(view.z, alpha) + lambda(light.z, alpha));
    distribution(half, alpha) * g2 / (4.0 * view.z)
}

/// D of a half vector above the surface.
pub fn distribution(half: DVec3, alpha: f64) -> f64 {
    let a2 = alpha * alpha;
    let t = half.z * half.z + (half.x * half.x + half.y * half.y) / a2;
    1.0 / (std::f64::consts::PI * a2 * t * t)
}

/// Visible normal for a point of the unit disk (Heitz 2018); its density over light directions is
/// [`visible_density`].
pub fn visible_normal(view: DVec3, alpha: f64, disk: DVec2) -> DVec3 {
    let stretched = DVec3::new(alpha * view.x, alpha * view.y, view.z).normalize();
    let across = if stretched.z < 1.0 { DVec3::new(-stretched.y, stretched.x, 0.0).normalize() } else { DVec3::Y };
    let along = stretched.cross(across);
    let s = 0.5 * (1.0 + stretched.z);
    let y = (1.0 - s) * (1.0 - disk.x * disk.x).max(0.0).sqrt() + s * disk.y;
    let up = (1.0 - disk.x * disk.x - y * y).max(0.0).sqrt();
    let normal = across * disk.x + along * y + stretched * up;
    DVec3::new(alpha * normal.x, alpha * normal.y, normal.z.max(0.0)).normalize()
}

/// Density, over solid angle of the light, of reflections about visible normals: G₁ D / (4 v·n).
pub fn visible_density(view: DVec3, half: DVec3, alpha: f64) -> f64 {
    distribution(half, alpha) / ((1.0 + lambda(view.z, alpha)) * 4.0 * view.z)
}
