//! Texels → lobes: one Gaussian for each bilinear cell, or for each quarter of a texel.
//!
//! Tan et al. 2022, section 5.1.1, step 1, converts a texel to four Gaussians of σ_h = 1 / √(32 ln 2) at its normal. Here a
//! seed stands for a box in which the filtered map is one bilinear patch: weight, mean and covariance are the exact
//! moments of positions and normals over that box, σ_h = edge / √12 among them, and the patch's twist is a residual.

use super::gaussian::Gaussian4;
use crate::normal_map::NormalMap;
use glam::{DMat2, DVec2};
use glint_formats::Wrap;
use glint_formats::lobes::Filter;

/// A piece of an axis in which the map runs straight from one texel to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Middle, in texels.
    pub centre: f64,
    /// Length, in texels.
    pub length: f64,
    /// Texels before and after; the same where the map is constant.
    pub texels: [i64; 2],
    /// Where the middle lies between the texels' centres.
    pub fraction: f64,
}

/// Segments whose middles lie in `from … to` (whole texels) of an axis of `size` texels, one or two a texel.
pub fn segments(from: u32, to: u32, size: u32, wrap: Wrap, filter: Filter, halves: bool) -> Vec<Segment> {
    let mut out = Vec::new();
    let constant = |centre: f64, length: f64, texel: i64| Segment { centre, length, texels: [texel; 2], fraction: 0.5 };
    for i in from as i64..to as i64 {
        let x = i as f64;
        match (filter, halves) {
            (Filter::Nearest, false) => out.push(constant(x + 0.5, 1.0, i)),
            (Filter::Nearest, true) => out.extend([constant(x + 0.25, 0.5, i), constant(x + 0.75, 0.5, i)]),
            (Filter::Linear, true) => {
                out.push(Segment { centre: x + 0.25, length: 0.5, texels: [i - 1, i], fraction: 0.75 });
                out.push(Segment { centre: x + 0.75, length: 0.5, texels: [i, i + 1], fraction: 0.25 });
            }
            // A clamped map is constant over the half texels at its edges.
            (Filter::Linear, false) if i == 0 && wrap == Wrap::Clamp => out.push(constant(0.25, 0.5, 0)),
            (Filter::Linear, false) => {
                out.push(Segment { centre: x, length: 1.0, texels: [i - 1, i], fraction: 0.5 });
            }
        }
    }
    if filter == Filter::Linear && !halves && wrap == Wrap::Clamp && to == size {
        out.push(constant(size as f64 - 0.25, 0.5, size as i64 - 1));
    }
    out
}

/// The seed of the box of two segments.
pub fn seed(map: &NormalMap, x: &Segment, y: &Segment) -> Gaussian4 {
    let s = |a: usize, b: usize| map.texel(x.texels[a], y.texels[b]);
    let (s00, s10, s01, s11) = (s(0, 0), s(1, 0), s(0, 1), s(1, 1));
    let (top, bottom) = (s00.lerp(s10, x.fraction), s01.lerp(s11, x.fraction));
    let jacobian = DMat2::from_cols((s10 - s00).lerp(s11 - s01, y.fraction), bottom - top);
    // s = mean + J d + twist · d_x d_y, and the product of two independent offsets has variance a² b² / 144.
    let twist = s11 - s10 - s01 + s00;
    let residual = DMat2::from_cols(twist * twist.x, twist * twist.y) * ((x.length * y.length).powi(2) / 144.0);
    let spread = DMat2::from_diagonal(DVec2::new(x.length * x.length, y.length * y.length) / 12.0);
    Gaussian4::of_surface(
        x.length * y.length,
        DVec2::new(x.centre, y.centre),
        spread,
        top.lerp(bottom, y.fraction),
        jacobian,
        residual,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_cover_the_axis_once() {
        for wrap in [Wrap::Repeat, Wrap::Clamp] {
            for filter in [Filter::Linear, Filter::Nearest] {
                for halves in [false, true] {
                    let mut total = 0.0;
                    for (from, to) in [(0, 4), (4, 7)] {
                        total += segments(from, to, 7, wrap, filter, halves).iter().map(|s| s.length).sum::<f64>();
                    }
                    assert_eq!(total, 7.0, "{wrap:?} {filter:?} {halves}");
                }
            }
        }
    }

    #[test]
    fn a_seed_has_the_moments_of_the_filtered_map_over_its_box() {
        let map = NormalMap {
            width: 3,
            height: 2,
            wrap: Wrap::Repeat,
            projected: vec![[0.1, 0.2], [-0.3, 0.5], [0.0, 0.1], [0.4, -0.2], [0.3, 0.3], [-0.1, 0.0]],
        };
        for halves in [false, true] {
            let xs = segments(0, 3, 3, Wrap::Repeat, Filter::Linear, halves);
            let ys = segments(0, 2, 2, Wrap::Repeat, Filter::Linear, halves);
            for (x, y) in [(&xs[0], &ys[1]), (&xs[2], &ys[0])] {
                let seed = seed(&map, x, y);
                let (mut mean, mut square, mut cross) = (DVec2::ZERO, 0.0, DVec2::ZERO);
                const N: usize = 64;
                for b in 0..N {
                    for a in 0..N {
                        let d = DVec2::new(a as f64 + 0.5, b as f64 + 0.5) / N as f64 - 0.5;
                        let d = d * DVec2::new(x.length, y.length);
                        let s = map.bilinear(DVec2::new(x.centre, y.centre) + d).0;
                        mean += s;
                        square += (s.x - seed.mean[2]) * (s.y - seed.mean[3]);
                        cross += d * s.x;
                    }
                }
                let n = (N * N) as f64;
                assert!((mean / n - seed.normal()).length() < 1e-12);
                assert!((square / n - seed.covariance[8]).abs() < 1e-4);
                assert!((cross.x / n - seed.covariance[2]).abs() < 1e-4);
                assert!((cross.y / n - seed.covariance[5]).abs() < 1e-4);
            }
        }
    }
}
