//! From a normal map and the roughness of its material to the levels below it.
//!
//! A level's normal is the mean over the box of its texel, renormalised, as engines make it: diffuse light asks for that, and it does
//! not jump as a mode would. Its roughness is fitted ([`super::fit`]) to facets of the bilinear surface in the same box.

use super::baked::{Level, Textures};
use super::fit::{self, Lobe, Offsets, Scratch};
use super::levels::{shares, sizes};
use super::options::{LEAST_ALPHA, Roughness, TexturesOptions};
use crate::error::BakeError;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use glint_formats::Wrap;
use rayon::prelude::*;

/// How finely a texel is fitted.
struct Effort {
    /// Points of the surface under a texel, in texels of the level from its upper left corner.
    points: Vec<[f32; 2]>,
    offsets: Offsets,
}

/// Efforts of a level: for most texels, and for those whose facets spread far for the width of their lobes.
struct Efforts {
    usual: Effort,
    spread: Effort,
}

impl Efforts {
    /// Points along an edge and half vectors by level: fine levels have many texels and few normals under each.
    fn of(level: usize) -> Efforts {
        const USUAL: [(usize, usize); 8] =
            [(4, 96), (5, 128), (8, 192), (12, 192), (16, 256), (24, 256), (28, 384), (40, 512)];
        const SPREAD: [(usize, usize); 8] =
            [(5, 128), (7, 192), (10, 256), (14, 288), (18, 384), (24, 512), (32, 512), (40, 640)];
        let of = |counts: [(usize, usize); 8]| {
            let (edge, half_vectors) = counts[(level - 1).min(counts.len() - 1)];
            Effort { points: points(edge, level > 3), offsets: Offsets::new(half_vectors) }
        };
        Efforts { usual: of(USUAL), spread: of(SPREAD) }
    }
}

/// One point in each of `edge`² cells. Bilinear normals vary least at the centres of texels, so that points shall lie everywhere between
/// those alike: in an even grid where cells are smaller than texels or much the same, else moved about by a Kronecker sequence.
fn points(edge: usize, moved: bool) -> Vec<[f32; 2]> {
    let at = |i: usize, within: f64| ((i as f64 + within) / edge as f64) as f32;
    let point = |k: usize| {
        let (i, j, t) = (k % edge, k / edge, k as f64 + 0.5);
        if moved {
            return [at(i, (t * 0.754_877_666_246_692_7).fract()), at(j, (t * 0.569_840_290_998_053_2).fract())];
        }
        [at(i, [0.25, 0.75][(i / 2 + j) % 2]), at(j, [0.25, 0.75][(i + j / 2) % 2])]
    };
    (0..edge * edge).map(point).collect()
}

/// Bakes all levels below the map.
///
/// # Errors
/// Those of [`Roughness::validate`] and [`TexturesOptions::check`].
pub fn bake(
    map: &NormalMap,
    roughness: &Roughness,
    options: &TexturesOptions,
    progress: &dyn Progress,
) -> Result<Textures, BakeError> {
    options.check(map)?;
    roughness.validate(map)?;
    let all = sizes(map.width, map.height);
    progress.begin("fitting roughness", all.iter().skip(1).map(|&(_, height)| u64::from(height)).sum());
    let mut means: Option<Means> = None;
    let mut levels = Vec::with_capacity(all.len() - 1);
    for (level, &size) in all.iter().enumerate().skip(1) {
        let next = match &means {
            Some(finer) if (finer.width, finer.height) == (2 * size.0, 2 * size.1) => finer.halved(),
            _ => Means::of(map, size),
        };
        levels.push(fitted(map, roughness, &next, &Efforts::of(level), progress));
        means = Some(next);
    }
    progress.end();
    Ok(Textures { levels })
}

/// Mean normals of a level, not renormalised.
struct Means {
    width: u32,
    height: u32,
    normals: Vec<[f32; 3]>,
}

impl Means {
    /// From the texels of the map.
    fn of(map: &NormalMap, (width, height): (u32, u32)) -> Means {
        let (columns, rows) = (shares(map.width, width), shares(map.height, height));
        let texel = |k: usize| {
            let (first_column, columns) = &columns[k % width as usize];
            let (first_row, rows) = &rows[k / width as usize];
            let mut sum = [0.0_f32; 3];
            for (dj, row) in rows.iter().enumerate() {
                let line = (*first_row as usize + dj) * map.width as usize + *first_column as usize;
                let mut along = [0.0_f32; 3];
                for (share, &[x, y]) in columns.iter().zip(&map.projected[line..]) {
                    along[0] += share * x;
                    along[1] += share * y;
                    along[2] += share * lifted(x, y);
                }
                for (sum, value) in sum.iter_mut().zip(along) {
                    *sum += row * value;
                }
            }
            sum
        };
        let count = width as usize * height as usize;
        Means { width, height, normals: (0..count).into_par_iter().map(texel).collect() }
    }

    /// Means of four texels each; the same as from the map.
    fn halved(&self) -> Means {
        let (width, height) = (self.width / 2, self.height / 2);
        let wide = self.width as usize;
        let texel = |k: usize| {
            let at = k / width as usize * 2 * wide + k % width as usize * 2;
            let four = [at, at + 1, at + wide, at + wide + 1].map(|at| self.normals[at]);
            [0, 1, 2].map(|c| 0.25 * ((four[0][c] + four[1][c]) + (four[2][c] + four[3][c])))
        };
        let count = width as usize * height as usize;
        Means { width, height, normals: (0..count).into_par_iter().map(texel).collect() }
    }
}

/// z of a unit normal.
#[inline]
fn lifted(x: f32, y: f32) -> f32 {
    (1.0 - x * x - y * y).max(0.0).sqrt()
}

/// A level whose means are known.
fn fitted(map: &NormalMap, roughness: &Roughness, means: &Means, efforts: &Efforts, progress: &dyn Progress) -> Level {
    let width = means.width as usize;
    let ratio = [map.width as f32 / means.width as f32, map.height as f32 / means.height as f32];
    let surface = Surface { map, roughness };
    let row = |(j, line): (usize, &[[f32; 3]])| {
        let (mut facets, mut scratch) = (Vec::new(), Scratch::default());
        let mut texels = Vec::with_capacity(width);
        for (i, mean) in line.iter().enumerate() {
            let mean = unit(*mean);
            let corner = [i as f32 * ratio[0], j as f32 * ratio[1]];
            surface.facets(corner, ratio, &efforts.usual.points, &mut facets);
            let mut spread = Spread::of(&facets, mean);
            let mut offsets = &efforts.usual.offsets;
            if spread.is_wide() {
                surface.facets(corner, ratio, &efforts.spread.points, &mut facets);
                spread = Spread::of(&facets, mean);
                offsets = &efforts.spread.offsets;
            }
            let lobe = spread.lobe(&facets, mean, offsets, &mut scratch);
            texels.push(([lobe.normal[0], lobe.normal[1]], lobe.a2.sqrt().clamp(LEAST_ALPHA, 1.0)));
        }
        progress.advance(1);
        texels
    };
    let rows: Vec<Vec<([f32; 2], f32)>> = means.normals.par_chunks(width).enumerate().map(row).collect();
    let (normals, alphas) = rows.into_iter().flatten().unzip();
    Level { width: means.width, height: means.height, normals, alphas }
}

/// A mean normal at length 1; flat where normals cancel out.
fn unit([x, y, z]: [f32; 3]) -> [f32; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    if length > 1e-6 { [x / length, y / length, z / length] } else { [0.0, 0.0, 1.0] }
}

/// The normal is free where the variance of normals is beyond this part of the least α².
const FREE_FROM: f32 = 0.1;
/// Below this part of α², the variance of normals is in the limit of small variances.
const SMALL_VARIANCE: f32 = 0.01;

/// How facets differ.
struct Spread {
    /// Mean square distance from the mean normal.
    variance: f32,
    /// Mean α².
    a2: f32,
    /// Least and largest α².
    range: [f32; 2],
}

impl Spread {
    fn of(facets: &[Lobe], mean: [f32; 3]) -> Spread {
        let mut spread = Spread { variance: 0.0, a2: 0.0, range: [f32::MAX, 0.0] };
        for facet in facets {
            let [dx, dy, dz] = [0, 1, 2].map(|c| facet.normal[c] - mean[c]);
            spread.variance += dx * dx + dy * dy + dz * dz;
            spread.a2 += facet.a2;
            spread.range = [spread.range[0].min(facet.a2), spread.range[1].max(facet.a2)];
        }
        let share = 1.0 / facets.len() as f32;
        Spread { variance: spread.variance * share, a2: spread.a2 * share, ..spread }
    }

    /// What variance adds to α² in the limit of small variances; `docs/methods/textures.md` says why.
    fn broadening(&self) -> f32 {
        self.variance * (1.0 - self.a2) * (1.0 - self.a2)
    }

    /// Whether the facets spread far for the width of their lobes.
    fn is_wide(&self) -> bool {
        self.variance > FREE_FROM * self.range[0]
    }

    /// The lobe that is nearest to the facets.
    fn lobe(&self, facets: &[Lobe], mean: [f32; 3], offsets: &Offsets, scratch: &mut Scratch) -> Lobe {
        let [least, most] = self.range;
        let a2 = self.a2 + self.broadening();
        if self.variance < SMALL_VARIANCE * self.a2 && most <= (1.0 + SMALL_VARIANCE) * least {
            return Lobe { normal: mean, a2: a2.min(1.0) };
        }
        let begin = Lobe { normal: mean, a2: a2.max(1.001 * least).min(1.0) };
        fit::nearest(facets, begin, least, self.is_wide(), offsets, scratch)
    }
}

/// The bilinear surface.
struct Surface<'a> {
    map: &'a NormalMap,
    roughness: &'a Roughness,
}

impl Surface<'_> {
    /// Facets at points of the box of `size` texels from `corner` on.
    fn facets(&self, corner: [f32; 2], size: [f32; 2], points: &[[f32; 2]], facets: &mut Vec<Lobe>) {
        facets.clear();
        for point in points {
            facets.push(self.facet(corner[0] + size[0] * point[0], corner[1] + size[1] * point[1]));
        }
    }

    fn facet(&self, u: f32, v: f32) -> Lobe {
        let (p, q) = (u - 0.5, v - 0.5);
        let (i, j) = (p.floor(), q.floor());
        let (fx, fy) = (p - i, q - j);
        let columns = self.neighbours(i as i32, self.map.width);
        let rows = self.neighbours(j as i32, self.map.height).map(|row| row * self.map.width as usize);
        let at = [rows[0] + columns[0], rows[0] + columns[1], rows[1] + columns[0], rows[1] + columns[1]];
        let mix = |a: f32, b: f32, c: f32, d: f32| {
            let (top, bottom) = (a + (b - a) * fx, c + (d - c) * fx);
            top + (bottom - top) * fy
        };
        let [a, b, c, d] = at.map(|at| self.map.projected[at]);
        let (x, y) = (mix(a[0], b[0], c[0], d[0]), mix(a[1], b[1], c[1], d[1]));
        let perceptual = match self.roughness {
            Roughness::Constant(value) => *value,
            Roughness::Map(values) => {
                let [a, b, c, d] = at.map(|at| values[at]);
                mix(a, b, c, d)
            }
        };
        let alpha = (perceptual * perceptual).clamp(LEAST_ALPHA, 1.0);
        Lobe { normal: [x, y, lifted(x, y)], a2: alpha * alpha }
    }

    /// A texel and the next along an axis.
    fn neighbours(&self, i: i32, size: u32) -> [usize; 2] {
        let size = size as i32;
        let wrapped = |i: i32| match self.map.wrap {
            Wrap::Repeat if i < 0 => i + size,
            Wrap::Repeat if i >= size => i - size,
            Wrap::Repeat => i,
            Wrap::Clamp => i.clamp(0, size - 1),
        };
        [wrapped(i) as usize, wrapped(i + 1) as usize]
    }
}
