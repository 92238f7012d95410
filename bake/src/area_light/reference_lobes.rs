//! What the closed forms and fits for lobes of normals approximate, by numerical integration in f64: the mean resultant
//! length, and the convolution of two lobes on the sphere. Shares no code with the fast path.

use std::f64::consts::{FRAC_1_PI, PI};

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
