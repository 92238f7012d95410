//! Random words of surface cells: uniform at every place, independent of each other, continuous, and coherent where rare.

use glam::Vec2;
use glint_bake_core::environment::query::{
    footprint_area, footprint_facets, surface_bits, surface_cells, surface_lod, surface_word, surface_words,
};
use glint_bake_core::rng::{ItemRng, Purpose};

/// A word is 1 − ∏ (1 − w x), x the least h / w: all of its digits where it is small, seven places where it is not.
#[test]
fn words_are_the_race_of_the_corners_to_their_digits() {
    let mut rng = ItemRng::new(5, Purpose::Test(78), 0);
    let mut rare = 0;
    for seed in 0..200_000 {
        let position = Vec2::new(rng.unit() as f32, rng.unit() as f32) * 40.0;
        let cells = surface_cells(position, 4.0 * rng.unit() as f32 - 2.0, seed);
        let weights = cells.inverse_weights.map(|inverse| 1.0 / f64::from(inverse) / 4_294_967_296.0);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-6, "{cells:?}");
        let numbers = cells.states.map(|state| (f64::from(surface_bits(state, 1)) + 0.5) / 4_294_967_296.0);
        let all = numbers.iter().zip(weights).map(|(h, w)| (h / w, w));
        let (least, weight) = all.fold((f64::INFINITY, 1.0), |a, b| if b.0 < a.0 { b } else { a });
        let exact = -libm::expm1(weights.iter().map(|w| libm::log1p(-w * least)).sum::<f64>());
        let found = f64::from(surface_word(&cells, 1));
        // Half a step of the corner's word, one of the place's, and what stands for the former on average.
        let steps = (0.5 / weight + 1.0 + 2.0) / 4_294_967_296.0;
        assert!((found - exact).abs() < 1e-6 * exact + steps, "{cells:?}: {found} {exact}");
        rare += u32::from(exact < 1e-3);
    }
    assert!((140..260).contains(&rare), "{rare} rare words, expected about 200");
}

/// Largest distance of the distribution function of words in (0, 1) from that of uniform numbers.
fn distance_from_uniform(mut words: Vec<f64>) -> f64 {
    words.sort_by(f64::total_cmp);
    let count = words.len() as f64;
    words.iter().enumerate().map(|(i, u)| (u - (i as f64 + 0.5) / count).abs()).fold(0.0, f64::max)
}

#[test]
fn words_are_uniform_at_corners_between_them_and_between_levels() {
    const SEEDS: u32 = 40_000;
    // Kolmogorov: 1.95 / √n is exceeded in 1 of 1000 cases.
    let most = 1.95 / f64::from(SEEDS).sqrt();
    for (position, lod) in [
        (Vec2::ZERO, 0.0),
        (Vec2::new(0.31, 0.17), 0.0),
        (Vec2::new(-7.4, 3.3), 0.5),
        (Vec2::new(0.5, -0.2), -2.9),
        (Vec2::new(123.4, 9.1), 3.01),
    ] {
        let words: Vec<f64> =
            (0..SEEDS).map(|seed| f64::from(surface_word(&surface_cells(position, lod, seed), 3))).collect();
        let rare = words.iter().filter(|u| **u < 1e-3).count() as f64 / (f64::from(SEEDS) * 1e-3);
        let distance = distance_from_uniform(words);
        assert!(distance < most, "{position} {lod}: {distance}, expected {most} at most");
        // 40 expected, five standard deviations.
        assert!((rare - 1.0).abs() < 0.8, "{position} {lod}: rare words {rare}");
    }
}

#[test]
fn the_words_of_a_place_do_not_depend_on_each_other() {
    const SEEDS: u32 = 20_000;
    let mut sums = [[0.0; 4]; 4];
    for seed in 0..SEEDS {
        let cells = surface_cells(Vec2::new(0.4, 0.3), 0.4, seed);
        let words = surface_words(&cells, 4).map(|word| f64::from(word) - 0.5);
        (0..4).for_each(|i| (0..4).for_each(|j| sums[i][j] += 12.0 * words[i] * words[j] / f64::from(SEEDS)));
    }
    for (i, row) in sums.iter().enumerate() {
        for (j, sum) in row.iter().enumerate() {
            let expected = if i == j { 1.0 } else { 0.0 };
            assert!((sum - expected).abs() < 0.04, "words {i} and {j}: {sum}");
        }
    }
}

/// A step of 1/1024 of a cell, or of a level, changes words little, and none jumps: were there seams between cells, one place
/// in a few hundred would lie on one, which is tens of these.
#[test]
fn words_change_gradually_with_place_and_footprint() {
    const STEP: f32 = 1.0 / 1024.0;
    let mut rng = ItemRng::new(5, Purpose::Test(77), 0);
    let (mut moved, mut zoomed, mut jumps) = (0.0, 0.0, 0);
    const PLACES: u32 = 20_000;
    for seed in 0..PLACES {
        let position = Vec2::new(rng.unit() as f32, rng.unit() as f32) * 40.0;
        let lod = 4.0 * rng.unit() as f32 - 2.0;
        let edge = lod.exp2();
        let word = |position, lod| f64::from(surface_word(&surface_cells(position, lod, seed), 1));
        let here = word(position, lod);
        let there = (word(position + Vec2::new(STEP * edge, 0.0), lod) - here).abs();
        moved += there / f64::from(PLACES);
        jumps += u32::from(there > 0.25);
        zoomed += (word(position, lod + STEP) - here).abs() / f64::from(PLACES);
    }
    println!("a step of 1/1024: words change by {moved:.5} (place), {zoomed:.5} (level); {jumps} by more than 1/4");
    // Independent words differ by 1/3 on average.
    assert!(moved < 2e-3 && zoomed < 2e-3, "{moved} {zoomed}");
    assert!(jumps == 0, "{jumps} of {PLACES} jump");
}

/// The spot of a rare facet is about a cell: where a word is below 1/1000, so it is a tenth of a cell further in most cases.
#[test]
fn rare_words_are_spots_of_about_a_cell() {
    let (mut met, mut kept) = (0, 0);
    for seed in 0..200_000 {
        let word = |x: f32| f64::from(surface_word(&surface_cells(Vec2::new(x, 0.37), 0.0, seed), 2));
        if word(0.21) < 1e-3 {
            met += 1;
            kept += u32::from(word(0.31) < 1e-3);
        }
    }
    assert!((120..280).contains(&met), "{met} rare words, expected about 200");
    assert!(kept * 3 > met * 2, "{kept} of {met} are rare a tenth of a cell further");
}

#[test]
fn footprints_without_area_have_no_facets_and_huge_ones_a_bounded_number() {
    let none = footprint_area(Vec2::X, Vec2::X);
    assert_eq!((none, footprint_facets(none, 1e9)), (0.0, 0.0));
    assert_eq!(surface_lod(none), -24.0);
    let huge = footprint_area(Vec2::splat(1e20), Vec2::new(-1e20, 1e20));
    assert_eq!(footprint_facets(huge, 1.0), 1e16);
    let words = surface_words(&surface_cells(Vec2::splat(f32::MAX), surface_lod(huge), 1), 16);
    assert!(words.iter().any(|word| *word != words[0]));
}
