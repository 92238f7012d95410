//! The mean over 1 024 surfaces is the smooth BRDF.

use crate::adapter::gpu;
use crate::subjects::{index_of, mean_radiance, subjects, wall};
use glint_view::render::{Compare, LightKind, Method, Side, View};

/// Seeds that are averaged.
const SEEDS: u32 = 1024;
/// Seeds of facets that are lit more often.
const FEWER_SEEDS: u32 = 256;
/// Pixels: one seed is off by some per cent, the mean by a thirtieth of that.
const SIZE: [u32; 2] = [72, 48];

#[test]
fn the_mean_over_seeds_is_the_smooth_brdf() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects(gpu);
    // Densities at which a pixel has a facet or few, and hundreds.
    for (method, densities) in [(Method::Dictionary, [1.0e3, 3.0e5]), (Method::Environment, [1.0e3, 3.0e5])] {
        let index = index_of(&subjects, method);
        for density in densities {
            let (mesh, mut settings, view) = wall(&subjects, index, SIZE);
            let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
            let camera = view.scene.camera;
            for material in &mut settings.materials {
                material.density = density;
                material.alpha = [0.4, 0.4];
            }
            let mut view_of = |shown: Method, vary_seed| {
                settings.shown = index_of(&subjects, shown);
                let mut view = View { vary_seed, ..settings.view(&subjects.shown, SIZE) };
                view.scene.camera = camera;
                view
            };
            let glints = view_of(method, true);
            let smooth = view_of(method.baseline().unwrap(), false);
            let (mean, _) = mean_radiance(gpu, &mut renderer, &glints, SEEDS);
            let (one, _) = mean_radiance(gpu, &mut renderer, &glints, 1);
            let (expected, _) = mean_radiance(gpu, &mut renderer, &smooth, 1);
            let error = (0..3).map(|c| (mean[c] / expected[c] - 1.0).abs()).fold(0.0, f64::max);
            println!(
                "{}, density {density:.0e}: off by {:.3} %, one seed {:.1} %",
                method.name(),
                100.0 * error,
                100.0 * (one[1] / expected[1] - 1.0).abs()
            );
            assert!(error < 0.01, "{}: mean {mean:?}, smooth {expected:?}", method.name());
        }
    }
}

/// Lights together and one by one, coloured facets beside a smooth part, on pixels that hold few facets and many.
#[test]
fn the_mean_over_seeds_of_counted_facets_is_their_smooth_form_in_every_light() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects(gpu);
    let index = index_of(&subjects, Method::Glints);
    let every = [LightKind::Sun, LightKind::Points, LightKind::Rect, LightKind::Environment];
    let lights: Vec<&[LightKind]> = every.chunks(1).chain([&every[..]]).collect();
    for kinds in lights {
        // Many facets a pixel are drawn in all lights together alone.
        let densities: &[f32] = if kinds.len() > 1 { &[3.0e4, 3.0e7] } else { &[3.0e4] };
        for &density in densities {
            let (mesh, mut settings, view) = wall(&subjects, index, SIZE);
            settings.lights.only(kinds);
            let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
            let material = &mut settings.materials[index];
            (material.density, material.alpha, material.facet_spread) = (density, [0.4, 0.2], 0.1);
            let mut glints = View { vary_seed: true, ..settings.view(&subjects.shown, SIZE) };
            glints.scene.camera = view.scene.camera;
            let Compare::Single(side) = &glints.compare else { panic!("one side was asked for") };
            let reference = Compare::Single(Side { reference: true, ..side.clone() });
            let smooth = View { vary_seed: false, compare: reference, ..glints.clone() };
            let (mean, _) = mean_radiance(gpu, &mut renderer, &glints, FEWER_SEEDS);
            let (expected, _) = mean_radiance(gpu, &mut renderer, &smooth, 1);
            let error = (0..3).map(|c| (mean[c] / expected[c] - 1.0).abs()).fold(0.0, f64::max);
            println!("glints, {kinds:?}, density {density:.0e}: off by {:.3} %", 100.0 * error);
            assert!(error < 0.01, "{kinds:?}, {density}: mean {mean:?}, smooth {expected:?}");
        }
    }
}
