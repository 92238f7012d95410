//! The micro-normals of a rectangle of the example, as weighted samples dense enough for a given spacing in the disk.
//!
//! Bilinear interpolation makes the map a patchwork of bilinear cells between texel centres; each quarter of a texel
//! lies in one cell, so normals there are a bilinear patch whose extremes are its four corners.

use crate::normal_map::NormalMap;
use glam::DVec2;

/// A rectangle of the example in texels: `min` inclusive, `max` exclusive, whole texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TexelRect {
    /// Upper left texel.
    pub min: [u32; 2],
    /// One past the lower right texel.
    pub max: [u32; 2],
}

impl TexelRect {
    /// Number of texels.
    pub fn area(&self) -> u32 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }
}

/// Bounds (min, max) of the projected normals in the rectangle.
pub fn bounds(map: &NormalMap, rect: TexelRect) -> (DVec2, DVec2) {
    let mut lo = DVec2::splat(f64::INFINITY);
    let mut hi = DVec2::splat(f64::NEG_INFINITY);
    for_each_quarter(map, rect, |corners| {
        for c in corners {
            lo = lo.min(*c);
            hi = hi.max(*c);
        }
    });
    (lo, hi)
}

/// Calls `visit(s, weight)` for samples of the rectangle's normals; weights sum to 1 and neighbouring samples of one
/// patch are at most `spacing` apart in the disk, as long as that takes no more than `max_per_axis` samples along an
/// edge of a quarter texel.
pub fn for_each_sample(
    map: &NormalMap,
    rect: TexelRect,
    spacing: f64,
    max_per_axis: u32,
    mut visit: impl FnMut(DVec2, f64),
) {
    let quarter_weight = 1.0 / (4.0 * rect.area() as f64);
    for_each_quarter(map, rect, |[s00, s10, s01, s11]| {
        let steps = |a: f64, b: f64| ((a.max(b) / spacing).ceil() as u32).clamp(1, max_per_axis);
        let nu = steps(s00.distance(*s10), s01.distance(*s11));
        let nv = steps(s00.distance(*s01), s10.distance(*s11));
        let weight = quarter_weight / (nu as f64 * nv as f64);
        for j in 0..nv {
            let v = (j as f64 + 0.5) / nv as f64;
            let left = s00.lerp(*s01, v);
            let step = (s10.lerp(*s11, v) - left) / nu as f64;
            for i in 0..nu {
                visit(left + step * (i as f64 + 0.5), weight);
            }
        }
    });
}

/// Calls `visit` with the corner normals (00, 10, 01, 11) of every quarter texel of the rectangle.
fn for_each_quarter(map: &NormalMap, rect: TexelRect, mut visit: impl FnMut(&[DVec2; 4])) {
    for y in rect.min[1] as i64..rect.max[1] as i64 {
        for x in rect.min[0] as i64..rect.max[0] as i64 {
            // Normals on the 3 × 3 lattice of the texel's corners, edge midpoints and centre.
            let mut lattice = [[DVec2::ZERO; 3]; 3];
            for (b, row) in lattice.iter_mut().enumerate() {
                for (a, s) in row.iter_mut().enumerate() {
                    let (dx, dy) = (a as i64 - 1, b as i64 - 1);
                    *s = 0.25
                        * (map.texel(x, y) + map.texel(x + dx, y) + map.texel(x, y + dy) + map.texel(x + dx, y + dy));
                }
            }
            for b in 0..2 {
                for a in 0..2 {
                    visit(&[lattice[b][a], lattice[b][a + 1], lattice[b + 1][a], lattice[b + 1][a + 1]]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glint_formats::Wrap;

    fn noisy_map() -> NormalMap {
        let projected = (0..20u32)
            .map(|k| {
                let h = |m: u32| (k.wrapping_mul(m) % 97) as f32 / 97.0 - 0.5;
                [h(31), h(57)]
            })
            .collect();
        NormalMap { width: 5, height: 4, wrap: Wrap::Repeat, projected }
    }

    #[test]
    fn quarters_follow_the_bilinear_map() {
        let map = noisy_map();
        let rect = TexelRect { min: [4, 3], max: [5, 4] };
        let mut corners = Vec::new();
        for_each_quarter(&map, rect, |c| corners.push(*c));
        for (k, at) in [(0, (4.0, 3.0)), (3, (4.5, 3.5))] {
            let (s, _) = map.bilinear(DVec2::new(at.0, at.1));
            assert!((corners[0][k] - s).length() < 1e-12);
        }
        assert!((corners[3][3] - map.bilinear(DVec2::new(5.0, 4.0)).0).length() < 1e-12);
    }

    #[test]
    fn weights_sum_to_one_and_the_mean_is_the_map_s() {
        let map = noisy_map();
        let rect = TexelRect { min: [0, 0], max: [5, 4] };
        let (mut total, mut mean) = (0.0, DVec2::ZERO);
        for_each_sample(&map, rect, 0.01, 64, |s, w| {
            total += w;
            mean += s * w;
        });
        let expected = map.projected.iter().map(|s| DVec2::new(s[0] as f64, s[1] as f64)).sum::<DVec2>() / 20.0;
        assert!((total - 1.0f64).abs() < 1e-12);
        assert!((mean - expected).length() < 1e-9, "{mean} {expected}");
    }
}
