//! Hard examples and hard footprints: every answer is finite, not negative and normalised, or an error says why not.

mod hard_maps;

use glam::{DVec2, Vec2};
use glint_bake_core::error::BakeError;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::bake::bake_maps;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::EvalSettings;
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, StochasticOptions, TransformRanges};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::metrics::DiskGrid;
use hard_maps::{hard_maps, map};

fn material(map: &NormalMap, roughness: f64, options: &PlacementOptions) -> Material {
    let options_of_maps = NdfMapsOptions { roughness, max_error: 0.02, ..NdfMapsOptions::default() };
    let maps = bake_maps(map, &options_of_maps, &Silent).unwrap();
    Material { placement: place(map, roughness, options).unwrap(), maps }
}

/// Integral of a footprint's NDF over the disk; panics when a value is negative or not finite.
fn integral(name: &str, material: &Material, footprint: &Footprint) -> f64 {
    let terms = material.gather(footprint, EvalSettings::default());
    assert!(!terms.is_empty(), "{name}: {footprint:?} sees nothing");
    let spacing = (material.maps.params.intrinsic_roughness as f64 / 2.0).clamp(2.0 / 900.0, 0.1);
    let grid = DiskGrid::over(DVec2::splat(-1.0), DVec2::splat(1.0), spacing);
    let values = grid.evaluate(|s| {
        let density = material.density(&terms, s.as_vec2());
        assert!(density.is_finite() && density >= 0.0, "{name}: {density} at {s} under {footprint:?}");
        density as f64
    });
    grid.integral(&values)
}

#[test]
fn hard_examples_stay_normalised_under_every_footprint() {
    let mut worst = (0.0, "");
    for (name, map) in hard_maps() {
        for options in [
            PlacementOptions::Tiled(TransformRanges::default()),
            PlacementOptions::Stochastic(StochasticOptions { cells: 4, ..StochasticOptions::default() }),
        ] {
            let material = material(&map, 0.05, &options);
            for (sigma, anisotropy) in [(0.0, 1.0), (0.01, 1.0), (0.3, 8.0), (1.0, 1000.0), (3.0, 1.0), (1e4, 1.0)] {
                // On a corner shared by wrap seam and patch seam, and off it.
                for mean in [DVec2::ZERO, DVec2::new(5.3, -1000.7)] {
                    let footprint = Footprint::new(mean, sigma, anisotropy, 0.7);
                    let got = integral(name, &material, &footprint);
                    assert!((got - 1.0).abs() < 0.02, "{name}: ∫D = {got} under σ {sigma}, anisotropy {anisotropy}");
                    if (got - 1.0).abs() > worst.0 {
                        worst = ((got - 1.0).abs(), name);
                    }
                }
            }
        }
    }
    println!("largest |∫D − 1|: {:.4} ({})", worst.0, worst.1);
}

#[test]
fn every_roughness_gives_normalised_nodes() {
    let map = map(8, 8, |i, j| [(i as f32 * 1.3).sin() * 0.4, (j as f32 * 0.9).cos() * 0.4]);
    for roughness in [1e-4, 1e-3, 0.05, 0.3, 1.0] {
        let options = NdfMapsOptions { roughness, max_error: 0.05, ..NdfMapsOptions::default() };
        let baked = bake_maps(&map, &options, &Silent).unwrap();
        assert!(baked.params.measured.energy < 1e-3, "σ_r {roughness}: {:?}", baked.params.measured);
        assert!(baked.params.measured.mean.is_finite());
        for node in 0..baked.nodes.len() as u32 {
            for k in 0..50 {
                let s = Vec2::from_angle(k as f32) * (k as f32 / 49.0);
                let density = baked.node_density(node, s);
                assert!(density.is_finite() && density >= 0.0, "σ_r {roughness}: {density}");
            }
        }
    }
}

#[test]
fn work_is_bounded_whatever_the_footprint() {
    let map = map(16, 16, |i, j| [(i as f32).sin() * 0.3, (j as f32).cos() * 0.3]);
    for options in [
        PlacementOptions::Tiled(TransformRanges::default()),
        PlacementOptions::Stochastic(StochasticOptions::default()),
    ] {
        let material = material(&map, 0.05, &options);
        for sigma in [1e-6, 1e-3, 0.1, 1.0, 2.5, 7.9, 15.0, 100.0, 1e4] {
            for anisotropy in [1.0, 10.0, 1000.0] {
                let footprint = Footprint::new(DVec2::new(3.0, 4.0), sigma, anisotropy, 0.3);
                let terms = material.gather(&footprint, EvalSettings::default()).len();
                assert!((1..=8192).contains(&terms), "{terms} terms at σ {sigma}, anisotropy {anisotropy}");
            }
        }
    }
}

#[test]
fn options_without_meaning_are_refused_with_their_name() {
    let map = map(8, 8, |_, _| [0.9, 0.0]);
    let refused = |roughness: f64, max_error: f64| {
        let options = NdfMapsOptions { roughness, max_error, ..NdfMapsOptions::default() };
        bake_maps(&map, &options, &Silent).unwrap_err().to_string()
    };
    assert!(refused(0.0, 0.01).contains("roughness"));
    assert!(refused(f64::NAN, 0.01).contains("roughness"));
    assert!(refused(0.02, 0.0).contains("error"));
    assert!(refused(0.02, f64::NAN).contains("error"));
    for finest_window in [0.1, 1e4, f64::NAN] {
        let options = NdfMapsOptions { finest_window, ..NdfMapsOptions::default() };
        let error = bake_maps(&map, &options, &Silent).unwrap_err();
        assert!(matches!(&error, BakeError::BadOption(what) if what.contains("finest window")), "{error}");
    }
    let wide = TransformRanges { stretch: (1.0, 1.5), ..TransformRanges::default() };
    let error = place(&map, 0.02, &PlacementOptions::Tiled(wide)).unwrap_err();
    assert!(matches!(&error, BakeError::BadOption(what) if what.contains("stretch")), "{error}");
}

#[test]
fn a_large_map_is_refused_with_advice() {
    let map = map(256, 128, |_, _| [0.0, 0.0]);
    let error = bake_maps(&map, &NdfMapsOptions::default(), &Silent).unwrap_err();
    assert!(matches!(&error, BakeError::LimitExceeded(what) if what.contains("use a part of it")), "{error}");
}
