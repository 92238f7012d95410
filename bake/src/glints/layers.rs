//! What counted facets lie on and under: light that is scattered below them, and a smooth clear coat over both, f32; twin: `layers.wgsl`.
//!
//! The coat is that of glTF 2.0 (KHR_materials_clearcoat): one of weight c leaves 1 − c F(n·o) of all that lies under it and adds c times its own
//! GGX reflection at an F0 of 0.04. What facets let in, 1 − F, is scattered evenly; glTF has F at the half vector, which lets a rough white surface
//! reflect more light than falls on it (by 0.7 % at 70°), so here it is F(n·o), too, the same for every light. Neither is counted: both are
//! smooth, and a pixel's facets are drawn as without them. Directions are unit vectors in the frame of the roughness.

use crate::area_light::baked::Tables;
use crate::area_light::rect::{RectLight, faces, isotropic_radiance, quad_form_factor};
use crate::brdf::{fresnel, half_vector};
use crate::microfacet::{GGX, SmoothSurface, microfacet_masked, microfacet_ndf, microfacet_under_cone};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Reflectance of a coat at normal incidence: that of an index of refraction of 1.5.
pub const COAT_F0: Vec3 = Vec3::splat(0.04);

/// What facets lie on and under.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Albedo of what is scattered below the facets, linear RGB; black for metals.
    pub diffuse: Vec3,
    /// Weight of the coat, 0 for none to 1.
    pub coat: f32,
    /// GGX roughness α of the coat, 1e-3 to 1.
    pub coat_alpha: f32,
}

/// The smooth surface that a coat is.
pub(super) fn coat_surface(layers: Layers) -> SmoothSurface {
    SmoothSurface { alpha2: Vec2::splat(layers.coat_alpha * layers.coat_alpha), normal_target: GGX }
}

/// Share that a coat leaves of what lies under it, for a view of this cosine.
pub fn coat_through(layers: Layers, cos_view: f32) -> f32 {
    if layers.coat > 0.0 { 1.0 - layers.coat * fresnel(COAT_F0, cos_view).x } else { 1.0 }
}

/// Albedo, linear RGB, of what is scattered below facets and coat, for a view of this cosine.
fn scattered(layers: Layers, f0: Vec3, cos_view: f32) -> Vec3 {
    layers.diffuse * (Vec3::ONE - fresnel(f0, cos_view)) * coat_through(layers, cos_view)
}

/// What a light that is a cone of `solid_angle` around `direction` adds to its facets, over its irradiance, linear RGB; 0 unless both directions
/// are above the surface. The coat's lobe is as wide as the light makes it, without a facet's own cone.
pub fn cone_layers(layers: Layers, f0: Vec3, view: Vec3, direction: Vec3, solid_angle: f32) -> Vec3 {
    let mut sum = Vec3::ZERO;
    if !(view.z > 0.0 && direction.z > 0.0) {
        return sum;
    }
    if layers.diffuse.cmpgt(Vec3::ZERO).any() {
        sum = scattered(layers, f0, view.z) * (direction.z * FRAC_1_PI);
    }
    if layers.coat > 0.0 {
        let half = half_vector(view, direction);
        let cos_h = view.dot(half);
        let seen = microfacet_under_cone(coat_surface(layers), view, solid_angle, cos_h);
        let reflected = microfacet_ndf(seen, half) * microfacet_masked(seen, view, direction);
        sum += fresnel(COAT_F0, cos_h) * (layers.coat * reflected);
    }
    sum
}

/// What a rectangle adds to its facets, linear RGB.
pub fn rect_layers(tables: &Tables, layers: Layers, f0: Vec3, view: Vec3, light: &RectLight) -> Vec3 {
    let mut sum = Vec3::ZERO;
    if !(view.z > 0.0 && faces(light)) {
        return sum;
    }
    if layers.diffuse.cmpgt(Vec3::ZERO).any() {
        sum = scattered(layers, f0, view.z) * (light.radiance * quad_form_factor(light.corners));
    }
    if layers.coat > 0.0 {
        sum += layers.coat * isotropic_radiance(tables, Vec3::Z, layers.coat_alpha, view, COAT_F0.x, light);
    }
    sum
}

/// What an environment adds to its facets, linear RGB: `around` is the mean radiance that falls on the surface, by the cosine, and `reflected` the smooth
/// reflection of a surface of [`COAT_F0`] and the coat's roughness.
pub fn sky_layers(layers: Layers, f0: Vec3, cos_view: f32, around: Vec3, reflected: Vec3) -> Vec3 {
    scattered(layers, f0, cos_view) * around + reflected * layers.coat
}
