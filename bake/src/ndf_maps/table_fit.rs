//! One node's NDF as a table of roots: candidates from coarse to fine, each fitted, quantised and measured.
//!
//! The paper samples every tile at 128² over [−1, 1]² (Xing et al. 2024, section 5.2, Eq. 2). Here each node has a box around its own
//! normals, its density is the integral under its window of one lobe of standard deviation σ_r a normal (not a sum over one lobe a
//! texel), and the square root of the density is fitted by least squares to what bilinear interpolation will reconstruct, with as few
//! texels along each axis as the error asked for allows.

use super::fine_grid::FineGrid;
use super::hats::{Fit, square_integral};
use multiversion::multiversion;
use std::ops::Range;

/// Finest and coarsest texel spacing tried, in points of the fine grid.
const SPACINGS: (usize, usize) = (1, 9);
/// What is cut off on each side of a table, as a part of the error asked for.
const CUT_OF_ERROR: f64 = 0.05;
/// Texels along an axis of a table, and steps between them, at most: eight bits each.
const MOST: usize = 255;

/// A node's fitted roots, quantised: what the pack holds.
#[derive(Clone, Debug)]
pub(super) struct FittedTable {
    /// Steps from s = (−1, −1) to texel (0, 0).
    pub origin: [u32; 2],
    /// Steps between texels.
    pub spacing: [u32; 2],
    /// Texels in a row, and rows.
    pub size: [usize; 2],
    /// Density that a root of 1 stands for.
    pub scale: f32,
    /// Roots in 8 bits, row-major.
    pub roots: Vec<u8>,
    /// E₁ against the fine grid.
    pub error: f64,
    /// |∫D̂ − 1| over the disk after the scale was set.
    pub energy: f64,
}

impl FittedTable {
    /// Bytes of an atlas that it takes, with the zeros that lie between it and the next.
    pub fn bytes(&self) -> usize {
        (self.size[0] + 1) * (self.size[1] + 1)
    }
}

/// The part of the fine grid that a table is made for.
struct Core<'a> {
    fine: &'a FineGrid,
    columns: Range<usize>,
    rows: Range<usize>,
    /// What lies outside, as a part of all.
    lost: f64,
    /// Roots of densities inside, row-major.
    roots: Vec<f32>,
    /// Sum of the densities at points in the disk.
    total: f64,
}

impl<'a> Core<'a> {
    fn new(fine: &'a FineGrid, cut: f64) -> Core<'a> {
        let ([columns, rows], lost) = fine.core(cut);
        let lines = rows.clone().flat_map(|j| &fine.density[j * fine.width..][columns.clone()]);
        let roots = lines.map(|v| v.max(0.0).sqrt()).collect();
        let mut core = Core { fine, columns, rows, lost, roots, total: 0.0 };
        for j in core.rows.clone() {
            let inside = core.columns_inside(j - core.rows.start);
            let row = &fine.density[j * fine.width + core.columns.start..][inside];
            core.total += row.iter().map(|v| f64::from(*v)).sum::<f64>();
        }
        core
    }

    /// Columns, of the core, of its row `j` whose points lie in the disk; may be none.
    fn columns_inside(&self, j: usize) -> Range<usize> {
        let Some(inside) = self.fine.columns_inside(self.rows.start + j) else { return 0..0 };
        let within = |i: usize| i.clamp(self.columns.start, self.columns.end) - self.columns.start;
        within(inside.start)..within(inside.end)
    }
}

/// Fits one node at spacings around the one that has the error asked for: candidates to choose from, of which the
/// first is the most accurate.
pub(super) fn fit_node(fine: &FineGrid, max_error: f64) -> Vec<FittedTable> {
    let core = Core::new(fine, CUT_OF_ERROR * max_error);
    let mut candidates = Candidates { lines: LineFits::new(&core), tried: Vec::new() };
    // The finest spacing that eight bits hold.
    let longest = core.columns.len().max(core.rows.len());
    let finest = (SPACINGS.0..=SPACINGS.1).find(|k| (longest - 1).div_ceil(*k) < MOST).unwrap_or(SPACINGS.1);
    let coarsest = SPACINGS.1.min(MOST / fine.step as usize).max(finest);
    // Errors shrink with the spacing: bisect for the coarsest that both axes may have.
    let (mut low, mut high) = (finest, coarsest);
    while low < high {
        let middle = (low + high).div_ceil(2);
        if candidates.error([middle, middle]) <= max_error {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    // A streak is smooth along its length and needs fewer texels there, so both axes vary on their own around it.
    let around = |d: i64| (low as i64 + d).clamp(finest as i64, coarsest as i64) as usize;
    for (dx, dy) in [(-1, 0), (0, -1), (0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)] {
        candidates.error([around(dx), around(dy)]);
    }
    let mut tables: Vec<FittedTable> = candidates.tried.into_iter().map(|(_, table)| table).collect();
    tables.sort_by(|a, b| a.error.total_cmp(&b.error));
    tables
}

/// Fits of one node, each made once.
struct Candidates<'a> {
    lines: LineFits<'a>,
    tried: Vec<([usize; 2], FittedTable)>,
}

impl Candidates<'_> {
    /// Error of the fit with texels `spacing` points apart.
    fn error(&mut self, spacing: [usize; 2]) -> f64 {
        if let Some((_, table)) = self.tried.iter().find(|(tried, _)| *tried == spacing) {
            return table.error;
        }
        let table = fit_hats(&mut self.lines, spacing);
        let error = table.error;
        self.tried.push((spacing, table));
        error
    }
}

/// The core's columns fitted at each spacing, transposed (element (j, i) at i · height + j); made once a spacing.
struct LineFits<'a> {
    core: &'a Core<'a>,
    by_spacing: Vec<Option<Vec<f32>>>,
}

impl LineFits<'_> {
    fn new<'a>(core: &'a Core<'a>) -> LineFits<'a> {
        LineFits { core, by_spacing: vec![None; SPACINGS.1 + 1] }
    }

    fn get(&mut self, spacing: usize) -> &[f32] {
        let core = self.core;
        self.by_spacing[spacing].get_or_insert_with(|| {
            let fit = Fit::new(core.rows.len(), spacing);
            transposed(&fit.solve(&core.roots, core.columns.len()), core.columns.len())
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

/// Least-squares fit of roots with texels `spacing` points apart, quantised, with its error.
fn fit_hats(lines: &mut LineFits, spacing: [usize; 2]) -> FittedTable {
    let core = lines.core;
    let across = Fit::new(core.columns.len(), spacing[0]);
    let columns = lines.get(spacing[1]);
    let size = [across.nodes(), columns.len() / core.columns.len()];
    let mut values = transposed(&across.solve(columns, size[1]), size[1]);
    let roots = quantise(&mut values);
    let fine = core.fine;
    let at = [core.columns.start, core.rows.start];
    let origin = [0, 1].map(|axis| fine.origin[axis] + fine.spacing * at[axis] as f64);
    let distance = spacing.map(|spacing| fine.spacing * spacing as f64);
    // Normalised after rounding, so that what is decoded integrates to one.
    let integral = square_integral(&values, size[0], size[1], origin, distance);
    let scale = (1.0 / integral.max(f64::MIN_POSITIVE)) as f32;
    FittedTable {
        origin: [0, 1].map(|axis| fine.first[axis] + fine.step * at[axis] as u32),
        spacing: spacing.map(|spacing| fine.step * spacing as u32),
        size,
        scale,
        error: error(core, &values, size[0], spacing, scale),
        roots,
        energy: (f64::from(scale) * integral - 1.0).abs(),
    }
}

/// Roots in 8 bits relative to the largest, which replace the values by what will be decoded.
fn quantise(values: &mut [f32]) -> Vec<u8> {
    let peak = values.iter().fold(f32::MIN_POSITIVE, |a, b| a.max(*b));
    values
        .iter_mut()
        .map(|v| {
            let byte = ((*v / peak).max(0.0) * 255.0).round() as u8;
            *v = f32::from(byte) / 255.0;
            byte
        })
        .collect()
}

/// E₁ of decoded roots over the fine points inside the disk.
#[multiversion(targets("x86_64+avx2", "x86_64+avx"))]
fn error(core: &Core<'_>, roots: &[f32], width: usize, spacing: [usize; 2], scale: f32) -> f64 {
    // Spread every row of roots over the fine columns, then blend two such rows for every fine row.
    let count = core.columns.len();
    let rows = roots.len() / width;
    // One more row of zeros, which lie beyond the last.
    let mut spread = vec![0.0f32; (rows + 1) * count];
    let mut padded = vec![0.0f32; width + 1];
    for (row, spread) in roots.chunks_exact(width).zip(spread.chunks_exact_mut(count)) {
        padded[..width].copy_from_slice(row);
        for (ends, between) in padded.windows(2).zip(spread.chunks_mut(spacing[0])) {
            for (k, out) in between.iter_mut().enumerate() {
                *out = ends[0] + (ends[1] - ends[0]) * (k as f32 / spacing[0] as f32);
            }
        }
    }
    // Differences of one row and the one before, zero outside the disk and around the core.
    let (mut row, mut before) = (vec![0.0f32; count + 2], vec![0.0f32; count + 2]);
    let mut difference = 0.0f64;
    for j in 0..core.rows.len() {
        let inside = core.columns_inside(j);
        let (at, f) = (j / spacing[1], (j % spacing[1]) as f32 / spacing[1] as f32);
        let above = &spread[at * count..][inside.clone()];
        let below = &spread[(at + 1) * count..][inside.clone()];
        let exact = &core.fine.density[(core.rows.start + j) * core.fine.width + core.columns.start..][inside.clone()];
        row.fill(0.0);
        let out = &mut row[1 + inside.start..1 + inside.end];
        for (((out, a), b), exact) in out.iter_mut().zip(above).zip(below).zip(exact) {
            let root = a + (b - a) * f;
            *out = root * root * scale - exact;
        }
        difference += f64::from(cells(&before, &row));
        std::mem::swap(&mut before, &mut row);
    }
    row.fill(0.0);
    difference += f64::from(cells(&before, &row));
    let all = core.total / (1.0 - core.lost).max(f64::MIN_POSITIVE);
    (difference + all - core.total) / all.max(f64::MIN_POSITIVE)
}

/// Mean absolute value of a function over a cell of the fine grid, from its values at corners.
///
/// Points of the fine grid lie on texels and midway between them, where differences are largest. The mean over them of |d| would be that
/// of a wave's extremes, where the wave's own is 2/π of it. So corners of one sign count fully and those that cancel by 2/π; in between by the
/// square of the part that does not cancel. Inlined, so that it has the vectors of its caller.
#[inline(always)]
pub(super) fn mean_size(corners: [f32; 4]) -> f32 {
    /// A quarter, for four corners, of 2/π.
    const WAVE: f32 = 0.5 * std::f32::consts::FRAC_1_PI;
    let sum = corners[0] + corners[1] + corners[2] + corners[3];
    let size = corners[0].abs() + corners[1].abs() + corners[2].abs() + corners[3].abs();
    WAVE * size + (0.25 - WAVE) * sum * sum / size.max(f32::MIN_POSITIVE)
}

/// Sum over the cells between two rows of a function's mean absolute value. Inlined as [`mean_size`].
#[inline(always)]
fn cells(above: &[f32], below: &[f32]) -> f32 {
    const LANES: usize = 8;
    let count = above.len() - 1;
    let mut sums = [0.0f32; LANES];
    let mut at = 0;
    while at + LANES <= count {
        let [a, b] = [above, below].map(|row| &row[at..at + LANES + 1]);
        for k in 0..LANES {
            sums[k] += mean_size([a[k], a[k + 1], b[k], b[k + 1]]);
        }
        at += LANES;
    }
    let rest: f32 = (at..count).map(|k| mean_size([above[k], above[k + 1], below[k], below[k + 1]])).sum();
    sums.iter().sum::<f32>() + rest
}
