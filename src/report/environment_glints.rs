//! Glints under environments: what is baked and drawn, against explicitly placed facets.

use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glam::DVec3;
use glint_bake_core::counting::eval::unit_from_bits;
use glint_bake_core::environment::eval::{Chances, Surface, environment_glints};
use glint_bake_core::environment::image::luminance;
use glint_bake_core::environment::options::LevelCount;
use glint_bake_core::environment::quality::relative_variance;
use glint_bake_core::environment::reference::{FacetMoments, FacetSurface};
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, bake, eval};
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::environment::LevelChoice;
use rayon::prelude::*;

const ENVIRONMENTS: [&str; 3] = ["noon_grass_1k.hdr", "dancing_hall_1k.hdr", "potsdamer_platz_1k.hdr"];
/// √α, as the paper names roughness.
const ROUGHNESSES: [f64; 3] = [0.2, 0.5, 0.7];
/// Facets a pixel.
const DENSITIES: [f32; 3] = [0.1, 10.0, 1000.0];
const LEVELS: [u32; 5] = [1, 2, 4, 8, 16];
const PAPER_LEVELS: [u32; 3] = [4, 8, 16];
/// Seeded surfaces of every environment and roughness, seen at 0° and at up to [`MAX_DEGREES`] from their normal.
const SURFACES: u32 = 8;
/// Largest angle of view.
const MAX_DEGREES: f64 = 60.0;
const FACE_SIZE: u32 = 128;
/// Draws, and patches of placed facets.
const PATCHES: u32 = 2000;

/// Files of the environments that are measured.
fn files(settings: &Settings) -> Vec<String> {
    ENVIRONMENTS[..settings.pick(ENVIRONMENTS.len(), 1)].iter().map(|name| format!("hdri/{name}")).collect()
}

/// Says why the report cannot be made.
pub fn check(settings: &Settings) -> Result<(), Failure> {
    settings.check(files(settings).iter().map(String::as_str))
}

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let scale = Scale { surfaces: settings.pick(SURFACES, 2), patches: settings.pick(PATCHES, 50) };
    let mut document = Document::new("environment-glints", "Glints under environments", settings);
    document.paragraph(format!(
        "Against facets placed one by one, each a mirror that takes the radiance of one pixel of the source: exact mean and \
         variance of what a facet reflects, in f64. {} seeded surfaces of every environment and roughness, F₀ 0.6, faces of \
         {FACE_SIZE} texels. Errors are sums of absolute errors over the surfaces, over the sum of what is exact: a surface \
         that sees the sun counts more than one that sees the sky.",
        scale.surfaces
    ));
    let mut all = Vec::new();
    for (file, name) in files(settings).iter().zip(ENVIRONMENTS) {
        settings.terminal.say(&format!("environment-glints: {name}"));
        let image = settings.environment(&settings.data(file)?)?;
        let optimal = LEVELS.map(|levels| baked(&image, levels, LevelChoice::Optimal));
        let paper = PAPER_LEVELS.map(|levels| baked(&image, levels, LevelChoice::LogUniform));
        let baked = optimal.into_iter().chain(paper).collect::<Result<Vec<Environment>, Failure>>()?;
        all.push(Subject { name, image, baked });
    }
    document.heading(2, "Variance of glint radiance");
    document.paragraph(
        "*ours*: optimal levels, and the second moment that is filtered besides radiance; *levels alone*: without it; *paper*: \
         log-uniform levels. Seen along the normal, a filtered map is the reflection up to F. At an angle one round look-up stands \
         for a lobe that is longer than wide and ends at the surface's own horizon: that decides the error there, whatever the levels.",
    );
    let mut panels = Vec::new();
    for max_degrees in [0.0, MAX_DEGREES] {
        document.heading(3, &format!("Seen at up to {max_degrees}° from the normal"));
        let curves = variances(&mut document, &all, max_degrees, scale);
        panels.push(panel(max_degrees, curves));
    }
    let figure = Figure { title: String::new(), panels, columns: 2, panel_size: (400, 300) };
    document.plot("", "error of the variance by number of levels", &figure);
    draws(&mut document, &all, scale);
    Ok(document)
}

/// How much is measured.
#[derive(Clone, Copy)]
struct Scale {
    /// Seeded surfaces of every environment and roughness.
    surfaces: u32,
    /// Draws, and patches of placed facets.
    patches: u32,
}

/// An environment, and what is baked of it: ours with each of [`LEVELS`], then the paper's with each of [`PAPER_LEVELS`].
struct Subject {
    name: &'static str,
    image: EnvironmentImage,
    baked: Vec<Environment>,
}

/// Errors of the variance over numbers of levels, mean over environments and roughnesses.
struct Curves {
    ours: Vec<(f64, f64)>,
    alone: Vec<(f64, f64)>,
    paper: Vec<(f64, f64)>,
}

fn panel(max_degrees: f64, curves: Curves) -> Panel {
    Panel {
        title: format!("seen at up to {max_degrees}°"),
        x: Axis::logarithmic("levels K", (1.0, 16.0)).ticks(&[1.0, 2.0, 4.0, 8.0, 16.0]),
        y: Axis::logarithmic("relative error of the variance", (0.01, 100.0)),
        series: vec![
            Series::line("paper", Colour::Vermilion, curves.paper),
            Series::line("optimal levels alone", Colour::Green, curves.alone),
            Series::line("ours", Colour::Blue, curves.ours),
        ],
    }
}

/// Error of the mean, and of the variance by every choice of levels.
fn variances(document: &mut Document, all: &[Subject], max_degrees: f64, scale: Scale) -> Curves {
    let mut table = Table::new(
        1,
        "environment | √α | mean | ours, K = 1 | 2 | 4 | 8 | 16 | levels alone, K = 4 | 8 | paper, K = 4 | 8 | 16",
    );
    let (ours, alone, paper) = ([0, 1, 2, 3, 4], [2, 3], [5, 6, 7]);
    let mut sums = [0.0; LEVELS.len() + 2 + PAPER_LEVELS.len()];
    for Subject { name, image, baked } in all {
        for root in ROUGHNESSES {
            let exact: Vec<FacetMoments> = exact_moments(image, root * root, max_degrees, scale.surfaces);
            let chances = |environment: &Environment, k: usize| {
                eval::chances(environment, &drawn(k, root * root, max_degrees, scale.surfaces, 1.0))
            };
            let mean = error_of(
                exact.iter().enumerate().map(|(k, m)| [brightness(chances(&baked[2], k).smooth_radiance), m.mean]),
            );
            let variance = |environment: &Environment, std_factor: Option<f32>| {
                error_of(exact.iter().enumerate().map(|(k, m)| {
                    let chances = chances(environment, k);
                    let chances = Chances { std_factor: std_factor.unwrap_or(chances.std_factor), ..chances };
                    let smooth = brightness(chances.smooth_radiance);
                    let drawn = f64::from(relative_variance(&chances, 1.0)) * smooth * smooth;
                    [drawn, m.relative_variance(1.0) * m.mean * m.mean]
                }))
            };
            let ours = ours.iter().map(|&k| variance(&baked[k], None));
            let without = alone.iter().chain(&paper).map(|&k| variance(&baked[k], Some(1.0)));
            let mut row = format!("{name} | {root} | {mean:.3}");
            for (sum, error) in sums.iter_mut().zip(ours.chain(without)) {
                *sum += error / (all.len() * ROUGHNESSES.len()) as f64;
                row += &format!(" | {error:.3}");
            }
            table.row(row);
        }
    }
    document.table(&table);
    let curve =
        |levels: &[u32], errors: &[f64]| levels.iter().map(|k| f64::from(*k)).zip(errors.iter().copied()).collect();
    let (ours, rest) = sums.split_at(LEVELS.len());
    Curves { ours: curve(&LEVELS, ours), alone: curve(&[4, 8], &rest[..2]), paper: curve(&PAPER_LEVELS, &rest[2..]) }
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
fn draws(document: &mut Document, all: &[Subject], scale: Scale) {
    let patches = scale.patches;
    document.heading(2, "Draws against placed facets");
    document.paragraph(format!(
        "{patches} draws, K = 4, and {patches} patches of placed facets, seen along the normal: their means over the exact \
         smooth reflection, and the Wasserstein distance of their luminances over it. *Noise*: the distance of two lots of \
         placed patches. A sun is too rare to be met at these counts of facets and patches: what both lots show is the sky."
    ));
    let mut table = Table::new(1, "environment | √α | facets | mean drawn | mean placed | distance | noise");
    for Subject { name, image, baked } in all {
        for root in ROUGHNESSES {
            let surface = surface(0, root * root, 0.0, scale.surfaces);
            let smooth = surface.moments(image).mean;
            for facets in DENSITIES {
                let drawn = drawn_lot(&baked[2], &drawn(0, root * root, 0.0, scale.surfaces, facets), patches, smooth);
                let lots = [2, 3].map(|seed| placed_lot(&surface, image, f64::from(facets), seed, patches, smooth));
                let mean = |lot: &[f64]| lot.iter().sum::<f64>() / lot.len() as f64;
                table.row(format!(
                    "{name} | {root} | {facets} | {:.3} | {:.3} | {:.3} | {:.3}",
                    mean(&drawn),
                    mean(&lots[0]),
                    distance(&drawn, &lots[0]),
                    distance(&lots[1], &lots[0])
                ));
            }
        }
    }
    document.table(&table);
}

/// Wasserstein distance of two sorted lots of equal size.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len() as f64
}

/// Luminances of placed patches over `smooth`, sorted. A fraction of a facet is there by chance.
fn placed_lot(
    surface: &FacetSurface,
    image: &EnvironmentImage,
    facets: f64,
    seed: u64,
    patches: u32,
    smooth: f64,
) -> Vec<f64> {
    let mut values: Vec<f64> = (0..patches)
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
fn drawn_lot(environment: &Environment, surface: &Surface, patches: u32, smooth: f64) -> Vec<f64> {
    let mut values: Vec<f64> = (0..patches)
        .map(|draw| {
            let mut rng = ItemRng::new(1, Purpose::GlintReport, draw);
            let words = std::array::from_fn(|_| unit_from_bits(rng.bits()));
            brightness(environment_glints(environment, surface, &words)) / smooth
        })
        .collect();
    values.sort_by(f64::total_cmp);
    values
}

fn baked(image: &EnvironmentImage, levels: u32, level_choice: LevelChoice) -> Result<Environment, Failure> {
    let options = EnvironmentOptions {
        face_size: FACE_SIZE,
        levels: LevelCount::Exactly(levels),
        level_choice,
        measured_reads: 0,
        ..EnvironmentOptions::default()
    };
    Ok(bake(image, &options, &Silent)?)
}

fn exact_moments(image: &EnvironmentImage, alpha: f64, max_degrees: f64, surfaces: u32) -> Vec<FacetMoments> {
    let of = |k| surface(k as usize, alpha, max_degrees, surfaces).moments(image);
    (0..surfaces).into_par_iter().map(of).collect()
}

/// Seeded surface number `k` of so many.
fn surface(k: usize, alpha: f64, max_degrees: f64, surfaces: u32) -> FacetSurface {
    let mut rng = ItemRng::new(0, Purpose::GlintReport, k as u32);
    let height = 2.0 * rng.unit() - 1.0;
    let turn = std::f64::consts::TAU * rng.unit();
    let level = (1.0 - height * height).sqrt();
    let normal = DVec3::new(level * turn.cos(), height, level * turn.sin());
    let angle = (max_degrees * k as f64 / f64::from(surfaces - 1)).to_radians();
    let view = normal * angle.cos() + normal.any_orthonormal_vector() * angle.sin();
    FacetSurface { normal, view, alpha, f0: 0.6 }
}

fn drawn(k: usize, alpha: f64, max_degrees: f64, surfaces: u32, facets: f32) -> Surface {
    let surface = surface(k, alpha, max_degrees, surfaces);
    Surface {
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
