//! One tile's NDF as a grid of values: the exact density on a fine grid, then the coarsest grid that reproduces it.
//!
//! The paper samples every tile at 128² over [−1, 1]². Here each tile has a box around its own normals, and values are
//! fitted by least squares to what bilinear interpolation will reconstruct, so that texels may be up to about one
//! intrinsic roughness apart (Xing et al. 2024, section 5.2, Eq. 2; the density is the integral over the tile of one
//! lobe of standard deviation σ_r a normal, not a sum over one lobe a texel).

use super::disk::{self, LobeNorm};
use super::micro_normals::{self, TexelRect};
use crate::normal_map::NormalMap;
use glam::DVec2;
use glint_formats::ndf_maps::DensityStorage;
use half::f16;

/// Fine grid nodes per σ_r.
const FINE_PER_SIGMA: f64 = 4.0;
/// How far the box reaches beyond the outermost normal, in σ_r: 0.05 % of a lobe's mass lies farther out.
const MARGIN_SIGMAS: f64 = 3.5;
/// Largest fine grid along one axis; a smaller σ_r than this resolves is widened, which the measured error shows.
const MAX_FINE: usize = 768;
/// Micro-normal samples per σ_r along a path through the disk.
const SAMPLES_PER_SIGMA: f64 = 2.5;
/// Samples along an edge of a quarter texel at most.
const MAX_SAMPLES: u32 = 128;
/// Coarsest spacing tried, in fine nodes.
const MAX_STEP: usize = 10;

/// A tile's fitted values, quantised: what the pack holds.
#[derive(Clone, Debug)]
pub struct FittedTile {
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
pub struct FitSettings {
    /// σ_r.
    pub roughness: f64,
    /// E₁ wanted of every tile.
    pub max_error: f64,
    /// How values are stored.
    pub storage: DensityStorage,
    /// Reciprocal mass of lobes inside the disk.
    pub norm: LobeNorm,
}

/// Fits one tile.
pub fn fit_tile(map: &NormalMap, rect: TexelRect, settings: &FitSettings) -> FittedTile {
    let fine = FineGrid::new(map, rect, settings);
    if settings.storage == DensityStorage::PaperF32 {
        return paper_tile(&fine);
    }
    // Errors shrink with the spacing: find the coarsest spacing that both axes may have, then widen each alone, since
    // a streak is smooth along its length and needs fewer texels there.
    let (mut low, mut high) = (1, MAX_STEP);
    let mut best = None;
    while low <= high {
        let step = (low + high) / 2;
        let tile = fine.fit([step, step], settings.storage);
        if tile.error <= settings.max_error {
            best = Some(([step, step], tile));
            low = step + 1;
        } else {
            high = step - 1;
        }
    }
    let Some((mut steps, mut tile)) = best else {
        return fine.fit([1, 1], settings.storage);
    };
    for axis in [0, 1] {
        loop {
            let mut wider = steps;
            wider[axis] += (steps[axis] / 3).max(1);
            let candidate = fine.fit(wider, settings.storage);
            if candidate.error > settings.max_error || candidate.bytes.len() >= tile.bytes.len() {
                break;
            }
            (steps, tile) = (wider, candidate);
        }
    }
    tile
}

/// A tile's exact density at the nodes of a fine grid.
struct FineGrid {
    origin: DVec2,
    spacing: f64,
    width: usize,
    height: usize,
    density: Vec<f32>,
}

impl FineGrid {
    /// Bins the tile's micro-normals (cloud in cell) and convolves with the lobe.
    fn new(map: &NormalMap, rect: TexelRect, settings: &FitSettings) -> FineGrid {
        let sigma = settings.roughness;
        let (lo, hi) = micro_normals::bounds(map, rect);
        let margin = DVec2::splat(MARGIN_SIGMAS * sigma);
        let origin = (lo - margin).max(DVec2::splat(-1.0));
        let extent = (hi + margin).min(DVec2::splat(1.0)) - origin;
        let spacing = (sigma / FINE_PER_SIGMA).max(extent.max_element() / (MAX_FINE - 2) as f64);
        let nodes = |length: f64| (length / spacing).ceil() as usize + 2;
        let (width, height) = (nodes(extent.x), nodes(extent.y));

        // The lobes' tails outside the box would come back by the convolution only from nodes inside it, which is all
        // there is: every micro-normal lies inside.
        let mut bins = vec![0.0f32; width * height];
        let sample_spacing = spacing.max(sigma) / SAMPLES_PER_SIGMA;
        let per_area = 1.0 / (spacing * spacing);
        micro_normals::for_each_sample(map, rect, sample_spacing, MAX_SAMPLES, |s, weight| {
            let p = (s - origin) / spacing;
            let (i, j) = ((p.x as usize).min(width - 2), (p.y as usize).min(height - 2));
            let (fx, fy) = ((p.x - i as f64) as f32, (p.y - j as f64) as f32);
            let w = (weight * per_area * settings.norm.reciprocal_mass(s.length())) as f32;
            let at = j * width + i;
            bins[at] += w * (1.0 - fx) * (1.0 - fy);
            bins[at + 1] += w * fx * (1.0 - fy);
            bins[at + width] += w * (1.0 - fx) * fy;
            bins[at + width + 1] += w * fx * fy;
        });
        // Cloud in cell widens by spacing² / 6 along each axis; the lobe makes up the rest of σ_r².
        let variance = (sigma * sigma - spacing * spacing / 6.0).max(0.0);
        let density = gaussian_blur(&bins, width, height, variance.sqrt() / spacing);
        FineGrid { origin, spacing, width, height, density }
    }

    /// Least-squares fit with texels `steps` fine nodes apart, quantised, with its error.
    fn fit(&self, steps: [usize; 2], storage: DensityStorage) -> FittedTile {
        let width = (self.width - 1).div_ceil(steps[0]) + 1;
        let height = (self.height - 1).div_ceil(steps[1]) + 1;
        // Project rows on the hat functions along x, then columns along y; the mass matrix is separable as well.
        let mut rows = vec![0.0f32; width * self.height];
        for j in 0..self.height {
            let row = &self.density[j * self.width..(j + 1) * self.width];
            project_on_splines(row, steps[0], &mut rows[j * width..(j + 1) * width]);
        }
        let mut values = vec![0.0f32; width * height];
        let mut column = vec![0.0f32; self.height];
        let mut fitted = vec![0.0f32; height];
        for i in 0..width {
            for j in 0..self.height {
                column[j] = rows[j * width + i];
            }
            project_on_splines(&column, steps[1], &mut fitted);
            for j in 0..height {
                values[j * width + i] = fitted[j].max(0.0);
            }
        }
        let spacing = [self.spacing * steps[0] as f64, self.spacing * steps[1] as f64];
        self.quantise(values, width, height, self.origin.to_array(), spacing, storage)
    }

    /// Encodes values, sets the scale so that the tile integrates to one over the disk, and measures the error.
    fn quantise(
        &self,
        mut values: Vec<f32>,
        width: usize,
        height: usize,
        origin: [f64; 2],
        spacing: [f64; 2],
        storage: DensityStorage,
    ) -> FittedTile {
        let peak = values.iter().fold(0.0f32, |a, b| a.max(*b)).max(f32::MIN_POSITIVE);
        let mut bytes = Vec::with_capacity(values.len() * storage.texel_bytes() as usize);
        for v in &mut values {
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
        let integral = disk::bilinear_integral(&values, width, height, origin, spacing);
        // The paper stores densities as they are; our own layouts are normalised after rounding.
        let scale = if storage == DensityStorage::PaperF32 { 1.0 } else { (1.0 / integral) as f32 };
        let mut tile = FittedTile {
            origin,
            spacing,
            width,
            height,
            scale,
            bytes,
            error: 0.0,
            energy: (scale as f64 * integral - 1.0).abs(),
        };
        tile.error = self.error(&tile, &values);
        tile
    }

    /// E₁ of decoded values over the fine nodes inside the disk.
    fn error(&self, tile: &FittedTile, values: &[f32]) -> f64 {
        let (mut difference, mut total) = (0.0f64, 0.0f64);
        // Blend the three rows of values around a fine row, then three values along the row.
        let mut blended = vec![0.0f32; tile.width + 4];
        let mut taps = Vec::new();
        for i in 0..self.width {
            let p = (self.origin.x + i as f64 * self.spacing - tile.origin[0]) / tile.spacing[0];
            taps.push(Taps::at(p as f32));
        }
        for j in 0..self.height {
            let y = self.origin.y + j as f64 * self.spacing;
            let rows = Taps::at(((y - tile.origin[1]) / tile.spacing[1]) as f32);
            blended.fill(0.0);
            for k in 0..3 {
                let r = rows.first + k;
                if r >= 0 && r < tile.height as i32 {
                    let row = &values[r as usize * tile.width..(r as usize + 1) * tile.width];
                    add_scaled(&mut blended[2..tile.width + 2], row, rows.weights[k as usize] * tile.scale);
                }
            }
            let y2 = y * y;
            for i in 0..self.width {
                let x = self.origin.x + i as f64 * self.spacing;
                if x * x + y2 > 1.0 {
                    continue;
                }
                let t = &taps[i];
                let decoded: f32 = if t.first < -2 || t.first > tile.width as i32 - 1 { 0.0 } else {
                    let at = (t.first + 2) as usize;
                    t.weights[0] * blended[at] + t.weights[1] * blended[at + 1] + t.weights[2] * blended[at + 2]
                };
                let exact = self.density[j * self.width + i];
                difference += (decoded - exact).abs() as f64;
                total += exact as f64;
            }
        }
        difference / total.max(f64::MIN_POSITIVE)
    }

    /// The density at `s`, interpolated bilinearly between fine nodes, zero outside.
    fn at(&self, s: DVec2) -> f32 {
        let p = (s - self.origin) / self.spacing;
        let cell = p.floor();
        if cell.x < 0.0 || cell.y < 0.0 || cell.x >= (self.width - 1) as f64 || cell.y >= (self.height - 1) as f64 {
            return 0.0;
        }
        let (i, j) = (cell.x as usize, cell.y as usize);
        let f = (p - cell).as_vec2();
        let row = |j: usize| {
            let at = j * self.width + i;
            self.density[at] * (1.0 - f.x) + self.density[at + 1] * f.x
        };
        row(j) * (1.0 - f.y) + row(j + 1) * f.y
    }
}

/// The paper's storage: density at 128 × 128 texel centres over [−1, 1]², as floats, not normalised.
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
    fine.quantise(values, N, N, [origin; 2], [spacing; 2], DensityStorage::PaperF32)
}

/// The three splines that reach a point: index of the first and their values.
struct Taps {
    first: i32,
    weights: [f32; 3],
}

impl Taps {
    fn at(p: f32) -> Taps {
        let middle = (p + 0.5).floor();
        let f = p - middle;
        Taps {
            first: middle as i32 - 1,
            weights: [0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)],
        }
    }
}

/// Convolves with a Gaussian of `sigma` nodes, separably, cut at 4σ and normalised.
fn gaussian_blur(input: &[f32], width: usize, height: usize, sigma: f64) -> Vec<f32> {
    let radius = (4.0 * sigma).ceil() as usize;
    if radius == 0 {
        return input.to_vec();
    }
    let weights: Vec<f64> = (0..=radius).map(|k| libm::exp(-0.5 * (k as f64 / sigma).powi(2))).collect();
    let total = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    let taps: Vec<f32> = weights.iter().map(|w| (w / total) as f32).collect();

    let mut rows = vec![0.0f32; input.len()];
    let mut padded = vec![0.0f32; width + 2 * radius];
    for j in 0..height {
        let source = &input[j * width..(j + 1) * width];
        if source.iter().all(|v| *v == 0.0) {
            continue;
        }
        padded[radius..radius + width].copy_from_slice(source);
        let target = &mut rows[j * width..(j + 1) * width];
        for offset in 0..=2 * radius {
            add_scaled(target, &padded[offset..offset + width], taps[offset.abs_diff(radius)]);
        }
    }
    let mut output = vec![0.0f32; input.len()];
    for j in 0..height {
        let target = &mut output[j * width..(j + 1) * width];
        for k in j.saturating_sub(radius)..=(j + radius).min(height - 1) {
            add_scaled(target, &rows[k * width..(k + 1) * width], taps[k.abs_diff(j)]);
        }
    }
    output
}

fn add_scaled(target: &mut [f32], source: &[f32], factor: f32) {
    for (t, s) in target.iter_mut().zip(source) {
        *t += factor * s;
    }
}

/// Least-squares coefficients of quadratic B-splines `step` samples apart for samples at the nodes: the right-hand side
/// is the sum of samples under each spline, the normal matrix has two diagonals on either side (Cholesky). Samples
/// beyond the last node count as zero.
fn project_on_splines(samples: &[f32], step: usize, out: &mut [f32]) {
    if step == 1 {
        // As many splines as samples would interpolate, and ring; a sample is its own coefficient near enough.
        out.copy_from_slice(samples);
        return;
    }
    let n = out.len();
    let q = step as f32;
    let reach = (3 * step - 1) / 2;
    let taps: Vec<f32> = (0..=reach).map(|k| quadratic_spline(k as f32 / q)).collect();
    for (k, o) in out.iter_mut().enumerate() {
        let centre = k * step;
        let mut sum = 0.0f32;
        for at in centre.saturating_sub(reach)..=(centre + reach).min(samples.len() - 1) {
            sum += samples[at] * taps[at.abs_diff(centre)];
        }
        *o = sum;
    }
    // Inner products of splines d nodes apart, over all samples.
    let product = |d: usize| {
        let mut sum = 0.0f32;
        for k in -(reach as i64)..=reach as i64 {
            let other = (k - (d * step) as i64).unsigned_abs() as usize;
            if other <= reach {
                sum += taps[k.unsigned_abs() as usize] * taps[other];
            }
        }
        sum
    };
    let (a, b, c) = (product(0), product(1), product(2));
    // Lower factor: diagonal, first and second subdiagonal.
    let mut factor = vec![[0.0f32; 3]; n];
    for k in 0..n {
        let second = if k >= 2 { c / factor[k - 2][0] } else { 0.0 };
        let first = if k >= 1 {
            let shared = if k >= 2 { second * factor[k - 1][1] } else { 0.0 };
            (b - shared) / factor[k - 1][0]
        } else {
            0.0
        };
        factor[k] = [(a - first * first - second * second).sqrt(), first, second];
        let mut v = out[k];
        if k >= 1 {
            v -= first * out[k - 1];
        }
        if k >= 2 {
            v -= second * out[k - 2];
        }
        out[k] = v / factor[k][0];
    }
    for k in (0..n).rev() {
        let mut v = out[k];
        if k + 1 < n {
            v -= factor[k + 1][1] * out[k + 1];
        }
        if k + 2 < n {
            v -= factor[k + 2][2] * out[k + 2];
        }
        out[k] = v / factor[k][0];
    }
}

/// The quadratic B-spline at distance `x` from its centre, in node distances.
fn quadratic_spline(x: f32) -> f32 {
    if x < 0.5 {
        0.75 - x * x
    } else if x < 1.5 {
        0.5 * (1.5 - x) * (1.5 - x)
    } else {
        0.0
    }
}
