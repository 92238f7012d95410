//! The BRDF of glTF's materials, against the reference of filtered textures for metal, and the specification's sum for the rest.

use crate::support::{QUERIES, compare, gpu, log_uniform, random};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use glint_bake_core::textures::reference::{Facet, radiance};
use glint_view::gpu::answer;
use rand::{Rng, RngExt};
use std::f64::consts::PI;

/// `TexturesQuery` of textures.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    normal: Vec3,
    alpha: f32,
    view: Vec3,
    metallic: f32,
    light: Vec3,
    base: f32,
}

/// A direction that is at most about 80° away from another.
fn around(rng: &mut impl Rng, axis: Vec3) -> Vec3 {
    let away = Vec3::from_array([0; 3].map(|_| 2.0 * rng.random::<f32>() - 1.0));
    (axis + away).normalize_or(axis)
}

/// Schlick's factor of the reflectance at normal incidence.
fn fresnel(f0: f64, cosine: f64) -> f64 {
    f0 + (1.0 - f0) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

fn expected(q: &Query) -> f64 {
    let [normal, view, light] = [q.normal, q.view, q.light].map(|v| v.as_dvec3().normalize());
    let cos_l = normal.dot(light);
    if normal.dot(view) <= 0.0 || cos_l <= 0.0 {
        return 0.0;
    }
    let (metallic, base) = (f64::from(q.metallic), f64::from(q.base));
    let half: DVec3 = (view + light).normalize();
    let fresnel = fresnel(0.04 + (base - 0.04) * metallic, view.dot(half));
    let diffuse = base * (1.0 - metallic) * cos_l / PI;
    fresnel * radiance(&Facet { normal, alpha: f64::from(q.alpha) }, view, light) + (1.0 - fresnel) * diffuse
}

#[test]
fn the_brdf_of_the_shader_is_that_of_the_reference() {
    let Some(gpu) = gpu() else { return };
    let mut rng = random(81);
    let queries: Vec<Query> = (0..QUERIES)
        .map(|k| {
            let normal = around(&mut rng, Vec3::Z);
            let view = around(&mut rng, Vec3::Z);
            let mirror = 2.0 * normal.dot(view) * normal - view;
            let alpha = log_uniform(&mut rng, 0.02, 1.0);
            // Half of them near the peak, whose width is about alpha.
            let light = if k % 2 == 0 {
                (mirror + alpha * around(&mut rng, mirror)).normalize()
            } else {
                around(&mut rng, Vec3::Z)
            };
            let metallic = if k % 3 == 0 { 1.0 } else { rng.random() };
            let base = if k % 3 == 0 { 1.0 } else { rng.random() };
            Query { normal, alpha, view, metallic, light, base }
        })
        .collect();
    let source = glint_shaders::compose(&["shade_textures_brdf"]) + include_str!("textures.wgsl");
    let found: Vec<f32> = answer(gpu, "textures", &source, &[], &queries).unwrap();
    compare("textures", found.into_iter().zip(&queries).map(|(gpu, query)| (gpu, expected(query) as f32)));
}
