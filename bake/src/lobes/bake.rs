//! A normal map → MIP-mapped lobes: seeds, bottom-up reduction by cells, packed levels.
//!
//! Tan et al. 2022, section 5.1.2. Where the paper clusters every level from the texels, a level here reduces the lobes of
//! the level below: cheaper, and closer to the map, since a good lobe is made once.

use super::baked::BakedLobes;
use super::gaussian::Gaussian4;
use super::merge::{self, MergeSettings};
use super::options::{LobesOptions, NormalsChoice, ROUNDING};
use super::quality::{self, Measured};
use super::quantise;
use super::query::QuerySettings;
use super::reference::Reference;
use crate::error::Result;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use crate::quality::sweep;
use crate::rng::{ItemRng, Purpose};
use glam::{DMat2, DVec2, Vec2};
use glint_formats::Wrap;
use glint_formats::lobes::{
    BEYOND_RIM, Filter, FootprintError, LobeLevel, LobesParams, MAX_LAST_CELLS, NormalsStorage,
};
use rayon::prelude::*;

/// Edge of cells that are reduced from seeds, one a texel, in texels; half that for four seeds a texel. Finer than the stored
/// levels: the cost of a reduction grows with the square of the parts of a cell.
const SEED_CELL: u32 = 8;
/// Footprint that cells of an edge are read with, over that edge: differences of position below it do not show.
const BLUR_OF_CELL: f64 = 0.6;
/// Sizes of footprints that the bake measures its error over, in texels, as far as the map goes.
pub(crate) const MEASURED_SIGMAS: [f64; 5] = [2.0, 4.0, 8.0, 16.0, 32.0];

/// Standard deviation of footprints, in texels, above which half as many are measured.
const LARGE_SIGMA: f64 = 4.0;
/// Range of normals over the roughness that the error is measured at, at most: the exact NDF of a rougher map takes minutes.
const MEASURED_RANGE: f64 = 100.0;

/// Pieces of the reference that the bake measures against are this much coarser than they could be, which changes E₁ by less
/// than half a point on steep maps.
pub(crate) const MEASURED_REFINEMENT: f64 = 0.6;

/// Bakes one map; reports the stages `lobes` and `error`.
///
/// # Errors
/// `BadOption` for an option out of range, `LimitExceeded` for a map that is too large.
pub fn bake(map: &NormalMap, options: &LobesOptions, progress: &dyn Progress) -> Result<BakedLobes> {
    options.check(map)?;
    let mut baked = without_levels(map, options);
    build_levels(map, options, &mut baked, progress);
    baked.params.rim_roughness = baked.rim_roughness(BEYOND_RIM);
    measure(map, options, &mut baked, progress);
    Ok(baked)
}

/// A map's normals and parameters; lobes are to follow.
pub(crate) fn without_levels(map: &NormalMap, options: &LobesOptions) -> BakedLobes {
    let (normals, words) = store_normals(map, options);
    let [low, high] = normal_range(map);
    let mut baked = BakedLobes {
        params: LobesParams {
            width: map.width,
            height: map.height,
            wrap: map.wrap,
            filter: options.filter,
            intrinsic_roughness: options.roughness as f32,
            storage: options.storage,
            normals,
            merge: options.merge,
            seeds: options.seeds,
            lobes_per_cell: options.lobes_per_cell,
            step_texels: 0,
            normal_low: low.to_array(),
            normal_extent: (high - low).to_array(),
            levels: Vec::new(),
            rim_roughness: 0.0,
            measured_roughness: options.roughness as f32,
            measured: Vec::new(),
        },
        lobes: Vec::new(),
        normals: Vec::new(),
    };
    baked.normals = normal_pairs(&baked.params, &words);
    baked
}

/// Levels of cells of doubling edge, up to so few cells that all of them are read for the whole map: one cell's lobes would
/// be too few for it.
fn grids(map: &NormalMap, options: &LobesOptions) -> Vec<LobeLevel> {
    let mut cell = options.cell_texels;
    let mut grids = Vec::new();
    loop {
        grids.push(grid(map, cell));
        let LobeLevel { cells_x, cells_y, .. } = grids[grids.len() - 1];
        if cells_x.max(cells_y) <= MAX_LAST_CELLS {
            return grids;
        }
        cell *= 2;
    }
}

/// A level's grid, without lobes yet.
pub(crate) fn grid(map: &NormalMap, cell_texels: u32) -> LobeLevel {
    LobeLevel {
        cell_texels,
        cells_x: map.width.div_ceil(cell_texels),
        cells_y: map.height.div_ceil(cell_texels),
        first_lobe: 0,
        weight_scale: 1.0,
        position_sigma: [1.0; 2],
        residual_sigma: [1.0; 2],
        jacobian_scale: 0.0,
    }
}

fn build_levels(map: &NormalMap, options: &LobesOptions, baked: &mut BakedLobes, progress: &dyn Progress) {
    let grids = grids(map, options);
    let count = |grid: &LobeLevel| grid.cells_x as usize * grid.cells_y as usize;
    // Cells of the first level hold finer ones that are not kept, so that they cost several times as much.
    let steps = |at: usize| if at == 0 { 4 } else { 1 };
    progress.begin("lobes", grids.iter().enumerate().map(|(at, grid)| steps(at) * count(grid) as u64).sum());
    let mut finer: Option<(LobeLevel, Vec<Vec<Gaussian4>>)> = None;
    for (at, grid) in grids.iter().enumerate() {
        let cells: Vec<Vec<Gaussian4>> = (0..count(grid))
            .into_par_iter()
            .map(|cell| {
                let (x, y) = (cell as u32 % grid.cells_x, cell as u32 / grid.cells_x);
                let parts = match &finer {
                    None => finest_parts(map, options, grid, x, y),
                    Some((below, cells)) => children(below, cells, x, y),
                };
                let lobes = reduce(options, grid, x, y, &parts);
                progress.advance(steps(at));
                lobes
            })
            .collect();
        store(grid, &cells, baked);
        finer = Some((*grid, cells));
    }
    progress.end();
}

pub(crate) fn reduce(options: &LobesOptions, grid: &LobeLevel, x: u32, y: u32, parts: &[Gaussian4]) -> Vec<Gaussian4> {
    let settings = MergeSettings {
        merge: options.merge,
        lobes: options.lobes_per_cell as usize,
        blur: [BLUR_OF_CELL * grid.cell_texels as f64, options.roughness],
    };
    let mut rng = ItemRng::new(options.seed, Purpose::LobeCells(grid.cell_texels), y * grid.cells_x + x);
    merge::reduce(parts, &settings, &mut rng)
}

/// What a cell of the first level is reduced from: seeds, or cells of half its edge that are not kept.
pub(crate) fn finest_parts(
    map: &NormalMap,
    options: &LobesOptions,
    cell: &LobeLevel,
    x: u32,
    y: u32,
) -> Vec<Gaussian4> {
    let seed_cell = if options.seeds == 4 { SEED_CELL / 2 } else { SEED_CELL };
    if cell.cell_texels <= seed_cell {
        return cell_seeds(map, options, cell, x, y);
    }
    let below = grid(map, cell.cell_texels / 2);
    let mut parts = Vec::new();
    for j in 2 * y..(2 * y + 2).min(below.cells_y) {
        for i in 2 * x..(2 * x + 2).min(below.cells_x) {
            parts.extend(reduce(options, &below, i, j, &finest_parts(map, options, &below, i, j)));
        }
    }
    parts
}

/// A piece of an axis in which the map runs straight from one texel to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Segment {
    /// Middle, in texels.
    centre: f64,
    /// Length, in texels.
    length: f64,
    /// Texels before and after; the same where the map is constant.
    texels: [i64; 2],
    /// Where the middle lies between the texels' centres.
    fraction: f64,
}

/// Segments whose middles lie in `from … to` (whole texels) of an axis of `size` texels, one or two a texel.
fn segments(from: u32, to: u32, size: u32, wrap: Wrap, filter: Filter, halves: bool) -> Vec<Segment> {
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

/// The seed of the box of two segments: the lobe of a box in which the filtered map is one bilinear patch, with the exact moments
/// of positions and normals over it.
///
/// Tan et al. 2022, section 5.1.1, step 1, converts a texel to four Gaussians of σ_h = 1 / √(32 ln 2) at its normal. Here
/// σ_h = edge / √12, and the patch's twist is a residual.
fn seed(map: &NormalMap, x: &Segment, y: &Segment) -> Gaussian4 {
    let s = |a: usize, b: usize| map.texel(x.texels[a], y.texels[b]);
    let (s00, s10, s01, s11) = (s(0, 0), s(1, 0), s(0, 1), s(1, 1));
    let (top, bottom) = (s00.lerp(s10, x.fraction), s01.lerp(s11, x.fraction));
    let jacobian = DMat2::from_cols((s10 - s00).lerp(s11 - s01, y.fraction), bottom - top);
    // s = mean + J d + twist · d_x d_y, and the product of two independent offsets has variance a² b² / 144.
    let twist = s11 - s10 - s01 + s00;
    let residual = DMat2::from_cols(twist * twist.x, twist * twist.y) * ((x.length * y.length).powi(2) / 144.0);
    let positions = DMat2::from_diagonal(DVec2::new(x.length * x.length, y.length * y.length) / 12.0);
    Gaussian4::of_surface(
        x.length * y.length,
        DVec2::new(x.centre, y.centre),
        positions,
        top.lerp(bottom, y.fraction),
        jacobian,
        residual,
    )
}

fn cell_seeds(map: &NormalMap, options: &LobesOptions, grid: &LobeLevel, x: u32, y: u32) -> Vec<Gaussian4> {
    let segments = |cell: u32, size: u32| {
        let (from, to) = (cell * grid.cell_texels, ((cell + 1) * grid.cell_texels).min(size));
        segments(from, to, size, map.wrap, options.filter, options.seeds == 4)
    };
    let (columns, rows) = (segments(x, map.width), segments(y, map.height));
    rows.iter().flat_map(|row| columns.iter().map(|column| seed(map, column, row))).collect()
}

fn children(below: &LobeLevel, cells: &[Vec<Gaussian4>], x: u32, y: u32) -> Vec<Gaussian4> {
    let mut parts = Vec::new();
    for j in 2 * y..(2 * y + 2).min(below.cells_y) {
        for i in 2 * x..(2 * x + 2).min(below.cells_x) {
            parts.extend_from_slice(&cells[(j * below.cells_x + i) as usize]);
        }
    }
    parts
}

/// Appends a level's records.
pub(crate) fn store(grid: &LobeLevel, cells: &[Vec<Gaussian4>], baked: &mut BakedLobes) {
    let stride = baked.params.storage.stride() as usize;
    let level = LobeLevel {
        first_lobe: (baked.lobes.len() / stride) as u32,
        ..quantise::ranges(cells.iter().flatten(), *grid)
    };
    for (cell, lobes) in cells.iter().enumerate() {
        let at = DVec2::new((cell as u32 % grid.cells_x) as f64, (cell as u32 / grid.cells_x) as f64);
        let corner = at * baked.params.step(grid.cell_texels) as f64;
        for k in 0..baked.params.lobes_per_cell as usize {
            quantise::encode(lobes.get(k), corner, &baked.params, &level, &mut baked.lobes);
        }
    }
    baked.params.levels.push(level);
}

fn normal_range(map: &NormalMap) -> [Vec2; 2] {
    let texels = map.projected.iter().map(|s| Vec2::from(*s));
    let (low, high) = texels.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(lo, hi), s| (lo.min(s), hi.max(s)));
    [low, high]
}

/// How normals are stored, and the word of each texel.
fn store_normals(map: &NormalMap, options: &LobesOptions) -> (NormalsStorage, Vec<u32>) {
    let unorm = |v: f32| ((v + 1.0) * 127.5).round().clamp(0.0, 255.0);
    let error: f64 = map.projected.iter().flatten().map(|v| ((unorm(*v) / 127.5 - 1.0 - v) as f64).powi(2)).sum();
    let rms = (error / (2 * map.projected.len()) as f64).sqrt();
    let small = match options.normals {
        NormalsChoice::Auto => rms <= ROUNDING * options.roughness,
        NormalsChoice::Unorm8 => true,
        NormalsChoice::Snorm16 => false,
    };
    let snorm = |v: f32| u32::from((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    let word = |[x, y]: [u32; 2]| x | y << 16;
    if small {
        let words = map.projected.iter().map(|s| word(s.map(|v| unorm(v) as u32)));
        (NormalsStorage::Unorm8, words.collect())
    } else {
        (NormalsStorage::Snorm16, map.projected.iter().map(|s| word(s.map(snorm))).collect())
    }
}

/// Each texel's word and that of the texel below it; zeros after the last where a buffer needs them.
fn normal_pairs(params: &LobesParams, words: &[u32]) -> Vec<[u32; 2]> {
    let row = |j: u32| &words[(j * params.width) as usize..][..params.width as usize];
    let pairs = |j: u32| row(j).iter().zip(row(params.row_below(j))).map(|(texel, below)| [*texel, *below]);
    let mut out: Vec<[u32; 2]> = (0..params.height).flat_map(pairs).collect();
    out.resize(params.pair_count() as usize, [0; 2]);
    out
}

/// Error over a few footprints a size, as the evaluator chooses levels.
fn measure(map: &NormalMap, options: &LobesOptions, baked: &mut BakedLobes, progress: &dyn Progress) {
    if options.footprints == 0 {
        return;
    }
    const SEED: u64 = 11;
    let extent = DVec2::new(map.width as f64, map.height as f64);
    let sizes = MEASURED_SIGMAS.iter().filter(|sigma| **sigma <= 0.25 * extent.max_element().max(8.0));
    progress.begin("error", sizes.clone().count() as u64);
    let roughness = measured_roughness(baked, options);
    baked.params.measured_roughness = roughness as f32;
    let reference = Reference::new(map, options.filter, roughness).refined(MEASURED_REFINEMENT);
    let mut rows = Vec::new();
    for &sigma in sizes {
        let count = measured_footprints(sigma, options);
        let footprints = sweep::footprints(sigma, 1.0, extent, count, SEED);
        let chosen = [(&*baked, Measured::Chosen(QuerySettings::default()))];
        let errors = quality::footprint_errors(&reference, &chosen, &footprints, 3 * quality::STRIDE);
        rows.push(FootprintError {
            sigma_texels: sigma as f32,
            mean: errors[0].e1.mean as f32,
            worst: errors[0].e1.worst as f32,
        });
        progress.advance(1);
    }
    progress.end();
    baked.params.measured = rows;
}

/// Roughness that errors are measured at: the bake's own, or what keeps the grid of normals small.
pub(crate) fn measured_roughness(baked: &BakedLobes, options: &LobesOptions) -> f64 {
    let range = Vec2::from(baked.params.normal_extent).max_element() as f64;
    options.roughness.max(range / MEASURED_RANGE)
}

/// Footprints of a size that errors are measured over. Large ones differ less from place to place, and cost more.
pub(crate) fn measured_footprints(sigma: f64, options: &LobesOptions) -> u32 {
    if sigma > LARGE_SIGMA { options.footprints.div_ceil(2) } else { options.footprints }
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
