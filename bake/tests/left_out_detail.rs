//! Tiles and mips that were left out change nothing for footprints that do not read them.

use glam::{DVec2, Vec2};
use glint_bake_core::area_light::baked::Maps;
use glint_bake_core::area_light::eval::fetch;
use glint_bake_core::area_light::{self, AreaLightOptions};
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
fn wide_footprints_read_the_same_tiles() {
    let map = map(32, 16);
    let material = |min_tile: u32| {
        let options = NdfMapsOptions { roughness: 0.1, max_error: 0.05, min_tile, ..NdfMapsOptions::default() };
        let placement = place(&map, 0.1, &PlacementOptions::Tiled(TransformRanges::default())).unwrap();
        Material { maps: bake_maps(&map, &options, &Silent).unwrap(), placement }
    };
    let (all, some) = (material(2), material(8));
    let edges = |material: &Material| material.maps.params.levels.iter().map(|l| l.tile_texels).collect::<Vec<_>>();
    assert_eq!((edges(&all), edges(&some)), (vec![2, 4, 8, 16, 32], vec![8, 16, 32]));
    let shift = all.maps.params.levels[2].first_tile;
    let at = DVec2::new(320.0, 160.0);
    for sigma in [8.0, 11.0, 20.0] {
        for footprint in footprints(sigma, 2.0, at, 16, 3) {
            let whole = all.gather(&footprint, EvalSettings::default()).tiles;
            let part = some.gather(&footprint, EvalSettings::default()).tiles;
            assert!(!whole.is_empty() && whole.len() == part.len());
            for (a, b) in whole.iter().zip(&part) {
                assert_eq!((a.tile, a.weight), (b.tile + shift, b.weight));
            }
        }
    }
    // Narrower ones see lobes instead: as many as there are, and still a whole.
    for footprint in footprints(1.0, 1.0, at, 8, 4) {
        let terms = some.gather(&footprint, EvalSettings::default());
        assert!(!terms.is_empty());
        let share: f32 = terms.tiles.iter().map(|term| term.weight).sum();
        assert!(terms.lobes.len() > 1 || (share - 1.0).abs() < 1e-4);
    }
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
