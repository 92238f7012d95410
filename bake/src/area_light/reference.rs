//! What the method approximates, from the definitions, in f64: GGX under a rectangle light by adaptive quadrature, and its
//! average over the normals of the actual map under a Gaussian footprint; mean resultant length and convolution of lobes of
//! normals by numerical integration. Shares no code with the fast path.
//!
//! > L = ∫ w(u) ∫_A f(v, l; n(u)) max(n·l, 0) max(−n_A·l, 0) / r² dA du
//!
//! f is Torrance–Sparrow with GGX (Walter et al. 2007), height-correlated Smith masking (Heitz 2014) and Schlick's
//! Fresnel factor; n(u) is the bilinear unit normal, w the footprint, A the rectangle.

use crate::footprint::Footprint;
use crate::normal_map::NormalMap;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_1_PI, PI};

/// A rectangle (or parallelogram) light and a view, relative to the shaded point, in the surface's tangent frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// One corner.
    pub corner: DVec3,
    /// The two edges from it; it radiates to the side of `edges.0 × edges.1`.
    pub edges: (DVec3, DVec3),
    /// Unit direction to the viewer.
    pub view: DVec3,
    /// GGX roughness α of the surface itself.
    pub alpha: f64,
    /// Reflectance at normal incidence.
    pub f0: f64,
}

/// BRDF times the cosine of the light.
pub fn brdf_cosine(normal: DVec3, view: DVec3, light: DVec3, alpha: f64, f0: f64) -> f64 {
    let (cos_v, cos_l) = (normal.dot(view), normal.dot(light));
    if cos_v <= 0.0 || cos_l <= 0.0 {
        return 0.0;
    }
    let half = (view + light).normalize();
    let cos_h = normal.dot(half);
    // sin² from the cross product: 1 − cos² would lose it near the peak.
    let sin2_h = normal.cross(half).length_squared();
    let t = cos_h * cos_h * alpha * alpha + sin2_h;
    let d = alpha * alpha / (PI * t * t);
    let lambda = |c: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 - c * c).max(0.0) / (c * c)).sqrt() - 1.0);
    let g = 1.0 / (1.0 + lambda(cos_v) + lambda(cos_l));
    let fresnel = f0 + (1.0 - f0) * (1.0 - view.dot(half)).max(0.0).powi(5);
    d * g * fresnel / (4.0 * cos_v)
}

/// Nodes and weights of the four-point Gauss rule on 0…1.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_2, 0.173_927_422_568_726_93),
];
/// Deepest subdivision: 2^-14 of the light's edge.
const MAX_DEPTH: u32 = 14;

/// Radiance towards the viewer of a facet with unit `normal`, for a light of radiance 1; relative error about
/// `tolerance`.
pub fn facet_radiance(scene: &Scene, normal: DVec3, tolerance: f64) -> f64 {
    if normal.dot(scene.view) <= 0.0 {
        return 0.0;
    }
    let whole = Cell { u: 0.0, v: 0.0, size: 1.0 };
    // The first pass only finds how bright it is, for the second to know what is small.
    let scale = refine(scene, normal, whole, whole.estimate(scene, normal), f64::INFINITY, 0);
    refine(scene, normal, whole, whole.estimate(scene, normal), tolerance * scale, 0)
}

#[derive(Clone, Copy)]
struct Cell {
    u: f64,
    v: f64,
    size: f64,
}

impl Cell {
    fn point(&self, scene: &Scene, x: f64, y: f64) -> DVec3 {
        scene.corner + scene.edges.0 * (self.u + self.size * x) + scene.edges.1 * (self.v + self.size * y)
    }

    fn estimate(&self, scene: &Scene, normal: DVec3) -> f64 {
        let across = scene.edges.0.cross(scene.edges.1);
        let mut sum = 0.0;
        for (x, wx) in GAUSS {
            for (y, wy) in GAUSS {
                let p = self.point(scene, x, y);
                let r2 = p.length_squared();
                let light = p / r2.sqrt();
                let solid_angle = (-across.dot(light)).max(0.0) / r2;
                if solid_angle > 0.0 {
                    sum += wx * wy * solid_angle * brdf_cosine(normal, scene.view, light, scene.alpha, scene.f0);
                }
            }
        }
        sum * self.size * self.size
    }

    fn children(&self) -> [Cell; 4] {
        let h = 0.5 * self.size;
        [(0.0, 0.0), (h, 0.0), (0.0, h), (h, h)].map(|(u, v)| Cell { u: self.u + u, v: self.v + v, size: h })
    }

    /// Whether the lobe could hide between the cell's nodes: half vectors turn by more, across the cell, than the lobe's
    /// width where they come nearest to the normal.
    fn hides_lobe(&self, scene: &Scene, normal: DVec3) -> bool {
        let centre = self.point(scene, 0.5, 0.5);
        let reach = 0.5 * self.size * (scene.edges.0.length() + scene.edges.1.length());
        let nearest = (centre.length() - reach).max(0.1 * centre.length());
        let half = (scene.view + centre.normalize_or(DVec3::Z)).normalize_or(DVec3::Z);
        // A half vector turns at most half as fast as the light, over the cosine between view and half vector.
        let turn = 0.5 * reach / nearest / scene.view.dot(half).max(0.1);
        let tilt = normal.cross(half).length() - turn;
        turn > (scene.alpha * scene.alpha + tilt.max(0.0).powi(2)).sqrt()
    }
}

fn refine(scene: &Scene, normal: DVec3, cell: Cell, estimate: f64, tolerance: f64, depth: u32) -> f64 {
    let children = cell.children();
    let parts = children.map(|child| child.estimate(scene, normal));
    let sum: f64 = parts.iter().sum();
    let done = (sum - estimate).abs() <= tolerance && !cell.hides_lobe(scene, normal);
    if done || depth == MAX_DEPTH {
        return sum;
    }
    (0..4).map(|k| refine(scene, normal, children[k], parts[k], 0.5 * tolerance, depth + 1)).sum()
}

/// Projected normals under a footprint and their shares, which add up to 1: midpoints of a grid over ±4 standard deviations
/// along the axes of the footprint, `per_texel` points a texel but at least 24 and at most `most` along an axis.
pub fn footprint_normals(map: &NormalMap, footprint: &Footprint, per_texel: f64, most: u32) -> Vec<(f64, DVec2)> {
    const REACH: f64 = 4.0;
    let (minor, major, axis) = footprint.principal();
    let nodes = |sigma: f64| -> Vec<(f64, f64)> {
        let count = (2.0 * REACH * sigma * per_texel).ceil().clamp(24.0, f64::from(most)) as u32;
        let step = 2.0 * REACH / f64::from(count);
        let at = |k: u32| -REACH + (f64::from(k) + 0.5) * step;
        let total: f64 = (0..count).map(|k| (-0.5 * at(k) * at(k)).exp()).sum();
        (0..count).map(|k| (at(k) * sigma, (-0.5 * at(k) * at(k)).exp() / total)).collect()
    };
    let across = nodes(minor);
    let mut normals = Vec::new();
    for (a, share_a) in nodes(major) {
        for &(b, share_b) in &across {
            let (s, _) = map.bilinear(footprint.mean + axis * a + axis.perp() * b);
            normals.push((share_a * share_b, s));
        }
    }
    normals
}

/// Radiance of the map under a footprint: facets one by one.
pub fn footprint_radiance(map: &NormalMap, footprint: &Footprint, scene: &Scene, tolerance: f64) -> f64 {
    let normals = footprint_normals(map, footprint, 4.0, 256);
    normals.iter().map(|&(share, s)| share * facet_radiance(scene, lift(s), tolerance)).sum()
}

/// Unit normal of a projected normal.
pub fn lift(s: DVec2) -> DVec3 {
    DVec3::new(s.x, s.y, (1.0 - s.length_squared()).max(0.0).sqrt())
}

/// Density over solid angle of normals of roughness α at an angle of cosine `z` and sine `s`: the LTC of Tao et al. 2021,
/// Eq. 1 and 2, which is D_GGX · cosθ.
pub fn lobe_density(alpha: f64, z: f64, s: f64) -> f64 {
    if z <= 0.0 {
        return 0.0;
    }
    // M⁻¹ = diag(1/α, 1/α, 1): |M⁻¹| / ‖M⁻¹ω‖⁴ · z / π.
    let (x, a2) = (s / alpha, alpha * alpha);
    let n2 = x * x + z * z;
    z * FRAC_1_PI / (a2 * n2 * n2)
}

/// 1 − ∫ cosθ p(ω) dω = ∫ (1 − cosθ) p dω, by the midpoint rule in the logarithm of the slope over α, with `steps` steps.
pub fn deficit(alpha: f64, steps: u32) -> f64 {
    // Slopes from α e^−20 to e^20 and beyond every tail of α ≥ 1e-4.
    let (low, high) = (-20.0, 30.0);
    let h = (high - low) / f64::from(steps);
    let mut sum = 0.0;
    for k in 0..steps {
        let slope = alpha * (low + (f64::from(k) + 0.5) * h).exp();
        let z = 1.0 / (1.0 + slope * slope).sqrt();
        let s = slope * z;
        // dω = 2π sinθ dθ, dθ = z² dm, dm = m dt; 1 − z = s² / (1 + z).
        sum += s * s / (1.0 + z) * lobe_density(alpha, z, s) * 2.0 * PI * s * z * z * slope * h;
    }
    sum
}

/// Density of the convolution of lobes a and b (Eq. 6) at polar angle `theta`: an integral over directions in the frame of
/// the narrower lobe, rings in equal shares of that lobe.
pub fn convolution(a: f64, b: f64, theta: f64, rings: u32, spokes: u32) -> f64 {
    let (narrow, wide) = if a < b { (a, b) } else { (b, a) };
    let (sin_t, cos_t) = theta.sin_cos();
    let mut sum = 0.0;
    for i in 0..rings {
        // Share u of the lobe lies within slope α √(u / (1 − u)).
        let u = (f64::from(i) + 0.5) / f64::from(rings);
        let slope = narrow * (u / (1.0 - u)).sqrt();
        let z = 1.0 / (1.0 + slope * slope).sqrt();
        let s = slope * z;
        for j in 0..spokes {
            let phi = PI * (f64::from(j) + 0.5) / f64::from(spokes);
            let cosine = cos_t * z + sin_t * s * phi.cos();
            // Sine from the components, for the cosine loses it near 1.
            let x = sin_t * z - cos_t * s * phi.cos();
            let y = s * phi.sin();
            sum += lobe_density(wide, cosine, (x * x + y * y).sqrt());
        }
    }
    sum / (f64::from(rings) * f64::from(spokes))
}

/// Roughness, at most 1, of the lobe nearest to the convolution of lobes a and b: the least of ∫ (p_α − c)² dω over α.
pub fn convolved_alpha(a: f64, b: f64) -> f64 {
    const NODES: u32 = 160;
    let scale = a.max(b).max(1e-6);
    // Polar angles by θ = scale · sinh-like growth up to π: midpoints in t of tan(θ/4) = tan(π/4) · (e^{kt} − 1)/(e^k − 1).
    let growth = (8.0 / scale).ln().max(0.5);
    let mut nodes = Vec::new();
    for k in 0..NODES {
        let edge = |t: f64| 4.0 * (((growth * t).exp() - 1.0) / (growth.exp() - 1.0)).atan();
        let (low, high) = (f64::from(k) / f64::from(NODES), f64::from(k + 1) / f64::from(NODES));
        let theta = edge(0.5 * (low + high));
        let weight = theta.sin() * (edge(high) - edge(low));
        nodes.push((theta, weight, convolution(a, b, theta, 120, 60)));
    }
    let distance = |alpha: f64| -> f64 {
        nodes.iter().map(|&(t, w, c)| w * (lobe_density(alpha, t.cos(), t.sin()) - c).powi(2)).sum()
    };
    let (mut low, mut high) = ((0.5 * scale).ln(), 0.0);
    for _ in 0..60 {
        let (x, y) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if distance(f64::exp(x)) < distance(f64::exp(y)) {
            high = y;
        } else {
            low = x;
        }
    }
    (0.5 * (low + high)).exp()
}
