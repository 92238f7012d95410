//! One tile's NDF as a grid of values: candidates from coarse to fine, each fitted, quantised and measured.
//!
//! The paper samples every tile at 128² over [−1, 1]² (Xing et al. 2024, section 5.2, Eq. 2). Here each tile has a box
//! around its own normals, its density is the integral over the tile of one lobe of standard deviation σ_r a normal (not
//! a sum over one lobe a texel), and values are fitted by least squares to what spline interpolation will reconstruct,
//! with as few texels along each axis as the error asked for allows.

use super::eval::spline;
use super::fine_grid::{FineGrid, LobeNorm};
use super::micro_normals::TexelRect;
use super::spline::{Fit, add_scaled, spline_integral};
use crate::normal_map::NormalMap;
use glam::DVec2;
use glint_formats::ndf_maps::DensityStorage;
use half::f16;
use multiversion::multiversion;

/// Finest and coarsest texel spacing tried, in fine nodes.
const STEPS: (usize, usize) = (1, 9);

/// A tile's fitted values, quantised: what the pack holds.
#[derive(Clone, Debug)]
pub(super) struct FittedTile {
    /// Projected normal of texel (0, 0).
    pub origin: [f64; 2],
    /// Texel spacing along both axes.
    pub spacing: [f64; 2],
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Density that a stored 1.0 stands for.
    pub scale: f32,
    /// Encoded texels, row-major.
    pub bytes: Vec<u8>,
    /// E₁ against the fine grid.
    pub error: f64,
    /// |∫D̂ − 1| over the disk after the scale was set.
    pub energy: f64,
}

/// What every tile of an example shares.
#[derive(Clone, Debug)]
pub(super) struct FitSettings {
    /// σ_r.
    pub roughness: f64,
    /// E₁ wanted on average over tiles.
    pub max_error: f64,
    /// How values are stored.
    pub storage: DensityStorage,
    /// Reciprocal mass of lobes inside the disk.
    pub norm: LobeNorm,
}

/// Fits one tile at spacings around the one that has the error asked for: candidates to choose from, of which the
/// first is the most accurate.
pub(super) fn fit_tile(map: &NormalMap, rect: TexelRect, settings: &FitSettings) -> Vec<FittedTile> {
    let fine = FineGrid::new(map, rect, settings.roughness, &settings.norm);
    if settings.storage == DensityStorage::PaperF32 {
        return vec![paper_tile(&fine)];
    }
    let mut candidates = Candidates { columns: ColumnFits::new(&fine), storage: settings.storage, tried: Vec::new() };
    // Errors shrink with the spacing: bisect for the coarsest that both axes may have.
    let (mut low, mut high) = STEPS;
    while low < high {
        let step = (low + high).div_ceil(2);
        if candidates.error([step, step]) <= settings.max_error {
            low = step;
        } else {
            high = step - 1;
        }
    }
    // A streak is smooth along its length and needs fewer texels there, so both axes vary on their own around it.
    let around = |d: i64| (low as i64 + d).clamp(STEPS.0 as i64, STEPS.1 as i64) as usize;
    for (dx, dy) in [(-1, 0), (0, -1), (0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)] {
        candidates.error([around(dx), around(dy)]);
    }
    let mut tiles: Vec<FittedTile> = candidates.tried.into_iter().map(|(_, tile)| tile).collect();
    tiles.sort_by(|a, b| a.error.total_cmp(&b.error));
    tiles
}

/// Fits of one tile, each made once.
struct Candidates<'a> {
    columns: ColumnFits<'a>,
    storage: DensityStorage,
    tried: Vec<([usize; 2], FittedTile)>,
}

impl Candidates<'_> {
    /// Error of the fit with texels `steps` fine nodes apart.
    fn error(&mut self, steps: [usize; 2]) -> f64 {
        if let Some((_, tile)) = self.tried.iter().find(|(tried, _)| *tried == steps) {
            return tile.error;
        }
        let tile = fit_splines(&mut self.columns, steps, self.storage);
        let error = tile.error;
        self.tried.push((steps, tile));
        error
    }
}

/// The fine grid's columns fitted at each spacing, transposed (element (j, i) at i · height + j); made once a spacing.
struct ColumnFits<'a> {
    fine: &'a FineGrid,
    by_step: Vec<Option<Vec<f32>>>,
}

impl ColumnFits<'_> {
    fn new(fine: &FineGrid) -> ColumnFits<'_> {
        ColumnFits { fine, by_step: vec![None; STEPS.1 + 1] }
    }

    fn get(&mut self, step: usize) -> &[f32] {
        let fine = self.fine;
        self.by_step[step].get_or_insert_with(|| {
            let fit = Fit::new(fine.height, step);
            transposed(&fit.solve(&fine.density, fine.width), fine.width)
        })
    }
}

fn transposed(values: &[f32], width: usize) -> Vec<f32> {
    let height = values.len() / width;
    let mut out = vec![0.0; values.len()];
    for (j, row) in values.chunks_exact(width).enumerate() {
        for (i, v) in row.iter().enumerate() {
            out[i * height + j] = *v;
        }
    }
    out
}

/// Least-squares fit with texels `steps` fine nodes apart, quantised, with its error.
fn fit_splines(columns: &mut ColumnFits, steps: [usize; 2], storage: DensityStorage) -> FittedTile {
    let fine = columns.fine;
    let across = Fit::new(fine.width, steps[0]);
    let columns = columns.get(steps[1]);
    let (width, height) = (across.nodes(), columns.len() / fine.width);
    let mut values = transposed(&across.solve(columns, height), height);
    values.iter_mut().for_each(|v| *v = v.max(0.0));
    let spacing = steps.map(|step| fine.spacing * step as f64);
    let origin = fine.origin.to_array();
    let bytes = encode(&mut values, storage);
    // Normalised after rounding, so that what is decoded integrates to one.
    let integral = spline_integral(&values, width, height, origin, spacing);
    let scale = (1.0 / integral) as f32;
    let error = spline_error(fine, &values, width, steps, scale);
    FittedTile { origin, spacing, width, height, scale, bytes, error, energy: (scale as f64 * integral - 1.0).abs() }
}

/// Encodes values relative to the largest and replaces them by what will be decoded.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn encode(values: &mut [f32], storage: DensityStorage) -> Vec<u8> {
    let peak = values.iter().fold(0.0f32, |a, b| a.max(*b)).max(f32::MIN_POSITIVE);
    let mut bytes = Vec::with_capacity(values.len() * storage.texel_bytes() as usize);
    for v in values {
        let relative = *v / peak;
        match storage {
            DensityStorage::SqrtU8 => {
                let q = (relative.sqrt() * 255.0).round() as u8;
                bytes.push(q);
                *v = (q as f32 / 255.0).powi(2);
            }
            DensityStorage::F16 => {
                let q = f16::from_f32(relative);
                bytes.extend_from_slice(&q.to_le_bytes());
                *v = q.to_f32();
            }
            DensityStorage::PaperF32 => bytes.extend_from_slice(&v.to_le_bytes()),
        }
    }
    bytes
}

/// E₁ of decoded values over the fine nodes inside the disk.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn spline_error(fine: &FineGrid, values: &[f32], width: usize, steps: [usize; 2], scale: f32) -> f64 {
    // Spread every row of values over the fine columns, then blend three such rows for every fine row.
    let taps: Vec<(usize, [f32; 3])> = (0..fine.width)
        .map(|i| spline(i as f32 / steps[0] as f32))
        .map(|taps| ((taps.first + 1) as usize, taps.weights))
        .collect();
    let mut spread = vec![0.0f32; values.len() / width * fine.width];
    let mut padded = vec![0.0f32; width + 2];
    for (row, spread) in values.chunks_exact(width).zip(spread.chunks_exact_mut(fine.width)) {
        padded[1..=width].copy_from_slice(row);
        for (out, (at, weights)) in spread.iter_mut().zip(&taps) {
            let three = &padded[*at..*at + 3];
            *out = weights[0] * three[0] + weights[1] * three[1] + weights[2] * three[2];
        }
    }
    let height = values.len() / width;
    let mut decoded = vec![0.0f32; fine.width];
    let (mut difference, mut total) = (0.0f64, 0.0f64);
    for j in 0..fine.height {
        let Some(columns) = fine.columns_inside(j) else { continue };
        let rows = spline(j as f32 / steps[1] as f32);
        decoded.fill(0.0);
        for (k, weight) in rows.weights.into_iter().enumerate() {
            let row = rows.first + k as i32;
            if row >= 0 && row < height as i32 {
                let source = &spread[row as usize * fine.width..(row as usize + 1) * fine.width];
                add_scaled(&mut decoded, source, weight * scale);
            }
        }
        let exact = &fine.density[j * fine.width..(j + 1) * fine.width];
        let (d, t) = difference_and_total(&decoded[columns.clone()], &exact[columns]);
        difference += d as f64;
        total += t as f64;
    }
    difference / total.max(f64::MIN_POSITIVE)
}

/// Σ|a − b| and Σb, in eight lanes; inlined, so that it has the vectors of its caller.
#[inline(always)]
fn difference_and_total(a: &[f32], b: &[f32]) -> (f32, f32) {
    let (mut differences, mut totals) = ([0.0f32; 8], [0.0f32; 8]);
    let (a8, b8) = (a.chunks_exact(8), b.chunks_exact(8));
    let mut tail = (0.0f32, 0.0f32);
    for (x, y) in a8.remainder().iter().zip(b8.remainder()) {
        tail = (tail.0 + (x - y).abs(), tail.1 + y);
    }
    for (x, y) in a8.zip(b8) {
        for k in 0..8 {
            differences[k] += (x[k] - y[k]).abs();
            totals[k] += y[k];
        }
    }
    (differences.iter().sum::<f32>() + tail.0, totals.iter().sum::<f32>() + tail.1)
}

/// The paper's storage: density at 128 × 128 texel centres over [−1, 1]², as floats, bilinear, not normalised.
fn paper_tile(fine: &FineGrid) -> FittedTile {
    const N: usize = 128;
    let spacing = 2.0 / N as f64;
    let origin = -1.0 + 0.5 * spacing;
    let mut values = vec![0.0f32; N * N];
    for j in 0..N {
        for i in 0..N {
            let s = DVec2::new(origin + spacing * i as f64, origin + spacing * j as f64);
            if s.length_squared() <= 1.0 {
                values[j * N + i] = fine.at(s);
            }
        }
    }
    let bytes = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    let decode = |s: DVec2| {
        let p = (s - origin) / spacing;
        let cell = p.floor();
        let f = (p - cell).as_vec2();
        let texel = |i: f64, j: f64| {
            let inside = i >= 0.0 && j >= 0.0 && i < N as f64 && j < N as f64;
            if inside { values[j as usize * N + i as usize] } else { 0.0 }
        };
        let row = |j: f64| texel(cell.x, j) * (1.0 - f.x) + texel(cell.x + 1.0, j) * f.x;
        row(cell.y) * (1.0 - f.y) + row(cell.y + 1.0) * f.y
    };
    let (mut difference, mut total, mut integral) = (0.0f64, 0.0f64, 0.0f64);
    for j in 0..fine.height {
        for i in fine.columns_inside(j).unwrap_or(0..0) {
            let s = fine.origin + DVec2::new(i as f64, j as f64) * fine.spacing;
            let exact = fine.density[j * fine.width + i];
            let decoded = decode(s);
            difference += (decoded - exact).abs() as f64;
            total += exact as f64;
            integral += decoded as f64;
        }
    }
    FittedTile {
        origin: [origin; 2],
        spacing: [spacing; 2],
        width: N,
        height: N,
        scale: 1.0,
        bytes,
        error: difference / total.max(f64::MIN_POSITIVE),
        energy: (integral * fine.spacing * fine.spacing - 1.0).abs(),
    }
}
