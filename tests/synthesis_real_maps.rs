//! Patch synthesis of real maps: seams, repetition, bytes, and the shares of normals, at the default options.

mod real_maps;

use glam::DVec2;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::synthesis::quality::repetition;
use glint_bake_core::synthesis::{SynthesisOptions, Target, assemble, bake};
use glint_formats::Wrap;
use real_maps::{data, load};

/// A map, and how much rougher its seams may be than its neighbours. Scratches are lines that seams cut.
const MAPS: [(&str, f64); 3] = [
    ("normals/leather_008_3dtextures.jpg", 1.45),
    ("normals/scratched_gold_cgbookcase_rgba.png", 1.7),
    ("normals/bluenoise_bevy_512_rgba.png", 1.05),
];

fn moments(map: &NormalMap) -> (DVec2, f64) {
    let (mut mean, mut square) = (DVec2::ZERO, 0.0);
    for &[x, y] in &map.projected {
        let s = DVec2::new(x.into(), y.into());
        mean += s;
        square += s.length_squared();
    }
    let n = map.projected.len() as f64;
    (mean / n, square / n)
}

#[test]
fn seams_are_as_rough_as_the_sample_and_nothing_repeats() {
    let Some(data) = data() else { return };
    for (name, roughest) in MAPS {
        let sample = NormalMap { wrap: Wrap::Clamp, ..load(&data, name, Some((0, 0, 256))) };
        let surface = bake(&sample, &SynthesisOptions::default(), &Silent).unwrap();
        let measured = surface.params.measured;
        assert!(measured.seam_ratio < roughest, "{name}: {measured:?}");
        assert!(measured.distinct_offsets > 400, "{name}: {measured:?}");
        assert!(4 * (surface.offsets.len() + surface.seams.len()) < 300_000);
        assert!(repetition(&surface, 64, 12) < 0.02, "{name}: {}", repetition(&surface, 64, 12));
        // The rim of a sample that does not repeat is in fewer patches than its middle.
        let (mean, square) = moments(&sample);
        let (found_mean, found_square) = moments(&assemble(&surface, &sample, (0, 0), (1024, 1024)).unwrap());
        assert!((found_mean - mean).length() < 0.1 * square.sqrt(), "{name}: {found_mean} {mean}");
        assert!((found_square / square - 1.0).abs() < 0.15, "{name}: {found_square} {square}");
    }
}

#[test]
fn a_map_that_repeats_does_not_on_its_surface() {
    let Some(data) = data() else { return };
    let sample = NormalMap { wrap: Wrap::Repeat, ..load(&data, "normals/carpaint_flakes_khronos_128.png", None) };
    let surface = bake(&sample, &SynthesisOptions::default(), &Silent).unwrap();
    let measured = surface.params.measured;
    assert!(repetition(&surface, 64, 12) < 0.02, "{}", repetition(&surface, 64, 12));
    assert!(measured.distinct_offsets > 200, "{measured:?}");
    assert!(measured.seam_ratio < 1.05, "{measured:?}");
}

#[test]
fn a_surface_without_end_is_nearly_as_good() {
    let Some(data) = data() else { return };
    for (name, roughest) in MAPS {
        let sample = NormalMap { wrap: Wrap::Clamp, ..load(&data, name, Some((0, 0, 256))) };
        let target = Target::Unbounded { colours: 3, variants: 2 };
        let options = SynthesisOptions { target, patch: 96, overlap: 6, ..SynthesisOptions::default() };
        let surface = bake(&sample, &options, &Silent).unwrap();
        let measured = surface.params.measured;
        assert!(measured.seam_ratio < 1.1 * roughest, "{name}: {measured:?}");
        assert!(repetition(&surface, 48, 8) < 0.12, "{name}: {}", repetition(&surface, 48, 8));
    }
}
