//! Evaluation of packed lobes against brute force and exact integration, and the two references against each other.

use glam::{DVec2, Vec2};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::lobes::eval::frame;
use glint_bake_core::lobes::options::{LobesOptions, NormalsChoice};
use glint_bake_core::lobes::quality::{Gathered, Measured, difference, footprint_errors};
use glint_bake_core::lobes::query::{Detail, Lod, QuerySettings};
use glint_bake_core::lobes::reference::{Reference, sum_of_boxes};
use glint_bake_core::lobes::{BakedLobes, bake};
use glint_bake_core::ndf_maps::bake::bake_maps as bake_ndf_maps;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, TransformRanges};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::metrics::{DiskGrid, e1};
use glint_bake_core::quality::sweep;
use glint_formats::Wrap;
use glint_formats::lobes::{Filter, LobeStorage, MAX_LAST_CELLS, Merge};

const ROUGHNESS: f64 = 0.02;

/// Waves of several lengths and directions with a scratch across them.
fn waves(size: u32) -> NormalMap {
    let projected = (0..size * size)
        .map(|k| {
            let (x, y) = ((k % size) as f32, (k / size) as f32);
            let turn = std::f32::consts::TAU / size as f32;
            let (a, b) = ((turn * (3.0 * x + 2.0 * y)).sin(), (turn * (2.0 * x - 5.0 * y)).cos());
            let scratch = if (x + 2.0 * y) as u32 % size == 7 { 0.2 } else { 0.0 };
            [0.12 * a + 0.05 * b + scratch, 0.1 * b - 0.03 * a]
        })
        .collect();
    NormalMap { width: size, height: size, wrap: Wrap::Repeat, projected }
}

fn options() -> LobesOptions {
    LobesOptions { footprints: 0, normals: NormalsChoice::Snorm16, ..LobesOptions::default() }
}

/// Part of a round footprint that the lobes of the last level show, every place alike, in pictures of a map of 64 × 64 texels.
#[test]
fn the_whole_map_stands_for_footprints_that_see_all_of_it() {
    let baked = bake(&waves(64), &options(), &Silent).unwrap();
    let whole = |sigma: f64| {
        let footprint = Footprint::new(DVec2::splat(20.0), sigma, 1.0, 0.0);
        let Lod { finer, coarser, fraction } = baked.lod(&frame(&footprint), &QuerySettings::realtime());
        let part = |detail: Detail, weight: f32| if detail == Detail::Whole { weight } else { 0.0 };
        part(finer, 1.0 - fraction) + part(coarser, fraction)
    };
    assert_eq!(whole(6.4), 0.0);
    assert_eq!(whole(64.0), 1.0);
}

#[test]
fn boxes_are_the_brute_force_sum() {
    let map = waves(32);
    let baked = bake(&map, &options(), &Silent).unwrap();
    for (sigma, anisotropy, edge) in [(1.5, 1.0, 1.0), (2.0, 3.0, 0.5), (0.3, 2.0, 0.25)] {
        let footprint = Footprint::new(DVec2::new(30.7, 5.2), sigma, anisotropy, 0.6);
        let seen = baked.gather_detail(&footprint, Detail::Boxes(edge), ROUGHNESS as f32, 6.0);
        let mut worst = (0.0f64, 0.0f64);
        for k in 0..40 {
            let s = DVec2::from_angle(k as f64) * (0.008 * k as f64);
            let exact = sum_of_boxes(&map, &footprint, edge as f64, ROUGHNESS, s);
            worst = (worst.0.max((exact - seen.density(s.as_vec2()) as f64).abs()), worst.1.max(exact));
        }
        // Half a step of 16-bit normals is 8e-4 σ_r.
        assert!(worst.0 < 8e-4 * worst.1, "{sigma}: {worst:?}");
    }
}

#[test]
fn the_reference_is_that_of_ndf_maps() {
    let map = waves(16);
    let options = NdfMapsOptions { roughness: ROUGHNESS, max_error: 1.0, ..NdfMapsOptions::default() };
    let material = Material {
        maps: bake_ndf_maps(&map, &options, &Silent).unwrap(),
        placement: place(&map, ROUGHNESS, &PlacementOptions::Tiled(TransformRanges::default())).unwrap(),
    };
    let other = SurfaceReference::new(&map, &material);
    let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
    let finer = Reference::new(&map, Filter::Linear, ROUGHNESS).refined(2.0);
    for (sigma, anisotropy) in [(0.7, 1.0), (1.5, 4.0), (5.0, 1.0), (6.0, 3.0)] {
        let footprint = Footprint::new(DVec2::new(14.3, 3.9), sigma, anisotropy, 2.1);
        let ours = reference.ndf(&footprint, 3);
        let doubled = e1(&ours.values, &finer.ndf(&footprint, 3).values);
        assert!(doubled < 2e-3, "{sigma} × {anisotropy}: {doubled} when pieces are half as long");
        // The other samples a lattice that lies across the map's patches.
        let error = e1(&ours.values, &other.ndf(&footprint).on_grid(&ours.grid));
        assert!(error < 6e-3, "{sigma} × {anisotropy}: {error}");
        assert!((ours.grid.integral(&ours.values) - 1.0).abs() < 2e-3);
    }
}

#[test]
fn one_query_and_gathered_lobes_agree() {
    let baked = bake(&waves(64), &options(), &Silent).unwrap();
    let settings = QuerySettings::default();
    for sigma in [0.2, 1.3, 2.6, 5.0, 11.0, 40.0, 900.0] {
        let footprint = Footprint::new(DVec2::new(-31.0, 70.5), sigma, 2.0, 1.0);
        let seen = baked.gather(&footprint, ROUGHNESS as f32, &settings);
        for k in 0..20 {
            let s = Vec2::from_angle(k as f32) * (0.01 * k as f32);
            let (one, all) = (baked.p_ndf(&footprint, s, ROUGHNESS as f32, &settings), seen.density(s));
            assert!((one - all).abs() <= 1e-4 * all.max(1e-3), "{sigma}: {one} {all}");
        }
    }
}

fn mean_error(reference: &Reference<'_>, baked: &BakedLobes, measured: Measured, sigma: f64) -> f64 {
    let footprints = sweep::footprints(sigma, 1.0, DVec2::splat(baked.params.width as f64), 6, 3);
    footprint_errors(reference, &[(baked, measured)], &footprints, 4)[0].e1.mean
}

#[test]
fn every_reduction_keeps_its_place_and_packing_costs_nothing_that_shows() {
    let map = waves(64);
    let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
    for (sigma, level) in [(4.0, 0), (8.0, 1)] {
        let error = |merge: Merge, storage: LobeStorage| {
            let baked = bake(&map, &LobesOptions { merge, storage, ..options() }, &Silent).unwrap();
            mean_error(&reference, &baked, Measured::At(Detail::Cells(level)), sigma)
        };
        let [kmeans, moments, runnalls] =
            [Merge::KMeans, Merge::Moments, Merge::Runnalls].map(|merge| error(merge, LobeStorage::Packed));
        assert!(runnalls < moments && moments < kmeans, "{sigma}: {runnalls} {moments} {kmeans}");
        assert!(runnalls < 0.5 * kmeans && runnalls < 0.05, "{sigma}: {runnalls} {kmeans}");
        let half = error(Merge::Runnalls, LobeStorage::Half);
        assert!(runnalls < half + 0.003, "{sigma}: {runnalls} {half}");
    }
}

#[test]
fn levels_by_edge_are_those_of_cells_as_wide_and_between_them_mixtures() {
    let map = waves(64);
    let baked = bake(&map, &options(), &Silent).unwrap();
    let axes = frame(&Footprint::new(DVec2::ZERO, 2.0, 1.0, 0.0));
    // Stored levels have cells of 8 and 16 texels; σ = 2 reads boxes of half a texel.
    for (lambda, finer, coarser, fraction) in [
        (2.0, Detail::Boxes(0.5), Detail::Boxes(0.5), 0.0),
        (2.75, Detail::Boxes(0.5), Detail::Cells(0), 0.75),
        (3.0, Detail::Cells(0), Detail::Cells(0), 0.0),
        (3.25, Detail::Cells(0), Detail::Cells(1), 0.25),
        (9.5, Detail::Cells(1), Detail::Cells(1), 0.5),
    ] {
        assert_eq!(baked.lod_of_edge(&axes, lambda), Lod { finer, coarser, fraction }, "{lambda}");
    }
    let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
    let error = |measured| mean_error(&reference, &baked, measured, 4.0);
    assert_eq!(error(Measured::Edge(4.0)), error(Measured::At(Detail::Cells(1))));
    let [finer, between, coarser] = [3.0, 3.5, 4.0].map(|lambda| error(Measured::Edge(lambda)));
    assert!(finer < between && between < coarser, "{finer} {between} {coarser}");
}

#[test]
fn levels_pass_into_each_other_without_a_jump() {
    let map = waves(64);
    let baked = bake(&map, &options(), &Silent).unwrap();
    let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
    let settings = QuerySettings::default();
    let mut footprint = Footprint::new(DVec2::new(20.0, 41.0), 1.9, 1.0, 0.0);
    let mut before: Option<Vec<f64>> = None;
    let (mut sigma, mut count) = (1.9, 0);
    let grid = DiskGrid::over(DVec2::splat(-0.45), DVec2::splat(0.45), 0.03);
    while sigma < 120.0 {
        footprint.covariance = Footprint::new(DVec2::ZERO, sigma, 1.0, 0.0).covariance;
        let seen = baked.gather(&footprint, ROUGHNESS as f32, &settings);
        if count % 20 == 0 {
            let exact = reference.ndf(&footprint, 6);
            let error = |seen: &Gathered| difference(&exact, seen).0;
            let lod = baked.lod(&frame(&footprint), &settings);
            let [finer, coarser] = [lod.finer, lod.coarser]
                .map(|detail| error(&baked.gather_detail(&footprint, detail, ROUGHNESS as f32, settings.reach)));
            let mixed = error(&seen);
            assert!(mixed < 1.2 * finer.max(coarser) + 1e-3, "σ {sigma}: {mixed} of {finer} and {coarser}");
        }
        let values = grid.evaluate(|s| seen.density(s.as_vec2()) as f64);
        if let Some(before) = &before {
            // The exact one changes by up to 0.011.
            let step = e1(&values, before);
            assert!(step < 0.015, "σ {sigma}: the P-NDF changes by {step}");
        }
        before = Some(values);
        sigma *= 1.01;
        count += 1;
    }
}

#[test]
fn the_level_of_detail_rises_with_the_footprint_and_bounds_the_work() {
    let baked = bake(&waves(128), &LobesOptions { seeds: 1, ..options() }, &Silent).unwrap();
    let settings = QuerySettings::default();
    for anisotropy in [1.0, 4.0, 32.0, 1000.0] {
        for exponent in -26..=54 {
            let sigma = 2.0f64.powf(exponent as f64 / 4.0);
            for angle in [0.0, 0.4, std::f64::consts::FRAC_PI_2] {
                let footprint = Footprint::new(DVec2::new(100.0, 3.0), sigma, anisotropy, angle);
                let seen = baked.gather(&footprint, 0.02, &settings);
                assert!(!seen.lobes.is_empty() && seen.lobes.len() < 6000, "{footprint:?}: {}", seen.lobes.len());
                let share: f32 = seen.lobes.iter().map(|lobe| lobe.share).sum();
                assert!((share - 1.0).abs() < 1e-3, "{footprint:?}: {share}");
            }
        }
    }
}

#[test]
fn nearest_maps_have_no_streaks() {
    // Flakes: neighbours have nothing to do with each other, and nothing lies between them.
    let hash = |k: u32| {
        let x = k.wrapping_mul(0x9e37_79b9) ^ (k.wrapping_mul(0x85eb_ca6b) >> 13);
        (x.wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1u32 << 24) as f32
    };
    let projected = (0..64 * 64).map(|k| [0.6 * (hash(k / 2) - 0.5), 0.6 * (hash(k / 2 + 9999) - 0.5)]).collect();
    let map = NormalMap { width: 64, height: 64, wrap: Wrap::Repeat, projected };
    let baked = bake(&map, &LobesOptions { filter: Filter::Nearest, ..options() }, &Silent).unwrap();
    assert!(baked.params.levels[0].jacobian_scale < 1.0);
    let reference = Reference::new(&map, Filter::Nearest, ROUGHNESS);
    let boxes = mean_error(&reference, &baked, Measured::At(Detail::Boxes(1.0)), 2.0);
    assert!(boxes < 0.03, "{boxes}");
    let linear = bake(&map, &options(), &Silent).unwrap();
    let streaks = mean_error(&reference, &linear, Measured::At(Detail::Boxes(0.5)), 2.0);
    assert!(streaks > 5.0 * boxes, "{streaks} {boxes}");
}

#[test]
fn the_same_bytes_at_any_number_of_threads_and_others_for_another_seed() {
    let map = waves(48);
    let bytes = |threads: usize, merge: Merge, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = LobesOptions { merge, seed, footprints: 2, ..LobesOptions::default() };
        pool.install(|| bake(&map, &options, &Silent).unwrap())
    };
    for merge in [Merge::Runnalls, Merge::KMeans] {
        let one = bytes(1, merge, 1);
        assert!(one == bytes(2, merge, 1) && one == bytes(7, merge, 1), "{merge:?}");
    }
    assert!(bytes(1, Merge::KMeans, 1).lobes != bytes(1, Merge::KMeans, 2).lobes);
}

#[test]
fn settings_for_pictures_see_few_lobes_and_little_else() {
    let map = waves(128);
    let baked = bake(&map, &options(), &Silent).unwrap();
    let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
    let settings = [QuerySettings::default(), QuerySettings::realtime()];
    for sigma in [0.7, 2.0, 5.0, 11.0] {
        let footprints = sweep::footprints(sigma, 1.0, DVec2::splat(128.0), 6, 3);
        let bakes = settings.map(|settings| (&baked, Measured::Chosen(settings)));
        let errors = footprint_errors(&reference, &bakes, &footprints, 6);
        let (default, few) = (errors[0], errors[1]);
        println!(
            "σ {sigma}: E₁ {:.3} and {:.3}, lobes {} and {}",
            default.e1.mean, few.e1.mean, default.lobes, few.lobes
        );
        assert!(few.e1.mean < 0.2, "σ {sigma}: {}", few.e1.mean);
        // Nine cells of a level, and of the next, read over a part of the way, as many, or the whole map's sixteen.
        let most = (9 + MAX_LAST_CELLS.pow(2) as usize) * 32;
        assert!(few.most_lobes <= most && few.lobes < 0.7 * default.lobes, "σ {sigma}: {} lobes", few.lobes);
    }
}
