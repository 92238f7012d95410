//! Validation, lifting and measuring on maps made by hand.

use std::f32::consts::FRAC_1_SQRT_2;

use super::*;
use crate::error::BakeError;
use glint_formats::Wrap;

const UP: NormalOptions = NormalOptions { wrap: Wrap::Repeat, y: GreenAxis::Up };

fn raw(width: u32, height: u32, vectors: Vec<[f32; 3]>) -> RawNormals {
    RawNormals { width, height, vectors }
}

fn message(error: BakeError) -> String {
    assert!(matches!(error, BakeError::BadInput(_)), "{error:?}");
    error.to_string()
}

#[test]
fn vectors_are_renormalised_and_counted() {
    let vectors = vec![[0.0, 0.0, 0.5], [0.6, 0.0, 0.8], [3.0, 0.0, 4.0], [0.0, 0.605, 0.8]];
    let (map, report) = NormalMap::from_vectors(&raw(2, 2, vectors), &UP).unwrap();
    assert_eq!(map.projected[0], [0.0, 0.0]);
    assert_eq!(map.projected[1], map.projected[2]);
    assert_eq!((report.texels, report.off_unit), (4, 2));
    assert_eq!((report.min_length, report.max_length), (0.5, 5.0));
}

#[test]
fn green_is_negated_when_it_points_down() {
    let down = NormalOptions { y: GreenAxis::Down, ..UP };
    let (map, report) = NormalMap::from_vectors(&raw(1, 1, vec![[0.0, 0.6, 0.8]]), &down).unwrap();
    assert_eq!(map.projected, [[0.0, -0.6]]);
    assert!((report.mean_normal[1] + 0.6).abs() < 1e-6 && report.is_flat);
}

#[test]
fn normals_below_the_horizon_end_just_above_it() {
    let mut vectors = vec![[0.0, 0.0, 1.0]; 8];
    vectors[1] = [1.0, 0.0, -0.2];
    vectors[2] = [0.0, 1.0, 0.0];
    vectors[3] = [0.0, 0.0, -1.0];
    vectors[4] = [0.6, 0.8, 1e-9];
    let (map, report) = NormalMap::from_vectors(&raw(4, 2, vectors), &UP).unwrap();
    assert_eq!(report.below_horizon, 3);
    assert_eq!(map.projected[1], [HORIZON as f32, 0.0]);
    assert_eq!(map.projected[3], [0.0, 0.0]);
    for s in map.projected {
        assert!(s[0].hypot(s[1]) <= HORIZON as f32 + 1e-6);
    }
}

#[test]
fn what_cannot_be_mended_is_refused_by_texel_or_count() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut vectors = vec![[0.0, 0.0, 1.0]; 12];
        vectors[7][2] = bad;
        let error = NormalMap::from_vectors(&raw(4, 3, vectors), &UP).unwrap_err();
        assert!(message(error).contains("texel (3, 1)"));
    }
    let error = NormalMap::from_vectors(&raw(4, 4, vec![[-1.0; 3]; 16]), &UP).unwrap_err();
    assert!(message(error).contains("16 of 16"));
    let error = NormalMap::from_vectors(&raw(4, 4, vec![[0.003; 3]; 16]), &UP).unwrap_err();
    assert!(message(error).contains("zero vector"));
    let mut few = vec![[0.0, 0.0, 1.0]; 100];
    few[0] = [0.0; 3];
    assert_eq!(NormalMap::from_vectors(&raw(10, 10, few), &UP).unwrap().1.zero_length, 1);
    assert!(message(NormalMap::from_vectors(&raw(0, 4, vec![]), &UP).unwrap_err()).contains("0×4"));
    assert!(message(NormalMap::from_vectors(&raw(2, 2, vec![[0.0; 3]; 3]), &UP).unwrap_err()).contains("needs 4"));
}

#[test]
fn two_channels_get_their_third() {
    let xy = [[0.6, 0.0], [0.0, 0.0], [0.9, 0.9], [0.0, -1.0]];
    let (map, report) = NormalMap::from_xy(2, 2, &xy, &UP).unwrap();
    assert_eq!(map.projected[0], [0.6, 0.0]);
    assert_eq!((report.below_horizon, report.off_unit), (2, 1));
    assert!((map.projected[2][0] - HORIZON as f32 * FRAC_1_SQRT_2).abs() < 1e-6);
    let error = NormalMap::from_xy(1, 2, &[[0.0, 0.0], [f32::NAN, 0.0]], &UP).unwrap_err();
    assert!(message(error).contains("texel (0, 1)"));
}

#[test]
fn heights_rise_against_the_normal() {
    // A ramp that rises by half a texel a texel to the right, and by a quarter downwards.
    let ramp: Vec<f32> = (0..25).map(|k| 0.5 * (k % 5) as f32 + 0.25 * (k / 5) as f32).collect();
    let (map, _) = NormalMap::from_heights(5, 5, &ramp, 1.0, Wrap::Clamp).unwrap();
    let length = (1.0f32 + 0.25 + 0.0625).sqrt();
    for s in &map.projected {
        assert!((s[0] + 0.5 / length).abs() < 1e-6 && (s[1] - 0.25 / length).abs() < 1e-6, "{s:?}");
    }
    // Repeated, the ramp falls back over its seam.
    let (map, report) = NormalMap::from_heights(5, 5, &ramp, 1.0, Wrap::Repeat).unwrap();
    assert!(map.projected[0][0] > 0.0 && map.projected[12][0] < 0.0);
    assert_eq!(report.off_unit, 0);
    let (one, _) = NormalMap::from_heights(1, 1, &[0.3], 1.0, Wrap::Clamp).unwrap();
    assert_eq!(one.projected, [[0.0, 0.0]]);
    let mut broken = ramp.clone();
    broken[8] = f32::NAN;
    let error = NormalMap::from_heights(5, 5, &broken, 1.0, Wrap::Clamp).unwrap_err();
    assert!(message(error).contains("texel (3, 1)"));
    let error = NormalMap::from_heights(5, 5, &ramp, f32::NAN, Wrap::Clamp).unwrap_err();
    assert!(matches!(error, BakeError::BadOption(_)));
}

/// Smooth tiling hills; both cross derivatives vary.
fn hills(side: u32) -> RawNormals {
    let wave = |i: u32, turns: f32| (std::f32::consts::TAU * turns * (i as f32 + 0.5) / side as f32).sin();
    let height = |k: u32| {
        let (i, j) = (k % side, k / side);
        wave(i, 3.0) * wave(j, 2.0) + wave(i + j, 4.0)
    };
    let heights: Vec<f32> = (0..side * side).map(height).collect();
    RawNormals::from_heights(side, side, &heights, 1.0, Wrap::Repeat).unwrap()
}

#[test]
fn flipped_green_is_suspected_only_with_enough_to_go_by() {
    let (_, report) = NormalMap::from_vectors(&hills(64), &UP).unwrap();
    assert!(report.curl_correlation.unwrap() > 0.95 && !report.flipped_green_suspected);
    let down = NormalOptions { y: GreenAxis::Down, ..UP };
    let (_, report) = NormalMap::from_vectors(&hills(64), &down).unwrap();
    assert!(report.curl_correlation.unwrap() < -0.95 && report.flipped_green_suspected);
    let (_, report) = NormalMap::from_vectors(&hills(63), &down).unwrap();
    assert!(report.curl_correlation.unwrap() < -0.9 && !report.flipped_green_suspected);
    for (width, height) in [(1, 1), (2, 2), (9, 1), (1, 9)] {
        let count = (width * height) as usize;
        let (_, report) = NormalMap::from_vectors(&raw(width, height, vec![[0.0, 0.0, 1.0]; count]), &UP).unwrap();
        assert_eq!(report.curl_correlation, None);
        assert!(report.is_flat);
    }
}

#[test]
fn a_seam_is_seen_and_only_where_the_map_repeats() {
    let (_, whole) = NormalMap::from_vectors(&hills(64), &UP).unwrap();
    assert!(!whole.seam_suspected, "{whole:?}");
    let part = hills(64).crop(0, 0, 40, 27).unwrap();
    let (_, report) = NormalMap::from_vectors(&part, &UP).unwrap();
    assert!(report.seam_suspected, "{report:?}");
    let clamped = NormalOptions { wrap: Wrap::Clamp, ..UP };
    assert!(!NormalMap::from_vectors(&part, &clamped).unwrap().1.seam_suspected);
}

#[test]
fn crops_take_the_right_texels() {
    let (map, _) = NormalMap::from_vectors(&hills(16), &UP).unwrap();
    let crop = map.crop(3, 5, 4, 2, Wrap::Clamp).unwrap();
    assert_eq!((crop.width, crop.height, crop.wrap), (4, 2, Wrap::Clamp));
    for j in 0..2 {
        for i in 0..4 {
            assert_eq!(crop.texel(i, j), map.texel(i + 3, j + 5));
        }
    }
    for (x, y, w, h) in [(0, 0, 0, 1), (13, 0, 4, 1), (0, 16, 1, 1), (u32::MAX, 0, 2, 1)] {
        assert!(matches!(map.crop(x, y, w, h, Wrap::Clamp), Err(BakeError::BadOption(_))));
    }
}

#[test]
fn eight_bit_noise_is_flat() {
    let vectors = (0..64).map(|k| [(k % 3) as f32 / 127.5 - 1.0 / 127.5, 0.0, 1.0]).collect();
    let (_, report) = NormalMap::from_vectors(&raw(8, 8, vectors), &UP).unwrap();
    assert!(report.is_flat && !report.flipped_green_suspected && !report.seam_suspected, "{report:?}");
}
