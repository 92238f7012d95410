//! From a normal map and the roughness of its material to the levels below it.
//!
//! A texel's normal is the mean over its box, renormalised, as engines make it, unless another is worth it; normal and roughness are
//! fitted ([`super::fit`]) to facets of the bilinear surface in the same box.

use super::anisotropy;
use super::baked::{Anisotropy, Level, Textures};
use super::fit::{self, Facet, Lobe, Offsets, Scratch};
use super::levels::{shares, sizes};
use super::options::{Axes, LEAST_ALPHA, Roughness, TexturesOptions};
use super::surface::{Layout, Surface};
use crate::error::BakeError;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use rayon::prelude::*;

/// How finely a texel is fitted.
struct Effort {
    layout: Layout,
    offsets: Offsets,
}

impl Effort {
    /// Fine levels have many texels, and few normals under each.
    fn of(map: &NormalMap, size: (u32, u32), level: usize, axes: Option<Axes>) -> Effort {
        const CELLS: usize = 3;
        // Parts of a patch along its edges, then points along those of a texel; and half vectors.
        const BY_LEVEL: [(usize, usize); 8] =
            [(1, 48), (1, 96), (1, 128), (12, 192), (18, 256), (24, 448), (32, 640), (40, 768)];
        // Cells are broadened alike in all directions, which thin lobes would feel: smaller ones.
        const OF_ANISOTROPY: [(usize, usize); CELLS] = [(3, 96), (2, 192), (2, 256)];
        let k = (level - 1).min(BY_LEVEL.len() - 1);
        let (count, half_vectors) = if axes.is_some() && k < CELLS { OF_ANISOTROPY[k] } else { BY_LEVEL[k] };
        let layout = if k < CELLS { Layout::cells(map, size, count as u32) } else { Layout::points(count) };
        Effort { layout, offsets: Offsets::new(half_vectors) }
    }
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
    let mut against_round = Vec::new();
    for (level, &size) in all.iter().enumerate().skip(1) {
        let next = match &means {
            Some(finer) if (finer.width, finer.height) == (2 * size.0, 2 * size.1) => finer.halved(),
            _ => Means::of(map, size),
        };
        let effort = Effort::of(map, size, level, options.anisotropy);
        let (level, errors) = fitted((map, roughness), &next, &effort, options.anisotropy, progress);
        levels.push(level);
        if options.anisotropy == Some(Axes::Surface) {
            against_round.push(errors);
        }
        means = Some(next);
    }
    progress.end();
    anisotropy::align(&mut levels);
    Ok(Textures { levels, against_round })
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

/// A level whose means are known, and the means of [`Texel::errors`].
fn fitted(
    (map, roughness): (&NormalMap, &Roughness),
    means: &Means,
    effort: &Effort,
    axes: Option<Axes>,
    progress: &dyn Progress,
) -> (Level, [f32; 2]) {
    let width = means.width as usize;
    let size = (means.width, means.height);
    let surface = Surface { map, roughness };
    let row = |(j, line): (usize, &[[f32; 3]])| {
        let mut fitter = Fitter { surface, effort, size, facets: Vec::new(), scratch: Scratch::default() };
        let texel = |(i, mean): (usize, &[f32; 3])| match axes {
            Some(axes) => fitter.anisotropic((i, j), *mean, axes),
            None => fitter.texel((i, j), *mean),
        };
        let texels: Vec<Texel> = line.iter().enumerate().map(texel).collect();
        progress.advance(1);
        texels
    };
    let rows: Vec<Vec<Texel>> = means.normals.par_chunks(width).enumerate().map(row).collect();
    let count = means.normals.len();
    let mut level = Level {
        width: means.width,
        height: means.height,
        normals: Vec::with_capacity(count),
        alphas: Vec::with_capacity(count),
        anisotropies: Vec::with_capacity(if axes.is_some() { count } else { 0 }),
    };
    let mut errors = [0.0_f64; 2];
    for texel in rows.into_iter().flatten() {
        for (sum, error) in errors.iter_mut().zip(texel.errors) {
            *sum += f64::from(error);
        }
        level.normals.push(texel.normal);
        level.alphas.push(texel.alpha);
        level.anisotropies.extend(texel.anisotropy);
    }
    (level, errors.map(|sum| (sum / count as f64) as f32))
}

/// A texel of a level.
struct Texel {
    normal: [f32; 2],
    alpha: f32,
    anisotropy: Option<Anisotropy>,
    /// Errors of the lobe that it has and of a round one, as parts of what the facets show; for axes of the surface.
    errors: [f32; 2],
}

/// Fits the texels of a row.
struct Fitter<'a> {
    surface: Surface<'a>,
    effort: &'a Effort,
    size: (u32, u32),
    facets: Vec<Facet>,
    scratch: Scratch,
}

impl Fitter<'_> {
    /// A texel whose mean normal is known.
    fn texel(&mut self, at: (usize, usize), sum: [f32; 3]) -> Texel {
        let mean = unit(sum);
        self.surface.facets(&self.effort.layout, self.size, at, sum, &mut self.facets);
        let spread = Spread::of(&self.facets, mean);
        let (lobe, _) = spread.lobe(&self.facets, mean, &self.effort.offsets, &mut self.scratch);
        let alpha = lobe.a2.sqrt().clamp(LEAST_ALPHA, 1.0);
        Texel { normal: [lobe.normal[0], lobe.normal[1]], alpha, anisotropy: None, errors: [0.0; 2] }
    }

    /// The same by an anisotropic lobe.
    fn anisotropic(&mut self, at: (usize, usize), sum: [f32; 3], axes: Axes) -> Texel {
        let mean = unit(sum);
        self.surface.facets(&self.effort.layout, self.size, at, sum, &mut self.facets);
        let spread = Spread::of(&self.facets, mean);
        let (round, round_error) = spread.lobe(&self.facets, mean, &self.effort.offsets, &mut self.scratch);
        // Around a normal that is free, the lobe is stretched about the one that is the best for a round lobe.
        let normal = if axes == Axes::Surface { mean } else { round.normal };
        let a2 = [spread.a2, spread.range[0]];
        let (lobe, error) =
            anisotropy::nearest(&self.facets, normal, a2, axes, &self.effort.offsets, &mut self.scratch);
        let (alpha, anisotropy) = lobe.stored();
        Texel { normal: [normal[0], normal[1]], alpha, anisotropy: Some(anisotropy), errors: [error, round_error] }
    }
}

/// A mean normal at length 1; flat where normals cancel out.
fn unit([x, y, z]: [f32; 3]) -> [f32; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    if length > 1e-6 { [x / length, y / length, z / length] } else { [0.0, 0.0, 1.0] }
}

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
    fn of(facets: &[Facet], mean: [f32; 3]) -> Spread {
        let mut spread = Spread { variance: 0.0, a2: 0.0, range: [f32::MAX, 0.0] };
        for Facet { lobe, weight } in facets {
            let [dx, dy, dz] = [0, 1, 2].map(|c| lobe.normal[c] - mean[c]);
            spread.variance += weight * (dx * dx + dy * dy + dz * dz);
            spread.a2 += weight * lobe.a2;
            spread.range = [spread.range[0].min(lobe.a2), spread.range[1].max(lobe.a2)];
        }
        spread
    }

    /// What variance adds to α² in the limit of small variances; `docs/methods/textures.md` says why.
    fn broadening(&self) -> f32 {
        self.variance * (1.0 - self.a2) * (1.0 - self.a2)
    }

    /// The lobe that is nearest to the facets, and its error; none in the limit of small variances.
    fn lobe(&self, facets: &[Facet], mean: [f32; 3], offsets: &Offsets, scratch: &mut Scratch) -> (Lobe, f32) {
        let [least, most] = self.range;
        let a2 = self.a2 + self.broadening();
        if self.variance < SMALL_VARIANCE * self.a2 && most <= (1.0 + SMALL_VARIANCE) * least {
            return (Lobe { normal: mean, a2: a2.min(1.0) }, 0.0);
        }
        let begin = Lobe { normal: mean, a2: a2.max(1.001 * least).min(1.0) };
        fit::nearest(facets, begin, least, offsets, scratch)
    }
}
