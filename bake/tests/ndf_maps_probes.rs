//! Stochastic surfaces seen at a few places under a footprint: no less exact than all tiles of the same size, for less work.

use glam::DVec2;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::bake::bake_maps;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::EvalSettings;
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, StochasticOptions};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::ndf_maps::quality::footprint_errors;
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::sweep::footprints;
use glint_formats::Wrap;

/// Settings of pictures, at which all tiles are seen.
const TILES: EvalSettings =
    EvalSettings { tile_sigmas: 4.0, lobe_sigmas: 1.0, max_terms: 32, splits: 0, reach: 2.0, probes: 0 };
const PROBES: EvalSettings = EvalSettings { probes: 2, ..TILES };

/// Facets of a texel each, with no order in them.
fn flakes() -> NormalMap {
    let normal = |k: u32| {
        let turn = f64::from(k) * 2.399_963;
        let tilt = 0.3 * (f64::from(k * 37 % 64) / 64.0).sqrt();
        [(tilt * turn.cos()) as f32, (tilt * turn.sin()) as f32]
    };
    NormalMap { width: 8, height: 8, wrap: Wrap::Repeat, projected: (0..64).map(normal).collect() }
}

fn material(map: &NormalMap) -> Material {
    let options = NdfMapsOptions { roughness: 0.03, max_error: 0.02, ..NdfMapsOptions::default() };
    let placement = PlacementOptions::Stochastic(StochasticOptions::default());
    Material {
        placement: place(map, options.roughness, &placement).unwrap(),
        maps: bake_maps(map, &options, &Silent).unwrap(),
    }
}

#[test]
fn places_tell_as_much_as_all_tiles_of_a_picture() {
    let map = flakes();
    let material = material(&map);
    let reference = SurfaceReference::new(&map, &material);
    let mut means = [0.0, 0.0];
    for anisotropy in [1.0, 2.0] {
        for sigma in [1.0, 2.0] {
            let places = footprints(sigma, anisotropy, DVec2::splat(256.0), 6, 5);
            for (mean, settings) in means.iter_mut().zip([TILES, PROBES]) {
                let error = footprint_errors(&reference, &places, settings).e1.mean;
                println!("σ {sigma}, anisotropy {anisotropy}, probes {}: E₁ {:.1} %", settings.probes, 100.0 * error);
                *mean += error / 4.0;
            }
        }
    }
    let [tiles, probes] = means;
    println!("means: tiles {:.1} %, places {:.1} %", 100.0 * tiles, 100.0 * probes);
    assert!(probes < 1.1 * tiles, "E₁ {probes} of places, {tiles} of all tiles");
}

#[test]
fn places_are_few_whatever_the_footprint() {
    let material = material(&flakes());
    for sigma in [0.5, 1.0, 2.0, 3.0] {
        for anisotropy in [1.0, 2.0, 4.0, 1000.0] {
            let footprint = Footprint::new(DVec2::new(5.3, -1000.7), sigma, anisotropy, 0.7);
            let terms = material.gather(&footprint, PROBES);
            assert!(
                terms.lobes.is_empty() && !terms.tiles.is_empty() && terms.tiles.len() <= 32,
                "{sigma}, {anisotropy}"
            );
            if anisotropy == 1.0 {
                assert_eq!(terms.tiles.len(), 4, "σ {sigma}");
            }
        }
    }
}
