//! The LTC tables: one linearly transformed cosine fitted to GGX for each view and roughness.
//!
//! Heitz et al. 2016, sections 3 and 5; five entries of M⁻¹ as in Heitz and Hill 2016, divided by the middle one.
//! Deviations from the authors' fitter, which moves three entries of M by a simplex search on an L3 error:
//! - all four free entries of M⁻¹ move, by Levenberg–Marquardt steps with the exact gradient;
//! - first the Hellinger distance ∫ (√g − √f)² is made least, which is smooth, then the L1 distance by reweighting;
//! - one fixed set of stratified directions, drawn from the visible normals, serves all steps. GGX and its masking are
//!   symmetric about the plane of incidence, so half of the disk is enough.
//!
//! Texel (i, j) of [`SIZE`]² stands for roughness α = (i / 63)² and view cosine 1 − (j / 63)². The first table holds a, c, b, d
//! of M⁻¹ = [[a, 0, b], [0, 1, 0], [c, 0, d]] (column by column), the second magnitude, Fresnel term, 0, and the clipped form
//! factor of a sphere.
//!
//! GGX is that of Walter et al. 2007 (D) with the masking of Heitz 2014 (Λ), sampled by its visible normals (Heitz 2018), in the
//! tangent frame. Only square roots and the four operations, so that fits have the same bits everywhere.

use super::baked::{LtcTables, SIZE};
use glam::{DMat3, DVec2, DVec3};
use half::f16;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_PI, PI};

/// Least roughness that is fitted; row 0 stands for it.
pub const MIN_ALPHA: f64 = 1e-5;
/// Least view cosine that is fitted; the last row stands for it.
pub const MIN_COSINE: f64 = 1e-3;

/// Roughness of column i.
pub fn alpha_of(i: usize) -> f64 {
    let x = i as f64 / (SIZE - 1) as f64;
    (x * x).max(MIN_ALPHA)
}

/// View cosine of row j.
pub fn cosine_of(j: usize) -> f64 {
    let y = j as f64 / (SIZE - 1) as f64;
    (1.0 - y * y).max(MIN_COSINE)
}

/// Fits all entries. The same bits on every platform and for any number of threads.
pub fn fit_tables() -> LtcTables {
    let coarse = DiskSet::new(24, 16);
    // Many rings: lights below the horizon begin somewhere in the tail, and the magnitude is what lies before.
    let fine = DiskSet::new(384, 24);
    let columns: Vec<Vec<[[u16; 4]; 2]>> =
        (0..SIZE).into_par_iter().map(|i| fit_column(alpha_of(i), &coarse, &fine)).collect();
    let mut tables = LtcTables { inverse: Vec::new(), terms: Vec::new() };
    for j in 0..SIZE {
        for i in 0..SIZE {
            let [inverse, mut terms] = columns[i][j];
            terms[3] = half(clipped_sphere(i as f64 / (SIZE - 1) as f64 * 2.0 - 1.0, j as f64 / (SIZE - 1) as f64));
            tables.inverse.push(inverse);
            tables.terms.push(terms);
        }
    }
    tables
}

/// All view cosines of one roughness, each from the fit before.
fn fit_column(alpha: f64, coarse: &DiskSet, fine: &DiskSet) -> Vec<[[u16; 4]; 2]> {
    let mut shape = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 2.0 * alpha));
    let mut column = Vec::with_capacity(SIZE);
    for j in 0..SIZE {
        let cosine = cosine_of(j);
        let (inverse, next) = fit(&Target::new(cosine, alpha, coarse), shape, j == 0);
        shape = next;
        let exact = Target::new(cosine, alpha, fine);
        let [a, b, c, d] = inverse.entries;
        column.push([[half(a), half(c), half(b), half(d)], [half(exact.magnitude), half(exact.fresnel), 0, 0]]);
    }
    column
}

fn half(value: f64) -> u16 {
    f16::from_f32(value as f32).to_bits()
}

/// Form factor of a sphere cut by the horizon, over that of the whole one: `cosine` of its centre, and its unclipped
/// form factor seen head-on, sin² of its angular radius.
///
/// Lambert's formula for the part of the cap's edge above the horizon, from −φ₀ to φ₀, and the arc of the horizon that
/// closes it: F = (φ₀ z sin²σ − sinσ cosσ √(1−z²) sinφ₀ + ψ₀) / π.
pub fn clipped_sphere(cosine: f64, form_factor: f64) -> f64 {
    let z = cosine.clamp(-1.0, 1.0);
    let form_factor = form_factor.clamp(1e-6, 1.0);
    let sin = form_factor.sqrt();
    let cos = (1.0 - form_factor).max(0.0).sqrt();
    let w = (1.0 - z * z).max(0.0).sqrt();
    let edge = cos * z;
    if edge >= sin * w && z > 0.0 {
        return z;
    }
    if -edge >= sin * w {
        return 0.0;
    }
    let cos_phi = (-edge / (sin * w)).clamp(-1.0, 1.0);
    let phi = libm::acos(cos_phi);
    let sin_phi = (1.0 - cos_phi * cos_phi).max(0.0).sqrt();
    let psi = libm::atan2(sin * sin_phi, cos * w - sin * cos_phi * z);
    let found = (phi * z * form_factor - sin * cos * w * sin_phi + psi) / PI;
    (found / form_factor).clamp(0.0, 1.0)
}

/// M⁻¹ = [[a, 0, b], [0, 1, 0], [c, 0, d]] in the plane of incidence: x towards the viewer, z the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inverse {
    /// Entries a, b, c, d.
    pub entries: [f64; 4],
}

impl Inverse {
    /// The density at unit direction `w`, normalised over the sphere (Heitz et al. 2016, Eq. 1).
    pub fn density(&self, w: DVec3) -> f64 {
        let [a, b, c, d] = self.entries;
        let v = DVec3::new(a * w.x + b * w.z, w.y, c * w.x + d * w.z);
        let n2 = v.length_squared();
        (a * d - b * c).abs() * v.z.max(0.0) * FRAC_1_PI / (n2 * n2)
    }

    /// The same density by a matrix of positive determinant: the cosine does not tell x from −x, but polygons do.
    fn unmirrored(self) -> Inverse {
        let [a, b, c, d] = self.entries;
        if a * d - b * c < 0.0 { Inverse { entries: [-a, -b, c, d] } } else { self }
    }

    /// M⁻¹ as a matrix.
    pub fn matrix(&self) -> DMat3 {
        let [a, b, c, d] = self.entries;
        DMat3::from_cols(DVec3::new(a, 0.0, c), DVec3::Y, DVec3::new(b, 0.0, d))
    }

    /// M⁻¹ of `shape` turned so that its pole points to `axis` (in the plane of incidence).
    fn turned(shape: DMat3, axis: DVec3) -> Inverse {
        let m = shape * basis(axis).transpose();
        let middle = m.y_axis.y;
        Inverse { entries: [m.x_axis.x / middle, m.z_axis.x / middle, m.x_axis.z / middle, m.z_axis.z / middle] }
    }
}

/// Columns: in the plane and perpendicular to `axis`, y, `axis`.
fn basis(axis: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::Y.cross(axis), DVec3::Y, axis)
}

/// Points of one half of the unit disk, of equal area.
pub struct DiskSet {
    points: Vec<DVec2>,
}

impl DiskSet {
    /// `rings` × `spokes` points.
    pub fn new(rings: u32, spokes: u32) -> DiskSet {
        let mut points = Vec::new();
        for i in 0..rings {
            let radius = ((f64::from(i) + 0.5) / f64::from(rings)).sqrt();
            for j in 0..spokes {
                let angle = PI * ((f64::from(j) + 0.5) / f64::from(spokes) - 0.5);
                points.push(DVec2::new(radius * libm::cos(angle), radius * libm::sin(angle)));
            }
        }
        DiskSet { points }
    }
}

/// GGX at the directions of a set, for one view and roughness.
pub struct Target {
    directions: Vec<DVec3>,
    /// 1 / (number · density) of each direction.
    weights: Vec<f64>,
    /// BRDF times cosine, normalised.
    values: Vec<f64>,
    /// Integral of BRDF times cosine: the directional albedo for F = 1.
    pub magnitude: f64,
    /// The same with Schlick's (1 − v·h)⁵ for F.
    pub fresnel: f64,
    /// Mean direction.
    pub mean: DVec3,
}

impl Target {
    /// Evaluates GGX for a view of cosine `cosine` and roughness α.
    pub fn new(cosine: f64, alpha: f64, set: &DiskSet) -> Target {
        let view = DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
        let count = set.points.len() as f64;
        let mut target = Target {
            directions: Vec::with_capacity(set.points.len()),
            weights: Vec::with_capacity(set.points.len()),
            values: Vec::with_capacity(set.points.len()),
            magnitude: 0.0,
            fresnel: 0.0,
            mean: DVec3::ZERO,
        };
        for &point in &set.points {
            let half = visible_normal(view, alpha, point);
            let cosine = view.dot(half);
            let light = 2.0 * cosine * half - view;
            let density = visible_density(view, half, alpha);
            if !(cosine > 0.0 && density > 0.0) {
                continue;
            }
            let weight = 1.0 / (count * density);
            let value = brdf_cosine(view, light, alpha);
            let share = weight * value;
            target.magnitude += share;
            let c = 1.0 - cosine;
            target.fresnel += share * c * c * c * c * c;
            target.mean += share * DVec3::new(light.x, 0.0, light.z);
            target.directions.push(light);
            target.weights.push(weight);
            target.values.push(value);
        }
        for value in &mut target.values {
            *value /= target.magnitude;
        }
        target.mean = target.mean.normalize();
        target
    }

    /// ∫ |g − f| / ∫ f.
    fn l1(&self, inverse: &Inverse) -> f64 {
        self.l1_scaled(inverse, 1.0)
    }

    /// ∫ |scale · g − f| / ∫ f, with the magnitude that a table holds over the exact one for `scale`.
    pub fn l1_scaled(&self, inverse: &Inverse, scale: f64) -> f64 {
        let mut sum = 0.0;
        for k in 0..self.directions.len() {
            sum += self.weights[k] * (scale * inverse.density(self.directions[k]) - self.values[k]).abs();
        }
        sum
    }

    fn hellinger(&self, inverse: &Inverse) -> f64 {
        let mut sum = 0.0;
        for k in 0..self.directions.len() {
            sum += self.weights[k] * (inverse.density(self.directions[k]).sqrt() - self.values[k].sqrt()).powi(2);
        }
        sum
    }
}

/// What is made least.
#[derive(Clone, Copy, PartialEq)]
enum Distance {
    Hellinger,
    L1,
}

/// Fits M⁻¹ to a target, from `shape`, the M⁻¹ of a neighbour relative to its own mean direction. `symmetric` for a
/// view along the normal. Returns M⁻¹ and its shape.
pub fn fit(target: &Target, shape: DMat3, symmetric: bool) -> (Inverse, DMat3) {
    let axis = if symmetric { DVec3::Z } else { target.mean };
    let mut best = Inverse::turned(shape, axis);
    for distance in [Distance::Hellinger, Distance::L1] {
        best = descend(target, best, distance, symmetric);
    }
    let best = best.unmirrored();
    (best, best.matrix() * basis(axis))
}

/// Levenberg–Marquardt steps until they no longer help.
fn descend(target: &Target, start: Inverse, distance: Distance, symmetric: bool) -> Inverse {
    let measure = |inverse: &Inverse| match distance {
        Distance::Hellinger => target.hellinger(inverse),
        Distance::L1 => target.l1(inverse),
    };
    let mut best = start;
    let mut error = measure(&best);
    let mut damping = 1e-3;
    for _ in 0..40 {
        let (normal, gradient) = equations(target, &best, distance, symmetric);
        let mut improved = 0.0;
        for _ in 0..8 {
            let step = solve(normal, gradient, damping);
            let mut next = best;
            for k in 0..4 {
                next.entries[k] -= step[k];
            }
            let found = measure(&next);
            if found < error {
                improved = (error - found) / error;
                (best, error) = (next, found);
                damping = (damping * 0.2).max(1e-9);
                break;
            }
            damping *= 5.0;
        }
        if improved < 1e-5 {
            break;
        }
    }
    best
}

/// Normal equations of the weighted squares at `inverse`.
fn equations(target: &Target, inverse: &Inverse, distance: Distance, symmetric: bool) -> ([[f64; 4]; 4], [f64; 4]) {
    let [a, b, c, d] = inverse.entries;
    let det = a * d - b * c;
    let (mut normal, mut gradient) = ([[0.0; 4]; 4], [0.0; 4]);
    for k in 0..target.directions.len() {
        let w = target.directions[k];
        let v = DVec3::new(a * w.x + b * w.z, w.y, c * w.x + d * w.z);
        if v.z <= 0.0 {
            continue;
        }
        let n2 = v.length_squared();
        let g = det.abs() * v.z * FRAC_1_PI / (n2 * n2);
        let of_z = 1.0 / v.z - 4.0 * v.z / n2;
        let of_x = -4.0 * v.x / n2;
        // Derivatives of ln g.
        let mut row = [d / det + of_x * w.x, -c / det + of_x * w.z, -b / det + of_z * w.x, a / det + of_z * w.z];
        if symmetric {
            row = [0.0, 0.0, 0.0, row[3]];
        }
        let f = target.values[k];
        let (weight, residual, scale) = match distance {
            Distance::Hellinger => (target.weights[k], g.sqrt() - f.sqrt(), 0.5 * g.sqrt()),
            Distance::L1 => (target.weights[k] / ((g - f).abs() + 1e-3 * (g + f)), g - f, g),
        };
        for i in 0..4 {
            gradient[i] += weight * residual * scale * row[i];
            for j in 0..4 {
                normal[i][j] += weight * scale * scale * row[i] * row[j];
            }
        }
    }
    (normal, gradient)
}

/// Solves (N + damping · diag N) x = g by elimination; what has no weight stays.
fn solve(mut n: [[f64; 4]; 4], mut g: [f64; 4], damping: f64) -> [f64; 4] {
    for i in 0..4 {
        n[i][i] = if n[i][i] > 0.0 { n[i][i] * (1.0 + damping) } else { 1.0 };
    }
    for i in 0..4 {
        for j in i + 1..4 {
            let factor = n[j][i] / n[i][i];
            for k in i..4 {
                n[j][k] -= factor * n[i][k];
            }
            g[j] -= factor * g[i];
        }
    }
    for i in (0..4).rev() {
        for k in i + 1..4 {
            g[i] -= n[i][k] * g[k];
        }
        g[i] /= n[i][i];
    }
    g
}

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
    1.0 / (PI * a2 * t * t)
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
