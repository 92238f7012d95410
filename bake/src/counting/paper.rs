//! The paper's own dual-gated Gaussian in f32: the baseline of the report, no part of the run time.
//!
//! Paper: Kneiphof and Klein 2025, section 6, algorithm 1. Line 6 is printed as (1 − c) · p^(N/c); Eq. 25 has
//! (1 − cp)^(N/c), which is used here. Φ⁻¹ is that of our own draws.

use super::eval::{MAX_LEVELS, digits, halvings, normal_upper_fraction, tree_leaves, unit_from_bits};

/// Below this p the paper scales p and N (ε = 10^−3.54).
const EPSILON: f32 = 2.884_031_5e-4;

/// z with P(Z > z) = u for a standard normal Z and 0 < u < 1, to 3e-5 for u from 2⁻³³ to ½, and antisymmetric around ½.
pub fn normal_upper_quantile(u: f32) -> f32 {
    let [whole, rest] = digits(4.0 * u * (1.0 - u));
    let [over, under] = normal_upper_fraction(u, whole + halvings(rest));
    over / under
}

/// n and n̄ of `n` ≥ 0 trials with chance `p` from 0 to 1; the first word decides the gates, the second is for the
/// Gaussian.
pub fn binomial(n: f32, p: f32, bits: [u32; 2]) -> [f32; 2] {
    let gate = unit_from_bits(bits[0]);
    let n2 = n.max(2.0);
    // At p = 0 the paper divides by zero; nothing is hit then.
    let c = (EPSILON / p.max(f32::MIN_POSITIVE)).max(1.0);
    let above_one = (n - 1.0).clamp(0.0, 1.0);
    let all = above_one * p.powf(n2);
    let none = above_one * (1.0 - c * p).powf(n2 / c);
    let tent = (1.0 - (1.0 - n).abs()).max(0.0);
    let (one, other_one) = (tent * p, tent * (1.0 - p));
    let mask = |on: bool| if on { 1.0f32 } else { 0.0 };
    let is_all = mask(gate < all);
    let is_one_or_all = mask(gate < all + one);
    let is_none = mask(1.0 - none <= gate);
    let is_other_one_or_none = mask(1.0 - none - other_one <= gate);
    let is_gaussian = mask(n > 1.0) * (1.0 - is_one_or_all) * (1.0 - is_other_one_or_none);
    let mean = 1.0 + (n2 - 2.0) * p;
    let variance = (n2 - 2.0) * p * (1.0 - p);
    let z = normal_upper_quantile(unit_from_bits(bits[1]));
    let gaussian = (mean + variance.sqrt() * z).clamp(1.0, n2 - 1.0);
    [
        is_all * (n2 - 1.0) + is_one_or_all + is_gaussian * gaussian,
        is_none * (n2 - 1.0) + is_other_one_or_none + is_gaussian * (n2 - gaussian),
    ]
}

/// Counts of the first `levels` weights by the paper's tree; words 2i and 2i + 1 of `bits` draw at node i.
pub fn multinomial(
    n: f32,
    weights: &[f32; MAX_LEVELS],
    levels: usize,
    bits: &[u32; 2 * MAX_LEVELS],
) -> [f32; MAX_LEVELS] {
    let leaves = tree_leaves(levels);
    let mut weight = [0.0f32; 2 * MAX_LEVELS];
    weight[leaves..leaves + levels].copy_from_slice(&weights[..levels]);
    for node in (1..leaves).rev() {
        weight[node] = weight[2 * node] + weight[2 * node + 1];
    }
    let mut count = [0.0f32; 2 * MAX_LEVELS];
    count[1] = n;
    for node in 1..leaves {
        let p = if weight[node] > 0.0 { weight[2 * node] / weight[node] } else { 1.0 };
        let split = binomial(count[node], p, [bits[2 * node], bits[2 * node + 1]]);
        count[2 * node] = split[0];
        count[2 * node + 1] = split[1];
    }
    let mut counts = [0.0; MAX_LEVELS];
    counts[..leaves].copy_from_slice(&count[leaves..2 * leaves]);
    counts
}
