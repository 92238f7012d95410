//! Fits one linearly transformed cosine to GGX for one view and roughness.
//!
//! Heitz et al. 2016, sections 3 and 5; five entries of M⁻¹ as in Heitz and Hill 2016, divided by the middle one.
//! Deviations from the authors' fitter, which moves three entries of M by a simplex search on an L3 error:
//! - all four free entries of M⁻¹ move, by Levenberg–Marquardt steps with the exact gradient;
//! - first the Hellinger distance ∫ (√g − √f)² is made least, which is smooth, then the L1 distance by reweighting;
//! - one fixed set of stratified directions, drawn from the visible normals, serves all steps. GGX and its masking are
//!   symmetric about the plane of incidence, so half of the disk is enough.

use super::ggx;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, PI};

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
            let half = ggx::visible_normal(view, alpha, point);
            let cosine = view.dot(half);
            let light = 2.0 * cosine * half - view;
            let density = ggx::visible_density(view, half, alpha);
            if !(cosine > 0.0 && density > 0.0) {
                continue;
            }
            let weight = 1.0 / (count * density);
            let value = ggx::brdf_cosine(view, light, alpha);
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
