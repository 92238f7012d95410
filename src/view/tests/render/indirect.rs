//! Light from all around on NDF maps: the mean normal and the roughness of a footprint against the micro-normals in it.

use crate::adapter::gpu;
use crate::subjects::{camera, environment_pack, index_of, ndf_maps_pack_of, wall};
use glint_bake_core::normal_map::NormalMap;
use glint_formats::Wrap;
use glint_view::render::{Compare, LightKind, Method, Side, Subject, View, picture};
use glint_view::subjects::Subjects;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Samples of the reference.
const SAMPLES: u32 = 1024;

/// Facets of Gaussian normals, wider along one axis.
fn facets() -> NormalMap {
    let mut rng = Pcg64::seed_from_u64(3);
    let normal = |_| {
        let radius = (-2.0 * (1.0 - rng.random::<f32>()).ln()).sqrt().min(3.0);
        let (sin, cos) = (std::f32::consts::TAU * rng.random::<f32>()).sin_cos();
        [0.16 * radius * cos, 0.08 * radius * sin]
    };
    NormalMap { width: 16, height: 16, wrap: Wrap::Repeat, projected: (0..256).map(normal).collect() }
}

#[test]
fn ndf_maps_reflect_an_environment_as_their_micro_normals_do() {
    let Some(gpu) = gpu() else { return };
    let packs = [ndf_maps_pack_of(&facets()), environment_pack()];
    let subjects = Subjects::of_packs(gpu, &packs.iter().collect::<Vec<_>>(), &[]).unwrap();
    let smooth = index_of(&subjects, Method::Smooth);
    let of_maps: Vec<usize> =
        (0..subjects.shown.len()).filter(|i| subjects.shown[*i].method == Method::NdfMaps).collect();
    assert!(of_maps.len() >= 2);
    for index in of_maps {
        let (mesh, mut settings, _) = wall(&subjects, index, [72, 48]);
        settings.lights.only(&[LightKind::Environment]);
        let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
        // A pixel spans from half a texel to eight.
        for height in [0.25, 1.0, 4.0] {
            let mut view = settings.view(&subjects.shown, [72, 48]);
            view.scene.camera = camera(height);
            let mut drawn = |shown: Subject, reference, frames| {
                let view = View { compare: Compare::Single(Side { shown, reference }), ..view.clone() };
                picture(gpu, &mut renderer, &view, frames).unwrap();
                renderer.radiance(gpu, &view, 0).unwrap()
            };
            let material = settings.materials[index];
            let shown = Subject { material, ..subjects.shown[index].clone() };
            let exact = drawn(shown.clone(), true, SAMPLES);
            let found = drawn(shown, false, 1);
            let flat = drawn(Subject { material, ..subjects.shown[smooth].clone() }, false, 1);
            let sum: f32 = exact.iter().map(|pixel| pixel[1]).sum();
            let apart =
                |pixels: &[[f32; 4]]| pixels.iter().zip(&exact).map(|(a, b)| (a[1] - b[1]).abs()).sum::<f32>() / sum;
            let mean = found.iter().map(|pixel| pixel[1]).sum::<f32>() / sum;
            let name = &subjects.shown[index].name;
            println!(
                "{name}, {height}: mean {mean:.4} of the reference, a pixel {:.4} apart, a smooth one {:.4}",
                apart(&found),
                apart(&flat)
            );
            assert!((mean - 1.0).abs() < 0.07, "{name}, {height}: mean {mean}");
            assert!(apart(&found) < 0.17 && apart(&found) < 0.75 * apart(&flat), "{name}, {height}: {}", apart(&found));
        }
    }
}
