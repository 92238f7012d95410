//! The P-NDF by its definition, in f64: D(s) = ∫ G_P(u) G_r(s − n(u)) du over the repeated map (Tan et al. 2022, Eq. 2), G_r
//! divided by its mass inside the disk.
//!
//! The map is sampled at midpoints of pieces of each quarter texel, in which it is one bilinear patch; pieces are small
//! against both the footprint and σ_r. Samples are shared out among 3 × 3 bins of σ_r / 6 by the quadratic B-spline, which
//! keeps their mean and adds a quarter of a squared bin to their variance wherever they lie; the bins are then blurred by
//! G_r less that variance.

use crate::footprint::Footprint;
use crate::ndf_maps::reference::DiskMass;
use crate::normal_map::NormalMap;
use crate::quality::metrics::DiskGrid;
use glam::{DMat2, DVec2};
use glint_formats::lobes::Filter;

/// Standard deviations that footprints reach in [`Reference`]: 4e-5 of their mass is farther out.
const REACH: f64 = 4.5;
/// Bins a standard deviation of the intrinsic lobe.
const BINS_PER_SIGMA: f64 = 6.0;

/// A repeated map and what it is made of.
pub struct Reference<'a> {
    map: &'a NormalMap,
    filter: Filter,
    roughness: f64,
    mass: DiskMass,
    refinement: f64,
}

/// A density on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct GridNdf {
    /// The points.
    pub grid: DiskGrid,
    /// Density at the points, row by row; 0 outside the disk.
    pub values: Vec<f64>,
}

impl<'a> Reference<'a> {
    /// Reference for a map, filtered this way, of this intrinsic roughness σ_r.
    pub fn new(map: &'a NormalMap, filter: Filter, roughness: f64) -> Reference<'a> {
        Reference { map, filter, roughness, mass: DiskMass::new(roughness), refinement: 1.0 }
    }

    /// The same with pieces `factor` times as short: above 1 to see that they are short enough, below 1 for speed.
    pub fn refined(self, factor: f64) -> Reference<'a> {
        Reference { refinement: factor, ..self }
    }

    /// Intrinsic roughness σ_r.
    pub fn roughness(&self) -> f64 {
        self.roughness
    }

    /// The P-NDF of a footprint on every `stride`-th bin.
    pub fn ndf(&self, footprint: &Footprint, stride: usize) -> GridNdf {
        let (low, high) = self.normals_under(footprint);
        let reach = DVec2::splat(7.0 * self.roughness);
        let (low, high) = (low - reach, high + reach);
        let bin = self.roughness / BINS_PER_SIGMA;
        let size = ((high - low) / bin).ceil();
        let (width, height) = (size.x as usize + 1, size.y as usize + 1);
        let mut bins = vec![0.0; width * height];
        let mut total = 0.0;
        self.for_each_sample(footprint, |s, weight| {
            let place = (s - low) / bin - 0.5;
            let middle = place.round();
            let (x, y) = (spline(place.x - middle.x), spline(place.y - middle.y));
            let first = (middle.y as usize - 1) * width + middle.x as usize - 1;
            total += weight;
            let weight = weight / self.mass.inside(s.length());
            for (row, wy) in y.into_iter().enumerate() {
                for (column, wx) in x.into_iter().enumerate() {
                    bins[first + row * width + column] += weight * wx * wy;
                }
            }
        });
        let kernel = self.kernel(bin);
        let rows = blurred(&bins, width, height, stride, &kernel);
        let (columns, count) = (width.div_ceil(stride), height.div_ceil(stride));
        // The same along columns, on the transposed.
        let turned = blurred(&transposed(&rows, columns, height), height, columns, stride, &kernel);
        let mut values = transposed(&turned, count, columns);
        let grid = DiskGrid { origin: low + 0.5 * bin, spacing: bin * stride as f64, width: columns, height: count };
        for j in 0..count {
            for i in 0..columns {
                let value = &mut values[j * columns + i];
                *value = if grid.point(i, j).length_squared() > 1.0 { 0.0 } else { *value / (bin * bin * total) };
            }
        }
        GridNdf { grid, values }
    }

    /// Bounds of the normals of the texels that the footprint's samples are filtered from.
    fn normals_under(&self, footprint: &Footprint) -> (DVec2, DVec2) {
        let (low, high) = quarters_under(footprint);
        let texels = |from: f64, to: f64, size: u32| {
            let (from, to) = ((from * 0.5).floor() as i64 - 1, (to * 0.5).ceil() as i64 + 1);
            // A range as long as the map holds all of it.
            from..=to.min(from + size as i64)
        };
        let mut bounds = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for j in texels(low.y, high.y, self.map.height) {
            for i in texels(low.x, high.x, self.map.width) {
                let at = |k: i64, size: u32| k.rem_euclid(size as i64);
                let s = self.map.texel(at(i, self.map.width), at(j, self.map.height));
                bounds = (bounds.0.min(s), bounds.1.max(s));
            }
        }
        bounds
    }

    /// Calls `visit` with normals under the footprint and their weights.
    fn for_each_sample(&self, footprint: &Footprint, mut visit: impl FnMut(DVec2, f64)) {
        let (minor, major, axis) = footprint.principal();
        let (minor, major) = (minor.max(1e-6), major.max(1e-6));
        let density = |u: DVec2| {
            let d = u - footprint.mean;
            libm::exp(-0.5 * ((d.dot(axis) / major).powi(2) + (axis.perp_dot(d) / minor).powi(2)))
        };
        let (low, high) = quarters_under(footprint);
        let size = DVec2::new(self.map.width as f64, self.map.height as f64);
        if minor >= 4.0 {
            // The footprint hardly changes over a quarter texel: all copies of the map together weight its quarters.
            let (width, height) = (2 * self.map.width as usize, 2 * self.map.height as usize);
            let mut shares = vec![0.0; width * height];
            for y in low.y as i64..=high.y as i64 {
                for x in low.x as i64..=high.x as i64 {
                    let at = y.rem_euclid(height as i64) as usize * width + x.rem_euclid(width as i64) as usize;
                    shares[at] += density((DVec2::new(x as f64, y as f64) + 0.5) * 0.5);
                }
            }
            let most = shares.iter().fold(0.0, |a: f64, b| a.max(*b));
            for (at, share) in shares.into_iter().enumerate().filter(|(_, share)| *share > 1e-7 * most) {
                let corner = DVec2::new((at % width) as f64, (at / width) as f64) * 0.5;
                self.for_each_piece(corner, f64::INFINITY, |u, part| visit(self.normal(u), share * part));
            }
        } else {
            for y in low.y as i64..=high.y as i64 {
                for x in low.x as i64..=high.x as i64 {
                    let corner = DVec2::new(x as f64, y as f64) * 0.5;
                    let copy = (corner / size).floor() * size;
                    self.for_each_piece(corner - copy, minor / 12.0, |u, part| {
                        visit(self.normal(u), density(u + copy) * part);
                    });
                }
            }
        }
    }

    /// Midpoints of the pieces of the quarter texel at `corner`, at most `longest` long, and their part of its area.
    fn for_each_piece(&self, corner: DVec2, longest: f64, mut visit: impl FnMut(DVec2, f64)) {
        const QUARTER: f64 = 0.5;
        let corners = [(0.01, 0.01), (0.49, 0.01), (0.01, 0.49), (0.49, 0.49)];
        let steepest = |axis: usize| {
            let length = |c: (f64, f64)| self.map.bilinear(corner + DVec2::new(c.0, c.1)).1.col(axis).length();
            if self.filter == Filter::Nearest { 0.0 } else { corners.into_iter().map(length).fold(0.0, f64::max) }
        };
        let pieces = |axis: usize| {
            // Midpoints lose a piece's own variance where slopes change; half as long pieces change E₁ by less than 2e-3.
            let by_normal = QUARTER * steepest(axis) / (0.7 * self.roughness);
            (self.refinement * by_normal.max(QUARTER / longest)).ceil().clamp(1.0, 2000.0) as u32
        };
        let (nu, nv) = (pieces(0), pieces(1));
        for j in 0..nv {
            for i in 0..nu {
                let f = DVec2::new((i as f64 + 0.5) / nu as f64, (j as f64 + 0.5) / nv as f64);
                visit(corner + QUARTER * f, 1.0 / (nu as f64 * nv as f64));
            }
        }
    }

    fn normal(&self, u: DVec2) -> DVec2 {
        match self.filter {
            Filter::Linear => self.map.bilinear(u).0,
            Filter::Nearest => self.map.texel(u.x.floor() as i64, u.y.floor() as i64),
        }
    }

    /// The intrinsic lobe along one axis, in bins, summing to 1.
    fn kernel(&self, bin: f64) -> Vec<f64> {
        let sigma = (self.roughness * self.roughness - 0.25 * bin * bin).sqrt() / bin;
        let half = (6.0 * BINS_PER_SIGMA) as i32;
        let values: Vec<f64> = (-half..=half).map(|k| libm::exp(-0.5 * (k as f64 / sigma).powi(2))).collect();
        let sum: f64 = values.iter().sum();
        values.into_iter().map(|v| v / sum).collect()
    }
}

/// First and last quarter texels, by column and row, within reach of a footprint.
fn quarters_under(footprint: &Footprint) -> (DVec2, DVec2) {
    let (minor, major, axis) = footprint.principal();
    let extent = DVec2::new((axis.x * major).hypot(axis.y * minor), (axis.y * major).hypot(axis.x * minor));
    let reach = extent.max(DVec2::splat(1e-6)) * REACH;
    (((footprint.mean - reach) * 2.0).floor(), ((footprint.mean + reach) * 2.0).floor())
}

/// Quadratic B-spline at the bins before, at and after a place `f` (−½ … ½) from the middle one.
fn spline(f: f64) -> [f64; 3] {
    [0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)]
}

/// Every `stride`-th column of rows convolved with a kernel.
fn blurred(values: &[f64], width: usize, height: usize, stride: usize, kernel: &[f64]) -> Vec<f64> {
    let half = kernel.len() / 2;
    let mut out = Vec::with_capacity(width.div_ceil(stride) * height);
    for row in values.chunks_exact(width) {
        for x in (0..width).step_by(stride) {
            let (from, to) = (x.saturating_sub(half), (x + half + 1).min(width));
            let taps = &kernel[from + half - x..to + half - x];
            out.push(row[from..to].iter().zip(taps).map(|(v, k)| v * k).sum());
        }
    }
    out
}

fn transposed(values: &[f64], width: usize, height: usize) -> Vec<f64> {
    let mut out = Vec::with_capacity(values.len());
    for x in 0..width {
        for y in 0..height {
            out.push(values[y * width + x]);
        }
    }
    out
}

/// Standard deviations that footprints reach in [`sum_of_boxes`].
const BOXES_REACH: f64 = 6.0;

/// The P-NDF at `s` of a bilinear map as a sum over all its finest lobes, those of boxes of `edge` texels, one over a whole number,
/// which begin at texel centres; σ_r = `roughness`. Lobes near the rim are not cut by it.
///
/// Tan et al. 2022, Eq. 3, 5 and 6 as they stand: every box of the repeated map within reach is one 4D Gaussian around its bilinear
/// normal and Jacobian; the product with the footprint is integrated by inverting its precision matrix. No levels, no cells, no
/// stored bytes.
pub fn sum_of_boxes(map: &NormalMap, footprint: &Footprint, edge: f64, roughness: f64, s: DVec2) -> f64 {
    let (_, major, _) = footprint.principal();
    let reach = DVec2::splat(BOXES_REACH * major + edge);
    let low = ((footprint.mean - reach - 0.5) / edge).floor();
    let high = ((footprint.mean + reach - 0.5) / edge).ceil();
    let variance = edge * edge / 12.0;
    let both = DMat2::from_diagonal(DVec2::splat(variance)) + footprint.covariance;
    let under_footprint =
        (DMat2::from_diagonal(DVec2::splat(1.0 / variance)) + footprint.covariance.inverse()).inverse();
    let (mut sum, mut share) = (0.0, 0.0);
    for j in low.y as i64..=high.y as i64 {
        for i in low.x as i64..=high.x as i64 {
            let centre = (DVec2::new(i as f64, j as f64) + 0.5) * edge + 0.5;
            let weight = gaussian(footprint.mean - centre, both);
            let (normal, jacobian) = map.bilinear(centre);
            // The Jacobian's change over the box, as a residual of the same variance.
            let right = map.bilinear(centre + DVec2::new(0.25 * edge, 0.0)).1.y_axis;
            let twist = (right - jacobian.y_axis) / (0.25 * edge);
            let residual = DMat2::from_cols(twist * twist.x, twist * twist.y) * variance * variance;
            let mean = normal + jacobian * (variance * (both.inverse() * (footprint.mean - centre)));
            let intrinsic = DMat2::from_diagonal(DVec2::splat(roughness * roughness));
            let covariance = intrinsic + residual + jacobian * under_footprint * jacobian.transpose();
            sum += weight * gaussian(s - mean, covariance);
            share += weight;
        }
    }
    sum / share
}

fn gaussian(d: DVec2, covariance: DMat2) -> f64 {
    let q = d.dot(covariance.inverse() * d);
    libm::exp(-0.5 * q) / (2.0 * std::f64::consts::PI * covariance.determinant().sqrt())
}
