//! Windows: the Gaussians that nodes are prefiltered by, on grids that repeat with the example.
//!
//! A footprint is a sum of windows of about its size, as a wide Gaussian is one of narrower ones. Nodes of a level stand on a lattice of
//! triangles, as nearly equilateral as the example's edges allow: node (i, j) at ((i + j/2) Δx, j Δy). At any place the three corners of
//! the triangle around it count, by weights that are linear in it. A node's weight as a function of the place is then a hat over six
//! triangles, of variance Δx²/8 along x and Δy²/6 along y (docs/methods/ndf-maps.md, *Windows*). The window has the level's variance
//! less that, so that what three nodes show together spreads alike in all directions.

use glam::DVec2;
use glint_formats::ndf_maps::Level;

/// Distance of neighbouring nodes in standard deviations of their level.
const SPACING: f64 = 1.3;
/// Height of an equilateral triangle over its edge.
const HEIGHT: f64 = 0.866_025_403_784_438_6;
/// From this standard deviation on, in edges of the example, windows side by side are even to 1.4 %.
const EVEN: f64 = 0.5;
/// Windows are cut at this many standard deviations (4e-4 of their mass).
const REACH: f64 = 4.0;

/// Levels of an example, from windows of standard deviation `finest_window` on, each with twice the variance of the one before, to
/// the one of the whole example.
pub fn levels(width: u32, height: u32, finest_window: f64) -> Vec<Level> {
    let mut levels = Vec::new();
    let mut first_node = 0;
    let mut variance = finest_window * finest_window;
    loop {
        let std = variance.sqrt();
        let nodes = |edge: u32, spacing: f64, multiple: u32| {
            let edge = f64::from(edge);
            if std >= EVEN * edge { 1 } else { (edge / (spacing * std) - 0.1).ceil() as u32 }.next_multiple_of(multiple)
        };
        // Rows go around in pairs, as every second one is shifted by half a distance.
        let nodes_y = nodes(height, SPACING * HEIGHT, if std >= EVEN * f64::from(height) { 1 } else { 2 });
        let level = Level { nodes_x: nodes(width, SPACING, 1).max(1), nodes_y, first_node };
        levels.push(level);
        if level.nodes() == 1 {
            return levels;
        }
        first_node += level.nodes_x * level.nodes_y;
        variance *= 2.0;
    }
}

/// The window of one node.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Where the node stands, in texels.
    pub centre: DVec2,
    /// 1 / variance along x and y; zero along an axis where the window is even.
    inverse: DVec2,
    /// How far it reaches along both axes, in texels; infinite where it is even.
    pub reach: DVec2,
}

impl Window {
    /// The window of node `index` (by rows) of a level of windows of `variance` (texels²).
    pub fn new(width: u32, height: u32, level: &Level, variance: f64, index: u32) -> Window {
        let size = DVec2::new(f64::from(width), f64::from(height));
        let step = size / DVec2::new(f64::from(level.nodes_x), f64::from(level.nodes_y));
        let (i, j) = (f64::from(index % level.nodes_x), f64::from(index / level.nodes_x));
        // One row alone is not shifted: its hats are those of a line.
        let hat = DVec2::new(if level.nodes_y == 1 { 1.0 / 6.0 } else { 1.0 / 8.0 }, 1.0 / 6.0);
        let own = DVec2::splat(variance) - step * step * hat;
        let of_axis = |nodes: u32, even: f64, otherwise: f64| if nodes == 1 { even } else { otherwise };
        let both = |even: f64, otherwise: DVec2| {
            DVec2::new(of_axis(level.nodes_x, even, otherwise.x), of_axis(level.nodes_y, even, otherwise.y))
        };
        Window {
            centre: step * DVec2::new(i + 0.5 * j, j),
            inverse: both(0.0, own.recip()),
            reach: both(f64::INFINITY, REACH * DVec2::new(own.x.sqrt(), own.y.sqrt())),
        }
    }

    /// That of a round Gaussian anywhere.
    pub(super) fn round(centre: DVec2, variance: f64) -> Window {
        Window { centre, inverse: DVec2::splat(variance.recip()), reach: DVec2::splat(REACH * variance.sqrt()) }
    }

    /// Weights below this are those beyond the reach.
    pub(super) const LEAST: f64 = 3.354_626_279_025_119e-4;

    /// The least standard deviation, in texels; infinite where the window is even.
    pub(super) fn least_sigma(&self) -> f64 {
        self.reach.min_element() / REACH
    }

    /// The window at the middles of parts of `edge` texels: what a part's extent adds to the variance is taken off.
    pub(super) fn of_parts(&self, edge: f64) -> Window {
        let own = |inverse: f64| if inverse == 0.0 { 0.0 } else { (inverse.recip() - edge * edge / 12.0).recip() };
        Window { inverse: DVec2::new(own(self.inverse.x), own(self.inverse.y)), ..*self }
    }

    /// Weights along an axis of the parts of an example that repeats: `count` parts, `per_texel` along a texel.
    pub(super) fn along(&self, axis: usize, count: u32, per_texel: u32) -> AxisWeights {
        if self.reach[axis].is_infinite() {
            return AxisWeights((0..count).map(|k| (k, 1.0)).collect());
        }
        let per_texel = f64::from(per_texel);
        let of_part = |k: i64| {
            let d = (k as f64 + 0.5) / per_texel - self.centre[axis];
            libm::exp(-0.5 * d * d * self.inverse[axis])
        };
        let first = (per_texel * (self.centre[axis] - self.reach[axis]) - 0.5).ceil() as i64;
        let end = (per_texel * (self.centre[axis] + self.reach[axis]) - 0.5).floor() as i64 + 1;
        let mut weights: Vec<(u32, f64)> = (first..end.min(first + i64::from(count)))
            .map(|k| (k.rem_euclid(i64::from(count)) as u32, of_part(k)))
            .collect();
        // Wide windows go around small examples.
        for k in first + i64::from(count)..end {
            weights[((k - first) % i64::from(count)) as usize].1 += of_part(k);
        }
        AxisWeights(weights)
    }

    /// Relative weight of a place at `d` texels from the centre: 1 in the middle, 0 out of reach.
    pub fn weight(&self, d: DVec2) -> f64 {
        let q = (d * d).dot(self.inverse);
        if q > REACH * REACH { 0.0 } else { libm::exp(-0.5 * q) }
    }
}

/// Index and weight of the parts of a map that a window reaches along an axis.
#[derive(Clone, Debug)]
pub(super) struct AxisWeights(pub Vec<(u32, f64)>);

#[cfg(test)]
mod tests {
    use super::*;

    /// The weight of the node at the origin, of a lattice of triangles of edge 1, at a place.
    fn hat(x: DVec2) -> f64 {
        let j = x.y / HEIGHT;
        let i = x.x - 0.5 * j;
        (1.0 - i.abs().max(j.abs()).max((i + j).abs())).max(0.0)
    }

    #[test]
    fn the_variance_of_a_hat_is_what_windows_leave_out() {
        let n = 400;
        let mut moments = [0.0; 4];
        for k in 0..4 * n * n {
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(n) - 1.0;
            let x = DVec2::new(at(k % (2 * n)), at(k / (2 * n)));
            let w = hat(x);
            moments[0] += w;
            moments[1] += w * x.x * x.x;
            moments[2] += w * x.x * x.y;
            moments[3] += w * x.y * x.y;
        }
        let of = |k: usize| moments[k] / moments[0];
        assert!((of(1) - 1.0 / 8.0).abs() < 1e-4 && (of(3) - HEIGHT * HEIGHT / 6.0).abs() < 1e-4, "{moments:?}");
        assert!(of(2).abs() < 1e-4, "{moments:?}");
    }

    #[test]
    fn windows_are_gaussians_at_every_size_of_example() {
        for (width, height) in [(1, 1), (1, 7), (5, 3), (16, 16), (128, 128), (8192, 1), (37, 2)] {
            let levels = levels(width, height, 0.7);
            assert_eq!(levels.last().unwrap().nodes(), 1);
            let mut variance = 0.49;
            for level in &levels {
                let window = Window::new(width, height, level, variance, 0);
                assert!(window.inverse.min_element() >= 0.0, "{level:?}: {window:?}");
                assert!(window.reach.min_element() > 0.0, "{level:?}: {window:?}");
                assert!(level.nodes_y == 1 || level.nodes_y % 2 == 0, "{level:?}");
                variance *= 2.0;
            }
        }
    }
}
