//! Multinomial counts: sums, marginals, covariances, exact distribution of few facets, and the degenerate cases.

use glint_bake_core::counting::eval::{count_value, tree_leaves, unit_from_bits, whole_count};
use glint_bake_core::counting::{Count, MAX_LEVELS, multinomial};
use glint_bake_core::rng::{ItemRng, Purpose};

fn words(rng: &mut ItemRng) -> [f32; MAX_LEVELS] {
    std::array::from_fn(|_| unit_from_bits(rng.bits()))
}

/// Weights of `levels` levels that span six decades, not in order, not adding up to 1.
fn weights(levels: usize) -> [f32; MAX_LEVELS] {
    let mut all = [0.0; MAX_LEVELS];
    for i in 0..levels {
        all[i] = 3.0 * 10f32.powf(-6.0 * ((7 * i + 3) % levels) as f32 / levels as f32);
    }
    all
}

#[test]
fn counts_are_whole_and_add_up() {
    let mut rng = ItemRng::new(23, Purpose::Test(1), 0);
    for levels in 1..=MAX_LEVELS {
        let all = weights(levels);
        for n in [0.0f32, 0.02, 0.9, 1.0, 1.5, 2.0, 7.3, 20.0, 1e3, 12345.6, 16_777_216.0, 1e10, 1e16] {
            for _ in 0..100 {
                let drawn = words(&mut rng);
                let counts = multinomial(n, &all, levels, &drawn);
                let counts = counts.map(f64::from);
                let sum: f64 = counts.iter().sum();
                let rounding = if n <= 1e13 { 0.0 } else { f64::from(n) * levels as f64 * 2f64.powi(-47) };
                let whole = f64::from(whole_count(n, drawn[0]));
                assert!((sum - whole).abs() <= rounding, "K {levels} N {n}: {counts:?}");
                assert!(counts.iter().all(|c| *c >= 0.0 && c.fract() == 0.0));
                assert!(counts[levels..].iter().all(|c| *c == 0.0), "K {levels}: {counts:?}");
            }
        }
    }
}

/// Chance of at least `least` hits where they are a Poisson number of this mean.
fn at_least(mean: f64, least: f64) -> f64 {
    let mut chance = (-mean).exp();
    let mut below = 0.0;
    for k in 0..least as u32 {
        below += chance;
        chance *= mean / f64::from(k + 1);
    }
    1.0 - below
}

#[test]
fn means_and_covariances_are_the_multinomials() {
    let draws = 60_000u32;
    for (item, (levels, n)) in
        [(2usize, 0.3f32), (3, 1.5), (4, 3.0), (5, 8.5), (8, 40.0), (11, 300.0), (16, 1e4), (16, 0.7)]
            .into_iter()
            .enumerate()
    {
        let all = weights(levels);
        let total: f64 = all.iter().map(|w| f64::from(*w)).sum();
        let chance: Vec<f64> = all.iter().map(|w| f64::from(*w) / total).collect();
        let (trials, fraction) = (f64::from(n), f64::from(n.fract()));
        let mut rng = ItemRng::new(23, Purpose::Test(2), item as u32);
        let mut shift = [0.0; MAX_LEVELS];
        let mut product = [[0.0; MAX_LEVELS]; MAX_LEVELS];
        let mut square = [[0.0; MAX_LEVELS]; MAX_LEVELS];
        for _ in 0..draws {
            let counts = multinomial(n, &all, levels, &words(&mut rng)).map(f64::from);
            for i in 0..levels {
                let a = counts[i] - trials * chance[i];
                shift[i] += a;
                for j in 0..levels {
                    let b = a * (counts[j] - trials * chance[j]);
                    product[i][j] += b;
                    square[i][j] += b * b;
                }
            }
        }
        let count = f64::from(draws);
        for i in 0..levels {
            for j in 0..levels {
                let own = if i == j { trials * chance[i] } else { 0.0 };
                let exact = own - (trials - fraction * (1.0 - fraction)) * chance[i] * chance[j];
                let found = product[i][j] / count;
                let error = ((square[i][j] / count - found * found) / count).sqrt();
                // Levels that were hit a few times only have no normal error to speak of.
                if trials * chance[i].min(chance[j]) * count > 500.0 {
                    let z = (found - exact) / error;
                    assert!(z.abs() < 5.0, "K {levels} N {n} levels {i} {j}: {found} {exact} z {z}");
                }
                let hits = trials * chance[i] * count;
                if i == j && hits > 50.0 {
                    let z = shift[i] / (exact * count).sqrt();
                    assert!(z.abs() < 4.5, "K {levels} N {n} level {i}: z {z}");
                }
                if i == j && hits <= 50.0 {
                    // As rare as 4.5 standard deviations; none at all may be likely.
                    let seen = (shift[i] + hits).round();
                    let tail = at_least(hits, seen).min(1.0 - at_least(hits, seen + 1.0));
                    assert!(tail > 3e-6, "K {levels} N {n} level {i}: {seen} hits, expected {hits}");
                }
            }
        }
    }
}

/// Counts that one f32 cannot tell apart: chances ½, ¼, ⅛ … are exact, so mean and variance must be too.
#[test]
fn counts_to_1e16_vary_as_they_should() {
    let draws = 40_000u32;
    for (item, n) in [1e12f32, 1e14, 1e16].into_iter().enumerate() {
        // Branches of ½ and ½ all down the tree, but the last: 2⁻²⁰ and the rest.
        let mut all = [0.125; MAX_LEVELS];
        (all[6], all[7]) = (0.25 * 2f32.powi(-20), 0.25 - 0.25 * 2f32.powi(-20));
        let mut rng = ItemRng::new(23, Purpose::Test(7), item as u32);
        let mut moments = [[0.0; 3]; 8];
        for _ in 0..draws {
            let counts = multinomial(n, &all, 8, &words(&mut rng)).map(f64::from);
            for (k, moments) in moments.iter_mut().enumerate() {
                let d = counts[k] - f64::from(n) * f64::from(all[k]);
                (0..3).for_each(|power| moments[power] += [d, d * d, d * d * d * d][power] / f64::from(draws));
            }
        }
        for (k, [mean, square, fourth]) in moments.into_iter().enumerate() {
            let p = f64::from(all[k]);
            let variance = f64::from(n) * p * (1.0 - p);
            let z = mean / (variance / f64::from(draws)).sqrt();
            let z_variance = (square - variance) / ((fourth - square * square) / f64::from(draws)).sqrt();
            assert!(z.abs() < 4.0 && z_variance.abs() < 4.0, "N {n:e} level {k}: z {z}, of the variance {z_variance}");
        }
    }
}

/// χ² of three facets on five levels against n! ∏ p^k / k!.
#[test]
fn few_facets_follow_the_multinomial_itself() {
    let all = weights(5).map(|w| w.sqrt());
    let total: f64 = all.iter().map(|w| f64::from(*w)).sum();
    let draws = 200_000u32;
    let mut rng = ItemRng::new(23, Purpose::Test(3), 0);
    let mut seen = std::collections::BTreeMap::<[u32; 5], u32>::new();
    for _ in 0..draws {
        let counts = multinomial(3.0, &all, 5, &words(&mut rng)).map(count_value);
        *seen.entry(std::array::from_fn(|i| counts[i] as u32)).or_default() += 1;
    }
    let (mut chi2, mut cells, mut mass) = (0.0, 0, 0.0);
    for code in 0..4u32.pow(5) {
        let key: [u32; 5] = std::array::from_fn(|i| code / 4u32.pow(i as u32) % 4);
        if key.iter().sum::<u32>() != 3 {
            continue;
        }
        let mut chance = 6.0;
        for (k, w) in key.iter().zip(all) {
            chance *= (f64::from(w) / total).powi(*k as i32) / [1.0, 1.0, 2.0, 6.0][*k as usize];
        }
        mass += chance;
        let expected = chance * f64::from(draws);
        if expected > 5.0 {
            chi2 += (f64::from(seen.get(&key).copied().unwrap_or(0)) - expected).powi(2) / expected;
            cells += 1;
        }
    }
    assert!((mass - 1.0).abs() < 1e-9);
    // Mean cells − 1, deviation √(2 cells): four of them.
    assert!(cells >= 20 && chi2 < f64::from(cells) + 4.0 * (2.0 * f64::from(cells)).sqrt(), "{chi2} of {cells}");
}

/// A sun of one facet in 10⁷ keeps its mean on whichever side of the tree it sits.
#[test]
fn a_rare_level_keeps_its_mean_anywhere() {
    for place in 0..8 {
        let mut all = [0.0; MAX_LEVELS];
        all[..8].fill(0.125);
        all[place] = 1e-7;
        let mut rng = ItemRng::new(23, Purpose::Test(4), place as u32);
        let (n, draws) = (1e4f32, 200_000);
        let total: f64 = all.iter().map(|w| f64::from(*w)).sum();
        let expected = f64::from(n) * 1e-7 / total * f64::from(draws);
        let mut hits = 0.0;
        for _ in 0..draws {
            hits += f64::from(multinomial(n, &all, 8, &words(&mut rng))[place]);
        }
        assert!((hits - expected).abs() < 4.0 * expected.sqrt(), "{place}: {hits} of {expected}");
    }
}

#[test]
fn degenerate_weights() {
    let mut rng = ItemRng::new(23, Purpose::Test(5), 0);
    for _ in 0..1000 {
        let drawn = words(&mut rng);
        for levels in [1, 2, 3, 8, 16] {
            for only in 0..levels {
                let mut all = [0.0; MAX_LEVELS];
                all[only] = 1e-30;
                let counts = multinomial(37.0, &all, levels, &drawn).map(count_value);
                assert_eq!(counts[only], 37.0);
                assert_eq!(counts.iter().sum::<f32>(), 37.0);
            }
            let black = multinomial(37.0, &[0.0; MAX_LEVELS], levels, &drawn).map(count_value);
            assert_eq!((black[0], black.iter().sum::<f32>()), (37.0, 37.0));
            let invalid = multinomial(5.0, &[f32::NAN; MAX_LEVELS], levels, &drawn).map(count_value);
            assert_eq!(invalid.iter().sum::<f32>(), 5.0);
        }
        assert_eq!(multinomial(0.0, &[1.0; MAX_LEVELS], 16, &drawn), [Count::default(); MAX_LEVELS]);
        assert_eq!(multinomial(1e16, &[1.0; MAX_LEVELS], 1, &drawn)[0], Count::from(1e16));
    }
    assert_eq!([1, 2, 3, 4, 5, 8, 9, 16].map(tree_leaves), [1, 2, 4, 4, 8, 8, 16, 16]);
}

/// Words that the documentation does not name are not read.
#[test]
fn only_the_words_of_the_tree_are_read() {
    let mut rng = ItemRng::new(23, Purpose::Test(6), 0);
    for levels in 1..=MAX_LEVELS {
        let leaves = tree_leaves(levels);
        for _ in 0..200 {
            let drawn = words(&mut rng);
            let mut other = words(&mut rng);
            other[..leaves].copy_from_slice(&drawn[..leaves]);
            let all = weights(levels);
            assert_eq!(multinomial(9.5, &all, levels, &drawn), multinomial(9.5, &all, levels, &other));
        }
    }
}
