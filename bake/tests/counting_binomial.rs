//! The binomial draw against the exact distribution: by going through its random word, and by drawing.

use glint_bake_core::counting::eval::{FEW, count_value, unit_from_bits, whole_binomial, whole_count};
use glint_bake_core::counting::paper::normal_upper_quantile;
use glint_bake_core::counting::quality::{CountingQuality, SecondWord, compare, outcomes};
use glint_bake_core::counting::reference::ExactBinomial;
use glint_bake_core::counting::{Count, binomial, paper};
use glint_bake_core::rng::{ItemRng, Purpose};

const TRIALS: [f32; 24] = [
    0.01, 0.3, 0.9, 1.0, 1.5, 2.0, 2.5, 3.0, 5.0, 8.0, 8.5, 11.0, 13.0, 16.0, 64.0, 300.0, 1e3, 1e4, 1e6, 1e8, 1e10,
    1e12, 1e14, 1e16,
];

/// Chances (p, q) for n trials: fixed ones from 1e-16 up, ones around the switch of methods, and all of them exchanged.
fn chances(n: f32) -> Vec<(f32, f32)> {
    let mut rare = vec![1e-16, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5];
    for expected in [0.1, 0.5, 1.0, 1.45, 2.0, 3.0, 5.0, 0.99 * FEW, 1.01 * FEW, 8.0, 12.0, 20.0, 100.0] {
        rare.push(expected / n);
    }
    rare.retain(|p| *p <= 0.5);
    rare.into_iter().flat_map(|p| [(p, 1.0 - p), (1.0 - p, p)]).collect()
}

fn measure(n: f32, p: f32, q: f32) -> (CountingQuality, ExactBinomial) {
    let exact = ExactBinomial::of_f32(n, p, q);
    let second = if exact.variance() < 4e4 { SecondWord::Bisected } else { SecondWord::Shares(1 << 15) };
    (compare(&outcomes(|bits| binomial(n, p, q, bits), second), &exact), exact)
}

#[test]
fn mean_variance_and_shape_are_the_binomials() {
    for n in TRIALS {
        for (p, q) in chances(n) {
            let (found, exact) = measure(n, p, q);
            let place = format!("N {n:e} p {p:e} q {q:e}: {found:?}");
            assert!(found.sum_error.abs() < 1e-6, "{place}");
            // 1e-4 is a third of a standard error of 10⁷ draws.
            assert!(found.mean_error.abs() < 1e-4, "{place}");
            // Events rarer than a random word can say have no variance to compare.
            if exact.trials * exact.p.min(exact.q) > 1e-6 {
                assert!(found.variance_error.abs() < 1e-3, "{place}");
            }
            assert!(found.wasserstein < 2e-3, "{place}");
        }
    }
}

#[test]
fn rare_hits_keep_their_mean() {
    for n in TRIALS {
        for expected in [1e-7f32, 1e-6, 1e-4, 1e-2] {
            let p = (expected / n).min(0.5);
            let (found, _) = measure(n, p, 1.0 - p);
            // Half a step of the random words is 1.2e-10, one in each of two words.
            let limit = 3e-5 + 2.4e-10 / f64::from(n * p) + 1.2e-10 / f64::from(n.fract()).clamp(1e-9, 1.0);
            assert!(found.relative_mean_error.abs() < limit, "N {n:e} Np {expected:e}: {found:?}");
        }
    }
}

/// The measure must be able to fail: the paper's draw does, as its bias is known to be.
#[test]
fn the_papers_draw_is_biased() {
    let (n, p) = (1e4f32, 1.45e-4f32);
    let exact = ExactBinomial::of_f32(n, p, 1.0 - p);
    let found =
        compare(&outcomes(|bits| paper::binomial(n, p, bits).map(Count::from), SecondWord::Shares(1 << 13)), &exact);
    assert!((0.30..0.36).contains(&found.relative_mean_error), "{found:?}");
    assert!(found.wasserstein > 0.3, "{found:?}");
    let (n, p) = (3.0f32, 0.2f32);
    let exact = ExactBinomial::of_f32(n, p, 1.0 - p);
    let found =
        compare(&outcomes(|bits| paper::binomial(n, p, bits).map(Count::from), SecondWord::Shares(1 << 13)), &exact);
    assert!((0.03..0.10).contains(&found.relative_mean_error), "{found:?}");
}

/// 2·10⁵ draws a place: |z| < 4 for the mean, < 5 for the variance (its own error is heavy-tailed).
#[test]
fn random_draws_agree() {
    let draws = 200_000u32;
    for (item, (n, p)) in [
        (0.4f32, 0.3f32),
        (1.5, 0.7),
        (2.5, 0.1),
        (3.0, 0.5),
        (8.0, 0.2),
        (8.5, 0.9),
        (12.0, 0.499),
        (13.0, 0.501),
        (100.0, 0.0145),
        (1e4, 1.45e-4),
        (1e4, 5.9e-4),
        (1e4, 6.1e-4),
        (1e4, 0.3),
        (1e4, 0.999),
        (1e7, 0.25),
        (1e16, 3e-16),
        (1e16, 1e-14),
        (1e14, 0.3),
        (1e16, 0.5),
    ]
    .into_iter()
    .enumerate()
    {
        let q = 1.0 - p;
        let exact = ExactBinomial::of_f32(n, p, q);
        let mut rng = ItemRng::new(17, Purpose::Test(1), item as u32);
        let (mut shift, mut square, mut fourth) = (0.0, 0.0, 0.0);
        for _ in 0..draws {
            let [hits, _] = binomial(n, p, q, [rng.bits(), rng.bits()]);
            let d = f64::from(hits) - exact.mean();
            shift += d;
            square += d * d;
            fourth += d * d * d * d;
        }
        let count = f64::from(draws);
        let (mean, variance) = (shift / count, square / count);
        let z = mean / (exact.variance() / count).sqrt();
        let z_variance = (variance - exact.variance()) / ((fourth / count - variance * variance) / count).sqrt();
        assert!(z.abs() < 4.0, "N {n:e} p {p:e}: z {z}");
        assert!(z_variance.abs() < 5.0, "N {n:e} p {p:e}: z of the variance {z_variance}");
    }
}

#[test]
fn hits_and_misses_add_up() {
    let mut rng = ItemRng::new(17, Purpose::Test(2), 0);
    for n in TRIALS {
        for (p, q) in chances(n) {
            for _ in 0..50 {
                let bits = [rng.bits(), rng.bits()];
                let counts = binomial(n, p, q, bits);
                let [hits, misses] = counts.map(f64::from);
                assert!(hits >= 0.0 && misses >= 0.0 && hits.fract() == 0.0 && misses.fract() == 0.0);
                assert!(counts.iter().all(|c| c.low == 0.0 || c.high > 16_777_216.0), "{counts:?}");
                let whole = whole_count(n, unit_from_bits(bits[0]));
                assert!(if n.fract() == 0.0 { whole == n } else { (whole - n).abs() < 1.0 });
                // From some 1e13 on the lower part of a count is itself rounded.
                let rounding = if n <= 1e13 { 0.0 } else { f64::from(n) * 2f64.powi(-47) };
                assert!((hits + misses - f64::from(whole)).abs() <= rounding, "N {n:e} p {p:e}: {hits} + {misses}");
            }
        }
    }
}

#[test]
fn both_ends_are_alike() {
    let mut rng = ItemRng::new(17, Purpose::Test(3), 0);
    for n in TRIALS {
        for (p, q) in chances(n).into_iter().filter(|(p, q)| p != q) {
            for _ in 0..50 {
                let (first, second) = (rng.bits(), rng.bits());
                let [hits, misses] = binomial(n, p, q, [first, second]);
                assert_eq!(binomial(n, q, p, [first, !second]), [misses, hits], "N {n:e} p {p:e}");
            }
        }
    }
    // At p = ½ the distribution itself is its mirror image.
    for n in [1.0f32, 2.0, 7.0, 12.0, 14.0, 101.0] {
        let all = outcomes(|bits| binomial(n, 0.5, 0.5, bits), SecondWord::Bisected);
        let chance = |k: f64| all.iter().filter(|o| o.hits == k).map(|o| o.weight).sum::<f64>();
        for k in 0..=n as u32 {
            let (here, there) = (chance(f64::from(k)), chance(f64::from(n) - f64::from(k)));
            assert!((here - there).abs() < 1e-6, "{n} {k}: {here} {there}");
        }
    }
}

/// Glints do not flicker: for a fixed word the hits never fall while p grows, but for the switch of methods, where the
/// two forms may disagree by one.
#[test]
fn hits_grow_with_the_chance() {
    let mut rng = ItemRng::new(17, Purpose::Test(4), 0);
    let (mut falls, mut steps) = (0, 0);
    for n in [1.0f32, 2.0, 5.0, 9.0, 12.0, 13.0, 40.0, 300.0] {
        for _ in 0..200 {
            let bits = rng.bits();
            let mut before = 0.0;
            for i in 0..=1000 {
                let p = i as f32 / 1000.0;
                let hits =
                    count_value(whole_binomial(n.into(), p, 1.0 - p, unit_from_bits(bits), unit_from_bits(!bits))[0]);
                assert!(hits >= before - 1.0, "N {n} p {p} word {bits:x}: {before} then {hits}");
                falls += u32::from(hits < before);
                steps += 1;
                before = hits;
            }
            assert_eq!(before, n);
        }
    }
    assert!(f64::from(falls) < 1e-4 * f64::from(steps), "{falls} of {steps}");
}

#[test]
fn certain_and_impossible_hits() {
    for n in [0.0f32, 1.0, 2.0, 12.0, 13.0, 1e4, 1e16] {
        for bits in [0u32, 1, 77, 1 << 31, u32::MAX - 1, u32::MAX] {
            let [u, v] = [bits, !bits].map(unit_from_bits);
            assert_eq!(whole_binomial(n.into(), 0.0, 1.0, u, v), [0.0, n].map(Count::from));
            assert_eq!(whole_binomial(n.into(), 1.0, 0.0, u, v), [n, 0.0].map(Count::from));
            for p in [1e-16f32, 1e-3, 0.5, 0.7, 1.0 - f32::EPSILON] {
                let [hits, misses] = whole_binomial(n.into(), p, 1.0 - p, u, v).map(count_value);
                assert!(hits >= 0.0 && hits <= n && misses >= 0.0 && misses <= n, "N {n} p {p} {hits} {misses}");
            }
        }
    }
    assert_eq!(binomial(-3.0, 0.5, 0.5, [0, 0]), [Count::default(); 2]);
    assert_eq!(binomial(0.0, 0.5, 0.5, [u32::MAX, 0]), [Count::default(); 2]);
}

#[test]
fn normal_quantile_is_that_of_the_error_function() {
    assert!(unit_from_bits(0) > 0.0 && unit_from_bits(u32::MAX) < 1.0);
    for i in 1..=40_000 {
        let z = 6.3 * f64::from(i) / 40_000.0;
        let u = 0.5 * libm::erfc(z / 2f64.sqrt());
        let found = f64::from(normal_upper_quantile(u as f32));
        assert!((found - z).abs() < 3e-5, "{z}: {found}");
    }
    for bits in (0..1u32 << 31).step_by(997_331) {
        let (low, high) = (normal_upper_quantile(unit_from_bits(bits)), normal_upper_quantile(unit_from_bits(!bits)));
        // Near 1 a uniform number in f32 has no more digits than this.
        let lost = 2f32.powi(-24) / (0.4 * (-0.5 * low * low).exp());
        assert!((low + high).abs() < 3e-5 + lost, "{bits}: {low} {high}");
    }
}
