//! The micro-normals under a window, as weighted samples dense enough for a given spacing in the disk.
//!
//! Bilinear interpolation makes the map a patchwork of bilinear cells between texel centres; each quarter of a texel
//! lies in one cell, so normals there are a bilinear patch whose extremes are its four corners.

use super::windows::Window;
use crate::normal_map::NormalMap;
use glam::DVec2;

/// Windows of this standard deviation and more, in texels, are constant over a quarter of a texel to a hundredth.
const WIDE: f64 = 2.0;

/// Normals of a quarter of a texel: those of its corners (00, 10, 01, 11) and how many samples it has along both axes.
#[derive(Clone, Copy, Debug)]
struct Patch {
    corners: [DVec2; 4],
    samples: [u32; 2],
}

impl Patch {
    /// Calls `visit(s, place)` for the samples, `place` from 0 to 1 along both axes.
    fn for_each(&self, mut visit: impl FnMut(DVec2, DVec2)) {
        let [s00, s10, s01, s11] = self.corners;
        let [nu, nv] = self.samples.map(f64::from);
        for j in 0..self.samples[1] {
            let v = (f64::from(j) + 0.5) / nv;
            let left = s00.lerp(s01, v);
            let step = (s10.lerp(s11, v) - left) / nu;
            for i in 0..self.samples[0] {
                let i = f64::from(i) + 0.5;
                visit(left + step * i, DVec2::new(i / nu, v));
            }
        }
    }

    fn count(&self) -> f64 {
        f64::from(self.samples[0]) * f64::from(self.samples[1])
    }
}

/// The micro-normals of an example.
pub(super) struct MicroNormals {
    /// Quarters of texels along both axes.
    size: [i64; 2],
    patches: Vec<Patch>,
}

impl MicroNormals {
    /// Those of `map`; neighbouring samples of one patch are at most `spacing` apart in the disk, as long as that takes no more than
    /// `max_per_axis` of them along an edge of a quarter texel.
    pub fn new(map: &NormalMap, spacing: f64, max_per_axis: u32) -> MicroNormals {
        let size = [2 * i64::from(map.width), 2 * i64::from(map.height)];
        let mut patches = Vec::with_capacity((size[0] * size[1]) as usize);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let corner = |dx: i64, dy: i64| map.bilinear(DVec2::new((x + dx) as f64, (y + dy) as f64) * 0.5).0;
                let corners @ [s00, s10, s01, s11] = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
                let steps = |a: f64, b: f64| ((a.max(b) / spacing).ceil() as u32).clamp(1, max_per_axis);
                let samples =
                    [steps(s00.distance(s10), s01.distance(s11)), steps(s00.distance(s01), s10.distance(s11))];
                patches.push(Patch { corners, samples });
            }
        }
        MicroNormals { size, patches }
    }

    /// Bounds (min, max) of the projected normals under a window.
    pub fn bounds(&self, window: &Window) -> (DVec2, DVec2) {
        let mut lo = DVec2::splat(f64::INFINITY);
        let mut hi = DVec2::splat(f64::NEG_INFINITY);
        self.for_each_patch(window, |at, _| {
            for corner in self.patches[at].corners {
                lo = lo.min(corner);
                hi = hi.max(corner);
            }
        });
        (lo, hi)
    }

    /// Calls `visit(s, weight)` for samples of the normals under a window; weights are relative.
    pub fn for_each_sample(&self, window: &Window, mut visit: impl FnMut(DVec2, f64)) {
        if window.reach.min_element() < 4.0 * WIDE {
            return self.for_each_patch(window, |at, d| {
                let patch = &self.patches[at];
                let share = patch.count().recip();
                patch.for_each(|s, place| {
                    let weight = window.weight(d + (place - 0.5) * 0.5);
                    if weight > 0.0 {
                        visit(s, weight * share);
                    }
                });
            });
        }
        // Wide windows go around small examples: each patch once, by all of its weight.
        let mut weights = vec![0.0; self.patches.len()];
        self.for_each_patch(window, |at, d| weights[at] += window.weight(d));
        for (patch, weight) in self.patches.iter().zip(weights) {
            if weight > 0.0 {
                let weight = weight / patch.count();
                patch.for_each(|s, _| visit(s, weight));
            }
        }
    }

    /// Calls `visit(index, d)` for the patches that a window reaches, their middles `d` texels from its centre; as often as the example
    /// goes around.
    fn for_each_patch(&self, window: &Window, mut visit: impl FnMut(usize, DVec2)) {
        let range = |axis: usize| {
            let (centre, reach) = (window.centre[axis], window.reach[axis]);
            if reach.is_infinite() {
                return 0..self.size[axis];
            }
            (2.0 * (centre - reach) - 0.5).floor() as i64..(2.0 * (centre + reach) + 0.5).ceil() as i64
        };
        for y in range(1) {
            for x in range(0) {
                let d = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * 0.5 - window.centre;
                let at = y.rem_euclid(self.size[1]) * self.size[0] + x.rem_euclid(self.size[0]);
                visit(at as usize, d);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::windows::levels;
    use super::*;
    use glint_formats::Wrap;

    #[test]
    fn the_whole_example_s_mean_is_that_of_its_texels() {
        let projected = (0..20).map(|k| [0.03 * k as f32 - 0.3, 0.01 * (k * k % 7) as f32]).collect();
        let map = NormalMap { width: 5, height: 4, wrap: Wrap::Repeat, projected };
        let levels = levels(5, 4, 0.7);
        let window = Window::new(5, 4, levels.last().unwrap(), 100.0, 0);
        let (mut total, mut mean) = (0.0f64, DVec2::ZERO);
        MicroNormals::new(&map, 0.004, 64).for_each_sample(&window, |s, w| {
            total += w;
            mean += s * w;
        });
        let expected = map.projected.iter().map(|s| DVec2::new(s[0] as f64, s[1] as f64)).sum::<DVec2>() / 20.0;
        assert!((mean / total - expected).length() < 1e-9, "{mean} {expected}");
    }
}
