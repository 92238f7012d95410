//! What a synthesised surface is like: its seams, its whole blocks, its repetitions.

use super::baked::Synthesis;
use crate::normal_map::NormalMap;
use glint_formats::synthesis::{Layout, MeasuredError};

/// Sample texel (column, row).
type Texel = (u32, u32);

/// Most patches whose seams are looked at.
const MAX_MEASURED: u32 = 256;

/// The measures that are stored.
pub fn measure(surface: &Synthesis, sample: &NormalMap) -> MeasuredError {
    let mut distinct = surface.offsets.clone();
    distinct.sort_unstable();
    distinct.dedup();
    MeasuredError { seam_ratio: seam_ratio(surface, sample), distinct_offsets: distinct.len() as u32 }
}

/// Root mean square difference of projected normals of neighbours across seams, over that of neighbours in the sample;
/// the larger of both axes, of at most 256 patches, evenly spread. Where neighbours in the sample are equal, or there are
/// no seams, 0.
pub fn seam_ratio(surface: &Synthesis, sample: &NormalMap) -> f64 {
    let (mut sum, mut pairs) = ([0.0; 2], [0u64; 2]);
    across_seams(surface, |axis, here, there| {
        sum[axis] += (normal(sample, here) - normal(sample, there)).length_squared();
        pairs[axis] += 1;
    });
    let inside = neighbour_mean_square(sample);
    let ratio = |axis: usize| {
        let none = pairs[axis] == 0 || inside[axis] == 0.0;
        if none { 0.0 } else { (sum[axis] / pairs[axis] as f64 / inside[axis]).sqrt() }
    };
    ratio(0).max(ratio(1))
}

/// How much larger than that of neighbours in the sample a squared difference is where a feature ends.
const END: f64 = 4.0;

/// Ends of features in a thousand neighbours across seams, of at most 256 patches, evenly spread. Of two neighbours across
/// a seam, each patch would have shown something else in the other's place. Where the squares of both differences are more
/// than [`END`] times the mean of neighbours in the sample, neither patch goes on as the other does. Where neighbours in
/// the sample are equal, or there are no seams, 0.
pub fn feature_ends(surface: &Synthesis, sample: &NormalMap) -> f64 {
    let inside = neighbour_mean_square(sample);
    let (mut ends, mut pairs) = (0u64, 0u64);
    across_seams(surface, |axis, here, there| {
        if inside[axis] == 0.0 {
            return;
        }
        let (dx, dy) = if axis == 0 { (1, 0) } else { (0, 1) };
        let beyond = sample.texel(i64::from(here.0) + dx, i64::from(here.1) + dy);
        let before = sample.texel(i64::from(there.0) - dx, i64::from(there.1) - dy);
        let on = (beyond - normal(sample, there)).length_squared();
        let back = (before - normal(sample, here)).length_squared();
        ends += u64::from(on.min(back) > END * inside[axis]);
        pairs += 1;
    });
    1000.0 * ends as f64 / pairs.max(1) as f64
}

/// Visits neighbours across the seams of at most [`MAX_MEASURED`] patches: the axis along which they lie (0 right, 1 below),
/// and where in the sample both are from.
fn across_seams(surface: &Synthesis, mut visit: impl FnMut(usize, Texel, Texel)) {
    let edge = surface.params.patch as i32;
    for (column, row) in spread(surface) {
        for y in row * edge..(row + 1) * edge {
            for x in column * edge..(column + 1) * edge {
                let here = surface.source_texel(x, y);
                for (axis, (dx, dy)) in [(1, 0), (0, 1)].into_iter().enumerate() {
                    let there = surface.source_texel(x + dx, y + dy);
                    if !adjacent(surface, here, there, (dx as u32, dy as u32)) {
                        visit(axis, here, there);
                    }
                }
            }
        }
    }
}

/// Columns and rows of at most [`MAX_MEASURED`] patches.
fn spread(surface: &Synthesis) -> Vec<(i32, i32)> {
    let (columns, rows) = match surface.params.layout {
        Layout::Patches { columns, rows, .. } => (columns, rows),
        Layout::CornerTiles { .. } => (16, 16),
    };
    let step = (columns * rows).div_ceil(MAX_MEASURED);
    (0..columns * rows).step_by(step as usize).map(|at| ((at % columns) as i32, (at / columns) as i32)).collect()
}

fn normal(sample: &NormalMap, at: Texel) -> glam::DVec2 {
    sample.texel(i64::from(at.0), i64::from(at.1))
}

fn adjacent(surface: &Synthesis, a: Texel, b: Texel, (dx, dy): (u32, u32)) -> bool {
    let params = &surface.params;
    (a.0 + dx) % params.sample_width == b.0 && (a.1 + dy) % params.sample_height == b.1
}

/// Mean squared difference of the projected normals of neighbours inside a map, along rows and along columns.
pub fn neighbour_mean_square(sample: &NormalMap) -> [f64; 2] {
    let (width, height) = (i64::from(sample.width), i64::from(sample.height));
    [(1, 0), (0, 1)].map(|(dx, dy)| {
        let (mut sum, mut pairs) = (0.0, 0u64);
        for y in 0..height - dy {
            for x in 0..width - dx {
                sum += (sample.texel(x, y) - sample.texel(x + dx, y + dy)).length_squared();
                pairs += 1;
            }
        }
        sum / pairs.max(1) as f64
    })
}

/// Edge of the finest blocks that are looked at, in texels.
const FINEST_BLOCK: i32 = 8;

/// Share of the blocks of 8 · 2^log2_size texels, over the first `blocks`² of them, that show one block of the sample: one that
/// begins at a multiple of its edge where `exact`, else at one of the alignment.
pub fn whole_share(surface: &Synthesis, blocks: i32, log2_size: u32, exact: bool) -> f64 {
    let size = FINEST_BLOCK << log2_size;
    let step = if exact { size as u32 } else { surface.params.alignment };
    let whole = |&(bx, by): &(i32, i32)| surface.block_source(bx * size, by * size, size, step).is_some();
    let found = (0..blocks).flat_map(|by| (0..blocks).map(move |bx| (bx, by))).filter(whole).count();
    found as f64 / f64::from(blocks).powi(2)
}

/// The largest share of the texels of a square of the surface that show the same sample texel again at one and the same
/// displacement of whole patches, up to `reach` patches away: 1 for a tiled sample.
pub fn repetition(surface: &Synthesis, patches: i32, reach: i32) -> f64 {
    let edge = surface.params.patch as i32;
    let grid = |count: i32| (0..count).map(move |k| k * edge + edge / 4);
    let mut largest = 0.0f64;
    for dy in 0..=reach {
        for dx in -reach..=reach {
            if dy == 0 && dx <= 0 {
                continue;
            }
            let mut same = 0;
            for y in grid(patches) {
                for x in grid(patches) {
                    same += u32::from(surface.source_texel(x, y) == surface.source_texel(x + dx * edge, y + dy * edge));
                }
            }
            largest = largest.max(f64::from(same) / f64::from(patches).powi(2));
        }
    }
    largest
}
