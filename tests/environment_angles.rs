//! Surfaces seen at an angle under every image of the data folder, baked as by default: mean and variance of glints with one to three
//! look-ups against explicit facets, and with the paper's one in the mirror direction. `--nocapture` prints the tables.

#[path = "real_maps/folder.rs"]
mod folder;

use glam::DVec3;
use glint_bake::input::environment::load_environment;
use glint_bake_core::environment::eval::{Surface, chances};
use glint_bake_core::environment::image::luminance;
use glint_bake_core::environment::quality::relative_variance;
use glint_bake_core::environment::reference::{FacetMoments, FacetSurface};
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, bake};
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use half::f16;
use rayon::prelude::*;
use std::path::PathBuf;

/// √α, as the paper names roughness.
const ROUGHNESSES: [f64; 3] = [0.2, 0.5, 0.7];
/// Seeded surfaces of every image, angle and roughness.
const SURFACES: u32 = 8;

fn images() -> Option<Vec<PathBuf>> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder::data()?.join("hdri")).ok()?.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    Some(files)
}

fn surface(k: u32, degrees: f64, alpha: f64) -> FacetSurface {
    let mut rng = ItemRng::new(5, Purpose::Test(77), k);
    let height = 2.0 * rng.unit() - 1.0;
    let (turn, aside) = (std::f64::consts::TAU * rng.unit(), std::f64::consts::TAU * rng.unit());
    let level = (1.0 - height * height).sqrt();
    let normal = DVec3::new(level * turn.cos(), height, level * turn.sin());
    let x = normal.any_orthonormal_vector();
    let towards = x * aside.cos() + normal.cross(x) * aside.sin();
    let angle = degrees.to_radians();
    FacetSurface { normal, view: normal * angle.cos() + towards * angle.sin(), alpha, f0: 0.6 }
}

/// Bakes whose filtered maps are the same: with one to three look-ups, and the paper's.
fn environments(image: &EnvironmentImage) -> [Environment; 4] {
    let options = EnvironmentOptions { measured_reads: 0, ..EnvironmentOptions::default() };
    let one = bake(image, &options, &Silent).unwrap();
    // The table depends on no image.
    let tiny = EnvironmentImage::new(4, 2, vec![[1.0; 3]; 8]).unwrap();
    let with = |look_ups: u32| {
        let options = EnvironmentOptions { look_ups, face_size: 4, min_face_size: 2, ..options };
        let mut environment = Environment { albedo: bake(&tiny, &options, &Silent).unwrap().albedo, ..one.clone() };
        environment.params.look_ups = look_ups;
        environment.uniform = environment.params.uniform();
        environment
    };
    let [two, three] = [2, 3].map(with);
    let mut paper = one.clone();
    let texels = paper.albedo.len() / 8;
    let (first, second) = paper.albedo.split_at_mut(4 * texels);
    for (first, second) in first.chunks_exact_mut(4).zip(second.chunks_exact_mut(4)) {
        (first[2], first[3]) = (f16::ZERO.to_bits(), f16::ONE.to_bits());
        let square = f16::from_f32(1.0 / f16::from_bits(second[3]).to_f32()).to_bits();
        second[..3].fill(square);
    }
    [paper, one, two, three]
}

/// Sum of absolute errors over the sum of exact values, of pairs of found and exact.
fn error_of(pairs: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (errors, whole) = pairs.fold((0.0, 0.0), |(e, w), [found, exact]| (e + (found - exact).abs(), w + exact));
    errors / whole
}

/// Errors of mean and variance.
fn errors(environment: &Environment, surfaces: &[FacetSurface], exact: &[FacetMoments]) -> [f64; 2] {
    let found: Vec<[f64; 2]> = surfaces
        .iter()
        .map(|s| {
            let (normal, view) = (s.normal.as_vec3(), s.view.as_vec3());
            let chances =
                chances(environment, &Surface { normal, view, alpha: s.alpha as f32, f0: s.f0 as f32, facets: 1.0 });
            let mean = luminance(chances.smooth_radiance.map(f64::from));
            [mean, f64::from(relative_variance(&chances, 1.0)) * mean * mean]
        })
        .collect();
    let pairs = |k: usize, of: fn(&FacetMoments) -> f64| {
        error_of(found.iter().zip(exact).map(move |(found, exact)| [found[k], of(exact)]))
    };
    [pairs(0, |m| m.mean), pairs(1, |m| m.relative_variance(1.0) * m.mean * m.mean)]
}

/// Errors of one image at an angle, a row a roughness: with the mirror direction, then with one to three look-ups.
fn rows(name: &str, image: &EnvironmentImage, environments: &[Environment; 4], degrees: f64) -> Vec<[[f64; 2]; 4]> {
    let row = |root: f64| {
        let surfaces: Vec<FacetSurface> = (0..SURFACES).map(|k| surface(k, degrees, root * root)).collect();
        let exact: Vec<FacetMoments> = surfaces.par_iter().map(|surface| surface.moments(image)).collect();
        let found = environments.each_ref().map(|environment| errors(environment, &surfaces, &exact));
        let cells = found.map(|[mean, variance]| format!("{mean:.3} / {variance:.3}"));
        println!("| {name} | {degrees}° | {root} | {} |", cells.join(" | "));
        found
    };
    ROUGHNESSES.map(row).to_vec()
}

/// Mean of errors over rows.
fn mean_of(rows: &[[[f64; 2]; 4]]) -> [[f64; 2]; 4] {
    let mean = |k: usize, c: usize| rows.iter().map(|row| row[k][c]).sum::<f64>() / rows.len() as f64;
    [0, 1, 2, 3].map(|k| [mean(k, 0), mean(k, 1)])
}

#[test]
fn look_ups_are_nearer_to_explicit_facets_than_the_mirror_direction() {
    let Some(files) = images() else { return };
    // Mean and variance with one to three look-ups.
    let angles = [
        (0.0, [[0.025, 0.055], [0.015, 0.055], [0.015, 0.055]]),
        (60.0, [[0.155, 0.4], [0.085, 0.28], [0.07, 0.26]]),
        (75.0, [[0.22, 0.53], [0.15, 0.39], [0.11, 0.36]]),
    ];
    let mut all = angles.map(|_| Vec::new());
    for file in &files {
        let image = load_environment(file, None, 1 << 30).unwrap().image;
        let environments = environments(&image);
        let name = file.file_stem().unwrap().to_string_lossy();
        for ((degrees, _), all) in angles.iter().zip(&mut all) {
            let rows = rows(&name, &image, &environments, *degrees);
            let [mirror, fitted @ ..] = mean_of(&rows);
            // At other angles means over all images count: eight surfaces see little of one.
            for found in fitted.into_iter().filter(|_| *degrees == 60.0) {
                assert!(found[0] <= mirror[0] && found[1] <= mirror[1], "{name} at {degrees}°: {found:?} {mirror:?}");
            }
            all.extend(rows);
        }
    }
    for ((degrees, within), all) in angles.iter().zip(&all) {
        let [mirror, fitted @ ..] = mean_of(all);
        println!("{degrees}°, mean of all: mirror direction {mirror:.3?}, look-ups {fitted:.3?}");
        for (found, within) in fitted.iter().zip(within) {
            assert!(found[0] <= within[0] && found[1] <= within[1], "{degrees}°: {found:?} {within:?}");
        }
    }
}
