//! The baked dictionary against exact lobes, against its target, and against its contract.

use glint_bake_core::dictionary::bake::to_half_with_sum;
use glint_bake_core::dictionary::quality::{
    domain_floor, integral_linear, measure, measure_level, read_linear, target_density,
};
use glint_bake_core::dictionary::{DictionaryOptions, bake, reference};
use glint_bake_core::error::BakeError;
use glint_bake_core::progress::Silent;
use half::f16;

/// Σ h |table − exact| / Σ h exact over the bin centres of one marginal.
fn l1_to_exact(options: &DictionaryOptions, table: &[f64], exact: &reference::ExactMarginal) -> f64 {
    let (mut difference, mut sum) = (0.0, 0.0);
    for b in 0..table.len() {
        let truth = exact.density((b as f64 + 0.5) * options.spacing());
        difference += (table[b] - truth).abs();
        sum += truth;
    }
    difference / sum
}

#[test]
fn tables_are_the_exact_lobes_at_bin_centres() {
    let options = DictionaryOptions { marginals: 24, levels: 14, ..Default::default() };
    let dictionary = bake(&options, &Silent).unwrap();
    // Up to level 8 only rounding to half floats is between them; above, also the sub-bins that lobes are counted in.
    for (level, mean_limit) in [(0, 5e-4), (1, 5e-4), (4, 5e-4), (8, 5e-4), (9, 6e-3), (11, 3e-3), (13, 1.5e-3)] {
        let exact = reference::exact_level(&options, level);
        let mut mean = 0.0;
        for i in 0..options.marginals {
            mean += l1_to_exact(&options, &dictionary.entries(level, i), &exact[i as usize]) / 24.0;
        }
        assert!(mean <= mean_limit, "level {level}: L1 {mean:.2e} to exact lobes, limit {mean_limit:.1e}");
    }
}

#[test]
fn interpolated_marginals_follow_the_exact_density_between_the_entries() {
    let options = DictionaryOptions { marginals: 4, levels: 13, ..Default::default() };
    let dictionary = bake(&options, &Silent).unwrap();
    let exact = reference::exact_level(&options, 12);
    for i in 0..options.marginals {
        let table = dictionary.entries(12, i);
        let (mut difference, mut sum) = (0.0, 0.0);
        for k in 0..400 {
            let x = (f64::from(k) + 0.5) / 400.0 * options.domain();
            let truth = exact[i as usize].density(x);
            difference += (read_linear(&table, options.spacing(), x) - truth).abs();
            sum += truth;
        }
        assert!(difference / sum < 0.01, "marginal {i}: {:.4}", difference / sum);
    }
}

#[test]
fn every_marginal_is_normalised_as_the_sampler_reads_it() {
    let sizes = [
        DictionaryOptions::default(),
        DictionaryOptions { marginals: 1, levels: 1, entries: 64, ..Default::default() },
        DictionaryOptions { marginals: 7, levels: 12, entries: 53, ..Default::default() },
        DictionaryOptions { marginals: 3, levels: 10, entries: 512, ..Default::default() },
        DictionaryOptions { marginals: 5, levels: 3, entries: 16, lobe_std: 0.1, ..Default::default() },
        DictionaryOptions { alpha_dict: 0.01, lobe_std: 0.0004, ..Default::default() },
        DictionaryOptions { alpha_dict: 10.0, lobe_std: 0.4, ..Default::default() },
    ];
    for options in sizes {
        let dictionary = bake(&options, &Silent).unwrap();
        for level in 0..options.levels {
            for i in 0..options.marginals {
                let table = dictionary.entries(level, i);
                let error = (2.0 * integral_linear(&table, options.spacing()) - 1.0).abs();
                assert!(error <= 1e-6, "{options:?} level {level} marginal {i}: {error:.2e}");
                assert!(table.iter().all(|v| v.is_finite() && *v >= 0.0));
            }
        }
    }
}

#[test]
fn the_default_dictionary_meets_its_targets_for_any_seed() {
    for seed in [0, 1, 2, 12345, u64::MAX] {
        let dictionary = bake(&DictionaryOptions { seed, ..Default::default() }, &Silent).unwrap();
        let measured = measure(&dictionary);
        assert!(measured.normalisation <= 1e-4, "seed {seed}: normalisation {:.2e}", measured.normalisation);
        assert!(measured.mean_l1_first_level <= 0.03, "seed {seed}: L1 {:.4}", measured.mean_l1_first_level);
        assert!(measured.ks_last_level <= 0.0019, "seed {seed}: KS {:.5}", measured.ks_last_level);
        let last = measure_level(&dictionary, 15);
        let above = last.ks_of_mean - domain_floor();
        assert!(above <= 5e-4, "seed {seed}: KS of the mean is {above:.2e} above the floor");
        for level in 0..16 {
            let ratio = measure_level(&dictionary, level).contrast_ratio;
            assert!((ratio - 1.0).abs() <= 0.1, "seed {seed} level {level}: contrast {ratio:.3} of independent");
        }
    }
}

#[test]
fn a_level_keeps_the_lobes_of_the_level_below() {
    let options = DictionaryOptions { marginals: 16, ..Default::default() };
    let dictionary = bake(&options, &Silent).unwrap();
    for level in 0..options.levels - 1 {
        for i in 0..options.marginals {
            let (below, above) = (dictionary.entries(level, i), dictionary.entries(level + 1, i));
            let (mut missing, mut changed) = (0.0, 0.0);
            for b in 0..below.len() {
                missing += (below[b] - 2.0 * above[b]).max(0.0) * options.spacing();
                changed += (below[b] - above[b]).abs() * options.spacing();
            }
            assert!(missing < 3e-3, "level {level} marginal {i}: {missing:.2e} of the lobes is gone");
            assert!(changed > 1e-4, "level {level} marginal {i}: nothing was added");
        }
    }
}

#[test]
fn lobes_near_the_end_of_the_domain_are_neither_lost_nor_empty() {
    // The authors' tables divide by zero when all lobes of a marginal lie beyond the domain: many seeds, one lobe each.
    let mut largest: f64 = 0.0;
    for seed in 0..40 {
        let options = DictionaryOptions { marginals: 512, levels: 1, seed, ..Default::default() };
        for exact in reference::exact_level(&options, 0) {
            assert!(exact.density(options.domain() * 1.001) == 0.0);
        }
        let dictionary = bake(&options, &Silent).unwrap();
        for i in 0..options.marginals {
            let table = dictionary.entries(0, i);
            let peak = (0..64).max_by(|a, b| table[*a].total_cmp(&table[*b])).unwrap();
            largest = largest.max((peak as f64 + 0.5) * options.spacing() / options.target_std());
            assert!(table[peak] > 5.0, "seed {seed} marginal {i}: peak {}", table[peak]);
        }
    }
    assert!(largest > 3.5, "no lobe beyond 3.5 standard deviations in 20 480: {largest}");
}

#[test]
fn the_bytes_do_not_depend_on_threads_or_platform() {
    let digest = |bytes: &[u8]| {
        bytes.iter().fold(0xcbf2_9ce4_8422_2325u64, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x100_0000_01b3))
    };
    let options = DictionaryOptions::default();
    let payload =
        || -> Vec<u8> { bake(&options, &Silent).unwrap().bits.iter().flat_map(|bits| bits.to_le_bytes()).collect() };
    let first = payload();
    for threads in [1, 2, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(payload) == first, "{threads} threads");
    }
    let other = bake(&DictionaryOptions { seed: 1, ..options }, &Silent).unwrap();
    assert!(other.bits != bake(&options, &Silent).unwrap().bits, "the seed changes nothing");
    assert_eq!(digest(&first), FROZEN_DIGEST, "default dictionary changed: {:#x}", digest(&first));
}

/// FNV-1a of the default dictionary's half floats.
const FROZEN_DIGEST: u64 = 0x99bf_be9e_9420_d301;

#[test]
fn the_table_holds_every_entry_with_the_next() {
    let dictionary = bake(&DictionaryOptions::default(), &Silent).unwrap();
    let pairs = dictionary.pairs();
    assert_eq!(pairs.len(), 64 * 3072);
    for (row, words) in dictionary.bits.chunks_exact(64).zip(pairs.chunks_exact(64)) {
        for b in 0..64 {
            assert_eq!(words[b], u32::from(row[b]) | u32::from(row[63.min(b + 1)]) << 16);
        }
    }
    let odd = DictionaryOptions { marginals: 1, levels: 1, entries: 53, ..Default::default() };
    let pairs = bake(&odd, &Silent).unwrap().pairs();
    assert_eq!((pairs.len(), &pairs[53..]), (56, &[0; 3][..]));
    let params = dictionary.params(measure(&dictionary));
    assert_eq!((params.marginals, params.levels, params.entries), (192, 16, 64));
    assert!(params.measured.ks_last_level > 0.0);
}

#[test]
fn what_cannot_work_is_refused_by_name() {
    let default = DictionaryOptions::default();
    let cases = [
        (DictionaryOptions { marginals: 0, ..default }, "marginals: expected 1 or more, found 0"),
        (DictionaryOptions { levels: 0, ..default }, "levels: expected 1 or more, found 0"),
        (DictionaryOptions { entries: 0, ..default }, "entries: expected 1 or more, found 0"),
        (DictionaryOptions { levels: 21, ..default }, "levels: expected 1 to 20, found 21"),
        (DictionaryOptions { alpha_dict: 0.0, ..default }, "found 0;"),
        (DictionaryOptions { alpha_dict: f64::NAN, ..default }, "found NaN;"),
        (DictionaryOptions { alpha_dict: 1e6, ..default }, "found 1000000;"),
        (DictionaryOptions { lobe_std: 0.0, ..default }, "lobe-std: expected a slope of 0.00001 or more"),
        (DictionaryOptions { lobe_std: f64::INFINITY, ..default }, "found inf"),
        (DictionaryOptions { lobe_std: 2.0, ..default }, "below the domain"),
        (DictionaryOptions { lobe_std: 0.5, ..default }, "narrower than the target"),
        (DictionaryOptions { lobe_std: 0.001, ..default }, "table empty"),
        (DictionaryOptions { entries: 16, ..default }, "25 entries or more"),
        (DictionaryOptions { entries: 1, lobe_std: 0.6, ..default }, "narrower than the target"),
    ];
    for (options, expected) in cases {
        match bake(&options, &Silent) {
            Err(BakeError::BadOption(message)) => assert!(message.contains(expected), "{message} lacks {expected}"),
            other => {
                panic!("{options:?}: expected a refusal with '{expected}', got {:?}", other.map(|_| "a dictionary"))
            }
        }
    }
    let large = DictionaryOptions { marginals: 1000, ..default };
    assert!(matches!(bake(&large, &Silent), Err(BakeError::LimitExceeded(m)) if m.contains("16000")));
    let advised = DictionaryOptions { entries: 25, ..default };
    assert!(bake(&advised, &Silent).is_ok(), "the message's own advice must work");
}

#[test]
fn rounding_keeps_the_sum_and_moves_entries_by_a_few_units_in_the_last_place() {
    let mut state = 1u32;
    for case in 0..2000 {
        let mut values = Vec::new();
        for _ in 0..64 {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            values.push(libm::exp(-20.0 * f64::from(state >> 8) / 16_777_216.0) * 10.0);
        }
        let sum: f64 = values.iter().sum();
        let mut bits = vec![0u16; 64];
        to_half_with_sum(&values, sum, &mut bits);
        let (mut rounded, mut moved) = (0.0, 0.0);
        for b in 0..64 {
            let value = f16::from_bits(bits[b]).to_f64();
            rounded += value;
            moved += (value - values[b]).abs();
            assert!(
                (value - values[b]).abs() <= values[b] * 8e-3 + 1.2e-7,
                "case {case}: {} became {value}",
                values[b]
            );
        }
        // Rounding alone moves up to 2^−11 of the sum; putting the sum right, as much again and one overshoot.
        assert!(moved <= 1.5e-3 * sum, "case {case}: moved {:.2e} of the sum", moved / sum);
        assert!((rounded / sum - 1.0).abs() < 1e-7, "case {case}: sum off by {:.2e}", rounded / sum - 1.0);
    }
}

#[test]
fn single_values_round_to_the_nearest_half_float() {
    // A table of one entry whose sum is that entry: the nearest half float is the best there is.
    let mut value = 1e-8;
    while value < 60_000.0 {
        let mut bits = [0u16];
        to_half_with_sum(&[value], value, &mut bits);
        let found = f16::from_bits(bits[0]).to_f64();
        for neighbour in [bits[0].saturating_sub(1), bits[0] + 1] {
            let other = f16::from_bits(neighbour).to_f64();
            assert!((found - value).abs() <= (other - value).abs(), "{value:e} became {found:e}, {other:e} is nearer");
        }
        value *= 1.000_37;
    }
}

#[test]
fn the_target_is_the_beckmann_marginal() {
    let options = DictionaryOptions::default();
    for x in [0.0, 0.1, 0.35, 1.0] {
        let beckmann = libm::exp(-x * x / 0.25) / (0.5 * std::f64::consts::PI.sqrt());
        assert!((target_density(&options, x) - beckmann).abs() < 1e-12);
    }
}
