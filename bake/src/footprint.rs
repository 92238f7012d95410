//! The pixel's footprint as a 2D Gaussian over a surface, in texels: [`Footprint`] in f64, and, as functions, what a shader does
//! in f32. Texel centres lie at i + ½.

use glam::{DMat2, DVec2, Vec2};

/// Where a pixel lies on a surface: uv, or whatever units the host measures a material's surface in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelOnSurface {
    /// Surface position at the pixel's centre.
    pub position: Vec2,
    /// Its derivative along the screen's x axis, a pixel.
    pub d_dx: Vec2,
    /// Its derivative along the screen's y axis, a pixel.
    pub d_dy: Vec2,
}

/// A footprint in f32, as a shader has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShaderFootprint {
    /// Centre, texels.
    pub mean: Vec2,
    /// Covariance along x, texels².
    pub xx: f32,
    /// Covariance of x with y, texels².
    pub xy: f32,
    /// Covariance along y, texels².
    pub yy: f32,
}

/// Principal axes of a footprint in f32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// Unit vector along the major axis; (1, 0) for a circle.
    pub axis: Vec2,
    /// Standard deviation along it, texels.
    pub major: f32,
    /// Standard deviation across it, texels.
    pub minor: f32,
}

/// Ellipse of a pixel's second moments, in squares of the units of its derivatives; its area is the pixel's over π/4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelAxes {
    /// Square of the longer axis.
    pub major2: f32,
    /// Square of the shorter one.
    pub minor2: f32,
    /// Vector at twice the longer axis's angle, `gap` long.
    pub difference: Vec2,
    /// Half the difference of the squares.
    pub gap: f32,
}

/// Footprint of a pixel at `mean` whose place moves by `d_dx` and `d_dy` (texels) a pixel along the screen's axes:
/// σ² (d_dx d_dxᵀ + d_dy d_dyᵀ). `pixel_sigma` is the standard deviation σ of the pixel's filter, in pixels.
pub fn footprint_of_pixel(mean: Vec2, d_dx: Vec2, d_dy: Vec2, pixel_sigma: f32) -> ShaderFootprint {
    let limit = Vec2::splat(1.0e8);
    let dx = (d_dx * pixel_sigma).clamp(-limit, limit);
    let dy = (d_dy * pixel_sigma).clamp(-limit, limit);
    ShaderFootprint {
        mean,
        xx: dx.x * dx.x + dy.x * dy.x,
        xy: dx.x * dx.y + dy.x * dy.y,
        yy: dx.y * dx.y + dy.y * dy.y,
    }
}

/// Parallelogram of a pixel whose place moves by `d_dx` and `d_dy` a pixel along the screen's axes, as the ellipse of its second moments.
pub fn pixel_axes(d_dx: Vec2, d_dy: Vec2) -> PixelAxes {
    let limit = Vec2::splat(1.0e8);
    let (dx, dy) = (d_dx.clamp(-limit, limit), d_dy.clamp(-limit, limit));
    let a = dx.x * dx.x + dy.x * dy.x;
    let b = dx.x * dx.y + dy.x * dy.y;
    let c = dx.y * dx.y + dy.y * dy.y;
    let half_difference = 0.5 * (a - c);
    let gap = (half_difference * half_difference + b * b).sqrt();
    let major2 = 0.5 * (a + c) + gap;
    // By the area, which keeps the digits of long pixels.
    let cross = dx.x * dy.y - dx.y * dy.x;
    PixelAxes { major2, minor2: cross * cross / major2.max(1.0e-30), difference: Vec2::new(half_difference, b), gap }
}

/// The leading 11 bits of a number. A product of two such parts is exact; what is left has 13.
fn upper_half(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & 0xffff_e000)
}

/// A number but for its last bit. Compilers of shaders take sums and products apart for speed, which costs the digits that are
/// kept by halves; they cannot look through integers.
fn keep(x: f32) -> f32 {
    f32::from_bits(x.to_bits() & 0xffff_fffe)
}

/// a c − b² with the digits that cancel, by exact products of halves.
fn determinant(a: f32, b: f32, c: f32) -> f32 {
    let ah = upper_half(a);
    let bh = upper_half(b);
    let ch = upper_half(c);
    let al = a - ah;
    let bl = b - bh;
    let cl = c - ch;
    let halves = keep(keep(ah * ch) - keep(bh * bh));
    let cross = keep(keep(ah * cl) - keep(bh * bl)) + keep(keep(al * ch) - keep(bh * bl));
    keep(halves + keep(cross)) + keep(al * cl - bl * bl)
}

/// Unit vector at half the angle of `v`, with x ≥ 0; (1, 0) for a zero vector.
fn half_angle(v: Vec2) -> Vec2 {
    let h = (v.x * v.x + v.y * v.y).sqrt();
    let up = if v.y >= 0.0 { 1.0 } else { -1.0 };
    let twice = if v.x >= 0.0 { Vec2::new(h + v.x, v.y) } else { Vec2::new(v.y.abs(), (h - v.x) * up) };
    let long = (twice.x * twice.x + twice.y * twice.y).sqrt();
    if long > 0.0 {
        return twice / long;
    }
    Vec2::X
}

/// Principal axes. The minor one follows from the determinant: four digits at an anisotropy of 1000, where the difference of
/// eigenvalues would have one.
pub fn principal(footprint: ShaderFootprint) -> Principal {
    // A power of two brings the numbers to order 1 without rounding.
    let exponent = (footprint.xx + footprint.yy).clamp(1.0e-30, 1.0e30).to_bits() & 0x7f80_0000;
    let down = f32::from_bits(0x7f00_0000 - exponent);
    let up = f32::from_bits(exponent);
    let a = footprint.xx * down;
    let b = footprint.xy * down;
    let c = footprint.yy * down;
    let half_gap = Vec2::new(0.5 * (a - c), b);
    let major2 = 0.5 * (a + c) + (half_gap.x * half_gap.x + half_gap.y * half_gap.y).sqrt();
    let minor2 = determinant(a, b, c).max(0.0) / major2.max(1.0e-30);
    Principal { axis: half_angle(half_gap), major: (major2 * up).sqrt(), minor: (minor2.min(major2) * up).sqrt() }
}

/// Gaussian footprint: mean and covariance in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Centre in texels.
    pub mean: DVec2,
    /// Covariance in texels².
    pub covariance: DMat2,
}

impl Footprint {
    /// Footprint with standard deviation `sigma_texels` along its minor axis and `anisotropy` times that along its
    /// major axis, which is turned by `angle` radians from +u.
    pub fn new(mean: DVec2, sigma_texels: f64, anisotropy: f64, angle: f64) -> Footprint {
        let axis = DVec2::from_angle(angle);
        let major = (sigma_texels * anisotropy).powi(2);
        let minor = sigma_texels.powi(2);
        let outer = DMat2::from_cols(axis * axis.x, axis * axis.y);
        let covariance = outer * (major - minor) + DMat2::IDENTITY * minor;
        Footprint { mean, covariance }
    }

    /// Standard deviations along the principal axes (minor, major) and the direction of the major axis.
    pub fn principal(&self) -> (f64, f64, DVec2) {
        let (a, b, c) = (self.covariance.x_axis.x, self.covariance.x_axis.y, self.covariance.y_axis.y);
        let mid = 0.5 * (a + c);
        let half_gap = (0.5 * (a - c)).hypot(b);
        let major = (mid + half_gap).max(0.0);
        let minor = (mid - half_gap).max(0.0);
        let angle = 0.5 * libm::atan2(2.0 * b, a - c);
        (minor.sqrt(), major.sqrt(), DVec2::from_angle(angle))
    }

    /// The footprint seen in coordinates x' = m · x + offset.
    pub fn transformed(&self, m: DMat2, offset: DVec2) -> Footprint {
        Footprint { mean: m * self.mean + offset, covariance: m * self.covariance * m.transpose() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_axes_in_f32_are_those_of_f64() {
        for (sigma, anisotropy) in [(0.01, 1.0), (0.5, 4.0), (3.0, 30.0), (10.0, 1000.0)] {
            for turn in 0..32 {
                let exact = Footprint::new(DVec2::ZERO, sigma, anisotropy, 0.1 * f64::from(turn));
                let DMat2 { x_axis, y_axis } = exact.covariance;
                let [xx, xy, yy] = [x_axis.x, x_axis.y, y_axis.y].map(|v| v as f32);
                let found = principal(ShaderFootprint { mean: Vec2::ZERO, xx, xy, yy });
                let given = DMat2::from_cols_array(&[xx, xy, xy, yy].map(f64::from));
                let (_, major, axis) = Footprint { covariance: given, ..exact }.principal();
                let minor = (given.determinant().max(0.0) / (major * major)).sqrt();
                assert!((f64::from(found.major) / major - 1.0).abs() < 1e-6, "{sigma} {anisotropy}");
                assert!((f64::from(found.minor) - minor).abs() < 1e-3 * minor, "{sigma} {anisotropy} {found:?}");
                if anisotropy > 1.0 {
                    assert!(found.axis.as_dvec2().dot(axis).abs() > 1.0 - 1e-6, "{sigma} {anisotropy}");
                }
            }
        }
    }
}
