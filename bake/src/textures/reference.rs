//! What a texel of a mip should show, from the definitions in f64: the mean radiance of the facets under it.
//!
//! The surface is the one that a renderer without mips sees: normals and perceptual roughness bilinear between texels, unit
//! normals, each facet a GGX lobe with height-correlated Smith masking and reflectance 1 (Walter et al. 2007, Heitz 2014).

use super::options::{Axes, Roughness};
use crate::normal_map::NormalMap;
use glam::{DVec2, DVec3};
use glint_formats::Wrap;
use multiversion::multiversion;
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

/// A texel as engines shade it with KHR_materials_anisotropy: the channels of its textures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretched {
    /// Unit normal.
    pub normal: DVec3,
    /// Roughness as it is stored, perceptual.
    pub roughness: f64,
    /// Strength of anisotropy.
    pub strength: f64,
    /// Direction of anisotropy, of any length but 0.
    pub direction: DVec2,
    /// What the engine takes the axes from.
    pub axes: Axes,
}

/// Radiance of an anisotropic texel, as the extension's own code has it.
pub fn stretched_radiance(of: &Stretched, view: DVec3, light: DVec3) -> f64 {
    let n = of.normal;
    let (cos_v, cos_l) = (n.dot(view), n.dot(light));
    if cos_v <= 0.0 || cos_l <= 0.0 {
        return 0.0;
    }
    let across = (of.roughness * of.roughness).max(LEAST_ALPHA);
    let along = across * (1.0 - of.strength * of.strength) + of.strength * of.strength;
    let up = if of.axes == Axes::Surface { DVec3::Z } else { n };
    let direction = of.direction.extend(0.0);
    let t = (direction - up * up.dot(direction)).normalize_or(DVec3::X);
    let b = up.cross(t);
    let half = (view + light).normalize();
    let f = DVec3::new(across * t.dot(half), along * b.dot(half), along * across * n.dot(half));
    let a2 = along * across;
    let w2 = a2 / f.dot(f);
    let distribution = a2 * w2 * w2 / PI;
    let of_view = cos_l * DVec3::new(along * t.dot(view), across * b.dot(view), cos_v).length();
    let of_light = cos_v * DVec3::new(along * t.dot(light), across * b.dot(light), cos_l).length();
    distribution * 0.5 / (of_view + of_light) * cos_l
}

/// Many facets of equal parts, with their means: [`density`] and [`radiance`] of all at once.
#[derive(Clone, Debug, Default)]
pub struct Facets {
    normals: [Vec<f64>; 3],
    a2: Vec<f64>,
}

const LANES: usize = 8;

impl Facets {
    /// These facets, whose number is a multiple of eight.
    pub fn new(facets: &[Facet]) -> Facets {
        assert!(facets.len().is_multiple_of(LANES), "{} facets", facets.len());
        let normals = [0, 1, 2].map(|c| facets.iter().map(|facet| facet.normal[c]).collect());
        Facets { normals, a2: facets.iter().map(|facet| facet.alpha * facet.alpha).collect() }
    }

    /// Mean of D (h·n).
    pub fn density(&self, half: DVec3) -> f64 {
        mean_density(self, half.to_array())
    }

    /// Mean radiance.
    pub fn radiance(&self, view: DVec3, light: DVec3) -> f64 {
        mean_radiance(self, view.to_array(), light.to_array(), (view + light).normalize().to_array())
    }
}

/// D's denominator without π, its root: |n × h|² + α² (n·h)².
#[inline(always)]
fn spread([x, y, z]: [f64; 3], a2: f64, c: f64, h: [f64; 3]) -> f64 {
    let cross = [y * h[2] - z * h[1], z * h[0] - x * h[2], x * h[1] - y * h[0]];
    cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2] + a2 * c * c
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn mean_density(of: &Facets, h: [f64; 3]) -> f64 {
    let mut sums = [0.0; LANES];
    for block in 0..of.a2.len() / LANES {
        let [x, y, z] = [0, 1, 2].map(|c| &of.normals[c][block * LANES..][..LANES]);
        let a2 = &of.a2[block * LANES..][..LANES];
        for k in 0..LANES {
            let n = [x[k], y[k], z[k]];
            let c = dot(n, h);
            let t = spread(n, a2[k], c, h);
            sums[k] += if c > 0.0 { a2[k] * c / (PI * t * t) } else { 0.0 };
        }
    }
    sums.iter().sum::<f64>() / of.a2.len() as f64
}

/// 1 + Λ(v) + Λ(l) is half of √(1 + α² tan² θ_v) + √(1 + α² tan² θ_l), and (n·v)² times what is under the root is
/// (n·v)² + α² (1 − (n·v)²).
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn mean_radiance(of: &Facets, v: [f64; 3], l: [f64; 3], h: [f64; 3]) -> f64 {
    let mut sums = [0.0; LANES];
    for block in 0..of.a2.len() / LANES {
        let [x, y, z] = [0, 1, 2].map(|c| &of.normals[c][block * LANES..][..LANES]);
        let a2 = &of.a2[block * LANES..][..LANES];
        for k in 0..LANES {
            let n = [x[k], y[k], z[k]];
            let (c, cv, cl) = (dot(n, h), dot(n, v), dot(n, l));
            let t = spread(n, a2[k], c, h);
            let root = |cos: f64| (cos * cos + a2[k] * (1.0 - cos * cos).max(0.0)).sqrt();
            let masking = root(cv) * cl + root(cl) * cv;
            let radiance = a2[k] * cl / (2.0 * PI * t * t * masking);
            sums[k] += if cv > 0.0 && cl > 0.0 { radiance } else { 0.0 };
        }
    }
    sums.iter().sum::<f64>() / of.a2.len() as f64
}
