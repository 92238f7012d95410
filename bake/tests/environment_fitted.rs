//! Fitted look-ups and the share of facets that reflect, against surfaces of explicit facets.

use glam::{DVec3, Vec3};
use glint_bake_core::environment::eval::{
    Surface, chances, environment_look_up, environment_table, level_probabilities, lobe_probabilities,
};
use glint_bake_core::environment::image::{direction, luminance};
use glint_bake_core::environment::options::LevelCount;
use glint_bake_core::environment::quality::relative_variance;
use glint_bake_core::environment::reference::FacetSurface;
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, bake};
use glint_bake_core::progress::Silent;
use glint_formats::environment::Kernel;
use std::f64::consts::PI;

fn image_of(radiance: impl Fn(DVec3) -> f32) -> EnvironmentImage {
    const HEIGHT: u32 = 64;
    let mut pixels = Vec::new();
    for y in 0..HEIGHT {
        for x in 0..2 * HEIGHT {
            let longitude = PI * ((f64::from(x) + 0.5) / f64::from(HEIGHT) - 1.0);
            let sine = (PI * (0.5 - (f64::from(y) + 0.5) / f64::from(HEIGHT))).sin();
            pixels.push([radiance(direction(longitude, sine)); 3]);
        }
    }
    EnvironmentImage::new(2 * HEIGHT, HEIGHT, pixels).unwrap()
}

fn baked(image: &EnvironmentImage, kernel: Kernel, look_ups: u32) -> Environment {
    let options = EnvironmentOptions {
        face_size: 64,
        look_ups,
        kernel,
        levels: LevelCount::Exactly(8),
        measured_reads: 0,
        ..EnvironmentOptions::default()
    };
    bake(image, &options, &Silent).unwrap()
}

/// A surface that an eye sees at `degrees` from its normal, `turn` around it.
fn facets(degrees: f64, turn: f64, alpha: f64, f0: f64) -> FacetSurface {
    let normal = DVec3::new(0.3, 0.8, 0.5).normalize();
    let x = normal.any_orthonormal_vector();
    let aside = x * turn.cos() + normal.cross(x) * turn.sin();
    FacetSurface { normal, view: normal * degrees.to_radians().cos() + aside * degrees.to_radians().sin(), alpha, f0 }
}

fn drawn(surface: &FacetSurface) -> Surface {
    Surface {
        normal: surface.normal.as_vec3(),
        view: surface.view.as_vec3(),
        alpha: surface.alpha as f32,
        f0: surface.f0 as f32,
        facets: 1.0,
    }
}

fn seen(cos_o: f32, alpha: f32) -> Surface {
    Surface { normal: Vec3::Z, view: Vec3::new((1.0 - cos_o * cos_o).sqrt(), 0.0, cos_o), alpha, f0: 0.6, facets: 1.0 }
}

#[test]
fn shares_are_of_one_whole_and_directions_lie_in_the_plane_above_the_surface() {
    let dark = image_of(|_| 0.0);
    for kernel in [Kernel::GgxSoft, Kernel::GgxNl, Kernel::Ndf] {
        for look_ups in 1..=3 {
            let environment = baked(&dark, kernel, look_ups);
            for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i as f32 / 20.0, j as f32 / 20.0))) {
                let surface = seen(i, j * j);
                let entry = |layer| environment_table(&environment, layer, &surface);
                let others: Vec<[f32; 4]> = (2..=look_ups).map(entry).collect();
                let whole: f32 = others.iter().map(|other| other[2]).sum();
                assert!(others.iter().all(|other| other[2] >= 0.0) && whole <= 1.0, "{i} {j}: {others:?}");
                let [_, _, shift, ratio] = entry(0);
                for [shift, ratio] in others.iter().map(|other| [other[0], other[1]]).chain([[shift, ratio]]) {
                    let look_up = environment_look_up(&environment, &surface, shift, ratio);
                    assert!(look_up.direction.y.abs() < 1e-6 && (look_up.direction.length() - 1.0).abs() < 1e-5);
                    // A ratio is at most that of a roughness of 1, but for rounding and what lies between entries.
                    assert!(ratio > 0.09 && ratio * j * j < 1.1, "{i} {j}: {ratio}");
                }
            }
        }
    }
}

/// Along the normal there is no plane of incidence, whatever the shift; sharp lobes are read at their own roughness.
#[test]
fn along_the_normal_all_look_ups_are_in_the_mirror_direction() {
    let dark = image_of(|_| 0.0);
    for look_ups in 1..=3 {
        let environment = baked(&dark, Kernel::GgxSoft, look_ups);
        for alpha in [0.0, 0.01, 0.3, 1.0] {
            let surface = seen(1.0, alpha);
            for layer in (2..=look_ups).chain([0]) {
                let entry = environment_table(&environment, layer, &surface);
                let shift = if layer == 0 { entry[2] } else { entry[0] };
                assert_eq!(environment_look_up(&environment, &surface, shift, 1.0).direction, Vec3::Z);
            }
        }
        if look_ups == 1 {
            for alpha in [0.001, 0.01, 0.04] {
                let ratio = environment_table(&environment, 0, &seen(1.0, alpha))[3];
                assert!((ratio - 1.0).abs() < 0.02, "{alpha}: {ratio}");
            }
        }
    }
}

/// Under even light all variance is that of reflectance, masking and the horizon.
#[test]
fn facets_under_even_light_vary_as_explicit_ones_do() {
    let image = image_of(|_| 2.0);
    let environment = baked(&image, Kernel::GgxSoft, 1);
    for (degrees, alpha) in
        [(0.0, 0.3), (30.0, 0.8), (60.0, 0.04), (60.0, 0.25), (60.0, 0.5), (75.0, 0.25), (80.0, 0.1)]
    {
        for f0 in [0.04, 0.6, 1.0] {
            let surface = facets(degrees, 0.0, alpha, f0);
            let exact = surface.moments(&image).relative_variance(1.0);
            let found = f64::from(relative_variance(&chances(&environment, &drawn(&surface)), 1.0));
            println!("{degrees}°, α {alpha}, F₀ {f0}: variance {found:.4}, exact {exact:.4}");
            assert!((found - exact).abs() < 0.003 + 0.02 * exact, "{degrees}° {alpha} {f0}: {found} {exact}");
        }
    }
}

/// Mean errors over surfaces turned all around under a lamp and a sky: of the mean, and of the variance, each over the exact.
fn errors(image: &EnvironmentImage, environment: &Environment, degrees: f64, alpha: f64) -> [f64; 2] {
    let (mut off, mut whole) = ([0.0; 2], [0.0; 2]);
    for turn in 0..12 {
        let surface = facets(degrees, f64::from(turn) * PI / 6.0, alpha, 0.6);
        let moments = surface.moments(image);
        let chances = chances(environment, &drawn(&surface));
        let mean = luminance(chances.smooth_radiance.map(f64::from));
        let found = [mean, f64::from(relative_variance(&chances, 1.0)) * mean * mean];
        let exact = [moments.mean, moments.relative_variance(1.0) * moments.mean * moments.mean];
        (0..2).for_each(|k| (off[k], whole[k]) = (off[k] + (found[k] - exact[k]).abs(), whole[k] + exact[k]));
    }
    [off[0] / whole[0], off[1] / whole[1]]
}

#[test]
fn more_look_ups_are_nearer_to_explicit_facets() {
    let lamp = DVec3::new(-0.4, 0.5, 0.3).normalize();
    let image = image_of(|d| if d.dot(lamp) > 0.98 { 60.0 } else { 0.4 + 0.3 * d.y as f32 });
    let all = [1, 2, 3].map(|look_ups| baked(&image, Kernel::GgxSoft, look_ups));
    let within = [[0.31, 0.44], [0.11, 0.2], [0.072, 0.135]];
    for (degrees, alpha) in [(60.0, 0.25), (60.0, 0.5), (75.0, 0.25)] {
        let found = all.each_ref().map(|environment| errors(&image, environment, degrees, alpha));
        println!("{degrees}°, α {alpha}: {found:.3?}");
        for ([mean, variance], [mean_within, variance_within]) in found.into_iter().zip(within) {
            assert!(mean <= mean_within && variance <= variance_within, "{degrees}°, α {alpha}: {found:.3?}");
        }
    }
}

/// Chances are the shares of the look-ups, whatever their number.
#[test]
fn chances_are_sums_over_look_ups() {
    let image = image_of(|d| if d.x > 0.9 { 50.0 } else { 0.5 + 0.4 * d.y as f32 });
    let environment = baked(&image, Kernel::GgxSoft, 3);
    let surface = drawn(&facets(50.0, 1.0, 0.3, 0.5));
    let [_, _, shift, ratio] = environment_table(&environment, 0, &surface);
    let first = environment_look_up(&environment, &surface, shift, ratio);
    let found = lobe_probabilities(&environment, &surface, &first, 0.8);
    let others = [2, 3].map(|layer| environment_table(&environment, layer, &surface));
    let left = 1.0 - others[0][2] - others[1][2];
    let mut expected = level_probabilities(&environment, first.direction, &first.roughness, 0.8).map(|p| left * p);
    for [shift, ratio, share, _] in others {
        let look_up = environment_look_up(&environment, &surface, shift, ratio);
        let p = level_probabilities(&environment, look_up.direction, &look_up.roughness, 0.8);
        expected.iter_mut().zip(p).for_each(|(sum, p)| *sum += share * p);
    }
    assert!((found.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}
