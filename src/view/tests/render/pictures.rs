//! Pictures of all methods: deterministic, and without pixels that are no number, in easy and in hard views.

use crate::adapter::gpu;
use crate::subjects::{camera, mean_radiance, subjects, wall};
use glam::Vec3;
use glint_view::render::{Overlay, picture};

#[test]
fn every_method_gives_light_and_the_same_bytes_twice() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects(gpu);
    for index in 0..subjects.shown.len() {
        let (mesh, _, view) = wall(&subjects, index, [96, 64]);
        let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
        let (mean, largest) = mean_radiance(gpu, &mut renderer, &view, 1);
        assert!(mean[1] > 0.0 && largest > 0.0, "{} is black", subjects.shown[index].method.name());
        let first = picture(gpu, &mut renderer, &view, 1).unwrap();
        let mut other = subjects.renderer(gpu, &mesh).unwrap();
        assert!(first == picture(gpu, &mut other, &view, 1).unwrap(), "{}", subjects.shown[index].method.name());
    }
}

#[test]
fn hard_views_have_no_pixel_without_a_number() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects(gpu);
    for index in 0..subjects.shown.len() {
        let (mesh, _, mut view) = wall(&subjects, index, [64, 48]);
        let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
        for height in [1e-6, 1e-3, 10.0, 30.0] {
            view.scene.camera = camera(height);
            mean_radiance(gpu, &mut renderer, &view, 1);
        }
        // Along the surface, light at and below the horizon, no roughness, all roughness.
        view.scene.camera = camera(1.0);
        view.scene.camera.position = Vec3::new(3.0, 0.0, 1e-3);
        for direction in [Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 1e-6), Vec3::NEG_Z] {
            view.scene.lights.sun.iter_mut().for_each(|sun| sun.direction = direction);
            mean_radiance(gpu, &mut renderer, &view, 1);
        }
        for overlay in [Overlay::Footprint, Overlay::Lod, Overlay::Loads] {
            view.display.overlay = overlay;
            mean_radiance(gpu, &mut renderer, &view, 1);
        }
    }
}
