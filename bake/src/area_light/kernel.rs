//! Averages over the texels of a mip level: the box of a texel, and the quadratic B-spline of three boxes, which is what a
//! bilinear look-up of boxes averages over. Its standard deviation is half a texel of the level.

use glam::DVec2;
use glint_formats::Wrap;

/// For every texel of a level of `coarse` texels along an axis of `fine`: the texels under its kernel and their shares,
/// which add up to 1. Texel i of the level covers texels i · fine / coarse to (i + 1) · fine / coarse.
pub fn weights(fine: u32, coarse: u32, wrap: Wrap, cdf: fn(f64) -> f64) -> Vec<Vec<(u32, f64)>> {
    let ratio = f64::from(fine) / f64::from(coarse);
    let mut all = Vec::with_capacity(coarse as usize);
    for i in 0..coarse {
        let centre = (f64::from(i) + 0.5) * ratio;
        let (first, last) = ((centre - 1.5 * ratio).floor() as i64, (centre + 1.5 * ratio).ceil() as i64);
        let lowest = if last - first < i64::from(fine) { first } else { 0 };
        let mut shares = vec![0.0; (last - first).min(i64::from(fine)) as usize];
        for k in first..last {
            let share = cdf((k as f64 + 1.0 - centre) / ratio) - cdf((k as f64 - centre) / ratio);
            let at = match wrap {
                Wrap::Repeat => (k - lowest).rem_euclid(i64::from(fine)),
                Wrap::Clamp => k.clamp(0, i64::from(fine) - 1) - lowest.max(0).min(i64::from(fine) - 1),
            };
            shares[at as usize] += share;
        }
        let start = match wrap {
            Wrap::Repeat => lowest,
            Wrap::Clamp => lowest.max(0).min(i64::from(fine) - 1),
        };
        let texel = |k: usize| (start + k as i64).rem_euclid(i64::from(fine)) as u32;
        all.push(shares.iter().enumerate().filter(|(_, w)| **w > 0.0).map(|(k, w)| (texel(k), *w)).collect());
    }
    all
}

/// Integral, up to x, of the box of width 1 around 0.
pub fn box_cdf(x: f64) -> f64 {
    (x + 0.5).clamp(0.0, 1.0)
}

/// Integral, up to x, of the quadratic B-spline of width 3 around 0.
pub fn spline_cdf(x: f64) -> f64 {
    let away = x.abs().min(1.5);
    let tail = if away >= 0.5 { (1.5 - away).powi(3) / 6.0 } else { 0.5 - away * (0.75 - away * away / 3.0) };
    if x < 0.0 { tail } else { 1.0 - tail }
}

/// `count` points with the density of the B-spline along both axes, in texels of the level from the centre: a Kronecker
/// sequence on the golden ratio's cubic sibling, so that no direction and no period of a map is preferred.
pub fn spline_points(count: u32) -> Vec<DVec2> {
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_2);
    (0..count)
        .map(|k| {
            let t = STEP * (f64::from(k) + 0.5);
            DVec2::new(spline_quantile(t.x.fract()), spline_quantile(t.y.fract()))
        })
        .collect()
}

fn spline_quantile(share: f64) -> f64 {
    let (mut low, mut high) = (-1.5, 1.5);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if spline_cdf(middle) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
