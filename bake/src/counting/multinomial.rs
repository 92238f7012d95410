//! Multinomial counts of up to sixteen levels by a binary tree of binomial draws, f32, as in WGSL.
//!
//! Paper: Kneiphof and Klein 2025, section 6, "Sampling Multinomial Distributions". Deviations:
//! - The number of facets is made whole once, at the root; every count below is whole, and they add up to it.
//!   In the paper inner counts are fractional, and where less than two facets reach a node the sum is lost.
//! - Both branch probabilities are quotients of sums of weights, never 1 − p, so that a rare level keeps its digits on
//!   either side.

use super::binomial::{whole_binomial, whole_count};
use super::count::Count;
use super::normal::Uniform;

/// Most levels of one draw.
pub const MAX_LEVELS: usize = 16;

/// Lighter nodes are taken as this heavy, which they fill in part: one over the weight must be a number.
const LEAST_WEIGHT: f32 = 1e-37;

/// Leaves of the tree that holds `levels` levels: the next power of two, at most [`MAX_LEVELS`].
///
/// This is also how many random words [`multinomial`] reads.
pub fn tree_leaves(levels: usize) -> usize {
    levels.clamp(1, MAX_LEVELS).next_power_of_two()
}

/// How many of `n` ≥ 0 facets fall to each level, with chances in proportion to `weights`.
///
/// The first `levels` (1 to 16) weights count; they are finite, ≥ 0, and need not add up to 1. A level of weight 0 gets
/// no facet; if all are 0, level 0 gets them. `words` are uniform numbers above 0 and at most 1: word 0
/// makes `n` whole and is small where there is one facet more, words 1 to [`tree_leaves`] − 1 draw and are small where the right branch
/// gets more: node i has the children 2i and 2i + 1. Whole counts come back that add up to a whole number with mean `n` (`n`
/// itself where it is whole). Chances are quotients of f32 sums of weights: they are off by about 1e-7 of themselves,
/// which is a shift of the mean that exceeds the standard deviation of counts above 1e14.
pub fn multinomial(
    n: f32,
    weights: &[f32; MAX_LEVELS],
    levels: usize,
    words: &[f32; MAX_LEVELS],
) -> [Count; MAX_LEVELS] {
    let leaves = tree_leaves(levels);
    let mut weight = [0.0f32; 2 * MAX_LEVELS];
    for i in 0..levels.min(MAX_LEVELS) {
        weight[leaves + i] = weights[i].max(0.0);
    }
    for node in (1..leaves).rev() {
        weight[node] = weight[2 * node] + weight[2 * node + 1];
    }
    let mut count = [Count::default(); 2 * MAX_LEVELS];
    count[1] = whole_count(n, words[0]).into();
    for node in 1..leaves {
        let (left, right) = (weight[2 * node], weight[2 * node + 1]);
        // A node without weight has chances of 0, of which all go left.
        let share = 1.0 / weight[node].max(LEAST_WEIGHT);
        let split = whole_binomial(count[node], left * share, right * share, Uniform::from_rest(words[node]));
        count[2 * node] = split[0];
        count[2 * node + 1] = split[1];
    }
    let mut counts = [Count::default(); MAX_LEVELS];
    counts[..leaves].copy_from_slice(&count[leaves..2 * leaves]);
    counts
}
