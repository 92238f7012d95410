//! Textures: the reference against integrals, the fit against scans of the reference, hard cases, limits.

use glam::{DVec2, DVec3};
use glint_bake_core::error::BakeError;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::textures::paper::{ClosedForm, moments};
use glint_bake_core::textures::quality::{albedo, measure, probes};
use glint_bake_core::textures::reference::{Facet, Facets, density, facet, facets, radiance};
use glint_bake_core::textures::{Level, Roughness, Textures, TexturesOptions, bake};
use glint_formats::Wrap;

fn map(width: u32, height: u32, normal: impl Fn(u32, u32) -> [f32; 2]) -> NormalMap {
    let projected = (0..width * height).map(|k| normal(k % width, k / width)).collect();
    NormalMap { width, height, wrap: Wrap::Repeat, projected }
}

/// Normals without order, at most `most` from the middle.
fn noise(width: u32, height: u32, most: f32) -> NormalMap {
    let hash = |i: u32, j: u32, k: u32| {
        let mut h = i.wrapping_mul(0x9e37_79b1) ^ j.wrapping_mul(0x85eb_ca6b) ^ k.wrapping_mul(0xc2b2_ae35);
        h ^= h >> 15;
        h = h.wrapping_mul(0x2c1b_3c6d);
        h ^= h >> 12;
        h as f32 / u32::MAX as f32 * 2.0 - 1.0
    };
    map(width, height, |i, j| [0.7 * most * hash(i, j, 1), 0.7 * most * hash(i, j, 2)])
}

fn baked(map: &NormalMap, roughness: &Roughness) -> Textures {
    bake(map, roughness, &TexturesOptions::default(), &Silent).unwrap()
}

fn texel(level: &Level, i: u32, j: u32) -> Facet {
    let at = (j * level.width + i) as usize;
    let [x, y] = level.normals[at].map(f64::from);
    let normal = DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt()).normalize();
    Facet { normal, alpha: f64::from(level.alphas[at]) }
}

#[test]
fn a_facet_reflects_what_falls_on_it_but_for_masking() {
    for alpha in [0.1, 0.3, 0.8] {
        let of = Facet { normal: DVec3::Z, alpha };
        // ∫ D (h·n) dω over a grid even in z and azimuth.
        let steps = 2000;
        let point = |k: i32| {
            let z = (f64::from(k) + 0.5) / f64::from(steps);
            density(&of, DVec3::new((1.0 - z * z).sqrt(), 0.0, z)) * z
        };
        let whole = std::f64::consts::TAU * (0..steps).map(point).sum::<f64>() / f64::from(steps);
        assert!((whole - 1.0).abs() < 2e-3, "α {alpha}: {whole}");
        // Straight from above, over half vectors: E[G (v·h) / ((n·v) (n·h))] = E[G], at equal shares of GGX.
        let masked = |k: i32| {
            let u = (f64::from(k) + 0.5) / f64::from(steps);
            let z = 2.0 / (1.0 + alpha * alpha * u / (1.0 - u)) - 1.0;
            let tan2 = (1.0 - z * z) / (z * z);
            if z > 0.0 { 1.0 / (1.0 + 0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)) } else { 0.0 }
        };
        let expected = (0..steps).map(masked).sum::<f64>() / f64::from(steps);
        let straight = albedo(&of, DVec3::Z, 600);
        assert!((straight - expected).abs() < 3e-3, "α {alpha}: {straight}, {expected}");
    }
}

#[test]
fn facets_are_those_of_the_bilinear_surface() {
    let map = map(4, 4, |i, _| [0.1 * i as f32, 0.0]);
    let roughness = Roughness::Map((0..16).map(|k| (k % 4) as f32 * 0.25).collect());
    let between = facet(&map, &roughness, DVec2::new(2.0, 1.5));
    assert!((between.normal.x - 0.15).abs() < 1e-6 && (between.alpha - 0.375f64.powi(2)).abs() < 1e-6, "{between:?}");
    let all = facets(&map, &roughness, DVec2::new(2.0, 2.0), DVec2::splat(4.0), 64);
    let mean = all.iter().map(|facet| facet.normal.x).sum::<f64>() / all.len() as f64;
    assert!((mean - 0.15).abs() < 2e-3, "{mean}");
}

#[test]
fn many_facets_at_once_are_the_mean_of_each() {
    let map = noise(8, 8, 0.9);
    let roughness = Roughness::Map((0..64).map(|k| k as f32 / 63.0).collect());
    let all = facets(&map, &roughness, DVec2::new(3.0, 4.0), DVec2::splat(8.0), 16);
    let many = Facets::new(&all);
    for k in 0..50 {
        let t = 0.5 + f64::from(k);
        let vector = |polar: f64, azimuth: f64| {
            DVec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos())
        };
        let (view, light) = (vector(0.03 * t, 1.7 * t), vector(1.5 - 0.02 * t, 2.3 * t));
        let half = (view + light).normalize();
        let mean = |of: &dyn Fn(&Facet) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        let shown = mean(&|of| radiance(of, view, light));
        let dense = mean(&|of| density(of, half) * of.normal.dot(half).max(0.0));
        assert!((many.radiance(view, light) - shown).abs() < 1e-12 * shown, "{k}");
        assert!((many.density(half) - dense).abs() < 1e-12 * dense, "{k}");
    }
}

#[test]
fn a_flat_map_keeps_its_roughness_and_its_normals() {
    for perceptual in [0.1_f32, 0.5, 1.0] {
        for level in baked(&map(16, 8, |_, _| [0.0, 0.0]), &Roughness::Constant(perceptual)).levels {
            assert!(level.normals.iter().all(|normal| *normal == [0.0, 0.0]));
            assert!(
                level.alphas.iter().all(|alpha| (alpha - perceptual * perceptual).abs() < 1e-6),
                "{:?}",
                level.alphas
            );
        }
    }
}

/// The error of ours at a level, that of the best α around the mean normal in a scan, and those of the closed forms.
fn against_scan(map: &NormalMap, roughness: &Roughness, mip: u32) -> (f64, f64, [f64; 4]) {
    let textures = baked(map, roughness);
    let level = &textures.levels[mip as usize - 1];
    let all = probes(map, roughness, mip, 8, 192);
    let ours = measure(&all, |i, j| texel(level, i, j)).error();
    let size = (level.width, level.height);
    let best: f64 = all
        .iter()
        .map(|probe| {
            let (i, j) = probe.texels[0];
            let normal = ClosedForm::Plain.texel(&moments(map, roughness, size, (i, j))).normal;
            let error = |k: i32| {
                let alpha = 0.01 * 100f64.powf(f64::from(k) / 99.0);
                measure(std::slice::from_ref(probe), |_, _| Facet { normal, alpha }).error()
            };
            (0..100).map(error).fold(f64::INFINITY, f64::min)
        })
        .sum::<f64>()
        / all.len() as f64;
    let forms =
        ClosedForm::ALL.map(|form| measure(&all, |i, j| form.texel(&moments(map, roughness, size, (i, j)))).error());
    (ours, best, forms)
}

/// The scan knows the reference's own lights; the fit has a few of its own, but may move the normal.
#[test]
fn the_fit_comes_near_the_best_of_a_scan_and_beats_closed_forms() {
    for (most, perceptual) in [(0.3, 0.25), (0.6, 0.3), (0.2, 0.5), (0.5, 0.6)] {
        let map = noise(64, 64, most);
        for mip in [1, 2, 4, 6] {
            let (ours, best, forms) = against_scan(&map, &Roughness::Constant(perceptual), mip);
            assert!(ours < 1.1 * best + 0.004, "{most} {perceptual} mip {mip}: {ours}, the best of the scan {best}");
            let [plain, ..] = forms;
            let closed = forms.into_iter().fold(f64::INFINITY, f64::min);
            assert!(ours < 1.05 * closed + 0.002 && ours < plain, "{most} {perceptual} mip {mip}: {ours}, {forms:?}");
        }
    }
}

/// Two groups of normals: the mode is nearer than the mean, and is taken.
#[test]
fn where_normals_fall_apart_one_group_is_taken() {
    let map = map(32, 32, |i, _| if i % 4 == 3 { [0.5, 0.0] } else { [-0.1, 0.0] });
    let roughness = Roughness::Constant(0.2);
    let textures = baked(&map, &roughness);
    let level = &textures.levels[1];
    assert!(level.normals.iter().all(|[x, _]| (x + 0.1).abs() < 0.03), "{:?}", &level.normals[..4]);
    let (ours, best, _) = against_scan(&map, &roughness, 2);
    assert!(ours < 0.75 * best, "{ours} {best}");
}

#[test]
fn threads_change_nothing() {
    let map = noise(97, 41, 0.5);
    let roughness = Roughness::Map((0..97 * 41).map(|k| (k % 89) as f32 / 88.0).collect());
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| baked(&map, &roughness))
    };
    let one = on(1);
    assert!(one == on(2) && one == on(7));
}

#[test]
fn hard_cases_stay_in_range() {
    let edge = |i: u32, j: u32| if (i + j).is_multiple_of(2) { [0.999_999, 0.0] } else { [-0.999_999, 0.0] };
    for map in [
        map(1, 1, |_, _| [0.3, 0.1]),
        map(1, 13, |_, j| [0.0, 0.05 * j as f32]),
        map(2048, 1, |i, _| [0.4 * ((i % 7) as f32 / 3.0 - 1.0), 0.0]),
        map(8, 8, edge),
        NormalMap { wrap: Wrap::Clamp, ..map(5, 3, edge) },
        noise(33, 17, 0.9),
        // Equal to one step of 8 bits.
        map(16, 16, |i, _| [if i % 3 == 0 { 1.0 / 127.5 } else { 0.0 }, 0.0]),
    ] {
        for perceptual in [0.0, 0.01, 0.05, 0.3, 1.0] {
            let textures = baked(&map, &Roughness::Constant(perceptual));
            let mut size = (map.width, map.height);
            for level in &textures.levels {
                size = ((size.0 / 2).max(1), (size.1 / 2).max(1));
                assert_eq!((level.width, level.height), size);
                assert_eq!(level.normals.len(), (size.0 * size.1) as usize);
                assert!(
                    level.alphas.iter().all(|alpha| (1e-3..=1.0).contains(alpha)),
                    "{perceptual}: {:?}",
                    level.alphas
                );
                assert!(level.alphas.iter().all(|alpha| *alpha >= 0.999 * perceptual * perceptual));
                assert!(level.normals.iter().all(|[x, y]| x * x + y * y <= 1.0 + 1e-6), "{:?}", level.normals);
            }
            assert_eq!(size, (1, 1));
        }
    }
}

#[test]
fn a_constant_map_of_roughness_is_a_constant() {
    let map = noise(32, 16, 0.4);
    let constant = baked(&map, &Roughness::Constant(0.35));
    assert_eq!(constant, baked(&map, &Roughness::Map(vec![0.35; 512])));
}

#[test]
fn bad_roughness_and_small_memory_are_refused() {
    let map = noise(4, 4, 0.3);
    let refused =
        |roughness: &Roughness, options: &TexturesOptions| bake(&map, roughness, options, &Silent).unwrap_err();
    let usual = TexturesOptions::default();
    let BakeError::BadOption(what) = refused(&Roughness::Constant(1.5), &usual) else { panic!() };
    assert_eq!(what, "roughness: expected 0 to 1, found 1.5");
    let mut values = vec![0.5; 16];
    values[6] = f32::NAN;
    let BakeError::BadInput(what) = refused(&Roughness::Map(values), &usual) else { panic!() };
    assert!(what.contains("texel (2, 1)"), "{what}");
    let BakeError::BadInput(what) = refused(&Roughness::Map(vec![0.5; 15]), &usual) else { panic!() };
    assert!(what.contains("16 texels") && what.contains("found 15"), "{what}");
    let small = TexturesOptions { max_memory: 100, ..usual };
    let BakeError::LimitExceeded(what) = refused(&Roughness::Constant(0.5), &small) else { panic!() };
    assert!(what.starts_with("max-memory: "), "{what}");
}
