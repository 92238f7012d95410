//! What a shader reads and computes, in f32: filtered radiance, probabilities of the radiance levels, and mean and
//! variance of what glints reflect.
//!
//! Paper: Eq. 15, 17 and 21. Glint radiance is L_o · Σ L_k M_k / (N Σ L_k p_k) with M multinomial; its sampling is in
//! `counting`. Deviation: [`spread_factor`] brings the second moment of that to the one that was filtered besides
//! radiance, so the variance of glints is right for any levels.

use super::tables::Environment;
use glam::Vec3;
use glint_formats::environment::MAX_LEVELS;
use std::ops::Neg;

/// Four texels of a cube and their weights, as seamless linear filtering takes them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taps {
    /// Face, column, row.
    pub texels: [(usize, u32, u32); 4],
    /// Weights; their sum is 1.
    pub weights: [f32; 4],
}

/// Face that (x, y, z) goes through, and numerators and denominator of its (s, t); X goes before Y before Z where two
/// are as large.
fn face_fraction<N: Copy + PartialOrd + Neg<Output = N>>([x, y, z]: [N; 3], zero: N) -> (usize, N, N, N) {
    let abs = |v: N| if v < zero { -v } else { v };
    let (ax, ay, az) = (abs(x), abs(y), abs(z));
    if ax >= ay && ax >= az {
        if x > zero { (0, -z, -y, ax) } else { (1, z, -y, ax) }
    } else if ay >= az {
        if y > zero { (2, x, z, ay) } else { (3, x, -z, ay) }
    } else if z > zero {
        (4, x, -y, az)
    } else {
        (5, -x, -y, az)
    }
}

/// The texel at column i and row j of a face, which may lie one beyond its edge: there it is the texel of the next face.
/// Whole numbers only, so that no rounding decides.
fn seamless_texel(face: usize, i: i32, j: i32, size: i32) -> (usize, u32, u32) {
    if (0..size).contains(&i) && (0..size).contains(&j) {
        return (face, i as u32, j as u32);
    }
    let (s, t) = (2 * i + 1 - size, 2 * j + 1 - size);
    let direction = match face {
        0 => [size, -t, -s],
        1 => [-size, -t, s],
        2 => [s, size, t],
        3 => [s, -size, -t],
        4 => [s, -t, size],
        _ => [-s, -t, -size],
    };
    let (face, s, t, whole) = face_fraction(direction, 0);
    let cell = |c: i32| ((c + whole) * size / (2 * whole)).clamp(0, size - 1) as u32;
    (face, cell(s), cell(t))
}

/// The texels around a direction on faces of `size` texels.
pub fn cube_taps(direction: Vec3, size: u32) -> Taps {
    let (face, s, t, whole) = face_fraction(direction.to_array(), 0.0);
    let place = |c: f32| 0.5 * (c / whole + 1.0) * size as f32 - 0.5;
    let (x, y) = (place(s), place(t));
    let (i, j) = (x.floor(), y.floor());
    let (fx, fy) = (x - i, y - j);
    let last = size as i32 - 1;
    let (i, j) = ((i as i32).clamp(-1, last), (j as i32).clamp(-1, last));
    let texel = |i: i32, j: i32| seamless_texel(face, i, j, size as i32);
    Taps {
        texels: [texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1)],
        weights: [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy],
    }
}

/// Mip of roughness α, between 0 and `mips` − 1: the inverse of what the bake gives each mip.
pub fn mip_of_roughness(alpha: f32, mips: u32) -> f32 {
    let perceptual = alpha.clamp(0.0, 1.0).sqrt();
    perceptual * (2.0 - perceptual) * (mips.max(2) - 1) as f32
}

/// Scale and bias of F₀, visible reflecting area and whole facet area at a view cosine and roughness.
pub fn environment_areas(environment: &Environment, cos_o: f32, alpha: f32) -> [f32; 4] {
    let last = (environment.params.albedo_size - 1) as f32;
    let place = |c: f32| (c.clamp(0.0, 1.0) * (last + 1.0) - 0.5).clamp(0.0, last);
    let (x, y) = (place(cos_o), place(alpha.max(0.0).sqrt()));
    let (i, j) = (x.floor(), y.floor());
    let (fx, fy) = (x - i, y - j);
    let mut areas = [0.0; 4];
    for (di, dj, weight) in [
        (0.0, 0.0, (1.0 - fx) * (1.0 - fy)),
        (1.0, 0.0, fx * (1.0 - fy)),
        (0.0, 1.0, (1.0 - fx) * fy),
        (1.0, 1.0, fx * fy),
    ] {
        let texel = environment.albedo_texel((i + di).min(last) as u32, (j + dj).min(last) as u32);
        (0..4).for_each(|c| areas[c] += weight * texel[c]);
    }
    areas
}

/// Calls `add` with mip, face, column, row and weight of the eight texels of a trilinear look-up.
fn trilinear(environment: &Environment, direction: Vec3, alpha: f32, mut add: impl FnMut(u32, (usize, u32, u32), f32)) {
    let mips = environment.params.mips();
    let mip = mip_of_roughness(alpha, mips).min((mips - 1) as f32);
    let low = (mip.floor() as u32).min(mips - 1);
    for (mip, share) in [(low, 1.0 - (mip - low as f32)), ((low + 1).min(mips - 1), mip - low as f32)] {
        let taps = cube_taps(direction, environment.size(mip));
        for (texel, weight) in taps.texels.into_iter().zip(taps.weights) {
            add(mip, texel, share * weight);
        }
    }
}

/// Filtered radiance around a direction: R, G, B and root mean square luminance.
pub fn environment_radiance(environment: &Environment, direction: Vec3, alpha: f32) -> [f32; 4] {
    let mut sum = [0.0; 4];
    trilinear(environment, direction, alpha, |mip, (face, i, j), weight| {
        let texel = environment.radiance_texel(mip, face, i, j);
        (0..4).for_each(|c| sum[c] += weight * texel[c]);
    });
    sum
}

/// Shares of the radiance levels around a direction; the first is what the others leave of 1.
pub fn environment_levels(environment: &Environment, direction: Vec3, alpha: f32) -> [f32; MAX_LEVELS] {
    let count = environment.params.levels.len();
    let mut shares = [0.0; MAX_LEVELS];
    for layer in 0..environment.params.indicator_layers() as usize {
        trilinear(environment, direction, alpha, |mip, (face, i, j), weight| {
            let texel = environment.indicator_texel(layer, mip, face, i, j);
            for c in 0..4.min(count - 1 - 4 * layer) {
                shares[4 * layer + c + 1] += weight * texel[c];
            }
        });
    }
    shares[0] = (1.0 - shares[1..].iter().sum::<f32>()).max(0.0);
    shares
}

/// Colour of level `level` (1 or more) around a direction, of luminance 1.
pub fn level_colour(environment: &Environment, level: usize, direction: Vec3, alpha: f32) -> [f32; 3] {
    let mut sum = [0.0; 3];
    trilinear(environment, direction, alpha, |mip, (face, i, j), weight| {
        let texel = environment.colour_texel(level - 1, mip, face, i, j);
        (0..3).for_each(|c| sum[c] += weight * texel[c]);
    });
    sum
}

/// Probabilities that a facet reflects each level (Eq. 15 and 21), with `visible` = E_D / D_H. Level 0 also takes the
/// facets that reflect nothing.
pub fn level_probabilities(shares: &[f32; MAX_LEVELS], count: usize, visible: f32) -> [f32; MAX_LEVELS] {
    let mut p = [0.0; MAX_LEVELS];
    if count == 1 {
        p[0] = visible;
        return p;
    }
    let mut lit = 0.0;
    for k in 1..count {
        p[k] = visible * shares[k];
        lit += p[k];
    }
    p[0] = (1.0 - lit).max(0.0);
    p
}

/// Mean and second moment of what one facet reflects.
pub fn facet_moments(levels: &[f64], p: &[f32; MAX_LEVELS]) -> [f32; 2] {
    let mut moments = [0.0; 2];
    for (level, p) in levels.iter().zip(p) {
        let level = *level as f32;
        moments[0] += p * level;
        moments[1] += p * level * level;
    }
    moments
}

/// Variance of glint radiance over N facets, as a share of the squared smooth radiance.
pub fn relative_variance(moments: [f32; 2], n: f32) -> f32 {
    let mean2 = moments[0] * moments[0];
    if mean2 > 0.0 { (moments[1] - mean2).max(0.0) / (n * mean2) } else { 0.0 }
}

/// Factor s for which n/N + s (X − n/N) has the variance that the unsorted facets have, n of N expected facets being
/// there, X = Σ L_k M_k / (N Σ L_k p_k): `square` is ⟨L²⟩ as filtered, `moments` those of the levels. At most 1: levels never vary too little.
pub fn spread_factor(moments: [f32; 2], square: f32, visible: f32) -> f32 {
    let mean2 = moments[0] * moments[0];
    let of_levels = moments[1] - mean2;
    if of_levels > 0.0 { ((visible * square - mean2) / of_levels).clamp(0.0, 1.0).sqrt() } else { 1.0 }
}
