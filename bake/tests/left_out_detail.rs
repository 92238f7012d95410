//! Windows and mips that were left out change nothing for footprints that do not read them.

use glam::{DVec2, Vec2};
use glint_bake_core::area_light::baked::Maps;
use glint_bake_core::area_light::eval::fetch;
use glint_bake_core::area_light::{self, AreaLightOptions};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::bake::bake_maps;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::EvalSettings;
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, TransformRanges};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::sweep::footprints;
use glint_formats::Wrap;

/// A tiling map with waves of several lengths.
fn map(width: u32, height: u32) -> NormalMap {
    let projected = (0..width * height)
        .map(|k| {
            let (x, y) = (f64::from(k % width), f64::from(k / width));
            let wave = |waves: f64| libm::sin(std::f64::consts::TAU * waves * (x + 2.0 * y) / f64::from(width));
            [(0.2 * wave(1.0) + 0.1 * wave(7.0)) as f32, (0.15 * wave(3.0)) as f32]
        })
        .collect();
    NormalMap { width, height, wrap: Wrap::Repeat, projected }
}

#[test]
fn wide_footprints_read_the_same_nodes() {
    let map = map(32, 16);
    let material = |finest_window: f64| {
        let options = NdfMapsOptions { roughness: 0.1, max_error: 0.05, finest_window };
        let placement = place(&map, 0.1, &PlacementOptions::Tiled(TransformRanges::default())).unwrap();
        Material { maps: bake_maps(&map, &options, &Silent).unwrap(), placement }
    };
    // Four times the variance: two levels fewer.
    let (all, some) = (material(1.0), material(2.0));
    let grids =
        |material: &Material| material.maps.params.levels.iter().map(|l| [l.nodes_x, l.nodes_y]).collect::<Vec<_>>();
    assert_eq!(grids(&all)[2..], grids(&some));
    let shift = all.maps.params.levels[2].first_node;
    let at = DVec2::new(320.0, 160.0);
    for sigma in [2.0, 3.0, 8.0, 20.0] {
        for footprint in footprints(sigma, 2.0, at, 16, 3) {
            let whole = all.gather(&footprint, EvalSettings::default());
            let part = some.gather(&footprint, EvalSettings::default());
            assert!(!whole.nodes.is_empty() && whole.nodes.len() == part.nodes.len());
            assert!(whole.patches.is_empty() && part.patches.is_empty());
            for (a, b) in whole.nodes.iter().zip(&part.nodes) {
                assert_eq!((a.node, a.weight), (b.node + shift, b.weight));
            }
        }
    }
    // Narrower ones see patches of the map instead; in part where they are little narrower, from 1 to 0.7 of the variance.
    let share = |sigma: f64| {
        let terms = some.gather(&Footprint::new(at, sigma, 1.0, 0.3), EvalSettings::default());
        (terms.nodes.iter().map(|term| term.weight).sum::<f32>(), terms.patches.len())
    };
    let ((none, patches), (a_third, more)) = (share(1.0), share(3.2f64.sqrt()));
    assert!(none == 0.0 && patches > 1, "{none}, {patches} patches");
    assert!((a_third - 1.0 / 3.0).abs() < 1e-3 && more > 1, "{a_third}, {more} patches");
}

#[test]
fn wide_footprints_fetch_the_same_from_coarse_mips() {
    let map = map(32, 16);
    let material = |skip_mips: u32| {
        let options = AreaLightOptions { anisotropic: true, skip_mips, ..AreaLightOptions::default() };
        area_light::bake(&map, &options, &Silent).unwrap()
    };
    let (all, some) = (material(0), material(2));
    assert_eq!((some.params.width, some.params.height), (8, 4));
    let (all, some) = (Maps::new(&all), Maps::new(&some));
    let scale = some.scale(32, 16);
    assert_eq!(scale, Vec2::splat(0.25));
    for k in 0..64 {
        let position = Vec2::new(0.37 + 0.61 * k as f32, 0.11 + 0.29 * k as f32);
        let footprint = 4.0 + 0.4 * k as f32;
        let (a, b) = (fetch(&all, position, footprint), fetch(&some, position * scale, footprint * 0.25));
        assert!((a.normal - b.normal).length() < 1e-5 && (a.alpha - b.alpha).abs() < 1e-5, "{a:?} {b:?}");
        assert!((a.length - b.length).abs() < 1e-5 && (a.by_direction.major - b.by_direction.major).abs() < 1e-4);
    }
}
