//! Glints under an environment: explicit facets against their exact moments, draws against their own, and what is baked
//! against explicit facets.

use glam::{DVec3, Vec3};
use glint_bake_core::counting::eval::unit_from_bits;
use glint_bake_core::environment::eval::{
    Surface, chances, environment_filtered, environment_glints, environment_roughness, environment_smooth,
};
use glint_bake_core::environment::image::{direction, luminance};
use glint_bake_core::environment::options::LevelCount;
use glint_bake_core::environment::quality::relative_variance;
use glint_bake_core::environment::reference::FacetSurface;
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, albedo, bake};
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::environment::MAX_LEVELS;
use std::f64::consts::PI;

fn image_of(radiance: impl Fn(DVec3) -> [f32; 3]) -> EnvironmentImage {
    const HEIGHT: u32 = 32;
    let mut pixels = Vec::new();
    for y in 0..HEIGHT {
        for x in 0..2 * HEIGHT {
            let longitude = PI * ((f64::from(x) + 0.5) / f64::from(HEIGHT) - 1.0);
            let sine = (PI * (0.5 - (f64::from(y) + 0.5) / f64::from(HEIGHT))).sin();
            pixels.push(radiance(direction(longitude, sine)));
        }
    }
    EnvironmentImage::new(2 * HEIGHT, HEIGHT, pixels).unwrap()
}

/// A dim room with a few lamps, a hundred times as bright.
fn lamps() -> EnvironmentImage {
    image_of(|d| {
        let lit = (9.0 * d.x).sin() * (7.0 * d.z).cos() > 0.85;
        if lit { [30.0, 24.0, 12.0] } else { [0.2 + 0.1 * d.y as f32, 0.25, 0.3] }
    })
}

fn baked(image: &EnvironmentImage, levels: u32, coloured: bool) -> Environment {
    let options = EnvironmentOptions {
        face_size: 64,
        min_face_size: 8,
        levels: LevelCount::Exactly(levels),
        coloured,
        measured_reads: 0,
        ..EnvironmentOptions::default()
    };
    bake(image, &options, &Silent).unwrap()
}

/// A surface that an eye sees at `degrees` from its normal.
fn facets(degrees: f64, alpha: f64) -> FacetSurface {
    let normal = DVec3::new(0.3, 0.8, 0.5).normalize();
    let aside = normal.any_orthonormal_vector();
    let view = normal * degrees.to_radians().cos() + aside * degrees.to_radians().sin();
    FacetSurface { normal, view, alpha, f0: 0.6 }
}

fn drawn_from(surface: &FacetSurface, facets: f32) -> Surface {
    Surface {
        normal: surface.normal.as_vec3(),
        view: surface.view.as_vec3(),
        alpha: surface.alpha as f32,
        f0: surface.f0 as f32,
        facets,
    }
}

fn words(seed: u64, draw: u32) -> [f32; MAX_LEVELS] {
    let mut rng = ItemRng::new(seed, Purpose::Test(99), draw);
    std::array::from_fn(|_| unit_from_bits(rng.bits()))
}

fn brightness(rgb: [f32; 3]) -> f64 {
    luminance(rgb.map(f64::from))
}

/// Mean, variance, and the standard errors of both.
fn statistics(values: &[f64]) -> [f64; 4] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let fourth = values.iter().map(|v| (v - mean).powi(4)).sum::<f64>() / n;
    [mean, variance, (variance / n).sqrt(), ((fourth - variance * variance) / n).sqrt()]
}

#[test]
fn placed_facets_have_the_moments_of_the_integral() {
    let image = lamps();
    for (degrees, alpha, count) in [(0.0, 0.3, 8), (50.0, 0.3, 8), (70.0, 0.1, 3)] {
        let surface = facets(degrees, alpha);
        let moments = surface.moments(&image);
        let values: Vec<f64> = (0..20_000).map(|patch| surface.placed(&image, count, 1, patch)).collect();
        let [mean, variance, mean_error, variance_error] = statistics(&values);
        let expected = moments.relative_variance(f64::from(count)) * moments.mean * moments.mean;
        let (z, z2) = ((mean - moments.mean) / mean_error, (variance - expected) / variance_error);
        println!("{degrees}°, α {alpha}: mean {mean:.4} z {z:.1}, variance {variance:.4} z {z2:.1}");
        assert!(z.abs() < 4.0 && z2.abs() < 4.0);
    }
}

#[test]
fn under_even_light_the_mean_is_the_albedo() {
    let image = image_of(|_| [2.0; 3]);
    for (degrees, alpha) in [(0.0, 0.3), (45.0, 0.2), (75.0, 0.5)] {
        let surface = facets(degrees, alpha);
        let areas = albedo::areas(degrees.to_radians().cos(), alpha);
        let expected = 2.0 * (surface.f0 * areas.scale + areas.bias);
        let found = surface.moments(&image).mean;
        assert!((found / expected - 1.0).abs() < 2e-3, "{degrees}°: {found}, albedo gives {expected}");
        assert!((surface.facet_area() / areas.whole - 1.0).abs() < 1e-6);
    }
}

#[test]
fn draws_have_the_mean_and_variance_they_claim() {
    let image = lamps();
    for (levels, count) in [(4, 0.3), (4, 20.0), (8, 7.5), (1, 5.0)] {
        let environment = baked(&image, levels, false);
        let surface = drawn_from(&facets(30.0, 0.3), count);
        let chances = chances(&environment, &surface);
        assert_eq!(chances.smooth_radiance, environment_smooth(&environment, &surface));
        let smooth = brightness(chances.smooth_radiance);
        let values: Vec<f64> =
            (0..20_000).map(|draw| brightness(environment_glints(&environment, &surface, &words(7, draw)))).collect();
        let [mean, variance, mean_error, variance_error] = statistics(&values);
        let expected = f64::from(relative_variance(&chances, count)) * smooth * smooth;
        let (z, z2) = ((mean - smooth) / mean_error, (variance - expected) / variance_error);
        println!("{levels} levels, {count} facets: mean z {z:.1}, variance {variance:.4} z {z2:.1}");
        assert!(z.abs() < 4.0 && z2.abs() < 4.0);
    }
}

#[test]
fn more_facets_converge_to_the_smooth_reflection() {
    let environment = baked(&lamps(), 4, false);
    let mut last = f64::INFINITY;
    for count in [1e2, 1e4, 1e6, 1e10] {
        let surface = drawn_from(&facets(30.0, 0.3), count);
        let smooth = brightness(environment_smooth(&environment, &surface));
        let values: Vec<f64> = (0..500)
            .map(|draw| brightness(environment_glints(&environment, &surface, &words(8, draw))) / smooth)
            .collect();
        let [_, variance, _, _] = statistics(&values);
        assert!(variance < 0.1 * last, "{count} facets: variance {variance} after {last}");
        last = variance;
    }
}

/// At the normal the filter is the reflection up to F and the texels; at an angle it is turned to the mirror direction,
/// where a real reflection is longer than wide.
#[test]
fn baked_levels_glint_as_placed_facets_do() {
    let image = lamps();
    for (degrees, alpha, mean_within) in [(0.0, 0.3, 0.03), (0.0, 0.15, 0.03), (40.0, 0.3, 0.1)] {
        let exact = facets(degrees, alpha).moments(&image);
        for levels in [4, 8] {
            let environment = baked(&image, levels, false);
            let chances = chances(&environment, &drawn_from(&facets(degrees, alpha), 10.0));
            let mean = brightness(chances.smooth_radiance) / exact.mean - 1.0;
            let variance = f64::from(relative_variance(&chances, 10.0)) / exact.relative_variance(10.0) - 1.0;
            println!(
                "{degrees}°, α {alpha}, {levels} levels: mean off by {mean:.4}, relative variance by {variance:.4}"
            );
            assert!(mean.abs() < mean_within && variance.abs() < 0.05);
        }
    }
}

#[test]
fn red_and_blue_lamps_make_red_and_blue_glints() {
    let image = image_of(|d| match d {
        d if d.x > 0.97 => [40.0, 0.0, 0.0],
        d if d.x < -0.97 => [0.0, 0.0, 120.0],
        _ => [0.02; 3],
    });
    let environment = baked(&image, 4, true);
    for (towards, bright, dark) in [(Vec3::X, 0, 2), (-Vec3::X, 2, 0)] {
        let surface = Surface { normal: towards, view: towards, alpha: 0.1, f0: 0.9, facets: 4.0 };
        let roughness = environment_roughness(&environment, 0.1);
        assert!(environment_filtered(&environment, towards, &roughness)[bright] > 1.0);
        let sum = (0..200)
            .map(|draw| environment_glints(&environment, &surface, &words(9, draw)))
            .fold([0.0; 3], |a, b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
        assert!(sum[bright] > 50.0 * sum[dark], "towards {towards}: {sum:?}");
    }
}

#[test]
fn hard_surfaces_stay_finite() {
    let black = image_of(|_| [0.0; 3]);
    let one = {
        let mut image = black.clone();
        image.pixels[700] = [1e6; 3];
        image
    };
    for image in [&black, &one, &image_of(|_| [1.0; 3])] {
        for coloured in [false, true] {
            let environment = baked(image, 4, coloured);
            for alpha in [0.0, 1e-3, 0.5, 1.0] {
                for facets in [0.0, 1e-3, 1.0, 1e16] {
                    for cos_o in [0.0, 1e-3, 1.0f32] {
                        let view = Vec3::new((1.0 - cos_o * cos_o).sqrt(), 0.0, cos_o);
                        let surface = Surface { normal: Vec3::Z, view, alpha, f0: 0.04, facets };
                        let rgb = environment_glints(&environment, &surface, &words(3, 1));
                        assert!(rgb.iter().all(|v| v.is_finite() && *v >= 0.0), "{rgb:?} for {surface:?}");
                    }
                }
            }
        }
    }
}
