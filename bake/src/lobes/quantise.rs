//! Lobes in 16 or 32 bytes, and back.
//!
//! Never the 4 × 4 matrix, whose rounded entries need not be a covariance: positions' spread by deviations and a
//! correlation, the Jacobian, and the normals' residual likewise, so that any bytes decode to a positive definite lobe. Each
//! part is rounded first and the next one computed against the rounded, so that the residual takes up their errors.

use super::gaussian::Gaussian4;
use glam::{DMat2, DVec2, Mat2, Vec2};
use glint_formats::lobes::{
    HalfLobe, LobeLevel, LobeStorage, LobesParams, MAX_CORRELATION, MAX_SIGMA_RATIO, PackedLobe,
};
use half::f16;

/// A lobe as a query uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Weight in texels; 0 is no lobe.
    pub weight: f32,
    /// Mean position from the cell's corner, in texels.
    pub position: Vec2,
    /// Mean projected normal.
    pub normal: Vec2,
    /// Factor of the covariance of positions: Σ_uu = F Fᵀ.
    pub spread: Mat2,
    /// ∂s/∂u per texel.
    pub jacobian: Mat2,
    /// Factor of the residual covariance of normals, σ_r² not in it.
    pub residual: Mat2,
}

/// What a cell's stored positions are relative to: the cell's edge, cut to the map.
fn nominal_extent(params: &LobesParams, level: &LobeLevel) -> Vec2 {
    Vec2::from(params.extent(level))
}

/// A level's ranges, with what every lobe would compute of them anew.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    level: LobeLevel,
    extent: Vec2,
    /// log₂ of largest over smallest deviation, of positions and of residuals.
    log_ratio: [f32; 2],
}

impl Scales {
    /// Scales of a level.
    pub fn new(params: &LobesParams, level: &LobeLevel) -> Scales {
        let log_ratio = [level.position_sigma, level.residual_sigma].map(|[low, high]| libm::log2f(high / low));
        Scales { level: *level, extent: nominal_extent(params, level), log_ratio }
    }

    fn position_sigma(&self, code: u8) -> f32 {
        self.level.position_sigma[0] * libm::exp2f(code as f32 / 255.0 * self.log_ratio[0])
    }

    fn residual_sigma(&self, code: u8) -> f32 {
        match code {
            0 => 0.0,
            _ => self.level.residual_sigma[0] * libm::exp2f((code - 1) as f32 / 254.0 * self.log_ratio[1]),
        }
    }
}

/// Ranges of a level that its lobes are stored over. Cell indices and first lobe are the caller's.
pub fn ranges<'a>(lobes: impl Iterator<Item = &'a Gaussian4>, level: LobeLevel) -> LobeLevel {
    let (mut weight, mut jacobian, mut residual) = (0.0f64, 0.0f64, 0.0f64);
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    for lobe in lobes {
        let (slope, spread) = (lobe.jacobian(), lobe.spread());
        weight = weight.max(lobe.weight);
        jacobian = slope.to_cols_array().into_iter().fold(jacobian, |a, v| a.max(v.abs()));
        let rest = lobe.residual(slope, spread);
        for variance in [rest.x_axis.x, rest.y_axis.y] {
            residual = residual.max(variance.max(0.0).sqrt());
        }
        for variance in [spread.x_axis.x, spread.y_axis.y] {
            low = low.min(variance.sqrt());
            high = high.max(variance.sqrt());
        }
    }
    let high = if high > 0.0 { high as f32 } else { 1.0 };
    // A range above 0 keeps the logarithm finite where there is no residual at all.
    let residual = (residual as f32).max(1e-9);
    LobeLevel {
        weight_scale: if weight > 0.0 { weight as f32 } else { 1.0 },
        position_sigma: [(low as f32).clamp(high / MAX_SIGMA_RATIO, high), high],
        residual_sigma: [residual / RESIDUAL_RATIO, residual],
        jacobian_scale: jacobian as f32,
        ..level
    }
}

/// Residuals below this part of the level's largest are 0.
const RESIDUAL_RATIO: f32 = 4096.0;

/// Appends the bytes of a lobe whose cell has its corner at `corner`; no lobe has the bytes of zeros.
pub fn encode(lobe: Option<&Gaussian4>, corner: DVec2, params: &LobesParams, level: &LobeLevel, out: &mut Vec<u8>) {
    match params.storage {
        LobeStorage::Packed => {
            let record = lobe.map_or_else(PackedLobe::default, |lobe| packed(lobe, corner, params, level));
            out.extend_from_slice(bytemuck::bytes_of(&record));
        }
        LobeStorage::Half => {
            let record = lobe.map_or_else(HalfLobe::default, |lobe| half(lobe, corner, params, level));
            out.extend_from_slice(bytemuck::bytes_of(&record));
        }
    }
}

fn packed(lobe: &Gaussian4, corner: DVec2, params: &LobesParams, level: &LobeLevel) -> PackedLobe {
    let unorm = |v: f64, most: f64| (v * most).round().clamp(0.0, most);
    let (position, normal) = relative(lobe, corner, params, level);
    let mut record = PackedLobe {
        normal_weight: unorm(normal.x, 4095.0) as u32
            | (unorm(normal.y, 4095.0) as u32) << 12
            | (unorm((lobe.weight / level.weight_scale as f64).sqrt(), 255.0).max(1.0) as u32) << 24,
        position: [unorm(position.x, 255.0) as u8, unorm(position.y, 255.0) as u8],
        ..PackedLobe::default()
    };
    let spread = Ellipse::of(lobe.spread());
    let correlation = |v: f64| (v / MAX_CORRELATION as f64 * 127.0).round().clamp(-127.0, 127.0) as i8;
    record.position_sigma = spread.sigmas.map(|sigma| unorm(log_place(sigma, level.position_sigma), 255.0) as u8);
    record.correlation[0] = correlation(spread.correlation);
    record.jacobian = lobe.jacobian().to_cols_array().map(|v| {
        let q = (v.abs() / (level.jacobian_scale as f64).max(f64::MIN_POSITIVE)).sqrt().copysign(v);
        (q * 127.0).round().clamp(-127.0, 127.0) as i8
    });
    let residual = Ellipse::of(rest(lobe, &decode_packed(&record, params, &Scales::new(params, level))));
    record.residual_sigma = residual.sigmas.map(|sigma| {
        if sigma < 0.7 * level.residual_sigma[0] as f64 || sigma <= 0.0 {
            0
        } else {
            1 + unorm(log_place(sigma, level.residual_sigma), 254.0) as u8
        }
    });
    record.correlation[1] = correlation(residual.correlation);
    record
}

fn half(lobe: &Gaussian4, corner: DVec2, params: &LobesParams, level: &LobeLevel) -> HalfLobe {
    let unorm = |v: f64| (v * 65535.0).round().clamp(0.0, 65535.0) as u16;
    let float = |v: f64| f16::from_f32(v as f32).to_bits();
    let (position, normal) = relative(lobe, corner, params, level);
    let spread = Ellipse::of(lobe.spread());
    let correlation = |v: f64| (v / MAX_CORRELATION as f64 * 32767.0).round().clamp(-32767.0, 32767.0) as i16;
    let mut record = HalfLobe {
        jacobian: lobe.jacobian().to_cols_array().map(float),
        normal: [unorm(normal.x), unorm(normal.y)],
        position: [unorm(position.x), unorm(position.y)],
        position_sigma: spread.sigmas.map(float),
        correlation: [correlation(spread.correlation), 0],
        weight: float(lobe.weight / level.weight_scale as f64),
        ..HalfLobe::default()
    };
    let residual = Ellipse::of(rest(lobe, &decode_half(&record, params, &Scales::new(params, level))));
    record.residual_sigma = residual.sigmas.map(float);
    record.correlation[1] = correlation(residual.correlation);
    record
}

/// Position and normal in their ranges, 0 to 1.
fn relative(lobe: &Gaussian4, corner: DVec2, params: &LobesParams, level: &LobeLevel) -> (DVec2, DVec2) {
    let extent = nominal_extent(params, level).as_dvec2();
    let [low, range] = [params.normal_low, params.normal_extent].map(|v| Vec2::from(v).as_dvec2());
    let within = (lobe.normal() - low) / range.max(DVec2::splat(f64::MIN_POSITIVE));
    ((lobe.position() - corner) / extent, within)
}

/// What the rounded spread and Jacobian leave of the covariance of normals.
fn rest(lobe: &Gaussian4, rounded: &Lobe) -> DMat2 {
    let spread = rounded.spread.as_dmat2();
    lobe.residual(rounded.jacobian.as_dmat2(), spread * spread.transpose())
}

/// A covariance by its deviations and correlation.
struct Ellipse {
    sigmas: [f64; 2],
    correlation: f64,
}

impl Ellipse {
    /// The nearest covariance to a symmetric matrix: its eigenvalues below 0 become 0.
    fn of(m: DMat2) -> Ellipse {
        let (a, b, c) = (m.x_axis.x, 0.5 * (m.x_axis.y + m.y_axis.x), m.y_axis.y);
        let (mid, half_gap) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
        let (mut a, mut b, mut c) = (a, b, c);
        if mid - half_gap < 0.0 {
            // One eigenvalue left, along the major axis: λ e eᵀ with e eᵀ = ½ I + (m − mid I) / (2 half_gap).
            let keep = (mid + half_gap).max(0.0);
            let scale = if half_gap > 0.0 { 0.5 * keep / half_gap } else { 0.0 };
            (a, b, c) = ((a - mid + half_gap) * scale, b * scale, (c - mid + half_gap) * scale);
        }
        let sigmas = [a, c].map(|v| v.max(0.0).sqrt());
        let product = sigmas[0] * sigmas[1];
        let most = MAX_CORRELATION as f64;
        Ellipse { sigmas, correlation: if product > 0.0 { (b / product).clamp(-most, most) } else { 0.0 } }
    }
}

/// Place of log σ in a range, 0 to 1.
fn log_place(sigma: f64, [low, high]: [f32; 2]) -> f64 {
    let ratio = libm::log(high as f64 / low as f64);
    if ratio > 0.0 { libm::log(sigma / low as f64) / ratio } else { 0.0 }
}

/// Factor F of a covariance F Fᵀ.
fn factor(sigmas: [f32; 2], correlation: f32) -> Mat2 {
    let rest = (1.0 - correlation * correlation).sqrt();
    Mat2::from_cols(Vec2::new(sigmas[0], correlation * sigmas[1]), Vec2::new(0.0, rest * sigmas[1]))
}

/// The lobe in a record.
pub fn decode_packed(record: &PackedLobe, params: &LobesParams, scales: &Scales) -> Lobe {
    let level = &scales.level;
    let word = record.normal_weight;
    let normal = Vec2::new((word & 0xfff) as f32, (word >> 12 & 0xfff) as f32) / 4095.0;
    let root = (word >> 24) as f32 / 255.0;
    let correlation = record.correlation.map(|c| c as f32 / 127.0 * MAX_CORRELATION);
    let jacobian = record.jacobian.map(|c| {
        let q = c as f32 / 127.0;
        level.jacobian_scale * q * q.abs()
    });
    let residual = record.residual_sigma.map(|code| scales.residual_sigma(code));
    let position = Vec2::new(record.position[0] as f32, record.position[1] as f32) / 255.0;
    Lobe {
        weight: level.weight_scale * root * root,
        position: position * scales.extent,
        normal: Vec2::from(params.normal_low) + normal * Vec2::from(params.normal_extent),
        spread: factor(record.position_sigma.map(|code| scales.position_sigma(code)), correlation[0]),
        jacobian: Mat2::from_cols_array(&jacobian),
        residual: factor(residual, correlation[1]),
    }
}

/// The lobe in a record.
pub fn decode_half(record: &HalfLobe, params: &LobesParams, scales: &Scales) -> Lobe {
    let float = |bits: u16| f16::from_bits(bits).to_f32();
    let unorm = |v: [u16; 2]| Vec2::new(v[0] as f32, v[1] as f32) / 65535.0;
    let correlation = record.correlation.map(|c| c as f32 / 32767.0 * MAX_CORRELATION);
    Lobe {
        weight: scales.level.weight_scale * float(record.weight),
        position: unorm(record.position) * scales.extent,
        normal: Vec2::from(params.normal_low) + unorm(record.normal) * Vec2::from(params.normal_extent),
        spread: factor(record.position_sigma.map(float), correlation[0]),
        jacobian: Mat2::from_cols_array(&record.jacobian.map(float)),
        residual: factor(record.residual_sigma.map(float), correlation[1]),
    }
}
