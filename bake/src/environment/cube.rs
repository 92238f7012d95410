//! Cube faces and texels, and the step from the equirectangular source to the mirror by exact areas.
//!
//! Faces are +X −X +Y −Y +Z −Z in the orientation of Vulkan, Direct3D and WebGPU: the direction through (s, t) of face
//! +Z, each from −1 to 1, is (s, −t, 1), and so on. Tools that take the nearest pixel lose some per cent of a sun.
//!
//! A texel of a side face is bounded by two meridians, so its share of each pixel is an integral over longitude of
//! differences of sines of latitude. A texel of +Y or −Y is a square seen from the pole: a meridian cuts it between two
//! radii. Longitudes are divided at texel corners, at pixel edges, and where an edge of the texel passes from one row of
//! pixels to the next; what is left is smooth and integrated by three Gauss points. All pieces of a texel are then
//! scaled to its exact solid angle (by 1e-6 or less).

use super::image::EnvironmentImage;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Nodes and weights of Gauss quadrature on (0, 1).
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Direction, not of unit length, through (s, t) of a face; each from −1 to 1, t down.
pub(super) fn face_direction(face: usize, s: f64, t: f64) -> DVec3 {
    match face {
        0 => DVec3::new(1.0, -t, -s),
        1 => DVec3::new(-1.0, -t, s),
        2 => DVec3::new(s, 1.0, t),
        3 => DVec3::new(s, -1.0, -t),
        4 => DVec3::new(s, -t, 1.0),
        _ => DVec3::new(-s, -t, -1.0),
    }
}

/// Face and (s, t) that a direction goes through.
pub fn face_of(d: DVec3) -> (usize, f64, f64) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        if d.x > 0.0 { (0, -d.z / a.x, -d.y / a.x) } else { (1, d.z / a.x, -d.y / a.x) }
    } else if a.y >= a.z {
        if d.y > 0.0 { (2, d.x / a.y, d.z / a.y) } else { (3, d.x / a.y, -d.z / a.y) }
    } else if d.z > 0.0 {
        (4, d.x / a.z, -d.y / a.z)
    } else {
        (5, -d.x / a.z, -d.y / a.z)
    }
}

/// (s or t) of the edge between texels i − 1 and i.
fn edge(i: u32, size: u32) -> f64 {
    2.0 * f64::from(i) / f64::from(size) - 1.0
}

/// Direction of the centre of texel (i, j), of unit length.
pub fn texel_direction(face: usize, i: u32, j: u32, size: u32) -> DVec3 {
    let [s, t] = [i, j].map(|k| (2.0 * f64::from(k) + 1.0) / f64::from(size) - 1.0);
    face_direction(face, s, t).normalize()
}

/// Solid angle of texel (i, j) of any face, in steradians.
pub fn texel_solid_angle_sr(i: u32, j: u32, size: u32) -> f64 {
    let corner = |s: f64, t: f64| libm::atan2(s * t, (s * s + t * t + 1.0).sqrt());
    let ([s0, s1], [t0, t1]) = ([edge(i, size), edge(i + 1, size)], [edge(j, size), edge(j + 1, size)]);
    corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0)
}

/// Texels of row `row` of the rows of all faces of `size` texels (even), one face after the other: of each the means of
/// `channels` numbers, which `values` gives by column and row of a pixel.
pub(super) fn resampled_row(
    image: &EnvironmentImage,
    size: u32,
    row: u32,
    channels: usize,
    values: impl Fn(u32, u32, &mut [f32]),
) -> Vec<f64> {
    let (face, j) = ((row / size) as usize, row % size);
    let mut texels = vec![0.0; size as usize * channels];
    let mut pieces = Vec::new();
    let mut of_pixel = vec![0.0; channels];
    for (i, texel) in (0..size).zip(texels.chunks_exact_mut(channels)) {
        pieces.clear();
        let square = ([edge(i, size), edge(i + 1, size)], [edge(j, size), edge(j + 1, size)]);
        if face == 2 || face == 3 {
            add_polar(image, face == 2, square, &mut pieces);
        } else {
            add_side(image, face, square, &mut pieces);
        }
        for (pixel, share) in shares(&mut pieces) {
            values(pixel % image.width, pixel / image.width, &mut of_pixel);
            for c in 0..channels {
                texel[c] += f64::from(share) * f64::from(of_pixel[c]);
            }
        }
    }
    texels
}

/// Each pixel of a texel's pieces and its share; the shares add up to 1.
fn shares(pieces: &mut [(u32, f64)]) -> impl Iterator<Item = (u32, f32)> {
    pieces.sort_unstable_by_key(|piece| piece.0);
    let whole: f64 = pieces.iter().map(|piece| piece.1).sum();
    pieces.chunk_by(|a, b| a.0 == b.0).map(move |pieces| {
        let share = pieces.iter().fold(0.0, |share, piece| share + piece.1 / whole);
        (pieces[0].0, share as f32)
    })
}

type Square = ([f64; 2], [f64; 2]);

/// A texel of a side face: longitudes from its columns, latitudes from its rows.
fn add_side(image: &EnvironmentImage, face: usize, ([s0, s1], [t0, t1]): Square, texel: &mut Vec<(u32, f64)>) {
    // Longitude falls as s rises: seen from inside, cube faces are mirrored.
    let middle = [FRAC_PI_2, -FRAC_PI_2, 0.0, 0.0, PI, 0.0][face];
    let range = (middle - libm::atan(s1), middle - libm::atan(s0));
    // An edge of the texel is at latitude φ with tan φ = −t cos(λ − middle).
    let cosines = [range.0, range.1].map(|lambda| libm::cos(lambda - middle));
    let least = cosines[0].min(cosines[1]);
    let most = if range.0 < middle && middle < range.1 { 1.0 } else { cosines[0].max(cosines[1]) };
    let mut kinks = Vec::new();
    for t in [t0, t1] {
        for tangent in parallels_between(image, -t * least, -t * most) {
            let angle = libm::acos((-tangent / t).clamp(-1.0, 1.0));
            kinks.extend([middle - angle, middle + angle]);
        }
    }
    kinks.sort_by(f64::total_cmp);
    over_longitudes(image, range, &kinks, |x, lambda, weight| {
        let c = libm::cos(lambda - middle);
        let sine = |t: f64| -t * c / (1.0 + t * t * c * c).sqrt();
        add_meridian(image, x, sine(t0), sine(t1), weight, texel);
    });
}

/// A texel of +Y or −Y: a square in the plane of the face, cut by the rays of longitude.
fn add_polar(image: &EnvironmentImage, top: bool, ([s0, s1], [t0, t1]): Square, texel: &mut Vec<(u32, f64)>) {
    // In the plane (s, q) with q = −t on +Y and t on −Y, longitude is atan2(s, q).
    let [q0, q1] = if top { [-t1, -t0] } else { [t0, t1] };
    let centre = libm::atan2(s0 + s1, q0 + q1);
    // Corners relative to the centre, so that the cut of atan2 does not matter; the pole itself has no longitude.
    let mut corners: Vec<f64> = [(s0, q0), (s0, q1), (s1, q0), (s1, q1)]
        .into_iter()
        .filter(|&(s, q)| s != 0.0 || q != 0.0)
        .map(|(s, q)| centre + wrapped(libm::atan2(s, q) - centre))
        .collect();
    corners.sort_by(f64::total_cmp);
    let range = (corners[0], corners[corners.len() - 1]);
    let mut kinks = corners;
    let sign = if top { 1.0 } else { -1.0 };
    let edges = [(true, s0, q0, q1), (true, s1, q0, q1), (false, q0, s0, s1), (false, q1, s0, s1)];
    for (along_q, fixed, low, high) in edges {
        // A point of the plane at distance r from the pole has tan φ = ±1 / r.
        let nearest = if low < 0.0 && high > 0.0 { 0.0 } else { low.abs().min(high.abs()) };
        let [near, far] = [nearest, low.abs().max(high.abs())].map(|v| fixed.hypot(v));
        for tangent in parallels_between(image, sign / near, sign / far) {
            let ratio = (fixed * tangent.abs()).clamp(-1.0, 1.0);
            let angles = if along_q {
                [libm::asin(ratio), PI - libm::asin(ratio)]
            } else {
                [libm::acos(ratio), -libm::acos(ratio)]
            };
            kinks.extend(angles.map(|angle| centre + wrapped(angle - centre)));
        }
    }
    kinks.sort_by(f64::total_cmp);
    over_longitudes(image, range, &kinks, |x, lambda, weight| {
        let (ds, dq) = (libm::sin(lambda), libm::cos(lambda));
        let (mut near, mut far) = (0.0f64, f64::INFINITY);
        for (d, low, high) in [(ds, s0, s1), (dq, q0, q1)] {
            if d.abs() > 1e-300 {
                let (a, b) = (low / d, high / d);
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
        }
        if far > near {
            let sine = |radius: f64| 1.0 / (1.0 + radius * radius).sqrt();
            let (inner, outer) = (sine(near), sine(far));
            let (high, low) = if top { (inner, outer) } else { (-outer, -inner) };
            add_meridian(image, x, high, low, weight, texel);
        }
    });
}

/// Tangents of the latitudes between rows of pixels, from one tangent to another.
fn parallels_between(image: &EnvironmentImage, a: f64, b: f64) -> impl Iterator<Item = f64> {
    let height = f64::from(image.height);
    let row_of = |tangent: f64| (0.5 - libm::atan(tangent) / PI) * height;
    let (first, last) = (row_of(a.max(b)).floor() as u32 + 1, row_of(a.min(b)).ceil() as u32);
    (first..last).map(move |row| libm::tan(PI * (0.5 - f64::from(row) / height)))
}

/// An angle's equal in (−π, π].
fn wrapped(angle: f64) -> f64 {
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}

/// Calls `add` with the column, the longitude and the weight of every node of the quadrature over a range.
fn over_longitudes(
    image: &EnvironmentImage,
    (begin, end): (f64, f64),
    kinks: &[f64],
    mut add: impl FnMut(u32, f64, f64),
) {
    let width = f64::from(image.width);
    let column_of = |lambda: f64| (lambda / (2.0 * PI) + 0.5) * width;
    let mut from = begin;
    while from < end {
        // A piece ends at the next pixel edge or kink. Pieces of rounding size are swallowed by the next.
        let column = (column_of(from) + 1e-9).floor();
        let next_edge = ((column + 1.0) / width - 0.5) * 2.0 * PI;
        let next_kink = kinks.iter().copied().find(|kink| *kink > from + 1e-12).unwrap_or(end);
        let to = end.min(next_edge).min(next_kink);
        let to = if end - to < 1e-12 { end } else { to };
        let x = column.rem_euclid(width) as u32;
        for (node, weight) in GAUSS {
            add(x.min(image.width - 1), from + node * (to - from), weight * (to - from));
        }
        from = to;
    }
}

/// Adds the pixels of column x between two sines of latitude, high to low.
fn add_meridian(image: &EnvironmentImage, x: u32, high: f64, low: f64, weight: f64, texel: &mut Vec<(u32, f64)>) {
    let row_of = |sine: f64| (0.5 - libm::asin(sine.clamp(-1.0, 1.0)) / PI) * f64::from(image.height);
    let last = image.height - 1;
    let first = (row_of(high) as u32).min(last);
    let end = (row_of(low) as u32).min(last);
    let mut top = high;
    for y in first..=end {
        let bottom = if y == end { low } else { image.sine(f64::from(y + 1)).max(low) };
        if top > bottom {
            texel.push((y * image.width + x, weight * (top - bottom)));
            top = bottom;
        }
    }
}
