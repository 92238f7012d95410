//! The synthetic materials: deterministic, tileable, true to their kind.

use glint_bake::input::synthetic::MATERIALS;
use glint_bake::input::{InputOptions, load_normal_map};

/// Slope deviation along u and v that each material is to have, and whether it is the surface of a height field.
const EXPECTED: [(&str, [f64; 2], bool); 4] = [
    ("brushed", [0.03, 0.4], true),
    ("scratches", [0.06, 0.06], true),
    ("flakes", [0.27, 0.27], false),
    ("leather", [0.1, 0.1], true),
];

#[test]
fn materials_are_like_real_ones_and_tile() {
    let folder = tempfile::tempdir().unwrap();
    for ((name, make), (expected_name, slope_std, is_surface)) in MATERIALS.into_iter().zip(EXPECTED) {
        assert_eq!(name, expected_name);
        let path = folder.path().join(format!("{name}.png"));
        make(128, 96, 7).save(&path).unwrap();
        let loaded = load_normal_map(&path, &InputOptions::default()).unwrap();
        let report = &loaded.report;
        assert!(!report.seam_suspected, "{name}: {report:?}");
        assert!(!report.flipped_green_suspected, "{name}: {report:?}");
        let curl = report.curl_correlation.unwrap();
        assert_eq!(curl > 0.5, is_surface, "{name}: curl {curl}");
        for axis in 0..2 {
            let ratio = report.slope_std[axis] / slope_std[axis];
            assert!((0.6..1.6).contains(&ratio), "{name}: slopes {:?}, expected {slope_std:?}", report.slope_std);
        }
    }
}

#[test]
fn materials_are_deterministic_and_exist_at_any_size() {
    for (name, make) in MATERIALS {
        assert_eq!(make(33, 17, 1), make(33, 17, 1), "{name}");
        assert_ne!(make(33, 17, 1), make(33, 17, 2), "{name}");
        for (width, height) in [(1, 1), (1, 5), (7, 1)] {
            assert_eq!(make(width, height, 3).dimensions(), (width, height), "{name}");
        }
    }
}
