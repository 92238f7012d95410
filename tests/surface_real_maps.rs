//! Surfaces of patches of real maps: P-NDFs across seams against those inside patches, and bytes.

mod real_maps;

use glint_bake_core::lobes::LobesOptions;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::surface::quality::{Exact, Measured, seam_footprints};
use glint_bake_core::surface::{SurfaceOptions, SurfaceSettings, bake};
use glint_bake_core::synthesis::SynthesisOptions;
use glint_formats::Wrap;
use real_maps::{data, load};

const MAPS: [&str; 4] = [
    "normals/leather_008_3dtextures.jpg",
    "normals/scratched_gold_cgbookcase_rgba.png",
    "normals/bluenoise_bevy_512_rgba.png",
    "normals/brushed_aluminium_godot_745.png",
];

/// Mean E₁ of footprints on seams over that of footprints inside patches, at most.
const SEAMS_OVER_INSIDE: f64 = 1.3;

#[test]
fn seams_are_no_worse_than_the_inside_of_patches() {
    let Some(data) = data() else { return };
    for name in MAPS {
        let sample = NormalMap { wrap: Wrap::Clamp, ..load(&data, name, Some((0, 0, 128))) };
        let synthesis = SynthesisOptions { alignment: 16, ..SynthesisOptions::default() };
        let lobes = LobesOptions { footprints: 0, ..LobesOptions::default() };
        let surface = bake(&sample, &SurfaceOptions { lobes: lobes.clone(), synthesis }, &Silent).unwrap();
        assert!(surface.gpu_bytes() < 800_000, "{name}: {}", surface.gpu_bytes());
        let exact = Exact { surface: &surface, sample: &sample, roughness: lobes.roughness, refinement: 1.0 };
        for sigma in [1.0, 2.0, 4.0, 8.0] {
            let mean = |inside| {
                let places = seam_footprints(&surface, sigma, 16, 7, inside);
                exact.errors(&[Measured::Chosen(SurfaceSettings::default())], &places, 4)[0].e1.mean
            };
            let (seams, inside) = (mean(false), mean(true));
            assert!(seams <= SEAMS_OVER_INSIDE * inside, "{name}, σ {sigma}: {seams} on seams, {inside} inside");
        }
    }
}
