//! A slow zoom through many levels of detail: mean radiance changes little from frame to frame, so nothing pops.

use crate::adapter::gpu;
use crate::subjects::{camera, mean_radiance, subjects, wall};

/// Frames of the zoom, each this much farther away.
const FRAMES: u32 = 48;
const STEP: f32 = 1.05;

#[test]
fn a_slow_zoom_does_not_pop() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects(gpu);
    for index in 0..subjects.shown.len() {
        let name = subjects.shown[index].method.name();
        let (mesh, _, mut view) = wall(&subjects, index, [160, 120]);
        let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
        let mut before: Option<f64> = None;
        let mut worst = 0.0f64;
        for frame in 0..FRAMES {
            view.scene.camera = camera(0.5 * STEP.powi(frame as i32));
            let (mean, _) = mean_radiance(gpu, &mut renderer, &view, 1);
            if let Some(before) = before {
                worst = worst.max((mean[1] / before - 1.0).abs());
            }
            before = Some(mean[1]);
        }
        println!("{name}: mean radiance changes by at most {:.1} % from frame to frame", 100.0 * worst);
        assert!(worst < 0.1, "{name}: {worst}");
    }
}
