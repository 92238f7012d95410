//! What a texel of a mip should show, from the definitions in f64: the mean radiance of the facets under it.
//!
//! The surface is the one that a renderer without mips sees: normals and perceptual roughness bilinear between texels, unit
//! normals, each facet a GGX lobe with height-correlated Smith masking and reflectance 1 (Walter et al. 2007, Heitz 2014).

use super::options::Roughness;
use crate::normal_map::NormalMap;
use glam::{DVec2, DVec3};
use glint_formats::Wrap;
use std::f64::consts::PI;

/// A facet of the surface, or a texel as an engine shades it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Unit normal.
    pub normal: DVec3,
    /// GGX α.
    pub alpha: f64,
}

/// Least α that is evaluated.
const LEAST_ALPHA: f64 = 1e-3;

/// The facet at `u`, in texels of the map.
pub fn facet(map: &NormalMap, roughness: &Roughness, u: DVec2) -> Facet {
    let s = map.bilinear(u).0;
    let normal = DVec3::new(s.x, s.y, (1.0 - s.length_squared()).max(0.0).sqrt()).normalize();
    let perceptual = match roughness {
        Roughness::Constant(value) => f64::from(*value),
        Roughness::Map(_) => {
            let (p, mut sum) = (u - 0.5, 0.0);
            let cell = p.floor();
            let f = p - cell;
            for (dj, di) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let weight = (if di == 1 { f.x } else { 1.0 - f.x }) * (if dj == 1 { f.y } else { 1.0 - f.y });
                sum += weight * f64::from(roughness.texel(index(map, cell.x as i64 + di, cell.y as i64 + dj)));
            }
            sum
        }
    };
    Facet { normal, alpha: (perceptual * perceptual).max(LEAST_ALPHA) }
}

/// Where a texel lies in a row-major map, beyond its edges too.
fn index(map: &NormalMap, i: i64, j: i64) -> usize {
    let (w, h) = (i64::from(map.width), i64::from(map.height));
    let (i, j) = match map.wrap {
        Wrap::Repeat => (i.rem_euclid(w), j.rem_euclid(h)),
        Wrap::Clamp => (i.clamp(0, w - 1), j.clamp(0, h - 1)),
    };
    (j * w + i) as usize
}

/// Facets at `edge`² points of the box of `size` texels around `centre`: one in each cell of a grid, moved about in its cell so
/// that no period of the map is met again and again.
pub fn facets(map: &NormalMap, roughness: &Roughness, centre: DVec2, size: DVec2, edge: u32) -> Vec<Facet> {
    let mut facets = Vec::with_capacity((edge * edge) as usize);
    for j in 0..edge {
        for i in 0..edge {
            let k = f64::from(j * edge + i) + 0.5;
            let within = DVec2::new((k * 0.754_877_666_246_692_7).fract(), (k * 0.569_840_290_998_053_2).fract());
            let at = (DVec2::new(f64::from(i), f64::from(j)) + within) / f64::from(edge) - 0.5;
            facets.push(facet(map, roughness, centre + at * size));
        }
    }
    facets
}

/// Λ of Smith's masking.
fn lambda(z: f64, alpha: f64) -> f64 {
    0.5 * ((1.0 + alpha * alpha * (1.0 - z * z).max(0.0) / (z * z)).sqrt() - 1.0)
}

/// Density of GGX's microfacet normals at `half`.
pub fn density(facet: &Facet, half: DVec3) -> f64 {
    let c = facet.normal.dot(half);
    if c <= 0.0 {
        return 0.0;
    }
    let a2 = facet.alpha * facet.alpha;
    let t = facet.normal.cross(half).length_squared() + a2 * c * c;
    a2 / (PI * t * t)
}

/// Radiance of a facet towards `view` under light of irradiance 1 from `light`, both unit vectors.
pub fn radiance(facet: &Facet, view: DVec3, light: DVec3) -> f64 {
    let (cos_v, cos_l) = (facet.normal.dot(view), facet.normal.dot(light));
    if cos_v <= 0.0 || cos_l <= 0.0 {
        return 0.0;
    }
    let half = (view + light).normalize();
    let masking = 1.0 / (1.0 + lambda(cos_v, facet.alpha) + lambda(cos_l, facet.alpha));
    density(facet, half) * masking / (4.0 * cos_v)
}

/// Mean radiance of many facets.
pub fn mean_radiance(facets: &[Facet], view: DVec3, light: DVec3) -> f64 {
    facets.iter().map(|facet| radiance(facet, view, light)).sum::<f64>() / facets.len() as f64
}
