//! Binomial and multinomial counts.
//!
//! A count is a step function of its random word. Logarithms of two devices differ in the last digits, so the places of the
//! steps do: where a word lies within [`NEAR`] of a step, the devices may stand on different sides. The twin is therefore asked
//! at the word and at words that far beside it, and the shader must give a count between those; how often it takes
//! another than that of the word itself is counted and bounded.

use crate::support::{QUERIES, compare, gpu, log_uniform, random};
use bytemuck::{Pod, Zeroable};
use glint_bake_core::counting::eval::{count_value, tree_leaves, unit_from_bits};
use glint_bake_core::counting::{MAX_LEVELS, binomial, multinomial};
use glint_view::gpu::answer;
use rand::RngExt;

/// How far a step may lie from where the twin has it, as a share of all words.
pub const NEAR: f32 = 1e-6;
/// Share of the draws that may be on the other side of a step.
pub const MAX_FLIPPED: f64 = 1e-3;

/// `CountingQuery` of query_counting.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    n: f32,
    p: f32,
    q: f32,
    levels: u32,
    // Random words of the binomial draw.
    bits: [u32; 2],
    unused: [u32; 2],
    weights: [f32; MAX_LEVELS],
    // And of the multinomial one.
    words: [f32; MAX_LEVELS],
}

/// `CountingAnswer`: high and low of hits and misses, and the counts.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Answer {
    split: [[f32; 2]; 2],
    counts: [f32; MAX_LEVELS],
}

fn queries(seed: u64) -> Vec<Query> {
    let rng = &mut random(seed);
    let make = |k: usize| {
        let small = match k % 4 {
            0 => rng.random::<f32>() * 0.5,
            _ => log_uniform(rng, 1e-16, 0.5),
        };
        // Either side of one half, and both ends.
        let (p, q) = match k % 8 {
            7 if k % 16 == 7 => (0.0, 1.0),
            7 => (1.0, 0.0),
            side if side % 2 == 0 => (small, 1.0 - small),
            _ => (1.0 - small, small),
        };
        // Half the draws where the count is small.
        let n =
            if rng.random() { log_uniform(rng, 0.01, 1e16) } else { log_uniform(rng, 0.01, 1e3) / small.max(1e-13) };
        let levels = 1 + rng.random::<u32>() % MAX_LEVELS as u32;
        let mut weights = [0.0; MAX_LEVELS];
        weights[..levels as usize]
            .fill_with(|| if rng.random::<f32>() < 0.1 { 0.0 } else { log_uniform(rng, 1e-8, 1.0) });
        let bits = [rng.random(), rng.random()];
        let words = std::array::from_fn(|_| unit_from_bits(rng.random()));
        Query { n: n.clamp(0.01, 1e16), p, q, levels, bits, unused: [0; 2], weights, words }
    };
    (0..2 * QUERIES).map(make).collect()
}

/// The bits, and those around them that are `NEAR` of all words away.
fn bits_beside(bits: u32) -> [u32; 3] {
    let step = (NEAR * 4_294_967_296.0) as u32;
    [bits, bits.saturating_sub(step), bits.saturating_add(step)]
}

/// The words that are `NEAR` of all words away from one.
pub fn beside(word: f32) -> [f32; 2] {
    [(word - NEAR).max(1e-10), (word + NEAR).min(1.0)]
}

#[test]
fn binomial_counts_of_the_shader_are_those_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let queries = queries(21);
    let source = glint_shaders::compose(&["query_counting"]);
    let answers: Vec<Answer> = answer(gpu, "counting", &source, &[], &queries).unwrap();
    let value = |count: [f32; 2]| f64::from(count[0]) + f64::from(count[1]);
    let mut flipped = 0;
    let mut rarer = Vec::new();
    for (query, answer) in queries.iter().zip(&answers) {
        let at = |word: u32| binomial(query.n, query.p, query.q, [query.bits[0], word]).map(f64::from);
        let near = bits_beside(query.bits[1]).map(at);
        let exchanged = usize::from(query.p > query.q);
        let (found, expected) = (value(answer.split[exchanged]), near.map(|pair| pair[exchanged]));
        // In standard deviations of the count, or whole counts where that is less than one.
        let sigma = (f64::from(query.n) * f64::from(query.p.min(query.q))).sqrt().max(1.0);
        let mut off = (found - expected[0]) / sigma;
        if off.abs() > 1e-3 {
            flipped += 1;
            let (low, high) = (expected[1].min(expected[2]), expected[1].max(expected[2]));
            off = (low - found).max(found - high).max(0.0) / sigma;
        }
        assert!(off.abs() <= 1e-3, "{query:?}: {found}, expected one of {expected:?}");
        let sum = value(answer.split[0]) + value(answer.split[1]);
        let whole: f64 = near[0].iter().sum();
        assert!((sum - whole).abs() <= whole * 1e-14, "{query:?}: the counts add up to {sum}, expected {whole}");
        rarer.push((found as f32, expected[0] as f32));
    }
    println!("binomial: {flipped} of {} on the other side of a step", queries.len());
    assert!(flipped as f64 <= MAX_FLIPPED * queries.len() as f64, "{flipped} flipped");
    // Those on the other side of a step were looked at above.
    compare("binomial", rarer.into_iter().filter(|(a, b)| (a - b).abs() > 1.0 || a == b));
}

#[test]
fn multinomial_counts_of_the_shader_are_those_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let queries = queries(22);
    let source = glint_shaders::compose(&["query_counting"]);
    let answers: Vec<Answer> = answer(gpu, "counting", &source, &[], &queries).unwrap();
    let mut flipped = 0;
    let mut same = Vec::new();
    for (query, answer) in queries.iter().zip(&answers) {
        let levels = query.levels as usize;
        let at = |words: &[f32; MAX_LEVELS]| multinomial(query.n, &query.weights, levels, words).map(count_value);
        let agrees = |expected: &[f32; MAX_LEVELS]| {
            answer.counts.iter().zip(expected).all(|(a, e)| (a - e).abs() <= 1e-3 * a.abs().max(e.abs()) + 1e-5)
        };
        let expected = at(&query.words);
        if agrees(&expected) {
            same.extend(answer.counts[..levels].iter().copied().zip(expected));
            continue;
        }
        flipped += 1;
        let beside = (1..tree_leaves(levels)).flat_map(|node| beside(query.words[node]).map(|word| (node, word)));
        let other = beside.into_iter().any(|(node, word)| {
            let mut words = query.words;
            words[node] = word;
            agrees(&at(&words))
        });
        assert!(other, "{query:?}: {:?}, expected {expected:?}", answer.counts);
    }
    println!("multinomial: {flipped} of {} on the other side of a step", queries.len());
    assert!(flipped as f64 <= MAX_FLIPPED * queries.len() as f64, "{flipped} flipped");
    compare("multinomial", same.into_iter());
}
