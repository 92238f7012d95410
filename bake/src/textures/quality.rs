//! Error of highlights: how far what a texel shows is from what lies under it, over views and lights.
//!
//! For a texel of a level and a view, E = ∫|L̂ − L| dω_l / ∫L dω_l over lights in all directions above the surface, L the
//! reference's radiance under a light of irradiance 1. Lights are drawn where the facets reflect them to, and a quarter of them
//! from a wide lobe; each stands for its share of solid angle, so that sums are integrals.
//!
//! Measured at the texel's centre, where it is read alone, and half a texel beside it, where an engine reads the mean of it and the
//! next one. What changes on the way is the flicker of a highlight that moves.

use super::levels::sizes;
use super::options::Roughness;
use super::reference::{self, Facet, Facets, Stretched};
use crate::normal_map::NormalMap;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Views by polar angle and azimuth, in radians.
pub const VIEWS: [[f64; 2]; 4] = [[0.0, 0.0], [0.5, 0.7], [0.9, 2.6], [1.2, 4.4]];
/// α of the wide lobe that a quarter of the lights come from.
const WIDE: f64 = 0.5;

/// A texel of a level with what it should show.
pub struct Probe {
    /// Column and row of the texel, and of the next one to the right.
    pub texels: [(u32, u32); 2],
    samples: Vec<Sample>,
}

/// A view and a light.
struct Sample {
    view: DVec3,
    light: DVec3,
    /// Solid angle that the light stands for.
    weight: f64,
    /// Radiance of the reference at the texel's centre, and half a texel beside it.
    exact: [f64; 2],
}

/// Sums of many probes; integrals over lights, added up over views.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    exact: f64,
    off: f64,
    off_beside: f64,
    change: f64,
    exact_change: f64,
}

impl Sums {
    /// E at texels' centres.
    pub fn error(&self) -> f64 {
        self.off / self.exact
    }

    /// E half a texel beside them.
    pub fn error_beside(&self) -> f64 {
        self.off_beside / self.exact
    }

    /// Change of the highlight over half a texel, as a part of it.
    pub fn flicker(&self) -> f64 {
        self.change / self.exact
    }

    /// The same of the reference.
    pub fn exact_flicker(&self) -> f64 {
        self.exact_change / self.exact
    }

    /// Both together.
    pub fn and(self, other: Sums) -> Sums {
        Sums {
            exact: self.exact + other.exact,
            off: self.off + other.off,
            off_beside: self.off_beside + other.off_beside,
            change: self.change + other.change,
            exact_change: self.exact_change + other.exact_change,
        }
    }
}

/// `count` texels spread evenly over a level, each with `lights` lights a view.
///
/// # Panics
/// When the map has no such level.
pub fn probes(map: &NormalMap, roughness: &Roughness, level: u32, count: u32, lights: u32) -> Vec<Probe> {
    let (width, height) = sizes(map.width, map.height)[level as usize];
    (0..count)
        .into_par_iter()
        .map(|k| {
            let t = f64::from(k) + 0.5;
            let i = ((t * 0.754_877_666_246_692_7).fract() * f64::from(width)) as u32;
            let j = ((t * 0.569_840_290_998_053_2).fract() * f64::from(height)) as u32;
            probe(map, roughness, (level, (width, height)), (i, j), lights)
        })
        .collect()
}

/// Points along an edge of a texel that the reference sees: two or more a texel of the map, at most 4096 in all.
fn edge(level: u32) -> u32 {
    [16, 24, 32, 48][(level.max(1) as usize - 1).min(3)].max(if level > 4 { 64 } else { 0 })
}

fn probe(
    map: &NormalMap,
    roughness: &Roughness,
    (level, (width, height)): (u32, (u32, u32)),
    (i, j): (u32, u32),
    lights: u32,
) -> Probe {
    let size = DVec2::new(f64::from(map.width) / f64::from(width), f64::from(map.height) / f64::from(height));
    let centre = DVec2::new(f64::from(i) + 0.5, f64::from(j) + 0.5) * size;
    let beside = centre + DVec2::new(0.5 * size.x, 0.0);
    let facets = [centre, beside].map(|at| reference::facets(map, roughness, at, size, edge(level)));
    let means = [0, 1].map(|at: usize| Facets::new(&facets[at]));
    let wide = Facet { normal: DVec3::Z, alpha: WIDE };
    let mut samples = Vec::new();
    for k in 0..lights {
        let t = f64::from(k) + 0.5;
        let (u, v, w) =
            ((t * 0.819_172_513_396_164_4).fract(), (t * 0.671_043_606_703_789).fract(), t * 0.549_700_477_901_941_2);
        let from = &facets[(k % 2) as usize];
        let lobe = if k % 8 < 6 { &from[(w.fract() * from.len() as f64) as usize] } else { &wide };
        let half = half_vector(lobe, u, v);
        let density = 0.375 * (means[0].density(half) + means[1].density(half))
            + 0.25 * reference::density(&wide, half) * half.z.max(0.0);
        for view in views() {
            let cos = view.dot(half);
            let light = 2.0 * cos * half - view;
            if cos <= 0.0 || light.z <= 0.0 {
                continue;
            }
            // dω_l = 4 (v·h) dω_h.
            let weight = 4.0 * cos / (density * f64::from(lights));
            let exact = [0, 1].map(|at: usize| means[at].radiance(view, light));
            samples.push(Sample { view, light, weight, exact });
        }
    }
    Probe { texels: [(i, j), ((i + 1) % width, j)], samples }
}

fn views() -> impl Iterator<Item = DVec3> {
    VIEWS
        .iter()
        .map(|[polar, azimuth]| DVec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()))
}

/// A half vector of the density D(h) (h·n), from two uniform numbers.
fn half_vector(facet: &Facet, u: f64, v: f64) -> DVec3 {
    let r = facet.alpha * (u / (1.0 - u)).sqrt();
    let (t, b) = facet.normal.any_orthonormal_pair();
    let (sin, cos) = (TAU * v).sin_cos();
    (facet.normal + r * (cos * t + sin * b)).normalize()
}

/// A texel as an engine reads and shades it.
pub trait Shaded {
    /// Radiance towards `view` under light of irradiance 1 from `light`, both unit vectors.
    fn radiance(&self, view: DVec3, light: DVec3) -> f64;

    /// What is read halfway between two texels.
    fn halfway(&self, next: &Self) -> Self;
}

impl Shaded for Facet {
    fn radiance(&self, view: DVec3, light: DVec3) -> f64 {
        reference::radiance(self, view, light)
    }

    fn halfway(&self, next: &Facet) -> Facet {
        let perceptual = 0.5 * (self.alpha.sqrt() + next.alpha.sqrt());
        Facet { normal: (self.normal + next.normal).normalize_or(DVec3::Z), alpha: perceptual * perceptual }
    }
}

impl Shaded for Stretched {
    fn radiance(&self, view: DVec3, light: DVec3) -> f64 {
        reference::stretched_radiance(self, view, light)
    }

    fn halfway(&self, next: &Stretched) -> Stretched {
        Stretched {
            normal: (self.normal + next.normal).normalize_or(DVec3::Z),
            roughness: 0.5 * (self.roughness + next.roughness),
            strength: 0.5 * (self.strength + next.strength),
            direction: 0.5 * (self.direction + next.direction),
            axes: self.axes,
        }
    }
}

/// What a method shows at all probes. `texel` gives its texel (i, j) of the level; between texels, what is stored is interpolated.
pub fn measure<T: Shaded>(probes: &[Probe], texel: impl Fn(u32, u32) -> T + Sync) -> Sums {
    let sums: Vec<Sums> = probes
        .par_iter()
        .map(|probe| {
            let [here, next] = probe.texels.map(|(i, j)| texel(i, j));
            let between = here.halfway(&next);
            let mut sums = Sums::default();
            for sample in &probe.samples {
                let [a, b] = [&here, &between].map(|of| of.radiance(sample.view, sample.light));
                sums.exact += sample.weight * sample.exact[0];
                sums.off += sample.weight * (a - sample.exact[0]).abs();
                sums.off_beside += sample.weight * (b - sample.exact[1]).abs();
                sums.change += sample.weight * (b - a).abs();
                sums.exact_change += sample.weight * (sample.exact[1] - sample.exact[0]).abs();
            }
            sums
        })
        .collect();
    sums.into_iter().fold(Sums::default(), Sums::and)
}

/// Integral over lights of what one facet reflects of a light from straight above to all views: 1 less what masking loses. For
/// tests of the reference.
pub fn albedo(facet: &Facet, view: DVec3, steps: u32) -> f64 {
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            let (z, angle) = ((f64::from(i) + 0.5) / f64::from(steps), TAU * (f64::from(j) + 0.5) / f64::from(steps));
            let r = (1.0 - z * z).sqrt();
            sum += reference::radiance(facet, view, DVec3::new(r * angle.cos(), r * angle.sin(), z));
        }
    }
    sum * 2.0 * PI / f64::from(steps * steps)
}
