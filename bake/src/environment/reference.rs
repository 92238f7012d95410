//! Filtered environments from the definition, in f64: a sum over every pixel of the source image.
//!
//! Radiance is constant over a pixel's rectangle of longitude and latitude. The kernel is written with the half vector, as
//! the paper has it (section 3.4, N = V = R), and integrated over each pixel by the midpoint rule on parts that are small
//! against the lobe and against the distance. Weights are normalised by their own sum.

use super::image::{EnvironmentImage, direction};
use glam::DVec3;
use glint_formats::environment::Kernel;
use std::f64::consts::PI;

/// Parts of a pixel are at most this part of α wide in the core of a lobe,
const PER_ALPHA: f64 = 16.0;
/// and this part of the distance to its middle outside.
const PER_DISTANCE: f64 = 40.0;

/// A filtered value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Filtered {
    /// Radiance.
    pub rgb: [f64; 3],
    /// Luminance.
    pub luminance: f64,
    /// Mean of squared luminance.
    pub square: f64,
}

/// GGX density of facets at a cosine.
pub fn ggx(cos_h: f64, alpha: f64) -> f64 {
    let a = alpha * alpha;
    a / (PI * (cos_h * cos_h * (a - 1.0) + 1.0).powi(2))
}

/// Weight of light from `l` in a texel towards `n`.
pub fn kernel_weight(kernel: Kernel, n: DVec3, l: DVec3, alpha: f64) -> f64 {
    let cos_l = n.dot(l);
    if cos_l <= 0.0 {
        return 0.0;
    }
    let h = (n + l).normalize();
    let facets = ggx(n.dot(h), alpha);
    match kernel {
        Kernel::GgxNl => facets * cos_l,
        Kernel::Ndf => {
            let tangent2 = (1.0 - cos_l * cos_l).max(0.0) / (cos_l * cos_l);
            facets * 2.0 / (1.0 + (1.0 + alpha * alpha * tangent2).sqrt())
        }
    }
}

/// Calls `add` with index and weight times solid angle of every pixel that has any weight.
fn over_pixels(image: &EnvironmentImage, kernel: Kernel, n: DVec3, alpha: f64, mut add: impl FnMut(usize, f64)) {
    let (width, height) = (f64::from(image.width), f64::from(image.height));
    let tall = PI / height;
    let centres: Vec<[f64; 2]> = (0..image.width)
        .map(|x| 2.0 * PI * ((f64::from(x) + 0.5) / width - 0.5))
        .map(|longitude| [libm::sin(longitude), libm::cos(longitude)])
        .collect();
    for y in 0..image.height {
        let wide = 2.0 * PI / width * libm::cos(PI * (0.5 - (f64::from(y) + 0.5) / height));
        let [top, bottom] = [y, y + 1].map(|row| image.sine(f64::from(row)));
        let sine = 0.5 * (top + bottom);
        let cosine = (1.0 - sine * sine).sqrt();
        let solid_angle = image.solid_angle_sr(y);
        for x in 0..image.width {
            let [s, c] = centres[x as usize];
            let distance = (DVec3::new(cosine * s, sine, -cosine * c) - n).length();
            // The farthest point of the horizon is √2 away.
            if distance > std::f64::consts::SQRT_2 + tall + wide {
                continue;
            }
            let fine = (alpha / PER_ALPHA).max((distance - tall.max(wide)).max(0.0) / PER_DISTANCE);
            let [parts_x, parts_y] = [wide, tall].map(|side| ((side / fine).ceil() as u32).max(1));
            let mut sum = 0.0;
            for i in 0..parts_x {
                let part = (f64::from(x) + (f64::from(i) + 0.5) / f64::from(parts_x)) / width;
                for j in 0..parts_y {
                    let sine = top + (bottom - top) * (f64::from(j) + 0.5) / f64::from(parts_y);
                    sum += kernel_weight(kernel, n, direction(2.0 * PI * (part - 0.5), sine), alpha);
                }
            }
            if sum > 0.0 {
                add((y * image.width + x) as usize, sum / f64::from(parts_x * parts_y) * solid_angle);
            }
        }
    }
}

/// What a texel towards `n` should hold.
pub fn filtered(image: &EnvironmentImage, kernel: Kernel, n: DVec3, alpha: f64) -> Filtered {
    let mut sum = Filtered::default();
    let mut whole = 0.0;
    over_pixels(image, kernel, n, alpha, |pixel, weight| {
        let l = image.luminance(pixel);
        (0..3).for_each(|c| sum.rgb[c] += weight * f64::from(image.pixels[pixel][c]));
        sum.luminance += weight * l;
        sum.square += weight * l * l;
        whole += weight;
    });
    Filtered { rgb: sum.rgb.map(|c| c / whole), luminance: sum.luminance / whole, square: sum.square / whole }
}

/// Mean of ⟨L²⟩ when every pixel's luminance is shared between two of `levels` (Eq. 19), and the exact one.
pub fn second_moments(
    image: &EnvironmentImage,
    kernel: Kernel,
    n: DVec3,
    alpha: f64,
    all_levels: &[Vec<f64>],
) -> (Vec<f64>, f64) {
    let mut with_levels = vec![0.0; all_levels.len()];
    let (mut exact, mut whole) = (0.0, 0.0);
    over_pixels(image, kernel, n, alpha, |pixel, weight| {
        let l = image.luminance(pixel);
        whole += weight;
        exact += weight * l * l;
        for (sum, levels) in with_levels.iter_mut().zip(all_levels) {
            let mut below = 0;
            while below + 2 < levels.len() && levels[below + 1] <= l {
                below += 1;
            }
            let (low, high) = (levels[below], levels[below + 1]);
            *sum += weight * (l * l + (l - low) * (high - l));
        }
    });
    (with_levels.into_iter().map(|sum| sum / whole).collect(), exact / whole)
}

/// Mean radiance over the part of the sphere that texel (i, j) of a face covers. Exact along `rows` lines of the texel,
/// which every edge of a pixel that crosses them cuts in pieces of one radiance; the midpoint rule across them.
pub fn texel_mean(image: &EnvironmentImage, face: usize, i: u32, j: u32, size: u32, rows: u32) -> Filtered {
    let place = |k: u32, part: f64| 2.0 * (f64::from(k) + part) / f64::from(size) - 1.0;
    let (left, right) = (place(i, 0.0), place(i, 1.0));
    let mut sum = Filtered::default();
    let mut whole = 0.0;
    for row in 0..rows {
        let t = place(j, (f64::from(row) + 0.5) / f64::from(rows));
        let mut cuts = pixel_edges(image, face, t, left, right);
        cuts.extend([left, right]);
        cuts.sort_by(f64::total_cmp);
        // The solid angle from the line's middle to s, a unit of t: ∫ ds / (1 + s² + t²)^1.5.
        let solid_angle = |s: f64| s / ((1.0 + t * t) * (1.0 + s * s + t * t).sqrt());
        for cut in cuts.windows(2) {
            let weight = solid_angle(cut[1]) - solid_angle(cut[0]);
            let middle = super::cube::face_direction(face, 0.5 * (cut[0] + cut[1]), t);
            let pixel = pixel_of(image, middle.normalize());
            let l = image.luminance(pixel);
            (0..3).for_each(|c| sum.rgb[c] += weight * f64::from(image.pixels[pixel][c]));
            sum.luminance += weight * l;
            sum.square += weight * l * l;
            whole += weight;
        }
    }
    Filtered { rgb: sum.rgb.map(|c| c / whole), luminance: sum.luminance / whole, square: sum.square / whole }
}

/// Where edges of pixels, prolonged over the sphere, cut the line of a face at `t` between `left` and `right`.
fn pixel_edges(image: &EnvironmentImage, face: usize, t: f64, left: f64, right: f64) -> Vec<f64> {
    // Points of the line are o + s d.
    let o = super::cube::face_direction(face, 0.0, t);
    let d = super::cube::face_direction(face, 1.0, t) - o;
    let mut cuts = Vec::new();
    let mut add = |s: f64| {
        if s > left && s < right {
            cuts.push(s);
        }
    };
    for column in 0..image.width {
        // A meridian lies in the plane of the axis and of its direction at the equator.
        let east = direction(2.0 * PI * (f64::from(column) / f64::from(image.width) - 0.5), 0.0);
        let normal = DVec3::new(east.z, 0.0, -east.x);
        add(-normal.dot(o) / normal.dot(d));
    }
    for row in 1..image.height {
        // A parallel is a cone: y² = sin² |o + s d|², which is quadratic in s.
        let sine2 = image.sine(f64::from(row)).powi(2);
        let a = d.y * d.y - sine2 * d.length_squared();
        let b = d.y * o.y - sine2 * d.dot(o);
        let c = o.y * o.y - sine2 * o.length_squared();
        let root = (b * b - a * c).max(0.0).sqrt();
        add((-b + root) / a);
        add((-b - root) / a);
    }
    cuts
}

/// Index of the pixel in a direction.
pub fn pixel_of(image: &EnvironmentImage, d: DVec3) -> usize {
    let u = libm::atan2(d.x, -d.z) / (2.0 * PI) + 0.5;
    let v = 0.5 - libm::asin(d.y.clamp(-1.0, 1.0)) / PI;
    let cell = |part: f64, count: u32| ((part * f64::from(count)) as u32).min(count - 1);
    (cell(v, image.height) * image.width + cell(u, image.width)) as usize
}
