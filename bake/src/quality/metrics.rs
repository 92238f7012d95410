//! Error of one density against another on a grid over the unit disk, and summaries of many errors.

use glam::DVec2;

/// A square grid of points over the part of the projected-normal disk that a density occupies; each point stands for a
/// cell of `spacing`².
#[derive(Clone, Debug, PartialEq)]
pub struct DiskGrid {
    /// First point.
    pub origin: DVec2,
    /// Distance of neighbouring points.
    pub spacing: f64,
    /// Points in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl DiskGrid {
    /// Grid over the box `lo … hi`, cut to [−1, 1]².
    pub fn over(lo: DVec2, hi: DVec2, spacing: f64) -> DiskGrid {
        let lo = lo.max(DVec2::splat(-1.0));
        let hi = hi.min(DVec2::splat(1.0)).max(lo);
        let cells = ((hi - lo) / spacing).ceil().max(DVec2::ONE);
        DiskGrid { origin: lo + 0.5 * spacing, spacing, width: cells.x as usize, height: cells.y as usize }
    }

    /// Point (i, j).
    pub fn point(&self, i: usize, j: usize) -> DVec2 {
        self.origin + DVec2::new(i as f64, j as f64) * self.spacing
    }

    /// The density at every point, row by row; zero outside the unit disk.
    pub fn evaluate(&self, density: impl Fn(DVec2) -> f64) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.width * self.height);
        for j in 0..self.height {
            for i in 0..self.width {
                let s = self.point(i, j);
                values.push(if s.length_squared() <= 1.0 { density(s) } else { 0.0 });
            }
        }
        values
    }

    /// Integral of values over the grid.
    pub fn integral(&self, values: &[f64]) -> f64 {
        values.iter().sum::<f64>() * self.spacing * self.spacing
    }
}

/// E₁ = ∫|D̂ − D| / ∫D.
pub fn e1(approximate: &[f64], exact: &[f64]) -> f64 {
    let difference: f64 = approximate.iter().zip(exact).map(|(a, b)| (a - b).abs()).sum();
    difference / exact.iter().sum::<f64>().max(f64::MIN_POSITIVE)
}

/// Mean, 95th percentile and worst of a set of errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Arithmetic mean.
    pub mean: f64,
    /// 95th percentile (nearest rank).
    pub p95: f64,
    /// Largest.
    pub worst: f64,
}

impl Summary {
    /// Summary of `errors`; zeros when there are none.
    pub fn of(mut errors: Vec<f64>) -> Summary {
        if errors.is_empty() {
            return Summary::default();
        }
        errors.sort_by(f64::total_cmp);
        let rank = (errors.len() as f64 * 0.95).ceil() as usize;
        Summary {
            mean: errors.iter().sum::<f64>() / errors.len() as f64,
            p95: errors[rank - 1],
            worst: errors[errors.len() - 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_of_a_ramp() {
        let s = Summary::of((1..=100).map(f64::from).collect());
        assert_eq!((s.mean, s.p95, s.worst), (50.5, 95.0, 100.0));
    }

    #[test]
    fn e1_of_disjoint_densities_is_two() {
        assert_eq!(e1(&[1.0, 0.0], &[0.0, 1.0]), 2.0);
    }
}
