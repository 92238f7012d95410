//! The NDF by its definition, in f64: an integral over micro-normals of one lobe each. Slow, and shares nothing with
//! the bake but the normal map.
//!
//! D(s) = ∫ w(u) K(s; n(u)) du, with n(u) the bilinear normal, w the footprint (or a node's window), and K the Gaussian of
//! standard deviation σ_r around n, divided by its mass inside the unit disk (Xing et al. 2024, Eq. 1 and 2, with the
//! continuous map in place of one lobe a texel).

use super::windows::Window;
use crate::normal_map::NormalMap;
use crate::quality::metrics::DiskGrid;
use glam::{DMat2, DVec2};

/// A lobe of the reference: everything a small piece of surface reflects.
#[derive(Clone, Copy, Debug)]
pub struct MicroNormal {
    /// Mean in the surface's disk.
    pub mean: DVec2,
    /// Share of the footprint over the lobe's mass inside the disk.
    pub weight: f64,
    /// Which of the reference's kernels the lobe has.
    pub kernel: usize,
}

/// Inverse covariance (xx, xy, yy), peak and reach (standard deviation of its longest axis) of a lobe.
#[derive(Clone, Copy, Debug)]
struct Kernel {
    inverse: [f64; 3],
    peak: f64,
    sigma: f64,
}

/// An NDF as a list of micro-normals.
#[derive(Clone, Debug)]
pub struct ReferenceNdf {
    kernels: Vec<Kernel>,
    micro_normals: Vec<MicroNormal>,
}

/// Lobes are cut at this many standard deviations (4e-6 of their mass).
const CUT: f64 = 5.0;

impl ReferenceNdf {
    /// NDF of `micro_normals` whose lobes have one of `covariances`.
    pub fn new(covariances: &[DMat2], micro_normals: Vec<MicroNormal>) -> ReferenceNdf {
        let kernels = covariances
            .iter()
            .map(|c| {
                let det = c.determinant();
                let trace = c.x_axis.x + c.y_axis.y;
                let largest = 0.5 * (trace + (trace * trace - 4.0 * det).max(0.0).sqrt());
                Kernel {
                    inverse: [c.y_axis.y / det, -c.x_axis.y / det, c.x_axis.x / det],
                    peak: 1.0 / (2.0 * std::f64::consts::PI * det.sqrt()),
                    sigma: largest.sqrt(),
                }
            })
            .collect();
        ReferenceNdf { kernels, micro_normals }
    }

    /// NDF under a window of the example, which repeats as a whole: Gauss–Legendre on pieces of half a texel at most, small
    /// enough that the normal moves by no more than 2.5 σ_r across one (four points there leave 1e-5).
    pub fn of_window(map: &NormalMap, window: &Window, roughness: f64) -> ReferenceNdf {
        // Nodes and weights of the 4-point rule on [0, 1].
        const NODES: [(f64, f64); 4] = [
            (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
            (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
            (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
            (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
        ];
        let mass = DiskMass::new(roughness);
        let size = DVec2::new(f64::from(map.width), f64::from(map.height));
        let halves = |axis: usize| {
            if window.reach[axis].is_infinite() {
                return 0..(2.0 * size[axis]) as i64;
            }
            let (low, high) = (window.centre[axis] - window.reach[axis], window.centre[axis] + window.reach[axis]);
            (2.0 * low).floor() as i64..(2.0 * high).ceil() as i64
        };
        let mut micro_normals = Vec::new();
        let mut total = 0.0;
        for y in halves(1) {
            for x in halves(0) {
                let low = DVec2::new(x as f64, y as f64) * 0.5;
                let within = low - (low / size).floor() * size;
                let (_, jacobian) = map.bilinear(within + 0.25);
                let corners = [(0.01, 0.01), (0.49, 0.01), (0.01, 0.49), (0.49, 0.49)];
                let slope = |axis: usize| {
                    let at = |c: (f64, f64)| map.bilinear(within + DVec2::new(c.0, c.1)).1.col(axis).length();
                    corners.into_iter().map(at).fold(jacobian.col(axis).length(), f64::max)
                };
                let pieces = |axis: usize| (0.5 * slope(axis) / (2.5 * roughness)).ceil().clamp(1.0, 400.0) as u32;
                let (nu, nv) = (pieces(0), pieces(1));
                for j in 0..nv {
                    for i in 0..nu {
                        for (fy, wy) in NODES {
                            for (fx, wx) in NODES {
                                let f = DVec2::new((i as f64 + fx) / nu as f64, (j as f64 + fy) / nv as f64) * 0.5;
                                let weight = wx * wy / (nu as f64 * nv as f64) * window.weight(low + f - window.centre);
                                if weight > 0.0 {
                                    let s = map.bilinear(within + f).0;
                                    total += weight;
                                    let weight = weight / mass.inside(s.length());
                                    micro_normals.push(MicroNormal { mean: s, weight, kernel: 0 });
                                }
                            }
                        }
                    }
                }
            }
        }
        micro_normals.iter_mut().for_each(|normal| normal.weight /= total);
        ReferenceNdf::new(&[DMat2::IDENTITY * (roughness * roughness)], micro_normals)
    }

    /// The density at `s`: the sum over all lobes, uncut.
    pub fn density(&self, s: DVec2) -> f64 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let mut sum = 0.0;
        for m in &self.micro_normals {
            let k = &self.kernels[m.kernel];
            let d = s - m.mean;
            let q = k.inverse[0] * d.x * d.x + 2.0 * k.inverse[1] * d.x * d.y + k.inverse[2] * d.y * d.y;
            sum += m.weight * k.peak * libm::exp(-0.5 * q);
        }
        sum
    }

    /// The densities at the points of a grid, each lobe added where it reaches.
    pub fn on_grid(&self, grid: &DiskGrid) -> Vec<f64> {
        let mut values = vec![0.0; grid.width * grid.height];
        let (mut along, mut across) = (Vec::new(), Vec::new());
        for m in &self.micro_normals {
            let k = &self.kernels[m.kernel];
            let reach = CUT * k.sigma;
            let range = |centre: f64, origin: f64, count: usize| {
                let first = ((centre - reach - origin) / grid.spacing).ceil().max(0.0) as usize;
                let last = ((centre + reach - origin) / grid.spacing).floor();
                first..((last + 1.0).max(0.0) as usize).min(count)
            };
            let columns = range(m.mean.x, grid.origin.x, grid.width);
            let rows = range(m.mean.y, grid.origin.y, grid.height);
            let offset = grid.point(columns.start, rows.start) - m.mean;
            gaussian_run(k.inverse[0], offset.x, grid.spacing, columns.len(), &mut along);
            gaussian_run(k.inverse[2], offset.y, grid.spacing, rows.len(), &mut across);
            for (j, ey) in rows.zip(&across) {
                let dy = grid.point(0, j).y - m.mean.y;
                let row = m.weight * k.peak * ey;
                let target = &mut values[j * grid.width + columns.start.min(grid.width)..];
                if k.inverse[1] == 0.0 {
                    for (value, ex) in target.iter_mut().zip(&along) {
                        *value += row * ex;
                    }
                } else {
                    for (i, (value, ex)) in target.iter_mut().zip(&along).enumerate() {
                        let dx = offset.x + i as f64 * grid.spacing;
                        *value += row * ex * libm::exp(-k.inverse[1] * dx * dy);
                    }
                }
            }
        }
        for j in 0..grid.height {
            for i in 0..grid.width {
                if grid.point(i, j).length_squared() > 1.0 {
                    values[j * grid.width + i] = 0.0;
                }
            }
        }
        values
    }

    /// A grid that holds all of the NDF and what a coarse approximation of it may spread around, `per_sigma` points a standard deviation of the narrowest lobe.
    pub fn grid(&self, per_sigma: f64) -> DiskGrid {
        let mut lo = DVec2::splat(f64::INFINITY);
        let mut hi = DVec2::splat(f64::NEG_INFINITY);
        for m in &self.micro_normals {
            let reach = DVec2::splat((CUT + 2.0) * self.kernels[m.kernel].sigma);
            lo = lo.min(m.mean - reach);
            hi = hi.max(m.mean + reach);
        }
        let narrowest = self.kernels.iter().map(|k| k.sigma).fold(f64::INFINITY, f64::min);
        DiskGrid::over(lo, hi, narrowest / per_sigma)
    }
}

/// exp(−½ `inverse` x²) at x = `first`, `first` + `step`, …: the ratio of neighbours shrinks by a constant factor, which
/// loses no more than the last three digits over the few dozen points of a lobe.
fn gaussian_run(inverse: f64, first: f64, step: f64, count: usize, values: &mut Vec<f64>) {
    values.clear();
    let mut value = libm::exp(-0.5 * inverse * first * first);
    let mut ratio = libm::exp(-inverse * step * (first + 0.5 * step));
    let shrink = libm::exp(-inverse * step * step);
    for _ in 0..count {
        values.push(value);
        value *= ratio;
        ratio *= shrink;
    }
}

/// Mass inside the unit disk of a Gaussian of standard deviation σ, by brute force on a grid of points, tabulated over
/// the distance of its centre from the disk's.
pub struct DiskMass {
    sigma: f64,
    table: Vec<f64>,
}

impl DiskMass {
    const STEPS: usize = 64;
    const REACH: f64 = 6.0;

    /// Mass of lobes of standard deviation `sigma`.
    pub fn new(sigma: f64) -> DiskMass {
        let table = (0..=Self::STEPS).map(|k| Self::sum(Self::radius(sigma, k), sigma)).collect();
        DiskMass { sigma, table }
    }

    fn radius(sigma: f64, k: usize) -> f64 {
        let first = (1.0 - Self::REACH * sigma).max(0.0);
        first + (1.0 - first) * k as f64 / Self::STEPS as f64
    }

    fn sum(radius: f64, sigma: f64) -> f64 {
        const N: usize = 600;
        let h = 2.0 * Self::REACH * sigma / N as f64;
        let at = |k: usize| -Self::REACH * sigma + h * (k as f64 + 0.5);
        let weights: Vec<f64> = (0..N).map(|k| libm::exp(-0.5 * (at(k) / sigma).powi(2))).collect();
        let mut total = 0.0;
        for j in 0..N {
            for i in 0..N {
                if (radius + at(i)).powi(2) + at(j) * at(j) <= 1.0 {
                    total += weights[i] * weights[j];
                }
            }
        }
        total * h * h / (2.0 * std::f64::consts::PI * sigma * sigma)
    }

    /// Mass inside for a lobe at `radius` from the centre.
    pub fn inside(&self, radius: f64) -> f64 {
        let first = Self::radius(self.sigma, 0);
        if first > 0.0 && radius <= first {
            return 1.0;
        }
        let p = ((radius.min(1.0) - first) / (1.0 - first) * Self::STEPS as f64).max(0.0);
        let k = (p as usize).min(Self::STEPS - 1);
        let f = p - k as f64;
        self.table[k] * (1.0 - f) + self.table[k + 1] * f
    }
}
