//! Filters the source into a mip to an error bound, and the first mip by exact areas.
//!
//! Paper: sections 3.4 and 5, which filter by importance sampling with a sample count. Here a group of texels walks the
//! tree of the source from coarse to fine ([`super::blocks`]) and sums the blocks it may take as points, for all texels
//! and channels at once ([`super::filter_sum`]). Nothing is random, so a sun is as exact as a grey sky; sharp mips see
//! single pixels and parts of them in the core of the lobe, rough ones large blocks.

use super::blocks::{Allowance, Bound, Group};
use super::cube::texel_direction;
use super::filter_sum::{LANES, Points, filter_sum};
use super::image::luminance;
use super::kernel::Lobe;
use super::tree::Tree;
use crate::progress::Progress;
use rayon::prelude::*;

/// Error that a block may have as a share of what it gives, in units of the error that is asked. Every block falls short
/// in the same sense where the kernel is convex, so their sum is bounded by this.
const OF_BLOCK: f64 = 0.2;
/// Error that a block may have as a share of its texel's value, in the same units; there are some thousands of blocks.
const OF_TEXEL: f64 = 2e-3;
/// Shares of blocks in the first pass, which only finds the size of a texel's value.
const FIRST_PASS: f32 = 0.1;

/// Texels of one mip, 6 · size² of `tree.channels` numbers each: face by face, row by row. Means under the lobe.
pub fn filter_mip(tree: &Tree, lobe: &Lobe, size: u32, max_error: f64, progress: &dyn Progress) -> Vec<f64> {
    let edge = size.min(4);
    let per_face = size / edge;
    let bound = Bound::new(lobe);
    let groups: Vec<u32> = (0..6 * per_face * per_face).collect();
    let filtered: Vec<Vec<f64>> = groups
        .par_iter()
        .map_init(Points::default, |points, &group| {
            let texels = texels_of(group, edge, per_face);
            let directions: Vec<_> =
                texels.iter().map(|&(face, i, j)| texel_direction(face, i, j, size).as_vec3()).collect();
            let totals = filter_group(tree, lobe, &bound, &Group::new(&directions), max_error, points);
            progress.advance(texels.len() as u64);
            totals
        })
        .collect();
    let mut texels = vec![0.0; 6 * (size * size) as usize * tree.channels];
    for (group, totals) in filtered.iter().enumerate() {
        for (lane, (face, i, j)) in texels_of(group as u32, edge, per_face).into_iter().enumerate() {
            let first = ((face as u32 * size + j) * size + i) as usize * tree.channels;
            for c in 0..tree.channels {
                texels[first + c] = totals[c * LANES + lane] / lobe.integral_sr;
            }
        }
    }
    texels
}

/// Texels of a group: a square of edge × edge of one face.
fn texels_of(group: u32, edge: u32, per_face: u32) -> Vec<(usize, u32, u32)> {
    let face = (group / (per_face * per_face)) as usize;
    let (column, row) = (group % per_face, group / per_face % per_face);
    (0..edge * edge).map(|k| (face, column * edge + k % edge, row * edge + k / edge)).collect()
}

fn filter_group(
    tree: &Tree,
    lobe: &Lobe,
    bound: &Bound,
    group: &Group,
    max_error: f64,
    points: &mut Points,
) -> Vec<f64> {
    let mut totals = vec![0.0; tree.channels * LANES];
    let first = Allowance { of_block: FIRST_PASS, of_texel: [0.0; 2] };
    bound.gather(tree, group, &first, points);
    filter_sum(points, tree.channels, &group.directions, lobe, &mut totals);
    // The darkest texel of the group decides.
    let of = |c: usize, lane: usize| totals[c * LANES + lane];
    let lanes = || 0..LANES;
    let light = lanes().map(|l| luminance([of(0, l), of(1, l), of(2, l)])).fold(f64::INFINITY, f64::min);
    let square = lanes().map(|l| of(3, l)).fold(f64::INFINITY, f64::min);
    let share = OF_TEXEL * max_error;
    let allowance = Allowance {
        of_block: (OF_BLOCK * max_error) as f32,
        of_texel: [(share * light) as f32, (share * square) as f32],
    };
    bound.gather(tree, group, &allowance, points);
    filter_sum(points, tree.channels, &group.directions, lobe, &mut totals);
    totals
}
