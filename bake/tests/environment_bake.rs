//! Baked environments against the definition: orientation, accuracy with a sun, hard inputs, and the same bytes again.

use glam::DVec3;
use glint_bake_core::environment::cube::texel_direction;
use glint_bake_core::environment::image::{direction, luminance};
use glint_bake_core::environment::options::LevelCount;
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, bake, quality, reads, sections};
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
        per_size: 2,
        levels: LevelCount::Exactly(levels),
        measured_reads: 16,
        ..EnvironmentOptions::default()
    }
}

fn baked(image: &EnvironmentImage, options: &EnvironmentOptions) -> Environment {
    bake(image, options, &Silent).unwrap()
}

fn all_finite(environment: &Environment) -> bool {
    let params = &environment.params;
    (0..=params.filtered()).all(|index| {
        let size = params.size(index);
        (0..6 * size * size).all(|k| {
            let (face, i, j) = ((k / (size * size)) as usize, k % size, k / size % size);
            environment.radiance_texel(index, face, i, j).iter().all(|v| v.is_finite() && *v >= 0.0)
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
    // Colour tells the direction, so any flip or swap shows in every texel. The lobe of the first roughness blurs it by a little.
    let image = image_of(256, 128, |d| [1.0 + d.x as f32, 1.0 + d.y as f32, 1.0 + d.z as f32]);
    let environment = baked(&image, &options(4));
    for (index, most) in [(0, 0.03), (1, 0.1)] {
        let size = environment.params.size(index);
        for (face, [centre, right, down]) in FACES.into_iter().map(|face| face.map(DVec3::from)).enumerate() {
            for (i, j) in [(0, 0), (size - 1, 0), (0, size - 1), (size - 1, size - 1), (size / 2, size / 4)] {
                let [s, t] = [i, j].map(|k| 2.0 * (f64::from(k) + 0.5) / f64::from(size) - 1.0);
                let expected = DVec3::ONE + (centre + right * s + down * t).normalize();
                let found = environment.radiance_texel(index, face, i, j);
                for c in 0..3 {
                    let difference = f64::from(found[c]) - expected[c];
                    assert!(
                        difference.abs() < most,
                        "roughness {index} face {face} ({i}, {j}): {found:?}, expected {expected}"
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

/// Luminance that the sun of [`sunny`] at 1e6 gives a texel under GGX alone, without an end at the horizon, and its mean square.
fn whole_sun(compared: &quality::Compared, alpha: f64, size: u32) -> [f64; 2] {
    let (face, i, j) = compared.texel;
    let sun = DVec3::new(0.3, 0.5, -0.6).normalize();
    let (a, t) = (alpha * alpha, 1.0 - texel_direction(face, i, j, size).dot(sun));
    let b = 0.5 * (1.0 - a);
    let weight = (a / (a + b * t)).powi(2) / (2.0 * PI * a / (a + b));
    let share = 2.0 * PI * (1.0 - 0.996) * weight;
    let light = luminance([1e6, 0.9e6, 0.8e6]);
    [share * light, share * light * light]
}

#[test]
fn every_roughness_is_as_near_to_the_definition_as_was_asked() {
    let image = sunny(128, 64, 1e6);
    for kernel in [Kernel::Ndf, Kernel::GgxNl, Kernel::GgxSoft] {
        let options = EnvironmentOptions { kernel, face_size: 64, measured_reads: 0, ..options(4) };
        let environment = baked(&image, &options);
        assert!(environment.params.measured.energy < 1e-4, "{}", environment.params.measured.energy);
        let mean = luminance(image.mean());
        for index in 1..=environment.params.filtered() {
            let compared = quality::compare(&image, &environment, index, 24);
            // Where kernels end they take parts of a sun, whose errors are ones of what it would give whole.
            let alpha = environment.params.roughness[index as usize];
            let beside = |c: &quality::Compared| whole_sun(c, alpha, environment.params.size(index));
            let mut error = quality::error_of(&compared, mean);
            let share = |c: &quality::Compared| c.error().abs() / (c.exact.luminance + beside(c)[0]);
            error.worst = compared.iter().map(share).fold(0.0, f64::max);
            let (rmse, worst) = if alpha < 0.04 { (0.02, 0.25) } else { (0.005, 0.05) };
            assert!(error.rmse <= rmse && error.worst <= worst, "{kernel:?} roughness {index}: {error:?}");
            for c in &compared {
                let square = f64::from(c.stored[3]).powi(2);
                let share = (square - c.exact.square).abs() / (c.exact.square + beside(c)[1]);
                assert!(share < worst, "{kernel:?} roughness {index} {:?}: {share}", c.texel);
            }
        }
    }
}

#[test]
fn the_mirror_keeps_areas_and_energy() {
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
            for index in 0..=white.params.filtered() {
                let texel = white.radiance_texel(index, 3, 0, 0);
                assert!(texel.iter().all(|v| (v - 2.0).abs() < 0.008), "{levels} roughness {index}: {texel:?}");
                assert_eq!(black.radiance_texel(index, 3, 0, 0), [0.0; 4]);
                if levels > 1 && index > 0 {
                    let last = (levels as usize - 2) / 4;
                    let share = |e: &Environment| e.indicator_texel(last, index, 3, 0, 0)[(levels as usize - 2) % 4];
                    assert!(share(&white) > 0.995, "{levels} {choice:?} roughness {index}: {}", share(&white));
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
        let options = EnvironmentOptions { coloured: true, measured_reads: 64, ..options(8) };
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
        (EnvironmentOptions { min_face_size: 16, ..base }, "min-face-size:"),
        (EnvironmentOptions { per_size: 0, ..base }, "roughnesses:"),
        (EnvironmentOptions { per_size: 9, ..base }, "roughnesses:"),
        (EnvironmentOptions { levels: LevelCount::Exactly(0), ..base }, "levels:"),
        (EnvironmentOptions { levels: LevelCount::Exactly(17), ..base }, "levels:"),
        (EnvironmentOptions { levels: LevelCount::Fewest(f64::NAN), ..base }, "max-moment-error:"),
        (EnvironmentOptions { levels: LevelCount::Exactly(1), coloured: true, ..base }, "coloured:"),
        (EnvironmentOptions { filter_error: 0.0, ..base }, "filter-error:"),
        (EnvironmentOptions { max_error: Some(0.0), ..base }, "max-error:"),
        (EnvironmentOptions { max_error: Some(0.01), measured_reads: 0, ..base }, "max-error:"),
        (EnvironmentOptions { floor: 0.0, ..base }, "floor:"),
    ] {
        let Err(BakeError::BadOption(message)) = bake(&image, &options, &Silent) else { panic!("{name}") };
        assert!(message.starts_with(name), "{message}");
    }
}

/// What a shader reads lies between texels and between roughnesses. A sky with a sun is read to the error that is recorded, and a bake
/// that is asked for less fails.
#[test]
fn what_is_read_between_texels_and_roughnesses_has_the_error_that_is_recorded() {
    let image = sunny(128, 64, 1e4);
    let options = EnvironmentOptions {
        face_size: 64,
        min_face_size: 16,
        per_size: 8,
        levels: LevelCount::Exactly(1),
        measured_reads: 512,
        ..options(1)
    };
    let environment = baked(&image, &options);
    let [sharp, rest] = environment.params.measured.reads[..] else { panic!("two entries") };
    println!("below .04 {sharp:?}, from there on {rest:?}");
    assert_eq!(sharp.count + rest.count, 512);
    // Faces of a quarter of the default's edge: the lobe of .04 is as narrow there as that of .01 is by default.
    assert!(rest.relative < 0.04 && rest.worst < 0.3, "{rest:?}");
    // Other look-ups have the same error, within what so few can tell.
    let others = reads::errors_of(&environment, &reads::random(&image, &environment, (0.01, 1.0), 5, 512))[1];
    assert!((others.relative / rest.relative).ln().abs() < 0.5, "{others:?} {rest:?}");
    // Fewer roughnesses read worse.
    let sparse = baked(&image, &EnvironmentOptions { per_size: 1, ..options });
    assert!(sparse.params.measured.reads[1].relative > 2.0 * rest.relative, "{:?}", sparse.params.measured.reads);
    let asked = |error| bake(&image, &EnvironmentOptions { max_error: Some(error), ..options }, &Silent);
    let least = rest.relative.max(sharp.relative / 3.0);
    assert!(asked(1.01 * least).is_ok());
    let Err(BakeError::LimitExceeded(message)) = asked(0.99 * least) else { panic!("a missed error was let pass") };
    assert!(message.contains("--max-error"), "{message}");
}
