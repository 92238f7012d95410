//! Writes the report on glints under environments: what is baked and drawn, against explicitly placed facets.

use glam::DVec3;
use glint_bake::input::environment::load_environment;
use glint_bake_core::counting::eval::unit_from_bits;
use glint_bake_core::environment::glints::{
    GlintChances, GlintSurface, environment_glints, glint_chances, glint_relative_variance,
};
use glint_bake_core::environment::image::luminance;
use glint_bake_core::environment::options::LevelCount;
use glint_bake_core::environment::reference_glints::{FacetMoments, FacetSurface};
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, bake};
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::environment::LevelChoice;
use rayon::prelude::*;
use std::path::Path;

const ENVIRONMENTS: [&str; 3] = ["noon_grass_1k.hdr", "dancing_hall_1k.hdr", "potsdamer_platz_1k.hdr"];
/// √α, as the paper names roughness.
const ROUGHNESSES: [f64; 3] = [0.2, 0.5, 0.7];
/// Facets a pixel.
const DENSITIES: [f32; 3] = [0.1, 10.0, 1000.0];
const LEVELS: [u32; 5] = [1, 2, 4, 8, 16];
/// Seeded surfaces of every environment and roughness, seen at 0° and at up to [`MAX_DEGREES`] from their normal.
const SURFACES: u32 = 8;
/// Largest angle of view.
const MAX_DEGREES: f64 = 60.0;
const FACE_SIZE: u32 = 128;
/// Draws, and patches of placed facets.
const PATCHES: u32 = 2000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [data] = arguments.as_slice() else {
        eprintln!("usage: glint_report DATA");
        std::process::exit(2);
    };
    println!(
        "# Glints under environments\n\nWritten by `just report`; do not edit. Against facets placed one by one, each a \
         mirror that takes the radiance of one pixel of the source: exact mean and variance of what a facet reflects, in f64. \
         {SURFACES} seeded surfaces of every environment and roughness, F₀ 0.6, faces of {FACE_SIZE} texels. Errors are sums \
         of absolute errors over the surfaces, over the sum of what is exact: a surface that sees the sun counts more than \
         one that sees the sky.\n"
    );
    let loaded: Vec<(&str, EnvironmentImage)> = ENVIRONMENTS
        .into_iter()
        .map(|name| {
            let path = Path::new(data).join("hdri").join(name);
            let loaded = load_environment(&path, 1 << 32).unwrap_or_else(|error| panic!("{error}"));
            (name, loaded.image)
        })
        .collect();
    let baked: Vec<Vec<Environment>> = loaded
        .iter()
        .map(|(_, image)| {
            let optimal = LEVELS.map(|levels| baked(image, levels, LevelChoice::Optimal));
            let paper = [4, 8, 16].map(|levels| baked(image, levels, LevelChoice::LogUniform));
            optimal.into_iter().chain(paper).collect()
        })
        .collect();
    println!(
        "## Variance of glint radiance\n\n*ours*: optimal levels, and the second moment that is filtered besides radiance; \
         *levels alone*: without it; *paper*: log-uniform levels. Seen along the normal, a filtered map is the reflection up \
         to F. At an angle it is that of the mirror direction, which is round where a reflection is longer than wide and does \
         not end at the surface's own horizon: that is the method's own limit, whatever the levels."
    );
    for max_degrees in [0.0, MAX_DEGREES] {
        println!("\n### Seen at up to {max_degrees}° from the normal\n");
        let exact: Vec<Vec<Vec<FacetMoments>>> = loaded
            .iter()
            .map(|(_, image)| ROUGHNESSES.map(|root| exact_moments(image, root * root, max_degrees)).to_vec())
            .collect();
        variances(&loaded, &exact, &baked, max_degrees);
    }
    draws(&loaded, &baked);
}

/// Error of the mean, and of the variance by every choice of levels.
fn variances(
    loaded: &[(&str, EnvironmentImage)],
    exact: &[Vec<Vec<FacetMoments>>],
    baked: &[Vec<Environment>],
    max_degrees: f64,
) {
    println!(
        "| environment | √α | mean | ours, K = 1 | 2 | 4 | 8 | 16 | levels alone, K = 4 | 8 | paper, K = 4 | 8 | 16 |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
    );
    for (e, (name, _)) in loaded.iter().enumerate() {
        for (r, root) in ROUGHNESSES.into_iter().enumerate() {
            let chances = |environment: &Environment, k: usize| {
                glint_chances(environment, &drawn(k, root * root, max_degrees, 1.0))
            };
            let exact = &exact[e][r];
            let mean =
                error_of(exact.iter().enumerate().map(|(k, m)| [brightness(chances(&baked[e][2], k).smooth), m.mean]));
            let variance = |environment: &Environment, spread: Option<f32>| {
                error_of(exact.iter().enumerate().map(|(k, m)| {
                    let chances = chances(environment, k);
                    let chances = GlintChances { spread: spread.unwrap_or(chances.spread), ..chances };
                    let smooth = brightness(chances.smooth);
                    let drawn = f64::from(glint_relative_variance(&chances, 1.0)) * smooth * smooth;
                    [drawn, m.relative_variance(1.0) * m.mean * m.mean]
                }))
            };
            let mut row = format!("| {name} | {root} | {mean:.3} |");
            for k in 0..LEVELS.len() {
                row += &format!(" {:.3} |", variance(&baked[e][k], None));
            }
            for k in [2, 3, 5, 6, 7] {
                row += &format!(" {:.3} |", variance(&baked[e][k], Some(1.0)));
            }
            println!("{row}");
        }
    }
}

/// Sum of absolute errors over the sum of exact values, of pairs of found and exact.
fn error_of(pairs: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (mut errors, mut whole) = (0.0, 0.0);
    for [found, exact] in pairs {
        errors += (found - exact).abs();
        whole += exact;
    }
    errors / whole
}

/// Draws against placed facets at three densities.
fn draws(loaded: &[(&str, EnvironmentImage)], baked: &[Vec<Environment>]) {
    println!(
        "\n## Draws against placed facets\n\n{PATCHES} draws, K = 4, and {PATCHES} patches of placed facets, seen along the \
         normal: their means over the exact smooth reflection, and the Wasserstein distance of their luminances over it. \
         *Noise*: the distance of two lots of placed patches. A sun is too rare to be met at these counts of facets and \
         patches: what both lots show is the sky.\n\n\
         | environment | √α | facets | mean drawn | mean placed | distance | noise |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | ---: |"
    );
    for (e, (name, image)) in loaded.iter().enumerate() {
        for root in ROUGHNESSES {
            let surface = surface(0, root * root, 0.0);
            let smooth = surface.moments(image).mean;
            for facets in DENSITIES {
                let drawn = drawn_lot(&baked[e][2], &drawn(0, root * root, 0.0, facets), smooth);
                let lots = [2, 3].map(|seed| placed_lot(&surface, image, f64::from(facets), seed, smooth));
                let mean = |lot: &[f64]| lot.iter().sum::<f64>() / lot.len() as f64;
                println!(
                    "| {name} | {root} | {facets} | {:.3} | {:.3} | {:.3} | {:.3} |",
                    mean(&drawn),
                    mean(&lots[0]),
                    distance(&drawn, &lots[0]),
                    distance(&lots[1], &lots[0])
                );
            }
        }
    }
}

/// Wasserstein distance of two sorted lots of equal size.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len() as f64
}

/// Luminances of placed patches over `smooth`, sorted. A fraction of a facet is there by chance.
fn placed_lot(surface: &FacetSurface, image: &EnvironmentImage, facets: f64, seed: u64, smooth: f64) -> Vec<f64> {
    let mut values: Vec<f64> = (0..PATCHES)
        .into_par_iter()
        .map(|patch| {
            let extra = ItemRng::new(seed, Purpose::GlintReport, patch).unit() < facets.fract();
            let count = facets as u32 + u32::from(extra);
            if count == 0 {
                0.0
            } else {
                surface.placed(image, count, seed, patch) * f64::from(count) / (facets * smooth)
            }
        })
        .collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Luminances of draws over `smooth`, sorted.
fn drawn_lot(environment: &Environment, surface: &GlintSurface, smooth: f64) -> Vec<f64> {
    let mut values: Vec<f64> = (0..PATCHES)
        .map(|draw| {
            let mut rng = ItemRng::new(1, Purpose::GlintReport, draw);
            let words = std::array::from_fn(|_| unit_from_bits(rng.bits()));
            brightness(environment_glints(environment, surface, &words)) / smooth
        })
        .collect();
    values.sort_by(f64::total_cmp);
    values
}

fn baked(image: &EnvironmentImage, levels: u32, level_choice: LevelChoice) -> Environment {
    let options = EnvironmentOptions {
        face_size: FACE_SIZE,
        levels: LevelCount::Exactly(levels),
        level_choice,
        measured_texels: 0,
        ..EnvironmentOptions::default()
    };
    bake(image, 0, &options, &Silent).unwrap_or_else(|error| panic!("{error}"))
}

fn exact_moments(image: &EnvironmentImage, alpha: f64, max_degrees: f64) -> Vec<FacetMoments> {
    (0..SURFACES as usize).into_par_iter().map(|k| surface(k, alpha, max_degrees).moments(image)).collect()
}

/// Seeded surface number `k`.
fn surface(k: usize, alpha: f64, max_degrees: f64) -> FacetSurface {
    let mut rng = ItemRng::new(0, Purpose::GlintReport, k as u32);
    let height = 2.0 * rng.unit() - 1.0;
    let turn = std::f64::consts::TAU * rng.unit();
    let level = (1.0 - height * height).sqrt();
    let normal = DVec3::new(level * turn.cos(), height, level * turn.sin());
    let angle = (max_degrees * k as f64 / f64::from(SURFACES - 1)).to_radians();
    let view = normal * angle.cos() + normal.any_orthonormal_vector() * angle.sin();
    FacetSurface { normal, view, alpha, f0: 0.6 }
}

fn drawn(k: usize, alpha: f64, max_degrees: f64, facets: f32) -> GlintSurface {
    let surface = surface(k, alpha, max_degrees);
    GlintSurface {
        normal: surface.normal.as_vec3(),
        view: surface.view.as_vec3(),
        alpha: alpha as f32,
        f0: surface.f0 as f32,
        facets,
    }
}

fn brightness(rgb: [f32; 3]) -> f64 {
    luminance(rgb.map(f64::from))
}
