//! Rectangle lights on normal-mapped surfaces at run time: mean normal and roughness of what lies under a pixel, and its lobes.
//! f32, plain functions, as in WGSL.
//!
//! Paper: Tao et al. 2021, sections 3.1, 3.3 and 3.5. Deviations:
//! - The roughness of the normals comes from the mip chain, see [`super::spread`]. Engines that have no more than the
//!   length of the mean normal take [`alpha_from_deficit`], the exact inverse of the paper's Eq. 4.
//! - Convolution by a symmetric formula ([`convolve_alpha`]).
//! - Normals that vary more along one direction: GGX of roughness p along and q across is taken apart into a few lobes
//!   along the direction, at equal shares of the marginal of √(p² − q²), each of which keeps q. An LTC of one anisotropic
//!   lobe cannot bend around the surface as the reflections of brushed metal do; three can.

use super::baked::{Maps, Tables};
use super::rect::{RectLight, Roughness, faces, isotropic_radiance, lobe_radiance, tangent_frame};
use super::spread;
use glam::{Vec2, Vec3};
use glint_formats::Wrap;

/// Lobes that anisotropic normals are taken apart into.
pub const LOBES: u32 = 3;
/// Most of them.
pub const MAX_LOBES: u32 = 9;
/// Deficit of a lobe of roughness 1.
pub const MAX_DEFICIT: f32 = 1.0 / 3.0;

/// What lies under a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Mean normal, unit.
    pub normal: Vec3,
    /// Length of the mean normal before it was made a unit vector.
    pub length: f32,
    /// Meso roughness α, the same in all directions.
    pub alpha: f32,
    /// Meso roughness by direction; `alpha` in all directions where the material is isotropic.
    pub by_direction: Roughness,
}

/// (atanh(β)/β − 1) / β² for β² = 1 − α², with 1 − R = α² times that.
fn deficit_shape(alpha: f32) -> f32 {
    let b2 = (1.0 - alpha) * (1.0 + alpha);
    if b2 < 0.35 {
        let mut sum = 0.0;
        for k in 0..14 {
            sum = sum * b2 + 1.0 / (29 - 2 * k) as f32;
        }
        return sum;
    }
    let b = b2.sqrt();
    (((1.0 + b) / alpha).ln() / b - 1.0) / b2
}

/// Roughness α of GGX normals whose mean resultant length is 1 − `deficit`; 1 for ⅓ and above.
pub fn alpha_from_deficit(deficit: f32) -> f32 {
    if deficit >= MAX_DEFICIT {
        return 1.0;
    }
    if deficit <= 0.0 || deficit.is_nan() {
        return 0.0;
    }
    // Newton's method on ln(1 − R) over ln α, which is nearly straight.
    let mut alpha = (deficit * 3.0).sqrt();
    for _ in 0..6 {
        let shape = deficit_shape(alpha);
        let b2 = (1.0 - alpha) * (1.0 + alpha);
        // α² times the derivative of the shape by β²; near β = 0 its series.
        let slope = if b2 < 0.02 {
            alpha * alpha * (0.2 + b2 * (0.285_714_3 + b2 / 3.0))
        } else {
            (0.5 - 1.5 * alpha * alpha * shape) / b2
        };
        let rate = 2.0 - 2.0 * slope / shape;
        let error = deficit / (alpha * alpha * shape);
        alpha = (alpha * (error.ln() / rate).exp()).min(1.0);
    }
    alpha
}

/// (1 + r^p)^(1/p) of the power sum with p = [`spread::EXPONENT`], for r from 0 to 1.
fn power_sum(r: f32) -> f32 {
    const EXPONENT: f32 = spread::EXPONENT as f32;
    (1.0 + r.powf(EXPONENT)).powf(1.0 / EXPONENT)
}

/// Roughness of the convolution of lobes of roughness a and b, both 0 to 1; at least the larger, at most 1 (section 3.5).
pub fn convolve_alpha(a: f32, b: f32) -> f32 {
    let (small, large) = (a.min(b), a.max(b));
    if small <= 0.0 || small.is_nan() {
        return large.clamp(0.0, 1.0);
    }
    let sum = large * power_sum(small / large);
    let bend = spread::FIRST as f32 - spread::SECOND as f32 * (a + b);
    (sum * (1.0 - a * b * bend)).clamp(large.min(1.0), 1.0)
}

/// Roughness α of a code of the textures, see [`spread::code_of`].
pub fn alpha_of_code(code: f32) -> f32 {
    let code = code.clamp(0.0, 0.99);
    if code > 0.0 {
        (spread::KAPPA as f32 * (code / (1.0 - code)).powf(1.0 / spread::CODE_POWER as f32)).min(1.0)
    } else {
        0.0
    }
}

/// Larger and smaller eigenvalue of xx, xy, yy, 0 to 1, and the direction of the larger.
pub fn principal(matrix: Vec3) -> Roughness {
    let middle = 0.5 * (matrix.x + matrix.z);
    let half = 0.5 * (matrix.x - matrix.z);
    let gap = (half * half + matrix.y * matrix.y).sqrt();
    let axis = if half >= 0.0 { Vec2::new(gap + half, matrix.y) } else { Vec2::new(matrix.y, gap - half) };
    let length = axis.length();
    Roughness {
        major: (middle + gap).clamp(0.0, 1.0),
        minor: (middle - gap).clamp(0.0, 1.0),
        axis: if length > 1.0e-12 { axis / length } else { Vec2::X },
    }
}

/// `position` brought into the map: textures repeat, and far out f32 has no fractions of texels.
fn into_map(maps: &Maps<'_>, position: Vec2) -> Vec2 {
    let size = maps.size();
    let inside = match maps.wrap() {
        Wrap::Repeat => position - (position / size).floor() * size,
        Wrap::Clamp => position,
    };
    let inside = inside.clamp(-size, 2.0 * size);
    if inside.is_finite() { inside } else { Vec2::ZERO }
}

/// Mip of a footprint of `footprint_texels`, twice its standard deviation.
fn level(maps: &Maps<'_>, footprint_texels: f32) -> f32 {
    footprint_texels.max(1.0).log2().clamp(0.0, (maps.mips() - 1) as f32)
}

/// Unit vector along a mean normal. Normals of opposite sides can cancel; what is left has no direction then.
fn mean_direction(mean: Vec3) -> Vec3 {
    let length = mean.length();
    if length > 1.0e-4 { mean / length } else { Vec3::Z }
}

/// What lies under a footprint of `footprint_texels` (twice its standard deviation, which is the edge of the texels whose
/// bilinear look-up averages over as much) around `position`, in texels of the first mip.
pub fn fetch(maps: &Maps<'_>, position: Vec2, footprint_texels: f32) -> Surface {
    let place = into_map(maps, position);
    let footprint = footprint_texels.clamp(0.0, 1.0e9);
    let level = level(maps, footprint);
    let mean = maps.normals(place, level);
    // Under less than a texel the map is all but plane, and normals differ in proportion to the footprint.
    let fade = footprint.min(1.0);
    let alpha = alpha_of_code(mean.w) * fade;
    let mut by_direction = Roughness { major: alpha, minor: alpha, axis: Vec2::X };
    if maps.is_anisotropic() {
        let code = principal(maps.roughness(place, level).truncate());
        by_direction = Roughness {
            major: alpha_of_code(code.major) * fade,
            minor: alpha_of_code(code.minor) * fade,
            axis: code.axis,
        };
    }
    let mean = mean.truncate();
    Surface { normal: mean_direction(mean), length: mean.length(), alpha, by_direction }
}

/// Radiance towards `view` (unit) of what lies under a pixel: base roughness `base_alpha` convolved with the meso roughness
/// of all directions, or, with `lobes` above 0 (at most [`MAX_LOBES`]), with that of each direction.
pub fn surface_radiance(
    tables: &Tables,
    surface: &Surface,
    base_alpha: f32,
    view: Vec3,
    f0: f32,
    light: &RectLight,
    lobes: u32,
) -> f32 {
    if lobes == 0 {
        let alpha = convolve_alpha(base_alpha, surface.alpha);
        return isotropic_radiance(tables, surface.normal, alpha, view, f0, light);
    }
    if !faces(light) {
        return 0.0;
    }
    let lobes = lobes.min(MAX_LOBES);
    let meso = surface.by_direction;
    let spread = (meso.major * meso.major - meso.minor * meso.minor).max(0.0).sqrt();
    let minor = convolve_alpha(base_alpha, meso.minor);
    let major = convolve_alpha(minor, spread / lobes as f32);
    let (t, b) = tangent_frame(surface.normal);
    let along = t * meso.axis.x + b * meso.axis.y;
    let mut sum = 0.0;
    for k in 0..lobes {
        // Share (k + ½) / lobes of the marginal of GGX: x = spread · c / √(1 − c²).
        let c = (2 * k + 1) as f32 / lobes as f32 - 1.0;
        let tilted = surface.normal + along * (spread * c / (1.0 - c * c).sqrt());
        let normal = tilted / tilted.length();
        let (t, b) = tangent_frame(normal);
        let axis = Vec2::new(t.dot(along), b.dot(along));
        let lobe = Roughness { major, minor, axis: axis / axis.length().max(1.0e-6) };
        sum += lobe_radiance(tables, normal, lobe, view, f0, light);
    }
    sum / lobes as f32 * light.radiance
}
