//! Pictures of all methods: deterministic, and without pixels that are no number, in easy and in hard views.

use crate::adapter::gpu;
use crate::subjects::{camera, mean_radiance, subjects, wall};
use glam::Vec3;
use glint_view::render::{Method, Overlay, picture};
use glint_view::subjects::Subjects;

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
        for overlay in [Overlay::Footprint, Overlay::Lod, Overlay::Loads, Overlay::Operations] {
            view.display.overlay = overlay;
            mean_radiance(gpu, &mut renderer, &view, 1);
        }
    }
}

#[test]
fn a_glint_takes_more_operations_than_none() {
    let Some(gpu) = gpu() else { return };
    let subjects = subjects(gpu);
    let operations: Vec<(Method, f64)> = (0..subjects.shown.len())
        .map(|index| {
            let (mesh, _, mut view) = wall(&subjects, index, [16, 12]);
            view.display.overlay = Overlay::Operations;
            let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
            picture(gpu, &mut renderer, &view, 1).unwrap();
            let pixels = renderer.radiance(gpu, &view, 0).unwrap();
            let sum: f64 = pixels.iter().map(|pixel| f64::from(pixel[3]).exp2() - 1.0).sum();
            (subjects.shown[index].method, sum / pixels.len() as f64)
        })
        .collect();
    let smooth = operations.iter().find(|(method, _)| *method == Method::Smooth).unwrap().1;
    assert!(smooth > 50.0 && smooth < 1000.0, "{smooth}");
    for (method, found) in operations.iter().filter(|(method, _)| method.baseline() == Some(Method::Smooth)) {
        assert!(*found > 2.0 * smooth && *found < 1e6, "{method:?}: {found} against {smooth}");
    }
}

#[test]
fn mass_beyond_the_rim_is_left_out_where_it_does_not_show() {
    let Some(gpu) = gpu() else { return };
    let mut subjects = subjects(gpu);
    let has_lobes = |method| matches!(method, Method::Lobes | Method::Surface);
    let indices: Vec<usize> = (0..subjects.shown.len()).filter(|i| has_lobes(subjects.shown[*i].method)).collect();
    assert!(indices.len() >= 2);
    for index in indices {
        let shown = &subjects.shown[index];
        assert!(shown.rim_roughness >= shown.material.intrinsic_roughness, "{} keeps it", shown.name);
        // Luminances, and how many operations they took.
        let drawn = |subjects: &Subjects| {
            let (mesh, _, mut view) = wall(subjects, index, [96, 64]);
            view.display.overlay = Overlay::Operations;
            let mut renderer = subjects.renderer(gpu, &mesh).unwrap();
            picture(gpu, &mut renderer, &view, 1).unwrap();
            let pixels = renderer.radiance(gpu, &view, 0).unwrap();
            let operations: f64 = pixels.iter().map(|pixel| f64::from(pixel[3]).exp2()).sum();
            (pixels.iter().map(|pixel| f64::from(pixel[1])).collect::<Vec<f64>>(), operations)
        };
        let (without, fewer) = drawn(&subjects);
        subjects.shown[index].rim_roughness = 0.0;
        let (with, all) = drawn(&subjects);
        let apart: f64 = with.iter().zip(&without).map(|(a, b)| (a - b).abs()).sum();
        let sum: f64 = with.iter().sum();
        println!("{}: {:.1e} apart, {:.3} of the operations", subjects.shown[index].name, apart / sum, fewer / all);
        assert!(sum > 0.0 && apart <= 1e-6 * sum, "{}: {apart} of {sum}", subjects.shown[index].name);
        assert!(fewer < all, "{}: {fewer} operations, {all} with all of it", subjects.shown[index].name);
    }
}
