//! A slow zoom through many levels of detail: mean radiance changes little from frame to frame, so nothing pops. Where the light
//! is near, a zoom changes what falls on the wall; so radiance counts over that of the method's baseline in the same frame.

use crate::adapter::gpu;
use crate::subjects::{camera, index_of, mean_radiance, subjects, wall};
use glint_view::render::{Compare, Method, Side, Subject, View};

/// Frames of the zoom, each this much farther away: a twentieth of the picture is new in each, which alone changes the mean where
/// few features are in view.
const FRAMES: u32 = 96;
const STEP: f32 = 1.025;
const SIZE: [u32; 2] = [160, 120];
/// Counted facets a unit²: so many that hundreds are lit in every picture.
const MANY_FACETS: f32 = 1e9;

#[test]
fn a_slow_zoom_does_not_pop() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects(gpu);
    for index in 0..subjects.shown.len() {
        let shown = &subjects.shown[index];
        let Some(smooth) = shown.method.baseline() else { continue };
        let name = shown.method.name();
        let material = shown.material;
        let baseline = Subject { material, ..subjects.shown[index_of(&subjects, smooth)].clone() };
        let baseline = Compare::Single(Side { shown: baseline, reference: false });
        let (mesh, mut settings, mut view) = wall(&subjects, index, SIZE);
        if shown.method == Method::Glints {
            // Of facets that the sun lights, a handful a picture, a new one alone changes the mean.
            settings.materials[index].density = MANY_FACETS;
            view = settings.view(&subjects.shown, SIZE);
        }
        let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
        let mut before: Option<f64> = None;
        let mut worst = 0.0f64;
        for frame in 0..FRAMES {
            view.scene.camera = camera(0.5 * STEP.powi(frame as i32));
            let (mean, _) = mean_radiance(gpu, &mut renderer, &view, 1);
            let plain = View { compare: baseline.clone(), ..view.clone() };
            let (smooth, _) = mean_radiance(gpu, &mut renderer, &plain, 1);
            let share = mean[1] / smooth[1];
            if let Some(before) = before {
                worst = worst.max((share / before - 1.0).abs());
            }
            before = Some(share);
        }
        println!("{name}: radiance changes by at most {:.1} % from frame to frame", 100.0 * worst);
        assert!(worst < 0.06, "{name}: {worst}");
    }
}
