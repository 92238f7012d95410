//! Baked environments against the definition: orientation, accuracy with a sun, hard inputs, and the same bytes again.

use glam::DVec3;
use glint_bake_core::environment::image::{direction, luminance};
use glint_bake_core::environment::options::LevelCount;
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, bake, quality, sections};
use glint_bake_core::error::BakeError;
use glint_bake_core::progress::Silent;
use glint_formats::environment::{Kernel, LevelChoice};
use glint_formats::{Codec, Limits, Pack, PackBuilder};
use std::f64::consts::PI;

/// An image whose pixels are a function of their direction.
fn image_of(width: u32, height: u32, radiance: impl Fn(DVec3) -> [f32; 3]) -> EnvironmentImage {
    let mut pixels = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let longitude = 2.0 * PI * ((f64::from(x) + 0.5) / f64::from(width) - 0.5);
            let sine = (PI * (0.5 - (f64::from(y) + 0.5) / f64::from(height))).sin();
            pixels.push(radiance(direction(longitude, sine)));
        }
    }
    EnvironmentImage::new(width, height, pixels).unwrap()
}

/// Sky, ground, some texture, and a sun of a few pixels that is `range` times as bright.
fn sunny(width: u32, height: u32, range: f32) -> EnvironmentImage {
    let sun = DVec3::new(0.3, 0.5, -0.6).normalize();
    image_of(width, height, |d| {
        if d.dot(sun) > 0.996 {
            return [range, 0.9 * range, 0.8 * range];
        }
        let texture = 1.0 + 0.5 * ((13.0 * d.x).sin() * (17.0 * d.z).cos()) as f32;
        if d.y > 0.0 { [0.3 * texture, 0.5 * texture, texture] } else { [0.2 * texture, 0.15, 0.1] }
    })
}

fn options(levels: u32) -> EnvironmentOptions {
    EnvironmentOptions {
        face_size: 16,
        min_face_size: 1,
        levels: LevelCount::Exactly(levels),
        ..EnvironmentOptions::default()
    }
}

fn baked(image: &EnvironmentImage, options: &EnvironmentOptions) -> Environment {
    bake(image, options, &Silent).unwrap()
}

fn all_finite(environment: &Environment) -> bool {
    let params = &environment.params;
    (0..params.mips()).all(|mip| {
        let size = environment.size(mip);
        (0..6 * size * size).all(|k| {
            let (face, i, j) = ((k / (size * size)) as usize, k % size, k / size % size);
            environment.radiance_texel(mip, face, i, j).iter().all(|v| v.is_finite() && *v >= 0.0)
        })
    })
}

fn pack_of(environment: &Environment) -> Pack {
    let mut builder = PackBuilder::new();
    for section in sections::to_sections("sky", environment, Codec::None) {
        builder.push(section).unwrap();
    }
    let pack = Pack::from_bytes(builder.finish().unwrap(), &Limits::default()).unwrap();
    assert_eq!(pack.verify(), []);
    pack
}

/// Centre, right and down of each face as graphics interfaces define cube maps.
const FACES: [[[f64; 3]; 3]; 6] = [
    [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]],
    [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
    [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
    [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
    [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
];

#[test]
fn no_face_is_flipped_or_swapped() {
    // Colour tells the direction, so any flip or swap shows in every texel.
    let image = image_of(256, 128, |d| [1.0 + d.x as f32, 1.0 + d.y as f32, 1.0 + d.z as f32]);
    let environment = baked(&image, &options(4));
    for mip in 0..2 {
        let size = environment.size(mip);
        for (face, [centre, right, down]) in FACES.into_iter().map(|face| face.map(DVec3::from)).enumerate() {
            for (i, j) in [(0, 0), (size - 1, 0), (0, size - 1), (size - 1, size - 1), (size / 2, size / 4)] {
                let [s, t] = [i, j].map(|k| 2.0 * (f64::from(k) + 0.5) / f64::from(size) - 1.0);
                let expected = DVec3::ONE + (centre + right * s + down * t).normalize();
                let found = environment.radiance_texel(mip, face, i, j);
                for c in 0..3 {
                    let difference = f64::from(found[c]) - expected[c];
                    assert!(
                        difference.abs() < 0.03,
                        "mip {mip} face {face} ({i}, {j}): {found:?}, expected {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_image_s_middle_is_minus_z_and_right_of_it_is_plus_x() {
    let mut pixels = vec![[0.0; 3]; 64 * 32];
    pixels[16 * 64 + 32] = [1.0, 0.0, 0.0]; // just right of and below the middle
    pixels[16 * 64 + 48] = [0.0, 1.0, 0.0]; // a quarter turn to the right
    pixels[32 + 2 * 64] = [0.0, 0.0, 1.0]; // near the top
    let image = EnvironmentImage::new(64, 32, pixels).unwrap();
    let environment = baked(&image, &options(2));
    let brightest = |c: usize| {
        let value = |face: usize| (0..256).map(|k| environment.radiance_texel(0, face, k % 16, k / 16)[c]).sum::<f32>();
        (0..6).max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap()
    };
    assert_eq!([brightest(0), brightest(1), brightest(2)], [5, 0, 2]);
}

#[test]
fn every_mip_is_as_near_to_the_definition_as_was_asked() {
    let image = sunny(128, 64, 1e6);
    for kernel in [Kernel::Ndf, Kernel::GgxNl] {
        let options = EnvironmentOptions { kernel, face_size: 64, measured_texels: 0, ..options(4) };
        let environment = baked(&image, &options);
        assert!(environment.params.measured.energy < 1e-4, "{}", environment.params.measured.energy);
        let mean = luminance(image.mean());
        for mip in 1..environment.params.mips() {
            let compared = quality::compare(&image, &environment, mip, 24);
            let error = quality::error_of(&compared, mean);
            let sharp = environment.params.roughness[mip as usize] < 0.04;
            let (rmse, worst) = if sharp { (0.02, 0.25) } else { (0.005, 0.05) };
            assert!(error.rmse <= rmse && error.worst <= worst, "{kernel:?} mip {mip}: {error:?}");
            for c in &compared {
                let square = f64::from(c.stored[3]).powi(2);
                let share = (square / c.exact.square - 1.0).abs();
                assert!(share < worst, "{kernel:?} mip {mip} {:?}: {share}", c.texel);
            }
        }
    }
}

#[test]
fn the_first_mip_keeps_areas_and_energy() {
    let image = sunny(100, 50, 1e6);
    let environment = baked(&image, &options(2));
    assert!(environment.params.measured.energy < 1e-4, "{}", environment.params.measured.energy);
    for c in quality::compare(&image, &environment, 0, 40) {
        let share = c.error().abs() / c.exact.luminance;
        assert!(share < 0.05, "{:?} {share}", c.texel);
    }
}

#[test]
fn white_stays_white_and_black_black() {
    for levels in [1, 2, 4, 8, 16] {
        for choice in [LevelChoice::Optimal, LevelChoice::LogUniform] {
            let options = EnvironmentOptions { level_choice: choice, ..options(levels) };
            let white = baked(&image_of(32, 16, |_| [2.0; 3]), &options);
            let black = baked(&image_of(32, 16, |_| [0.0; 3]), &options);
            for mip in 0..white.params.mips() {
                let texel = white.radiance_texel(mip, 3, 0, 0);
                assert!(texel.iter().all(|v| (v - 2.0).abs() < 0.008), "{levels} mip {mip}: {texel:?}");
                assert_eq!(black.radiance_texel(mip, 3, 0, 0), [0.0; 4]);
                if levels > 1 {
                    let last = (levels as usize - 2) / 4;
                    let share = |e: &Environment| e.indicator_texel(last, mip, 3, 0, 0)[(levels as usize - 2) % 4];
                    assert!(share(&white) > 0.995, "{levels} {choice:?} mip {mip}: {}", share(&white));
                    assert_eq!(share(&black), 0.0);
                }
            }
            pack_of(&white);
            pack_of(&black);
        }
    }
}

#[test]
fn hard_images_give_sound_packs() {
    let mut single = vec![[0.0; 3]; 64 * 32];
    single[10 * 64 + 7] = [5e4, 1e6, 2e3];
    let single = EnvironmentImage::new(64, 32, single).unwrap();
    let sizes = [(1, 1), (2, 1), (3, 1), (63, 31), (65, 33), (33, 16)];
    let mut images: Vec<EnvironmentImage> = sizes.iter().map(|&(w, h)| sunny(w, h, 1e6)).collect();
    images.extend([single, sunny(64, 32, 1e11), image_of(32, 16, |d| [1e-9 * (2.0 + d.x as f32); 3])]);
    for image in images {
        let options = EnvironmentOptions { coloured: true, measured_texels: 4, ..options(8) };
        let environment = baked(&image, &options);
        let (width, height) = (image.width, image.height);
        assert!(all_finite(&environment), "{width} × {height}");
        assert!(environment.params.measured.energy < 1e-3, "{width} × {height}: {:?}", environment.params.measured);
        assert_eq!(sections::from_pack(&pack_of(&environment), "sky").unwrap(), environment);
    }
}

#[test]
fn bad_pixels_are_named_and_negative_ones_counted() {
    for (value, name) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (1e30, "1e30")] {
        let mut pixels = vec![[1.0; 3]; 8 * 4];
        pixels[2 * 8 + 5][1] = value;
        let Err(BakeError::BadInput(message)) = EnvironmentImage::new(8, 4, pixels) else { panic!("{name} was taken") };
        assert!(message.contains("pixel (5, 2)") && message.contains("green"), "{message}");
    }
    let mut pixels = vec![[1.0; 3]; 8 * 4];
    pixels[9][2] = -0.5;
    pixels[11] = [-1.0; 3];
    let image = EnvironmentImage::new(8, 4, pixels).unwrap();
    let report = image.report;
    assert_eq!((report.negative_pixels, report.first_negative), (2, Some((1, 1))));
    assert_eq!((image.pixels[9], image.pixels[11]), ([1.0, 1.0, 0.0], [0.0; 3]));
    for (width, height) in [(8, 8), (6, 1), (4, 4), (100, 40)] {
        let pixels = vec![[1.0; 3]; (width * height) as usize];
        let Err(BakeError::BadInput(message)) = EnvironmentImage::new(width, height, pixels) else { panic!() };
        assert!(message.contains("twice as many columns"), "{message}");
    }
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let image = sunny(96, 48, 1e5);
    let options = EnvironmentOptions { coloured: true, ..options(5) };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| baked(&image, &options))
    };
    let one = on(1);
    for threads in [2, 7] {
        assert!(one == on(threads), "{threads} threads");
    }
}

#[test]
fn impossible_options_are_refused_by_their_name() {
    let image = image_of(8, 4, |_| [1.0; 3]);
    let base = options(4);
    for (options, name) in [
        (EnvironmentOptions { face_size: 12, ..base }, "face-size:"),
        (EnvironmentOptions { face_size: 2, ..base }, "face-size:"),
        (EnvironmentOptions { min_face_size: 32, ..base }, "min-face-size:"),
        (EnvironmentOptions { levels: LevelCount::Exactly(0), ..base }, "levels:"),
        (EnvironmentOptions { levels: LevelCount::Exactly(17), ..base }, "levels:"),
        (EnvironmentOptions { levels: LevelCount::Fewest(f64::NAN), ..base }, "max-moment-error:"),
        (EnvironmentOptions { levels: LevelCount::Exactly(1), coloured: true, ..base }, "coloured:"),
        (EnvironmentOptions { max_error: 0.0, ..base }, "max-error:"),
        (EnvironmentOptions { floor: 0.0, ..base }, "floor:"),
    ] {
        let Err(BakeError::BadOption(message)) = bake(&image, &options, &Silent) else { panic!("{name}") };
        assert!(message.starts_with(name), "{message}");
    }
}
