//! Glints under an environment from their definition, in f64: facets placed one by one, and the exact mean and variance
//! of what one facet reflects.
//!
//! Paper: section 3.2. A patch has N facets whose normals h are spread as D(h) / D_H. A facet is a mirror: it takes the
//! radiance of the one pixel that it reflects to the eye. Per facet, with weight F G₂ (h·ω_o) / (n·ω_o) · D_H / N, the
//! sum has the smooth reflection as its mean. No filtered map, no levels, no common reflectance of all facets.

use super::image::{EnvironmentImage, direction};
use super::reference::{ggx, pixel_of};
use crate::rng::{ItemRng, Purpose};
use glam::DVec3;
use std::f64::consts::PI;

/// Parts of a pixel are at most this part of a lobe wide in its core,
const PER_LOBE: f64 = 12.0;
/// and this part of the distance to its middle outside.
const PER_DISTANCE: f64 = 30.0;

/// A surface of facets as an eye sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetSurface {
    /// Surface normal, unit length.
    pub normal: DVec3,
    /// Direction to the eye, unit length, above the surface.
    pub view: DVec3,
    /// GGX roughness α.
    pub alpha: f64,
    /// Reflectance at normal incidence.
    pub f0: f64,
}

/// Mean of what one facet adds, times their number, and mean of its square, times the square of their number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacetMoments {
    /// The smooth reflection, in luminance.
    pub mean: f64,
    /// Mean square.
    pub square: f64,
}

impl FacetMoments {
    /// Variance of the sum over `facets`, of which the fraction is there by chance, over the squared mean.
    pub fn relative_variance(&self, facets: f64) -> f64 {
        let part = facets - facets.floor();
        let mean2 = self.mean * self.mean;
        (self.square - mean2) / (facets * mean2) + part * (1.0 - part) / (facets * facets)
    }
}

impl FacetSurface {
    /// Facet area of unit surface, by Simpson's rule over the angle.
    pub fn facet_area(&self) -> f64 {
        self.area_within(0.5 * PI)
    }

    /// Facet area of unit surface tilted by up to `theta`.
    fn area_within(&self, theta: f64) -> f64 {
        const STEPS: u32 = 20_000;
        let h = theta / f64::from(STEPS);
        let mut sum = 0.0;
        for k in 0..=STEPS {
            let at = h * f64::from(k);
            let weight = if k == 0 || k == STEPS { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
            sum += weight * ggx(libm::cos(at), self.alpha) * 2.0 * PI * libm::sin(at);
        }
        sum * h / 3.0
    }

    /// F G₂ (h·ω_o) / (n·ω_o) of a facet, and where it reflects the eye to; none below the horizon.
    fn facet(&self, h: DVec3) -> Option<(f64, DVec3)> {
        let (cos_o, oh) = (self.normal.dot(self.view), self.view.dot(h));
        let light = 2.0 * oh * h - self.view;
        let cos_i = self.normal.dot(light);
        if oh <= 0.0 || cos_i <= 0.0 {
            return None;
        }
        let fresnel = self.f0 + (1.0 - self.f0) * (1.0 - oh).powi(5);
        let lambda = |c: f64| 0.5 * ((1.0 + self.alpha * self.alpha * (1.0 / (c * c) - 1.0)).sqrt() - 1.0);
        let visible = 1.0 / (1.0 + lambda(cos_o) + lambda(cos_i));
        Some((fresnel * visible * oh / cos_o, light))
    }

    /// Moments under `image`, by a sum over parts of its pixels.
    pub fn moments(&self, image: &EnvironmentImage) -> FacetMoments {
        let mirror = 2.0 * self.normal.dot(self.view) * self.normal - self.view;
        let (tall, wide) = (PI / f64::from(image.height), 2.0 * PI / f64::from(image.width));
        let lobe = self.alpha * self.normal.dot(self.view) / PER_LOBE;
        let whole = self.facet_area();
        let mut moments = FacetMoments::default();
        for y in 0..image.height {
            let [top, bottom] = [y, y + 1].map(|row| image.sine(f64::from(row)));
            let solid_angle = image.solid_angle_sr(y);
            for x in 0..image.width {
                let longitude = |part: f64| 2.0 * PI * ((f64::from(x) + part) / f64::from(image.width) - 0.5);
                let distance = (direction(longitude(0.5), 0.5 * (top + bottom)) - mirror).length();
                let fine = lobe.max((distance - tall.max(wide)).max(0.0) / PER_DISTANCE);
                let across = wide * (1.0 - top.min(bottom).abs().min(top.max(bottom).abs()).powi(2)).max(0.0).sqrt();
                let [parts_x, parts_y] = [across, tall].map(|side| ((side / fine).ceil() as u32).max(1));
                let (mut first, mut second) = (0.0, 0.0);
                for j in 0..parts_y {
                    let sine = top + (bottom - top) * (f64::from(j) + 0.5) / f64::from(parts_y);
                    for i in 0..parts_x {
                        let light = direction(longitude((f64::from(i) + 0.5) / f64::from(parts_x)), sine);
                        let h = (light + self.view).normalize();
                        // A facet reflects dω_i of light when its normal lies in dω_h = dω_i / (4 h·ω_o).
                        if let Some((weight, _)) = self.facet(h) {
                            let density = ggx(self.normal.dot(h), self.alpha) / (4.0 * self.view.dot(h));
                            first += density * weight;
                            second += density * weight * weight;
                        }
                    }
                }
                let share = solid_angle / f64::from(parts_x * parts_y);
                let radiance = image.luminance((y * image.width + x) as usize);
                moments.mean += share * first * radiance;
                moments.square += whole * share * second * radiance * radiance;
            }
        }
        moments
    }

    /// Luminance towards the eye of one patch of `facets` placed at random, patch number `patch`.
    pub fn placed(&self, image: &EnvironmentImage, facets: u32, seed: u64, patch: u32) -> f64 {
        let mut rng = ItemRng::new(seed, Purpose::PlacedFacets, patch);
        let whole = self.facet_area();
        let x = self.normal.any_orthonormal_vector();
        let y = self.normal.cross(x);
        let mut sum = 0.0;
        for _ in 0..facets {
            let theta = self.tilt(rng.unit() * whole);
            let phi = 2.0 * PI * rng.unit();
            let h = (x * libm::cos(phi) + y * libm::sin(phi)) * libm::sin(theta) + self.normal * libm::cos(theta);
            if let Some((weight, light)) = self.facet(h) {
                sum += weight * image.luminance(pixel_of(image, light));
            }
        }
        sum * whole / f64::from(facets)
    }

    /// The tilt within which lies `area` of the facets, by bisection of the closed form: with c = cos θ and e = 1 − α²,
    /// ∫ dc / (1 − e c²)² = ½ (c / (1 − e c²) + atanh(√e c) / √e).
    fn tilt(&self, area: f64) -> f64 {
        let e = 1.0 - self.alpha * self.alpha;
        let primitive = |c: f64| {
            let logarithm = if e > 1e-9 { libm::atanh(e.sqrt() * c) / e.sqrt() } else { c };
            0.5 * (c / (1.0 - e * c * c) + logarithm)
        };
        let within = |theta: f64| 2.0 * self.alpha * self.alpha * (primitive(1.0) - primitive(libm::cos(theta)));
        let (mut low, mut high) = (0.0, 0.5 * PI);
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if within(middle) < area {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}
