//! Area lights on real maps: the highlight, against the reference over distance. Parts of the maps; the report has
//! whole ones.

mod real_maps;

use glam::DVec2;
use glint_bake_core::area_light::baked::Maps;
use glint_bake_core::area_light::baked::decode_tables;
use glint_bake_core::area_light::eval::LOBES;
use glint_bake_core::area_light::quality::{
    Comparison, HighlightError, RadianceGrid, grid_weights, highlight_error, scenes,
};
use glint_bake_core::area_light::reference::{Scene, footprint_normals, footprint_radiance};
use glint_bake_core::area_light::{AreaLightOptions, bake};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::progress::Silent;
use real_maps::{data, load};
use std::sync::OnceLock;

/// Real maps, and squares of them.
const MAPS: [(&str, &str); 5] = [
    ("brushed", "normals/brushed_aluminium_godot_745.png"),
    ("scratched", "normals/scratched_gold_cgbookcase_rgba.png"),
    ("leather", "normals/leather_008_3dtextures.jpg"),
    ("wicker", "normals/wicker_khronos_512.png"),
    ("diamond plate", "normals/diamond_plate_pmndrs0008.jpg"),
];

/// The scenes of the report, with a coarser grid of the reference.
fn all_scenes() -> &'static [(Scene, RadianceGrid)] {
    static SCENES: OnceLock<Vec<(Scene, RadianceGrid)>> = OnceLock::new();
    SCENES.get_or_init(|| {
        let all = [0.05, 0.15].into_iter().flat_map(scenes);
        all.map(|scene| (scene, RadianceGrid::new(&scene, 81, 3e-3))).collect()
    })
}

fn measured(data: &std::path::Path, file: &str, sizes: &[f64]) -> Vec<HighlightError> {
    let map = load(data, file, Some((100, 60, 256)));
    let material = bake(&map, &AreaLightOptions { anisotropic: true, ..Default::default() }, &Silent).unwrap();
    let tables = decode_tables(&material.tables);
    let measure = |&size: &f64| {
        // Small footprints see less of the map each, and cost less.
        let places = (4096.0 / size).clamp(64.0, 1024.0) as u32;
        let over = Comparison { scenes: all_scenes(), places, lobes: LOBES, seed: 1 };
        highlight_error(&map, &Maps::new(&material), &tables, size, &over)
    };
    sizes.iter().map(measure).collect()
}

/// Footprints in texels.
const SIZES: [f64; 9] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0];

#[test]
fn highlights_keep_their_width_over_distance() {
    let Some(data) = data() else { return };
    let mut ratios = Vec::new();
    for (name, file) in MAPS {
        for row in measured(&data, file, &SIZES) {
            let [plain, _, _, isotropic, _, anisotropic] = row.rmse;
            for method in [3, 5] {
                // With so many places a ratio says something: its standard error is small against its distance to 1.
                assert!(row.to_paper_error[method] < 0.05, "{name}: {row:?}");
                assert!(row.to_paper[method] <= 1.02, "{name}: {row:?}");
            }
            if row.footprint_texels >= 4.0 {
                assert!(isotropic < plain && anisotropic < plain, "{name}: {row:?}");
                ratios.push(isotropic / plain);
            }
            if name == "brushed" {
                let most = if row.footprint_texels >= 16.0 { 0.75 } else { 0.9 };
                assert!(anisotropic < most * isotropic, "{row:?}");
            }
        }
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!(ratios.len() == 35 && mean <= 0.5, "{mean}: {ratios:?}");
}

#[test]
fn the_tabulated_reference_is_the_direct_one() {
    let Some(data) = data() else { return };
    let map = load(&data, MAPS[3].1, Some((100, 60, 64)));
    let (mut errors, mut power) = (0.0, 0.0);
    for (k, (scene, grid)) in all_scenes().iter().enumerate().step_by(5) {
        let footprint = Footprint::new(DVec2::new(20.0 + 7.0 * k as f64, 31.3), 0.5, 1.0, 0.0);
        let exact = footprint_radiance(&map, &footprint, scene, 1e-3);
        let found = grid.mean(&grid_weights(&footprint_normals(&map, &footprint, 4.0, 256), grid.size()));
        errors += (found - exact).powi(2);
        power += exact * exact;
    }
    assert!((errors / power).sqrt() < 0.01, "{}", (errors / power).sqrt());
}
