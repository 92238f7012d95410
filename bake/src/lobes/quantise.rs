//! Lobes in 16 or 32 bytes, and back.
//!
//! Never the 4 × 4 matrix, whose rounded entries need not be a covariance: positions' covariance by standard deviations and
//! a correlation, the Jacobian, and the normals' residual likewise, so that any bytes decode to a positive definite lobe. Each
//! part is rounded first and the next one computed against the rounded, so that the residual takes up their errors.

use super::baked::BakedLobes;
use super::eval::Lobe;
use super::gaussian::Gaussian4;
use super::{half, packed};
use ::half::f16;
use glam::{DMat2, DVec2, Vec2};
use glint_formats::lobes::{
    HalfLobe, LevelUniform, LobeLevel, LobeStorage, LobesParams, MAX_CORRELATION, MAX_SIGMA_RATIO, PackedLobe,
};

impl BakedLobes {
    /// A lobe by its index among all; `level` is its level.
    pub(crate) fn lobe(&self, level: &LevelUniform, index: u32) -> Lobe {
        let stride = self.params.storage.stride() as usize;
        let bytes = &self.lobes[index as usize * stride..][..stride];
        match self.params.storage {
            LobeStorage::Packed => packed::lobe(&self.params, level, &bytemuck::pod_read_unaligned(bytes)),
            LobeStorage::Half => half::lobe(&self.params, level, &bytemuck::pod_read_unaligned(bytes)),
        }
    }
}

/// Ranges of a level that its lobes are stored over. Cell indices and first lobe are the caller's.
pub(super) fn ranges<'a>(lobes: impl Iterator<Item = &'a Gaussian4>, level: LobeLevel) -> LobeLevel {
    let (mut weight, mut jacobian, mut residual) = (0.0f64, 0.0f64, 0.0f64);
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    for lobe in lobes {
        let (slope, positions) = (lobe.jacobian(), lobe.position_covariance());
        weight = weight.max(lobe.weight);
        jacobian = slope.to_cols_array().into_iter().fold(jacobian, |a, v| a.max(v.abs()));
        let rest = lobe.residual(slope, positions);
        for variance in [rest.x_axis.x, rest.y_axis.y] {
            residual = residual.max(variance.max(0.0).sqrt());
        }
        for variance in [positions.x_axis.x, positions.y_axis.y] {
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
pub(super) fn encode(
    lobe: Option<&Gaussian4>,
    corner: DVec2,
    params: &LobesParams,
    level: &LobeLevel,
    out: &mut Vec<u8>,
) {
    match params.storage {
        LobeStorage::Packed => {
            let record = lobe.map_or_else(PackedLobe::default, |lobe| packed_record(lobe, corner, params, level));
            out.extend_from_slice(bytemuck::bytes_of(&record));
        }
        LobeStorage::Half => {
            let record = lobe.map_or_else(HalfLobe::default, |lobe| half_record(lobe, corner, params, level));
            out.extend_from_slice(bytemuck::bytes_of(&record));
        }
    }
}

fn packed_record(lobe: &Gaussian4, corner: DVec2, params: &LobesParams, level: &LobeLevel) -> PackedLobe {
    let unorm = |v: f64, most: f64| (v * most).round().clamp(0.0, most);
    let (position, normal) = relative(lobe, corner, params, level);
    let mut record = PackedLobe {
        normal_weight: unorm(normal.x, 4095.0) as u32
            | (unorm(normal.y, 4095.0) as u32) << 12
            | (unorm((lobe.weight / level.weight_scale as f64).sqrt(), 255.0).max(1.0) as u32) << 24,
        position: [unorm(position.x, 255.0) as u8, unorm(position.y, 255.0) as u8],
        ..PackedLobe::default()
    };
    let positions = Rounded::of(lobe.position_covariance());
    let correlation = |v: f64| (v / MAX_CORRELATION as f64 * 127.0).round().clamp(-127.0, 127.0) as i8;
    record.position_sigma = positions.sigmas.map(|sigma| unorm(log_place(sigma, level.position_sigma), 255.0) as u8);
    record.correlation[0] = correlation(positions.correlation);
    record.jacobian = lobe.jacobian().to_cols_array().map(|v| {
        let q = (v.abs() / (level.jacobian_scale as f64).max(f64::MIN_POSITIVE)).sqrt().copysign(v);
        (q * 127.0).round().clamp(-127.0, 127.0) as i8
    });
    let residual = Rounded::of(rest(lobe, &packed::lobe(params, &params.level_uniform(level), &record)));
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

fn half_record(lobe: &Gaussian4, corner: DVec2, params: &LobesParams, level: &LobeLevel) -> HalfLobe {
    let unorm = |v: f64| (v * 65535.0).round().clamp(0.0, 65535.0) as u16;
    let float = |v: f64| f16::from_f32(v as f32).to_bits();
    let (position, normal) = relative(lobe, corner, params, level);
    let positions = Rounded::of(lobe.position_covariance());
    let correlation = |v: f64| (v / MAX_CORRELATION as f64 * 32767.0).round().clamp(-32767.0, 32767.0) as i16;
    let mut record = HalfLobe {
        jacobian: lobe.jacobian().to_cols_array().map(float),
        normal: [unorm(normal.x), unorm(normal.y)],
        position: [unorm(position.x), unorm(position.y)],
        position_sigma: positions.sigmas.map(float),
        correlation: [correlation(positions.correlation), 0],
        weight: float(lobe.weight / level.weight_scale as f64),
        ..HalfLobe::default()
    };
    let residual = Rounded::of(rest(lobe, &half::lobe(params, &params.level_uniform(level), &record)));
    record.residual_sigma = residual.sigmas.map(float);
    record.correlation[1] = correlation(residual.correlation);
    record
}

/// Position and normal in their ranges, 0 to 1.
fn relative(lobe: &Gaussian4, corner: DVec2, params: &LobesParams, level: &LobeLevel) -> (DVec2, DVec2) {
    let extent = Vec2::from(params.extent(level)).as_dvec2();
    let [low, range] = [params.normal_low, params.normal_extent].map(|v| Vec2::from(v).as_dvec2());
    let within = (lobe.normal() - low) / range.max(DVec2::splat(f64::MIN_POSITIVE));
    ((lobe.position() - corner) / extent, within)
}

/// What the rounded covariance of positions and Jacobian leave of the covariance of normals.
fn rest(lobe: &Gaussian4, rounded: &Lobe) -> DMat2 {
    let factor = rounded.factor.as_dmat2();
    lobe.residual(rounded.jacobian.as_dmat2(), factor * factor.transpose())
}

/// A covariance by its standard deviations and correlation, at most [`MAX_CORRELATION`].
struct Rounded {
    sigmas: [f64; 2],
    correlation: f64,
}

impl Rounded {
    /// The nearest covariance to a symmetric matrix: its eigenvalues below 0 become 0.
    fn of(m: DMat2) -> Rounded {
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
        Rounded { sigmas, correlation: if product > 0.0 { (b / product).clamp(-most, most) } else { 0.0 } }
    }
}

/// Place of log σ in a range, 0 to 1.
fn log_place(sigma: f64, [low, high]: [f32; 2]) -> f64 {
    let ratio = libm::log(high as f64 / low as f64);
    if ratio > 0.0 { libm::log(sigma / low as f64) / ratio } else { 0.0 }
}
