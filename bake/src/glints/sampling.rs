//! Directions of light in proportion to what a material of counted facets reflects on average, for path tracers, f32; twin: `sampling.wgsl`.
//!
//! One of three lobes is taken: facets, what is scattered below them, the coat; with chances by what each reflects of the view. GGX's visible
//! normals are sampled as caps of a sphere (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", Listing 3), Beckmann's by
//! their slopes, which are Gaussian. Counting does not enter: a sample is weighed by [`four_lights`](super::eval::four_lights) of
//! a light without extent of irradiance 1 over [`counted_pdf`], which is that of the smooth surface on average.
//! Directions are unit vectors in the tangent frame.

use super::eval::{CountedMaterial, smooth_surface, turned};
use super::layers::{COAT_F0, coat_surface, coat_through};
use crate::brdf::fresnel;
use crate::microfacet::{mirror_normal, mirror_pdf};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Chances of the lobes: facets, scattered light, coat; 1 together.
fn lobe_chances(material: CountedMaterial, cos_view: f32) -> Vec3 {
    let brightest = |colour: Vec3| colour.max_element();
    let reflected = fresnel(material.f0, cos_view);
    let through = coat_through(material.layers, cos_view);
    let facets = brightest(reflected) * through;
    let scattered = brightest(material.layers.diffuse * (Vec3::ONE - reflected)) * through;
    let coat = material.layers.coat * fresnel(COAT_F0, cos_view).x;
    // A material that reflects nothing is sampled by its facets.
    let all = Vec3::new(facets + 1e-6, scattered, coat);
    all / (all.x + all.y + all.z)
}

/// A direction of light for `view` and three uniform numbers in [0, 1): its density is [`counted_pdf`]. Below the surface it counts as
/// one that brings nothing.
pub fn counted_sample(material: CountedMaterial, view: Vec3, random: Vec3) -> Vec3 {
    let chances = lobe_chances(material, view.z);
    let numbers = Vec2::new(random.y, random.z);
    if random.x >= chances.x && random.x < chances.x + chances.y {
        let (sine, cosine) = (TAU * numbers.x).sin_cos();
        let across = numbers.y.sqrt();
        return Vec3::new(across * cosine, across * sine, (1.0 - numbers.y).sqrt());
    }
    let seen = turned(material.turn, view);
    let taken = if random.x < chances.x { smooth_surface(material) } else { coat_surface(material.layers) };
    let normal = mirror_normal(taken, seen, numbers);
    let light = normal * (2.0 * seen.dot(normal)) - seen;
    turned(material.turn * Vec2::new(1.0, -1.0), light)
}

/// Density over solid angle, 1/sr, of [`counted_sample`] at `light`; 0 unless both directions are above the surface.
pub fn counted_pdf(material: CountedMaterial, view: Vec3, light: Vec3) -> f32 {
    if !(view.z > 0.0 && light.z > 0.0) {
        return 0.0;
    }
    let chances = lobe_chances(material, view.z);
    let (seen, towards) = (turned(material.turn, view), turned(material.turn, light));
    chances.x * mirror_pdf(smooth_surface(material), seen, towards)
        + chances.y * (light.z * FRAC_1_PI)
        + chances.z * mirror_pdf(coat_surface(material.layers), seen, towards)
}
