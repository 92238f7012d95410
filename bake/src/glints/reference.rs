//! Facets and their chances in f64 from the definitions: quadrature over the light's directions, and facets one by one.
//!
//! Kneiphof and Klein 2025, Eq. 8 and 9. Nothing is shared with [`eval`](super::eval): distributions, masking and areas are written
//! anew, and lights are integrated, not approximated.

use super::options::GlintsOptions;
use crate::rng::ItemRng;
use glam::{DVec2, DVec3};
use glint_formats::glints::Slopes;
use libm::{acos, atan2, cos, erfc, exp, log, sin, sqrt};
use std::f64::consts::PI;

/// Steps of quadratures along each axis.
const STEPS: u32 = 256;

/// A smooth surface in f64, in the frame of its roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceSurface {
    slopes: Slopes,
    alpha: DVec2,
    f0: DVec3,
}

impl ReferenceSurface {
    /// That of these options.
    pub fn new(options: &GlintsOptions) -> ReferenceSurface {
        let alpha = DVec2::new(f64::from(options.alpha[0]), f64::from(options.alpha[1]));
        ReferenceSurface { slopes: options.slopes, alpha, f0: DVec3::from_array(options.f0.map(f64::from)) }
    }

    /// Distribution of normals at the unit vector `m`.
    pub fn ndf(&self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let slope2 = (DVec2::new(m.x, m.y) / m.z / self.alpha).length_squared();
        let density = match self.slopes {
            Slopes::Beckmann => exp(-slope2),
            Slopes::Ggx => 1.0 / (1.0 + slope2).powi(2),
        };
        density / (PI * self.alpha.x * self.alpha.y * m.z.powi(4))
    }

    /// Smith's Λ of a direction.
    fn lambda(&self, w: DVec3) -> f64 {
        let a = sqrt((DVec2::new(w.x, w.y) * self.alpha).length_squared()) / w.z;
        match self.slopes {
            Slopes::Ggx => 0.5 * (sqrt(1.0 + a * a) - 1.0),
            Slopes::Beckmann if a < 1e-9 => 0.0,
            // Exactly (Heitz 2014, section 5.3), with 1 / a.
            Slopes::Beckmann => 0.5 * (exp(-1.0 / (a * a)) * a / sqrt(PI) - erfc(1.0 / a)),
        }
    }

    /// BRDF, by colour, times the cosine of the light.
    pub fn brdf_cosine(&self, view: DVec3, light: DVec3) -> DVec3 {
        if view.z <= 0.0 || light.z <= 0.0 {
            return DVec3::ZERO;
        }
        let half = (view + light).normalize();
        let fresnel = self.f0 + (DVec3::ONE - self.f0) * (1.0 - view.dot(half)).powi(5);
        fresnel * (self.ndf(half) / (4.0 * view.z * (1.0 + self.lambda(view) + self.lambda(light))))
    }

    /// ∫ D(m) dm over the hemisphere.
    pub fn facet_area(&self) -> f64 {
        // Over slopes, by polar angles that stretch with the roughness: E[√(1 + |slope|²)].
        let steps = 4 * STEPS;
        let mut sum = 0.0;
        for i in 0..steps {
            // Slopes' tails are as heavy as 1 / r³ times r: r = t / (1 − t)² takes them in.
            let t = (f64::from(i) + 0.5) / f64::from(steps);
            let (r, dr) = (t / (1.0 - t).powi(2), (1.0 + t) / (1.0 - t).powi(3));
            let density = match self.slopes {
                Slopes::Beckmann => exp(-r * r),
                Slopes::Ggx => 1.0 / (1.0 + r * r).powi(2),
            };
            for j in 0..steps {
                let phi = (f64::from(j) + 0.5) * 2.0 * PI / f64::from(steps);
                let slope = self.alpha * DVec2::new(cos(phi), sin(phi)) * r;
                sum += density * sqrt(1.0 + slope.length_squared()) * r * dr;
            }
        }
        sum * 2.0 / f64::from(steps).powi(2)
    }

    /// Facet area that reflects light from `light` towards `view`, over its solid angle: D(h) / (4 h·ω), of lights above the surface.
    fn facets_towards(&self, view: DVec3, light: DVec3) -> f64 {
        if light.z <= 0.0 {
            return 0.0;
        }
        let half = (view + light).normalize();
        self.ndf(half) / (4.0 * half.dot(light))
    }

    /// Chance that a facet reflects a cone of `solid_angle` steradians around `direction` (Eq. 8), given ∫ D.
    pub fn cone_chance(&self, view: DVec3, direction: DVec3, solid_angle: f64, facet_area: f64) -> f64 {
        let x = direction.any_orthonormal_vector();
        let y = direction.cross(x);
        let mut sum = 0.0;
        for i in 0..STEPS {
            // Even in solid angle.
            let depth = (f64::from(i) + 0.5) / f64::from(STEPS) * solid_angle / (2.0 * PI);
            let (across, along) = (sqrt(depth * (2.0 - depth)), 1.0 - depth);
            for j in 0..STEPS {
                let phi = (f64::from(j) + 0.5) * 2.0 * PI / f64::from(STEPS);
                let light = direction * along + (x * cos(phi) + y * sin(phi)) * across;
                sum += self.facets_towards(view, light);
            }
        }
        sum * solid_angle / f64::from(STEPS).powi(2) / facet_area
    }

    /// Calls `f` with directions to `steps`² places of the rectangle with these corners, and their solid angles.
    fn over_rect(corners: [DVec3; 4], steps: u32, mut f: impl FnMut(DVec3, f64)) {
        let [a, b, _, d] = corners;
        let (u, v) = (b - a, d - a);
        let front = u.cross(v) / f64::from(steps).powi(2);
        let place = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        for i in 0..steps {
            for j in 0..steps {
                let to = a + u * place(i) + v * place(j);
                let distance2 = to.length_squared();
                let light = to / sqrt(distance2);
                f(light, front.dot(light).abs() / distance2);
            }
        }
    }

    /// Chance that a facet reflects a rectangle, given ∫ D.
    pub fn rect_chance(&self, view: DVec3, corners: [DVec3; 4], facet_area: f64) -> f64 {
        let mut sum = 0.0;
        ReferenceSurface::over_rect(corners, 2 * STEPS, |light, angle| sum += angle * self.facets_towards(view, light));
        sum / facet_area
    }

    /// Radiance of a rectangle of radiance 1.
    pub fn rect_radiance(&self, view: DVec3, corners: [DVec3; 4]) -> DVec3 {
        let mut sum = DVec3::ZERO;
        ReferenceSurface::over_rect(corners, 2 * STEPS, |light, angle| sum += self.brdf_cosine(view, light) * angle);
        sum
    }
}

/// Facets of a round GGX surface, one by one: places on the unit square and normals.
#[derive(Clone, Debug, PartialEq)]
pub struct ExplicitFacets {
    /// Places, 0 to 1 each.
    pub places: Vec<DVec2>,
    /// Normals, unit vectors.
    pub normals: Vec<DVec3>,
}

impl ExplicitFacets {
    /// `count` facets of roughness `alpha`: places even, normals in proportion to D (section 3.2).
    pub fn new(count: usize, alpha: f64, rng: &mut ItemRng) -> ExplicitFacets {
        // Share of the facets within an angle of the normal, by its cosine: from that of D_H's closed form.
        let beta = sqrt(1.0 - alpha * alpha);
        let within = |cosine: f64| {
            let inner = |c: f64| {
                0.5 * (c / (1.0 - beta * beta * c * c) + 0.5 / beta * log((1.0 + beta * c) / (1.0 - beta * c)))
            };
            1.0 - inner(cosine) / inner(1.0)
        };
        let mut facets = ExplicitFacets { places: Vec::with_capacity(count), normals: Vec::with_capacity(count) };
        for _ in 0..count {
            facets.places.push(DVec2::new(rng.unit(), rng.unit()));
            let (wanted, phi) = (rng.unit(), 2.0 * PI * rng.unit());
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if within(middle) > wanted { low = middle } else { high = middle }
            }
            let sine = sqrt(1.0 - low * low);
            facets.normals.push(DVec3::new(sine * cos(phi), sine * sin(phi), low));
        }
        facets
    }

    /// Which facets reflect `view` into the cone of half angle `spread` around `direction`.
    pub fn lit(&self, view: DVec3, direction: DVec3, spread: f64) -> Vec<bool> {
        let reflects = |normal: &DVec3| {
            let mirrored = 2.0 * view.dot(*normal) * *normal - view;
            // The angle between unit vectors, with its digits where it is small.
            let angle = atan2(mirrored.cross(direction).length(), mirrored.dot(direction));
            angle <= spread
        };
        self.normals.iter().map(reflects).collect()
    }
}

/// Half angle of the cone of a solid angle, in radians.
pub fn cone_half_angle(solid_angle: f64) -> f64 {
    acos(1.0 - solid_angle / (2.0 * PI))
}
