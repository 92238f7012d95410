//! Accuracy and size of NDF maps on real maps: every tile against its exact NDF, and covered surfaces against the
//! normal map that the placement describes. Skips, and says so, where the data folder is missing.

mod real_maps;

use glint_bake_core::ndf_maps::bake::{self, BakedNdfMaps, NdfMapsOptions};
use glint_bake_core::ndf_maps::eval::Material;
use glint_bake_core::ndf_maps::measure::{footprint_errors, tile_errors};
use glint_bake_core::ndf_maps::placement::{self, PlacementOptions, StochasticOptions};
use glint_bake_core::ndf_maps::surface::EvalSettings;
use glint_bake_core::ndf_maps::transform::TransformRanges;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::metrics::Summary;
use glint_bake_core::quality::sweep::{ANISOTROPIES, SIGMAS_TEXELS, footprints};
use glint_formats::ndf_maps::DensityStorage;
use real_maps::{CROPS_16, CROPS_32, TINY};

fn baked(map: &NormalMap, roughness: f64, max_error: f64) -> BakedNdfMaps {
    let options = NdfMapsOptions { roughness, max_error, storage: DensityStorage::SqrtU8 };
    bake::bake(map, &options, &Silent).unwrap()
}

/// Bakes `map` for σ_r and the E₁ asked, and checks decoded tiles, every `stride`th of them, against exact ones.
fn check_tiles(name: &str, map: &NormalMap, roughness: f64, asked: f64, stride: usize) {
    let baked = baked(map, roughness, asked);
    let errors = tile_errors(map, &baked, |tile| tile % stride == 0);
    let e1 = Summary::of(errors.iter().map(|e| e.e1).collect());
    let energy = errors.iter().fold(0.0f64, |worst, e| worst.max(e.energy));
    println!(
        "{name}: σ_r {roughness}, {:.1} KiB, E₁ mean {:.4} worst {:.4} over {} tiles, energy {energy:.1e}",
        baked.gpu_bytes() as f64 / 1024.0,
        e1.mean,
        e1.worst,
        errors.len()
    );
    assert!(e1.mean <= asked, "{name}: mean E₁ {} at σ_r {roughness}, asked {asked}", e1.mean);
    assert!(e1.worst <= 5.0 * asked, "{name}: worst E₁ {} at σ_r {roughness}, asked {asked}", e1.worst);
    assert!(energy <= 1e-3, "{name}: energy is off by {energy} at σ_r {roughness}");
}

#[test]
fn tiles_of_tiny_maps_are_as_exact_as_asked() {
    let Some(data) = real_maps::data() else { return };
    for name in TINY {
        let map = real_maps::load(&data, name, None);
        check_tiles(name, &map, 0.02, 0.01, 1);
    }
}

#[test]
fn tiles_of_crops_are_as_exact_as_asked() {
    let Some(data) = real_maps::data() else { return };
    for (name, x, y) in CROPS_16 {
        check_tiles(name, &real_maps::load(&data, name, Some((x, y, 16))), 0.02, 0.01, 1);
    }
    for (name, x, y) in CROPS_32 {
        check_tiles(name, &real_maps::load(&data, name, Some((x, y, 32))), 0.02, 0.01, 1);
    }
}

#[test]
fn tiles_at_small_roughness_are_as_exact_as_asked() {
    let Some(data) = real_maps::data() else { return };
    for name in ["tiny/brushed_16x16.png", "tiny/scratches_32x32.png", "tiny/wicker_box16_32x32.png"] {
        let map = real_maps::load(&data, name, None);
        check_tiles(name, &map, 0.01, 0.02, 17);
        check_tiles(name, &map, 0.005, 0.05, 37);
    }
}

#[test]
fn sizes_stay_within_a_64th_of_the_paper_s() {
    let Some(data) = real_maps::data() else { return };
    let size = |name: &str, crop| baked(&real_maps::load(&data, name, crop), 0.02, 0.01).gpu_bytes();
    assert!(size("tiny/brushed_16x16.png", None) <= 96 * 1024);
    for (name, x, y) in CROPS_16 {
        let bytes = size(name, Some((x, y, 16)));
        assert!(bytes <= 96 * 1024, "{name}: {bytes} bytes for 16²");
    }
    for name in ["tiny/scratches_32x32.png", "tiny/wicker_box16_32x32.png"] {
        assert!(size(name, None) <= 384 * 1024, "{name}");
    }
    for (name, x, y) in CROPS_32 {
        let bytes = size(name, Some((x, y, 32)));
        assert!(bytes <= 384 * 1024, "{name}: {bytes} bytes for 32²");
    }
}

/// Mean E₁ over the footprints of the sweep on a surface covered with `map`, and the largest energy error.
fn surface_error(map: &NormalMap, options: &PlacementOptions, sigmas: &[f64], count: u32) -> (f64, f64) {
    let maps = baked(map, 0.02, 0.01);
    let material = Material { placement: placement::bake(map, 0.02, options).unwrap(), maps };
    let extent = glam::DVec2::new(map.width as f64, map.height as f64) * 32.0;
    let (mut total, mut rows, mut energy) = (0.0, 0.0, 0.0f64);
    for anisotropy in ANISOTROPIES {
        for sigma in sigmas {
            let footprints = footprints(*sigma, anisotropy, extent, count, 5);
            let errors = footprint_errors(map, &material, &footprints, EvalSettings::default());
            println!("σ {sigma} anisotropy {anisotropy}: E₁ {:.4}, {:.0} terms", errors.e1.mean, errors.terms);
            total += errors.e1.mean;
            rows += 1.0;
            energy = energy.max(errors.energy.worst);
        }
    }
    (total / rows, energy)
}

#[test]
fn a_tiled_surface_agrees_with_its_explicit_map() {
    let Some(data) = real_maps::data() else { return };
    let ranges = TransformRanges { rotate_degrees: (20.0, 20.0), scale: (1.3, 1.3), ..TransformRanges::default() };
    for name in ["tiny/brushed_16x16.png", "tiny/flakes_8x8.png"] {
        let map = real_maps::load(&data, name, None);
        let (e1, energy) = surface_error(&map, &PlacementOptions::Tiled(ranges), &SIGMAS_TEXELS, 2);
        assert!(e1 <= 0.08, "{name}: mean E₁ {e1}");
        assert!(energy <= 2e-3, "{name}: energy {energy}");
    }
}

#[test]
fn a_stochastic_surface_agrees_with_its_explicit_map() {
    let Some(data) = real_maps::data() else { return };
    for name in ["tiny/brushed_16x16.png", "tiny/flakes_8x8.png"] {
        let map = real_maps::load(&data, name, None);
        let options = PlacementOptions::Stochastic(StochasticOptions::default());
        let (e1, energy) = surface_error(&map, &options, &SIGMAS_TEXELS, 2);
        assert!(e1 <= 0.12, "{name}: mean E₁ {e1}");
        assert!(energy <= 2e-3, "{name}: energy {energy}");
    }
}
