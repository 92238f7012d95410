//! Look-ups in a baked environment, texel by texel, in f32: what `eval.wgsl` asks of the program that includes it.
//!
//! The host's shader `bind_environment_exact.wgsl` does the same by loads; `bind_environment.wgsl` leaves it to a sampler, which may
//! round weights to 8 bits and has its own rule at the corners of a cube.

use super::baked::Environment;
use glam::Vec3;
use std::ops::Neg;

/// Four texels of a cube and their weights, as seamless linear filtering takes them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CubeTaps {
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
pub fn cube_taps(direction: Vec3, size: u32) -> CubeTaps {
    let (face, s, t, whole) = face_fraction(direction.to_array(), 0.0);
    let place = |c: f32| 0.5 * (c / whole + 1.0) * size as f32 - 0.5;
    let (x, y) = (place(s), place(t));
    let (i, j) = (x.floor(), y.floor());
    let (fx, fy) = (x - i, y - j);
    let last = size as i32 - 1;
    let (i, j) = ((i as i32).clamp(-1, last), (j as i32).clamp(-1, last));
    let texel = |i: i32, j: i32| seamless_texel(face, i, j, size as i32);
    CubeTaps {
        texels: [texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1)],
        weights: [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy],
    }
}

/// The mirror around a direction: R, G, B and root mean square luminance.
pub fn mirror_at(environment: &Environment, direction: Vec3) -> [f32; 4] {
    roughness_at(environment, 0, direction)
}

/// Radiance of layer `layer` of a mip around a direction: R, G, B and root mean square luminance.
pub fn radiance_at(environment: &Environment, layer: u32, direction: Vec3, mip: u32) -> [f32; 4] {
    roughness_at(environment, index_of(environment, mip, layer), direction)
}

/// Filtered roughness that a layer of a mip holds.
fn index_of(environment: &Environment, mip: u32, layer: u32) -> u32 {
    1 + mip * environment.params.per_size + layer
}

fn roughness_at(environment: &Environment, index: u32, direction: Vec3) -> [f32; 4] {
    let taps = cube_taps(direction, environment.params.size(index));
    let mut sum = [0.0; 4];
    for ((face, i, j), weight) in taps.texels.into_iter().zip(taps.weights) {
        let texel = environment.radiance_texel(index, face, i, j);
        (0..4).for_each(|c| sum[c] += weight * texel[c]);
    }
    sum
}

/// Shares of levels around a direction, layer `layer` of the indicators of a mip: that of radiance times the number of layers of
/// each, plus a quarter of the level.
pub(super) fn indicators_at(environment: &Environment, layer: u32, direction: Vec3, mip: u32) -> [f32; 4] {
    let layers = environment.params.indicator_layers();
    let index = index_of(environment, mip, layer / layers);
    let taps = cube_taps(direction, environment.params.size(index));
    let mut sum = [0.0; 4];
    for ((face, i, j), weight) in taps.texels.into_iter().zip(taps.weights) {
        let texel = environment.indicator_texel((layer % layers) as usize, index, face, i, j);
        (0..4).for_each(|c| sum[c] += weight * texel[c]);
    }
    sum
}

/// Colour of level `layer` + 1 around a direction, of luminance 1, at `mip`, 0 to the last.
pub fn colour_at(environment: &Environment, layer: u32, direction: Vec3, mip: f32) -> [f32; 3] {
    let last = environment.params.mips() - 1;
    let low = (mip.floor() as u32).min(last);
    let mut sum = [0.0; 3];
    for (mip, share) in [(low, 1.0 - (mip - low as f32)), ((low + 1).min(last), mip - low as f32)] {
        let taps = cube_taps(direction, environment.params.size(index_of(environment, mip, 0)));
        for ((face, i, j), weight) in taps.texels.into_iter().zip(taps.weights) {
            let texel = environment.colour_texel(layer as usize, mip, face, i, j);
            (0..3).for_each(|c| sum[c] += share * weight * texel[c]);
        }
    }
    sum
}

/// Layer `layer` of the albedo table at a place, each coordinate from 0 to 1, clamped to the middles of its outer texels.
pub(super) fn albedo_at(environment: &Environment, layer: u32, place: [f32; 2]) -> [f32; 4] {
    let last = (environment.params.albedo_size - 1) as f32;
    let [x, y] = place.map(|c| (c * (last + 1.0) - 0.5).clamp(0.0, last));
    let (i, j) = (x.floor(), y.floor());
    let (fx, fy) = (x - i, y - j);
    let mut sum = [0.0; 4];
    for (di, dj, weight) in [
        (0.0, 0.0, (1.0 - fx) * (1.0 - fy)),
        (1.0, 0.0, fx * (1.0 - fy)),
        (0.0, 1.0, (1.0 - fx) * fy),
        (1.0, 1.0, fx * fy),
    ] {
        let texel = environment.albedo_texel(layer, (i + di).min(last) as u32, (j + dj).min(last) as u32);
        (0..4).for_each(|c| sum[c] += weight * texel[c]);
    }
    sum
}
