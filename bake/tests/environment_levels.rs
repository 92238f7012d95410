//! Radiance levels, what glints make of them, level colours, and the albedo table, against definitions.

use glam::{DVec3, Vec3};
use glint_bake_core::environment::albedo::{areas, facet_area, reflecting_area_at_normal};
use glint_bake_core::environment::cube::{face_of, texel_direction, texel_solid_angle_sr};
use glint_bake_core::environment::eval::{
    Surface, environment_filtered, environment_radiance, environment_roughness, environment_table, facet_moments,
    level_probabilities, std_factor,
};
use glint_bake_core::environment::image::{direction, luminance};
use glint_bake_core::environment::levels::{RadianceHistogram, fewest, log_uniform, optimal, shares};
use glint_bake_core::environment::lookup::{colour_at, cube_taps};
use glint_bake_core::environment::options::LevelCount;
use glint_bake_core::environment::reference::{filtered, ggx, second_moments};
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, bake};
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::environment::{Kernel, LevelChoice, roughness_of};
use std::f64::consts::PI;

/// Random radiance over several decades, with two lamps.
fn image() -> EnvironmentImage {
    let mut rng = ItemRng::new(7, Purpose::Test(1), 1);
    let mut pixels: Vec<[f32; 3]> =
        (0..64 * 32).map(|_| [0.0; 3].map(|_: f64| (-6.0 * rng.unit()).exp() as f32)).collect();
    for x in 8..11 {
        pixels[12 * 64 + x] = [900.0, 20.0, 20.0];
        pixels[12 * 64 + 40 + x] = [20.0, 20.0, 2400.0];
    }
    EnvironmentImage::new(64, 32, pixels).unwrap()
}

fn baked(image: &EnvironmentImage, levels: u32, coloured: bool) -> Environment {
    let options = EnvironmentOptions {
        face_size: 32,
        min_face_size: 1,
        per_size: 2,
        levels: LevelCount::Exactly(levels),
        coloured,
        measured_reads: 0,
        ..EnvironmentOptions::default()
    };
    bake(image, &options, &Silent).unwrap()
}

#[test]
fn shares_of_levels_keep_the_mean_and_add_up_to_one() {
    let levels = [0.0, 0.5, 2.0, 7.0];
    let mut out = [0.0; 3];
    for (l, expected) in [
        (0.0, [0.0, 0.0, 0.0]),
        (0.25, [0.5, 0.0, 0.0]),
        (0.5, [1.0, 0.0, 0.0]),
        (1.25, [0.5, 0.5, 0.0]),
        (7.0, [0.0, 0.0, 1.0]),
    ] {
        shares(&levels, l, &mut out);
        assert_eq!(out, expected, "{l}");
    }
}

#[test]
fn the_dynamic_programme_finds_the_best_of_all_choices() {
    let histogram = RadianceHistogram::new(&image(), Kernel::Ndf);
    let (best, error) = optimal(&histogram, 4);
    assert_eq!((best.len(), best[0]), (4, 0.0));
    assert!((histogram.error(&best) - error).abs() < 1e-9 * (1.0 + error), "{error} {}", histogram.error(&best));
    // No other choice of the two levels between is better.
    let top = best[3];
    for a in 1..60 {
        for b in a + 1..60 {
            let level = |k: i32| top * 10f64.powf(-6.0 * (1.0 - f64::from(k) / 60.0));
            assert!(histogram.error(&[0.0, level(a), level(b), top]) >= error * (1.0 - 1e-9), "{a} {b}");
        }
    }
    let mut last = f64::INFINITY;
    for count in 2..=16 {
        let (levels, error) = optimal(&histogram, count);
        assert_eq!(levels.len(), count);
        assert!(levels.windows(2).all(|pair| pair[0] < pair[1]) && error <= last);
        assert!(error <= histogram.error(&log_uniform(&image(), count, 1e-3)) + 1e-12, "{count}");
        last = error;
    }
    let (levels, error) = fewest(&histogram, 0.1);
    assert!(error <= 0.1 && optimal(&histogram, levels.len() - 1).1 > 0.1, "{} {error}", levels.len());
}

#[test]
fn the_estimate_of_the_second_moment_is_that_of_the_reference() {
    let image = image();
    let histogram = RadianceHistogram::new(&image, Kernel::Ndf);
    let levels = [log_uniform(&image, 4, 1e-3), optimal(&histogram, 4).0];
    let mut errors = [0.0; 2];
    let mut count = 0.0;
    for k in 0..40 {
        let mut rng = ItemRng::new(3, Purpose::Test(2), k);
        let n = direction(2.0 * PI * rng.unit(), 2.0 * rng.unit() - 1.0);
        for alpha in glint_bake_core::environment::levels::ROUGHNESSES {
            let (with_levels, exact) = second_moments(&image, Kernel::Ndf, n, alpha, &levels);
            (0..2).for_each(|i| errors[i] += with_levels[i] / exact - 1.0);
            count += 1.0;
        }
    }
    for i in 0..2 {
        let (measured, estimated) = (errors[i] / count, histogram.error(&levels[i]));
        assert!((measured / estimated - 1.0).abs() < 0.25, "{measured} {estimated}");
    }
}

#[test]
fn stored_levels_have_the_moments_of_the_source() {
    let image = image();
    let environment = baked(&image, 8, false);
    // The first of two roughnesses of faces of 4 texels.
    let (index, size) = (5, 4);
    assert_eq!(environment.params.size(index), size);
    let alpha = environment.params.roughness[index as usize];
    for k in 0..12u32 {
        let (face, i, j) = ((k % 6) as usize, k % 4, k / 3);
        let n = texel_direction(face, i, j, size);
        let exact = filtered(&image, environment.params.kernel, n, alpha);
        let (n, visible) = (n.as_vec3(), 0.8);
        let at = environment_roughness(&environment, alpha as f32);
        let p = level_probabilities(&environment, n, &at, visible);
        assert!((p.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        let moments = facet_moments(&environment, &p);
        let mean = f64::from(visible) * exact.luminance;
        assert!((f64::from(moments[0]) / mean - 1.0).abs() < 0.01, "{k}: {moments:?} {mean}");
        // Levels vary too much, never too little; matched, they vary as the source does.
        assert!(f64::from(moments[1]) > 0.995 * f64::from(visible) * exact.square, "{k}");
        let rms = environment_filtered(&environment, n, &at)[3];
        let s = std_factor(moments, rms * rms, visible);
        let variance = f64::from(visible) * exact.square - mean * mean;
        let of_levels = moments[1] - moments[0] * moments[0];
        let matched = f64::from(s * s * of_levels / (moments[0] * moments[0])) * mean * mean;
        assert!((matched / variance - 1.0).abs() < 0.02, "{k}: {matched} {variance}");
    }
}

#[test]
fn red_and_blue_lamps_make_red_and_blue_levels() {
    let image = image();
    let environment = baked(&image, 4, true);
    let towards = |x: f64| direction(2.0 * PI * (x / 64.0 - 0.5), (PI * (0.5 - 12.5 / 32.0)).sin()).as_vec3();
    let sharp = environment_roughness(&environment, 0.1).colour_mip;
    let red = colour_at(&environment, 2, towards(9.5), sharp);
    let blue = colour_at(&environment, 2, towards(49.5), sharp);
    assert!(red[0] > 10.0 * red[2] && blue[2] > 10.0 * blue[0], "{red:?} {blue:?}");
    // Levels with their colours add up to the filtered colour.
    let n = texel_direction(1, 2, 1, 4).as_vec3();
    // The roughness of faces of 4 texels that colours have.
    let index = 5 + environment.params.colour_layer();
    let at = environment_roughness(&environment, environment.params.roughness[index as usize] as f32);
    let shares = level_probabilities(&environment, n, &at, 1.0);
    let radiance = environment_filtered(&environment, n, &at);
    for c in 0..3 {
        let sum: f32 = (1..4)
            .map(|k| {
                let colour = colour_at(&environment, k as u32 - 1, n, at.colour_mip);
                shares[k] * environment.params.levels[k] as f32 * colour[c]
            })
            .sum();
        assert!((sum / radiance[c] - 1.0).abs() < 0.02, "{sum} {}", radiance[c]);
    }
}

#[test]
fn look_ups_are_smooth_across_edges_and_roughnesses() {
    let mut pixels = Vec::new();
    for y in 0..32 {
        for x in 0..64 {
            let d = direction(
                2.0 * PI * ((f64::from(x) + 0.5) / 64.0 - 0.5),
                (PI * (0.5 - (f64::from(y) + 0.5) / 32.0)).sin(),
            );
            pixels.push([2.0 + d.x as f32, 2.0 + d.y as f32, 2.0 + d.z as f32]);
        }
    }
    let image = EnvironmentImage::new(64, 32, pixels).unwrap();
    let environment = baked(&image, 2, false);
    for k in 0..500 {
        let mut rng = ItemRng::new(9, Purpose::Test(4), k);
        let d = direction(2.0 * PI * rng.unit(), 2.0 * rng.unit() - 1.0).as_vec3();
        let taps = cube_taps(d, 8);
        assert!((taps.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        let near = taps.texels.iter().all(|&(f, i, j)| texel_direction(f, i, j, 8).as_vec3().distance(d) < 0.5);
        assert!(near, "{d} {taps:?}");
        let alpha = (0.02 + 0.1 * rng.unit()) as f32;
        let roughness = environment_roughness(&environment, alpha);
        let filtered = environment_filtered(&environment, d, &roughness);
        let [r, g, b, _] = filtered;
        let found = environment_radiance(&environment, d, &roughness, [r, g, b]);
        assert!((Vec3::new(found[0], found[1], found[2]) - (Vec3::splat(2.0) + d)).length() < 0.2, "{d} {found:?}");
    }
    let [smooth, rough] = [0.0, 1.0].map(|alpha| environment_roughness(&environment, alpha));
    assert_eq!((smooth.low, smooth.share, smooth.mirror, smooth.colour_mip), ([0, 0], 0.0, 1.0, 0.0));
    assert_eq!((rough.high, rough.mirror, rough.colour_mip), ([4, 1], 0.0, 4.0));
}

#[test]
fn cube_texels_cover_the_sphere_and_are_found_again() {
    for size in [1, 2, 8] {
        let whole: f64 = (0..size * size).map(|k| texel_solid_angle_sr(k % size, k / size, size)).sum();
        assert!((6.0 * whole / (4.0 * PI) - 1.0).abs() < 1e-12);
        for face in 0..6 {
            let (found, s, t) = face_of(texel_direction(face, 0, size - 1, size));
            let edge = 1.0 / f64::from(size) - 1.0;
            assert!(found == face && (s - edge).abs() < 1e-12 && (t + edge).abs() < 1e-12);
        }
    }
}

/// Areas by the plainest sum: over light directions of a hemisphere.
fn areas_by_directions(cos_o: f64, alpha: f64, f0: f64) -> (f64, f64) {
    let o = DVec3::new((1.0 - cos_o * cos_o).sqrt(), 0.0, cos_o);
    let (rows, columns) = (2000, 1000);
    let (mut albedo, mut reflecting) = (0.0, 0.0);
    let lambda = |c: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 / (c * c) - 1.0)).sqrt() - 1.0);
    for j in 0..rows {
        let cos_i = (f64::from(j) + 0.5) / f64::from(rows);
        let sin_i = (1.0 - cos_i * cos_i).sqrt();
        for i in 0..columns {
            let phi = PI * (f64::from(i) + 0.5) / f64::from(columns);
            let h = (o + DVec3::new(sin_i * phi.cos(), sin_i * phi.sin(), cos_i)).normalize();
            let oh = o.dot(h);
            let part = 2.0 * PI / f64::from(rows * columns) * ggx(h.z, alpha) / (4.0 * oh);
            reflecting += part;
            let fresnel = f0 + (1.0 - f0) * (1.0 - oh).powi(5);
            albedo += part * fresnel * oh / cos_o / (1.0 + lambda(cos_o) + lambda(cos_i));
        }
    }
    (albedo, reflecting)
}

#[test]
fn areas_agree_with_closed_forms_and_with_sums_over_light() {
    assert!((facet_area(1.0) - 2.0).abs() < 1e-12 && (facet_area(1e-4) - 1.0).abs() < 1e-6);
    for alpha in [0.01, 0.1, 0.3, 0.6, 0.9, 1.0] {
        let at_normal = areas(1.0, alpha);
        let exact = reflecting_area_at_normal(alpha);
        assert!((at_normal.reflecting / exact - 1.0).abs() < 1e-3, "{alpha}: {} {exact}", at_normal.reflecting);
        assert!(at_normal.reflecting <= at_normal.whole);
    }
    for (cos_o, alpha) in [(0.95, 0.3), (0.5, 0.2), (0.5, 0.8), (0.15, 0.4), (0.7, 1.0)] {
        let table = areas(cos_o, alpha);
        for f0 in [0.04, 1.0] {
            let (albedo, reflecting) = areas_by_directions(cos_o, alpha, f0);
            let found = f0 * table.scale + table.bias;
            assert!((found / albedo - 1.0).abs() < 4e-3, "albedo at {cos_o} {alpha} {f0}: {found} {albedo}");
            assert!(
                (table.reflecting / reflecting - 1.0).abs() < 4e-3,
                "{cos_o} {alpha}: {} {reflecting}",
                table.reflecting
            );
        }
    }
    let environment = baked(&image(), 2, false);
    for (cos_o, alpha) in [(0.9f32, 0.1f32), (0.3, 0.5), (0.02, 0.9)] {
        let view = Vec3::new((1.0 - cos_o * cos_o).sqrt(), 0.0, cos_o);
        let surface = Surface { normal: Vec3::Z, view, alpha, f0: 0.04, facets: 1.0 };
        let [first, second] = [0, 1].map(|layer| environment_table(&environment, layer, &surface));
        let exact = areas(f64::from(cos_o), f64::from(alpha));
        let expected = [exact.scale, exact.bias, exact.reflecting / exact.whole];
        for (read, exact) in [first[0], first[1], second[3]].into_iter().zip(expected) {
            assert!((f64::from(read) - exact).abs() < 0.01, "{cos_o} {alpha}: {read} {exact}");
        }
    }
}

#[test]
fn one_level_reflects_the_mean_and_log_uniform_is_eq_18() {
    let image = image();
    let environment = baked(&image, 1, false);
    assert_eq!(environment.params.levels, [luminance(image.mean())]);
    assert!(environment.indicators.is_empty());
    assert_eq!(level_probabilities(&environment, Vec3::Y, &environment_roughness(&environment, 0.3), 0.7)[0], 0.7);

    let levels = log_uniform(&image, 5, 1e-2);
    let top = image.max_luminance();
    let darkest = (0..image.pixels.len()).map(|i| image.luminance(i)).fold(f64::INFINITY, f64::min).max(1e-2);
    for k in 1..5 {
        let expected = darkest.powf(1.0 - f64::from(k) / 4.0) * top.powf(f64::from(k) / 4.0);
        assert!((levels[k as usize] / expected - 1.0).abs() < 1e-9, "{k}");
    }
    let options = EnvironmentOptions {
        face_size: 8,
        min_face_size: 1,
        level_choice: LevelChoice::LogUniform,
        measured_reads: 0,
        ..EnvironmentOptions::default()
    };
    assert_eq!(bake(&image, &options, &Silent).unwrap().params.levels, log_uniform(&image, 4, options.floor));
}

/// The roughness of every filtered cube is read from it alone, whatever the faces and the number of each size.
#[test]
fn every_roughness_finds_its_own_cube() {
    for (face_size, min_face_size, per_size) in [(32, 1, 2), (16, 8, 1), (64, 4, 3), (4, 2, 8), (256, 16, 4)] {
        let roughness = roughness_of(face_size, (face_size / min_face_size).ilog2() * per_size);
        assert!(roughness.windows(2).all(|pair| pair[0] < pair[1]) && roughness[roughness.len() - 1] == 1.0);
        let options = EnvironmentOptions {
            face_size: face_size.min(64),
            min_face_size: min_face_size.min(8),
            per_size,
            levels: LevelCount::Exactly(1),
            measured_reads: 0,
            ..EnvironmentOptions::default()
        };
        let white = EnvironmentImage::new(4, 2, vec![[1.0; 3]; 8]).unwrap();
        let environment = bake(&white, &options, &Silent).unwrap();
        let params = &environment.params;
        for index in 1..=params.filtered() {
            let found = environment_roughness(&environment, params.roughness[index as usize] as f32);
            let (mip, layer) = params.place(index);
            // Rounding may put it a little to either side.
            let low = found.low == [mip, layer] && found.share < 1e-4;
            let high = found.high == [mip, layer] && found.share > 0.9999;
            assert!(low || high, "{face_size} {per_size} {index}: {found:?}");
            assert!(found.mirror < 1e-6, "{found:?}");
        }
    }
}
