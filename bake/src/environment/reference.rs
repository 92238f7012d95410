//! Filtered environments and glints under them from their definitions, in f64.
//!
//! A filtered environment is a sum over every pixel of the source image. Radiance is constant over a pixel's rectangle of longitude and latitude. The kernel is written with the half vector, as
//! the paper has it (section 3.4, N = V = R), and integrated over each pixel by the midpoint rule on parts that are small
//! against the lobe and against the distance. Weights are normalised by their own sum.
//!
//! Glints are facets placed one by one, and the exact mean and variance of what one facet reflects (section 3.2). A patch has N
//! facets whose normals h are spread as D(h) / D_H. A facet is a mirror: it takes the radiance of the one pixel that it reflects
//! to the eye. Per facet, with weight F G₂ (h·ω_o) / (n·ω_o) · D_H / N, the sum has the smooth reflection as its mean. No filtered
//! map, no levels, no common reflectance of all facets.

use super::cube::face_direction;
use super::image::{EnvironmentImage, direction};
use crate::rng::{ItemRng, Purpose};
use glam::DVec3;
use glint_formats::environment::{Kernel, SOFT_TOE};
use std::borrow::Cow;
use std::f64::consts::PI;

/// Parts of a pixel are at most this part of α wide in the core of a lobe,
const PER_ALPHA: f64 = 16.0;
/// and this part of the distance to its middle outside.
const PER_DISTANCE: f64 = 40.0;

/// Parts of a pixel are at most this part of a lobe wide in its core,
const PER_LOBE: f64 = 12.0;
/// and this part of the distance to its middle outside.
const PER_DISTANCE_OF_FACETS: f64 = 30.0;

/// Images of fewer columns have their pixels divided, so that sums have not to divide them everywhere.
const FINE_WIDTH: u32 = 256;

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

/// The same radiance in pixels that are small enough for sums to be fast.
pub(super) fn with_small_pixels(image: &EnvironmentImage) -> Cow<'_, EnvironmentImage> {
    match FINE_WIDTH.div_ceil(image.width) {
        0 | 1 => Cow::Borrowed(image),
        parts => Cow::Owned(image.divided(parts)),
    }
}

/// GGX density of facets at a cosine.
pub fn ggx(cos_h: f64, alpha: f64) -> f64 {
    let a = alpha * alpha;
    a / (PI * (cos_h * cos_h * (a - 1.0) + 1.0).powi(2))
}

/// Weight of light from `l` in a texel towards `n`.
fn kernel_weight(kernel: Kernel, n: DVec3, l: DVec3, alpha: f64) -> f64 {
    let cos_l = n.dot(l);
    if 1.0 - cos_l >= farthest(kernel) {
        return 0.0;
    }
    let h = (n + l).normalize();
    let facets = ggx(n.dot(h), alpha);
    match kernel {
        Kernel::GgxNl => facets * cos_l,
        Kernel::GgxSoft if cos_l >= SOFT_TOE => facets * cos_l,
        Kernel::GgxSoft => facets * (cos_l + SOFT_TOE).powi(2) / (4.0 * SOFT_TOE),
        Kernel::Ndf => {
            let tangent2 = (1.0 - cos_l * cos_l).max(0.0) / (cos_l * cos_l);
            facets * 2.0 / (1.0 + (1.0 + alpha * alpha * tangent2).sqrt())
        }
    }
}

/// 1 − cosine at which a kernel ends.
fn farthest(kernel: Kernel) -> f64 {
    if kernel == Kernel::GgxSoft { 1.0 + SOFT_TOE } else { 1.0 }
}

/// Calls `add` with index and weight times solid angle of every pixel that has any weight.
fn over_pixels(image: &EnvironmentImage, kernel: Kernel, n: DVec3, alpha: f64, mut add: impl FnMut(usize, f64)) {
    let (width, height) = (f64::from(image.width), f64::from(image.height));
    let tall = PI / height;
    let reach = (2.0 * farthest(kernel)).sqrt();
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
            if distance > reach + tall + wide {
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
pub(super) fn texel_mean(image: &EnvironmentImage, face: usize, i: u32, j: u32, size: u32, rows: u32) -> Filtered {
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
            let middle = face_direction(face, 0.5 * (cut[0] + cut[1]), t);
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
    let o = face_direction(face, 0.0, t);
    let d = face_direction(face, 1.0, t) - o;
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
fn pixel_of(image: &EnvironmentImage, d: DVec3) -> usize {
    let u = libm::atan2(d.x, -d.z) / (2.0 * PI) + 0.5;
    let v = 0.5 - libm::asin(d.y.clamp(-1.0, 1.0)) / PI;
    let cell = |part: f64, count: u32| ((part * f64::from(count)) as u32).min(count - 1);
    (cell(v, image.height) * image.width + cell(u, image.width)) as usize
}

/// A surface of facets as an eye sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetSurface {
    /// Surface normal, unit length.
    pub normal: DVec3,
    /// Direction to the eye, unit length, above the surface.
    pub view: DVec3,
    /// GGX roughness α.
    pub alpha: f64,
    /// Reflectance at normal incidence.
    pub f0: f64,
}

/// Mean of what one facet adds, times their number, and mean of its square, times the square of their number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FacetMoments {
    /// The smooth reflection, in luminance.
    pub mean: f64,
    /// Mean square.
    pub square: f64,
}

impl FacetMoments {
    /// Variance of the sum over `facets`, of which the fraction is there by chance, over the squared mean.
    pub fn relative_variance(&self, facets: f64) -> f64 {
        let part = facets - facets.floor();
        let mean2 = self.mean * self.mean;
        (self.square - mean2) / (facets * mean2) + part * (1.0 - part) / (facets * facets)
    }
}

impl FacetSurface {
    /// Facet area of unit surface, by Simpson's rule over the angle.
    pub fn facet_area(&self) -> f64 {
        self.area_within(0.5 * PI)
    }

    /// Facet area of unit surface tilted by up to `theta`.
    fn area_within(&self, theta: f64) -> f64 {
        const STEPS: u32 = 20_000;
        let h = theta / f64::from(STEPS);
        let mut sum = 0.0;
        for k in 0..=STEPS {
            let at = h * f64::from(k);
            let weight = if k == 0 || k == STEPS { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
            sum += weight * ggx(libm::cos(at), self.alpha) * 2.0 * PI * libm::sin(at);
        }
        sum * h / 3.0
    }

    /// F G₂ (h·ω_o) / (n·ω_o) of a facet, and where it reflects the eye to; none below the horizon.
    fn facet(&self, h: DVec3) -> Option<(f64, DVec3)> {
        let (cos_o, oh) = (self.normal.dot(self.view), self.view.dot(h));
        let light = 2.0 * oh * h - self.view;
        let cos_i = self.normal.dot(light);
        if oh <= 0.0 || cos_i <= 0.0 {
            return None;
        }
        let fresnel = self.f0 + (1.0 - self.f0) * (1.0 - oh).powi(5);
        let lambda = |c: f64| 0.5 * ((1.0 + self.alpha * self.alpha * (1.0 / (c * c) - 1.0)).sqrt() - 1.0);
        let visible = 1.0 / (1.0 + lambda(cos_o) + lambda(cos_i));
        Some((fresnel * visible * oh / cos_o, light))
    }

    /// Moments under `image`, by a sum over parts of its pixels.
    pub fn moments(&self, image: &EnvironmentImage) -> FacetMoments {
        let mirror = 2.0 * self.normal.dot(self.view) * self.normal - self.view;
        let (tall, wide) = (PI / f64::from(image.height), 2.0 * PI / f64::from(image.width));
        let lobe = self.alpha * self.normal.dot(self.view) / PER_LOBE;
        let whole = self.facet_area();
        let mut moments = FacetMoments::default();
        for y in 0..image.height {
            let [top, bottom] = [y, y + 1].map(|row| image.sine(f64::from(row)));
            let solid_angle = image.solid_angle_sr(y);
            for x in 0..image.width {
                let longitude = |part: f64| 2.0 * PI * ((f64::from(x) + part) / f64::from(image.width) - 0.5);
                let distance = (direction(longitude(0.5), 0.5 * (top + bottom)) - mirror).length();
                let fine = lobe.max((distance - tall.max(wide)).max(0.0) / PER_DISTANCE_OF_FACETS);
                let across = wide * (1.0 - top.min(bottom).abs().min(top.max(bottom).abs()).powi(2)).max(0.0).sqrt();
                let [parts_x, parts_y] = [across, tall].map(|side| ((side / fine).ceil() as u32).max(1));
                let (mut first, mut second) = (0.0, 0.0);
                for j in 0..parts_y {
                    let sine = top + (bottom - top) * (f64::from(j) + 0.5) / f64::from(parts_y);
                    for i in 0..parts_x {
                        let light = direction(longitude((f64::from(i) + 0.5) / f64::from(parts_x)), sine);
                        let h = (light + self.view).normalize();
                        // A facet reflects dω_i of light when its normal lies in dω_h = dω_i / (4 h·ω_o).
                        if let Some((weight, _)) = self.facet(h) {
                            let density = ggx(self.normal.dot(h), self.alpha) / (4.0 * self.view.dot(h));
                            first += density * weight;
                            second += density * weight * weight;
                        }
                    }
                }
                let share = solid_angle / f64::from(parts_x * parts_y);
                let radiance = image.luminance((y * image.width + x) as usize);
                moments.mean += share * first * radiance;
                moments.square += whole * share * second * radiance * radiance;
            }
        }
        moments
    }

    /// Luminance towards the eye of one patch of `facets` placed at random, patch number `patch`.
    pub fn placed(&self, image: &EnvironmentImage, facets: u32, seed: u64, patch: u32) -> f64 {
        let mut rng = ItemRng::new(seed, Purpose::PlacedFacets, patch);
        let whole = self.facet_area();
        let x = self.normal.any_orthonormal_vector();
        let y = self.normal.cross(x);
        let mut sum = 0.0;
        for _ in 0..facets {
            let theta = self.tilt(rng.unit() * whole);
            let phi = 2.0 * PI * rng.unit();
            let h = (x * libm::cos(phi) + y * libm::sin(phi)) * libm::sin(theta) + self.normal * libm::cos(theta);
            if let Some((weight, light)) = self.facet(h) {
                sum += weight * image.luminance(pixel_of(image, light));
            }
        }
        sum * whole / f64::from(facets)
    }

    /// The tilt within which lies `area` of the facets, by bisection of the closed form: with c = cos θ and e = 1 − α²,
    /// ∫ dc / (1 − e c²)² = ½ (c / (1 − e c²) + atanh(√e c) / √e).
    fn tilt(&self, area: f64) -> f64 {
        let e = 1.0 - self.alpha * self.alpha;
        let primitive = |c: f64| {
            let logarithm = if e > 1e-9 { libm::atanh(e.sqrt() * c) / e.sqrt() } else { c };
            0.5 * (c / (1.0 - e * c * c) + logarithm)
        };
        let within = |theta: f64| 2.0 * self.alpha * self.alpha * (primitive(1.0) - primitive(libm::cos(theta)));
        let (mut low, mut high) = (0.0, 0.5 * PI);
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if within(middle) < area {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}
