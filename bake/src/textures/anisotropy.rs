//! The anisotropic lobe of least L1 error, as engines shade KHR_materials_anisotropy.
//!
//! With T along the direction and B across it,
//!
//! D = 1/(π α_t α_b ((T·h)²/α_t² + (B·h)²/α_b² + (n·h)²)²).
//!
//! α_b is the α of the roughness, α_t = α_b + (1 − α_b) strength². The extension's own code takes T and B from the surface
//! ([`Axes::Surface`]): its highlight lies around the surface's normal whatever n is, normals that lean are a wider lobe, and the
//! second moments that say T are about that normal. With [`Axes::Normal`] all of these are about n, which is the mean of all normals.
//!
//! Masking is Hammon's as in [`super::fit`], for the α along the azimuth of view and of light.

use super::baked::{Anisotropy, Level};
use super::fit::{Facet, LANES, Lanes, Offsets, Samples, Scratch, WORTH, descend, place, shine, whole};
use super::options::{Axes, LEAST_ALPHA};
use multiversion::multiversion;

impl Stretched {
    /// GGX α across the direction, and what the extension makes of both widths.
    pub fn stored(&self) -> (f32, Anisotropy) {
        let [along, across] = self.widths.map(|width| width.sqrt().clamp(LEAST_ALPHA, 1.0));
        let strength = if across < 1.0 { ((along - across).max(0.0) / (1.0 - across)).sqrt() } else { 0.0 };
        (across, Anisotropy { strength, direction: self.direction })
    }
}

/// An anisotropic lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretched {
    /// Unit vector along which the lobe is wider, in the plane of the texture.
    pub direction: [f32; 2],
    /// α_t² along it, and α_b² across it; the first is not the less.
    pub widths: [f32; 2],
}

/// Below this part of α², squares of projected normals are in the limit of small variances.
const SMALL_SQUARES: f32 = 0.005;

/// Samples against a normal and the axes of a lobe.
#[derive(Clone, Copy, Debug, Default)]
struct Along {
    /// (T·h)², (B·h)², (n·h)².
    half: [Lanes; 3],
    /// Parts of T and B in the azimuth, cos² and sin², and n·v.
    view: [Lanes; 3],
    /// The same, and n·l where it is lit.
    light: [Lanes; 3],
}

/// Mean squares of the facets' projected normals about those of `centre` along their principal axes, the larger first, and the direction
/// of that.
fn moments(facets: &[Facet], centre: [f32; 3]) -> ([f32; 2], [f32; 2]) {
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for Facet { lobe, weight } in facets {
        let [x, y] = [0, 1].map(|c| lobe.normal[c] - centre[c]);
        xx += weight * x * x;
        xy += weight * x * y;
        yy += weight * y * y;
    }
    let (mean, half, off) = (0.5 * (xx + yy), 0.5 * (xx - yy), xy);
    let length = (half * half + off * off).sqrt();
    if length <= 1e-6 * mean {
        return ([mean, mean], [1.0, 0.0]);
    }
    ([mean + length, (mean - length).max(0.0)], halved([half / length, off / length]))
}

/// A unit vector of half the angle, from −π/2 to π/2.
fn halved([cos, sin]: [f32; 2]) -> [f32; 2] {
    let c = (0.5 * (1.0 + cos)).max(0.0).sqrt();
    let s = (0.5 * (1.0 - cos)).max(0.0).sqrt();
    [c, if sin < 0.0 { -s } else { s }]
}

/// The lobe nearest to facets, and its error as a part of what they show: facets of mean normal `mean` and mean α² `a2`; none of them has a lesser α² than `least`. Where squares of
/// projected normals are small, it is that of the limit of small variances.
pub(super) fn nearest(
    facets: &[Facet],
    mean: [f32; 3],
    [a2, least]: [f32; 2],
    axes: Axes,
    offsets: &Offsets,
    scratch: &mut Scratch,
) -> (Stretched, f32) {
    let centre = if axes == Axes::Surface { [0.0, 0.0, 1.0] } else { mean };
    let (squares, direction) = moments(facets, centre);
    let rest = 1.0 - a2;
    let grown = squares.map(|square| (a2 + 2.0 * square * (rest * rest)).min(1.0));
    if squares[0] < SMALL_SQUARES * a2 {
        return (Stretched { direction, widths: grown }, 0.0);
    }
    let begin = grown.map(|width| width.max(1.001 * least).min(1.0));
    place(centre, stretch(direction, begin), offsets, &mut scratch.samples);
    shine(facets, &mut scratch.samples, &mut scratch.terms);
    let samples = &scratch.samples;
    let along = see_along(mean, frame(centre, direction), samples);
    let at = |broadening: f32| (least + broadening).min(1.0);
    let error = |widths: [f32; 2]| error_along(widths, samples, &along);

    let (broadening, round_error) = descend(0.5 * (begin[0] + begin[1]) - least, |b| error([at(b); 2]));
    let round = [at(broadening); 2];
    let mut widths = begin;
    let mut found = f32::MAX;
    for _ in 0..2 {
        let across = descend(widths[1] - least, |b| error([widths[0].max(at(b)), at(b)])).0;
        widths = [widths[0].max(at(across)), at(across)];
        let (over, least_error) = descend((widths[0] - least).max(1e-6), |b| error([at(b).max(widths[1]), widths[1]]));
        (widths[0], found) = (at(over).max(widths[1]), least_error);
    }
    let (widths, error) = if found < (1.0 - WORTH) * round_error { (widths, found) } else { (round, round_error) };
    (Stretched { direction, widths }, error / whole(samples))
}

/// What makes slopes of α = 1 those of a lobe with these squared widths.
fn stretch([x, y]: [f32; 2], widths: [f32; 2]) -> [[f32; 2]; 2] {
    let [t, b] = widths.map(f32::sqrt);
    [[t * x, -b * y], [t * y, b * x]]
}

/// T and B: a direction of the plane of the texture in the plane across `centre`, and what stands on both.
fn frame(centre: [f32; 3], direction: [f32; 2]) -> [[f32; 3]; 2] {
    let along = [direction[0], direction[1], 0.0];
    let off = dot(centre, along);
    let t = [0, 1, 2].map(|c| along[c] - off * centre[c]);
    let length = dot(t, t).sqrt();
    // A direction that looks along the normal has none across it.
    let [tx, ty, tz] = if length > 1e-3 { t.map(|component| component / length) } else { along };
    let [x, y, z] = centre;
    [[tx, ty, tz], [y * tz - z * ty, z * tx - x * tz, x * ty - y * tx]]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Samples against a normal and axes.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+avx"))]
fn see_along(normal: [f32; 3], [t, b]: [[f32; 3]; 2], samples: &[Samples]) -> Vec<Along> {
    let mut along = vec![Along::default(); samples.len()];
    for (of, along) in samples.iter().zip(&mut along) {
        let mut block = Along::default();
        for k in 0..LANES {
            let [h, v] = [&of.half, &of.view].map(|vector| [vector[0][k], vector[1][k], vector[2][k]]);
            let l = [0, 1, 2].map(|c| of.twice[k] * h[c] - v[c]);
            let dots = |vector: [f32; 3]| [t, b, normal].map(|axis| dot(axis, vector));
            let ([th, bh, nh], [tv, bv, nv], [tl, bl, nl]) = (dots(h), dots(v), dots(l));
            (block.half[0][k], block.half[1][k], block.half[2][k]) = (th * th, bh * bh, nh * nh);
            let (of_view, of_light) = (1.0 / (tv * tv + bv * bv + 1e-12), 1.0 / (tl * tl + bl * bl + 1e-12));
            (block.view[0][k], block.view[1][k], block.view[2][k]) =
                (tv * tv * of_view, bv * bv * of_view, nv.max(1e-3));
            (block.light[0][k], block.light[1][k]) = (tl * tl * of_light, bl * bl * of_light);
            block.light[2][k] = if nv > 0.0 { nl.max(0.0) } else { 0.0 };
        }
        *along = block;
    }
    along
}

/// L1 error of a lobe of these squared widths, up to the factor of [`super::fit`].
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2", "x86_64+avx"))]
fn error_along([t2, b2]: [f32; 2], samples: &[Samples], along: &[Along]) -> f32 {
    let mut sums: Lanes = [0.0; LANES];
    let (over_t, over_b, power) = (1.0 / t2, 1.0 / b2, 1.0 / (t2 * b2).sqrt());
    for (of, along) in samples.iter().zip(along) {
        let Along { half, view, light } = along;
        for k in 0..LANES {
            let t = half[0][k] * over_t + half[1][k] * over_b + half[2][k];
            let of_view = (t2 * view[0][k] + b2 * view[1][k]).sqrt();
            let of_light = (t2 * light[0][k] + b2 * light[1][k]).sqrt();
            let (nv, nl) = (view[2][k], light[2][k]);
            let masking = nl * (of_view + nv * (1.0 - of_view)) + nv * (of_light + nl * (1.0 - of_light));
            sums[k] += of.weight[k] * (light[2][k] * (power / (t * t * masking)) - of.exact[k]).abs();
        }
    }
    sums.iter().sum()
}

/// Turns directions so that neighbours and levels that are near to one line point the same way, for they are interpolated: all to one
/// side of the line across the direction of the finest level as a whole.
pub(super) fn align(levels: &mut [Level]) {
    // Directions at twice the angle have no sign.
    let (mut cos, mut sin) = (0.0_f64, 0.0_f64);
    for Anisotropy { strength, direction: [x, y] } in levels.iter().take(1).flat_map(|level| &level.anisotropies) {
        cos += f64::from(strength * (x * x - y * y));
        sin += f64::from(strength * (2.0 * x * y));
    }
    let length = (cos * cos + sin * sin).sqrt();
    let [x, y] = if length > 0.0 { halved([cos / length, sin / length].map(|c| c as f32)) } else { [1.0, 0.0] };
    for Anisotropy { direction, .. } in levels.iter_mut().flat_map(|level| &mut level.anisotropies) {
        if x * direction[0] + y * direction[1] < 0.0 {
            *direction = direction.map(|component| -component);
        }
    }
}
