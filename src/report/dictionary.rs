//! Speed against error of the slope dictionary. Its headline stands in the README as well.

use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glam::{DVec2, Vec2, Vec3};
use glint_bake_core::brdf::{masking, normal_to_slope, sdf_to_ndf};
use glint_bake_core::dictionary::baked::{Dictionary, Tables};
use glint_bake_core::dictionary::eval::{
    DictionaryMaterial, TARGET_BECKMANN, TARGET_GGX, cell_sdf, patch_sdf, slope_query,
};
use glint_bake_core::dictionary::quality::{LevelQuality, domain_floor, measure_level};
use glint_bake_core::dictionary::reference::smooth_density;
use glint_bake_core::dictionary::{DictionaryOptions, bake};
use glint_bake_core::footprint::PixelOnSurface;
use glint_bake_core::hash::cell_state;
use glint_bake_core::progress::Silent;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;
use std::time::Instant;

/// How the headline starts, here and in the README.
pub const HEADLINE: &str = "Default dictionary (";

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let options = DictionaryOptions::default();
    let dictionary = bake(&options, &Silent)?;
    let levels: Vec<LevelQuality> = (0..options.levels).map(|level| measure_level(&dictionary, level)).collect();
    let mut document = Document::new("dictionary", "Slope dictionary: speed against error", settings);
    document.headline(&headline(&options, &levels)?);
    document.plot("", "error by level", &figure(&levels));
    by_level(&mut document, &levels);
    by_size(&mut document, &options, settings)?;
    queries(&mut document, &dictionary.tables(), settings);
    furnaces(&mut document, &dictionary.tables(), settings);
    Ok(document)
}

/// Least time of eight bakes, in seconds. The bake has one thread, so on a quiet machine this is its processor time.
fn bake_seconds(options: &DictionaryOptions) -> Result<(Dictionary, f64), Failure> {
    let mut least = f64::MAX;
    let mut dictionary = bake(options, &Silent)?;
    for _ in 0..8 {
        let start = Instant::now();
        dictionary = bake(options, &Silent)?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok((dictionary, least))
}

fn headline(options: &DictionaryOptions, levels: &[LevelQuality]) -> Result<String, Failure> {
    let (dictionary, seconds) = bake_seconds(options)?;
    let normalisation = levels.iter().map(|q| q.normalisation).fold(0.0, f64::max);
    let last = levels[levels.len() - 1];
    Ok(format!(
        "{HEADLINE}{} marginals × {} levels × {} entries): **{:.0} KiB, baked in {:.3} s on one core**, worst \
         normalisation error {normalisation:.1e}, L1 of the mean at level 0 {:.4}, KS at the last level {:.5} (mean over \
         marginals) and {:.1e} (of the mean; the end of the domain alone leaves {:.1e}).",
        options.marginals,
        options.levels,
        options.entries,
        (4 * dictionary.pairs().len()) as f64 / 1024.0,
        seconds,
        levels[0].l1_of_mean,
        last.ks_mean,
        last.ks_of_mean,
        domain_floor()
    ))
}

fn by_level(document: &mut Document, levels: &[LevelQuality]) {
    document.heading(2, "By level");
    document.paragraph(
        "L1 and KS to the target marginal. Contrast is the standard deviation over marginals as a share of the \
         density (root mean squares over slopes); the ratio compares it with independent lobe means in closed form.",
    );
    let mut table = Table::new(
        0,
        "level | L1 mean | L1 worst | KS mean | KS worst | L1 of mean | KS of mean | contrast | ratio | normalisation",
    );
    for (level, q) in levels.iter().enumerate() {
        table.row(format!(
            "{level} | {:.4} | {:.4} | {:.5} | {:.5} | {:.5} | {:.6} | {:.4} | {:.3} | {:.1e}",
            q.l1_mean,
            q.l1_worst,
            q.ks_mean,
            q.ks_worst,
            q.l1_of_mean,
            q.ks_of_mean,
            q.contrast,
            q.contrast_ratio,
            q.normalisation
        ));
    }
    document.table(&table);
}

fn by_size(document: &mut Document, default: &DictionaryOptions, settings: &Settings) -> Result<(), Failure> {
    document.heading(2, "By size of the dictionary");
    document.paragraph(
        "One cell: mean L1 of 16 cells at the last level to the smooth target, in two dimensions. Worst contrast: the \
         level whose ratio is farthest from 1. ★: no other row has both fewer bytes and a nearer cell.",
    );
    let mut table = Table::new(
        0,
        "marginals | levels | entries | KiB | bake ms | L1 of mean, level 0 | KS mean, last | KS of mean, last | \
         one cell Beckmann | one cell GGX | worst contrast | normalisation | ",
    );
    let mut all = Vec::new();
    for marginals in [48, 96, 192, 384] {
        all.push(DictionaryOptions { marginals, ..*default });
    }
    for levels in [10, 12, 14, 18] {
        all.push(DictionaryOptions { levels, ..*default });
    }
    for entries in [32, 48, 128] {
        all.push(DictionaryOptions { entries, ..*default });
    }
    all.truncate(settings.pick(usize::MAX, 2));
    let mut rows = Vec::new();
    for options in all {
        let (dictionary, seconds) = bake_seconds(&options)?;
        let tables = dictionary.tables();
        let bytes = 4 * dictionary.pairs().len();
        let mut worst: f64 = 1.0;
        let mut normalisation: f64 = 0.0;
        for level in 0..options.levels {
            let q = measure_level(&dictionary, level);
            normalisation = normalisation.max(q.normalisation);
            if (q.contrast_ratio - 1.0).abs() > (worst - 1.0).abs() {
                worst = q.contrast_ratio;
            }
        }
        let first = measure_level(&dictionary, 0);
        let last = measure_level(&dictionary, options.levels - 1);
        let beckmann = one_cell_l1(&tables, TARGET_BECKMANN);
        let text = format!(
            "{} | {} | {} | {:.0} | {:.1} | {:.4} | {:.5} | {:.6} | {beckmann:.4} | {:.4} | {worst:.3} | {normalisation:.1e}",
            options.marginals,
            options.levels,
            options.entries,
            bytes as f64 / 1024.0,
            seconds * 1e3,
            first.l1_of_mean,
            last.ks_mean,
            last.ks_of_mean,
            one_cell_l1(&tables, TARGET_GGX)
        );
        rows.push((bytes, beckmann, text));
    }
    for (bytes, error, text) in &rows {
        let beaten = rows.iter().any(|(b, e, _)| b <= bytes && e <= error && (b < bytes || e < error));
        table.row(format!("{text} | {}", if beaten { "" } else { "★" }));
    }
    document.table(&table);
    Ok(())
}

fn material(target: u32, alpha: f32, density: f32, max_anisotropy: f32) -> DictionaryMaterial {
    DictionaryMaterial {
        alpha: Vec2::splat(alpha),
        normal_target: target,
        density,
        relative_area: 1.0,
        density_randomisation: 0.01,
        max_anisotropy,
        seed: 3,
        colours: Vec::new(),
        mean_colour: Vec3::ONE,
    }
}

/// Mean over 16 cells of ∫|cell − target| at the last level, over equal shares of the target.
fn one_cell_l1(tables: &Tables, target: u32) -> f64 {
    let mut m = material(target, 0.5, 1e9, 4.0);
    m.density_randomisation = 0.0;
    let ggx = target == TARGET_GGX;
    let n = 200;
    let mut sum = 0.0;
    for cell in 0..16u32 {
        for a in 0..n {
            let u = (a as f64 + 0.5) / n as f64;
            let r = if ggx { (u / (1.0 - u)).sqrt() } else { (-libm::log1p(-u)).sqrt() };
            for b in 0..2 * n {
                let slope = DVec2::from_angle((b as f64 + 0.5) / n as f64 * PI) * r * 0.5;
                let level = (tables.levels - 1) as f32;
                let value = f64::from(
                    cell_sdf(
                        tables,
                        &m,
                        cell_state(cell * 977, cell, m.seed),
                        level,
                        &slope_query(tables, &m, slope.as_vec2()),
                    )
                    .sdf
                    .x,
                );
                sum += (value / smooth_density(ggx, DVec2::splat(0.5), slope) - 1.0).abs();
            }
        }
    }
    sum / (16 * 2 * n * n) as f64
}

fn queries(document: &mut Document, tables: &Tables, settings: &Settings) {
    let count = settings.pick(20_000, 2_000);
    document.heading(2, "A query at run time");
    document.paragraph(format!(
        "One evaluation of the slope distribution on one core, least of five passes over {count} random pixels, \
         footprints of 1 to 64 cells of level 0. Each cell reads four texels of two bytes."
    ));
    let mut table = Table::new(
        1,
        "target | footprint anisotropy | γ | ns | ns a cell | cells mean | cells most | bytes read, mean",
    );
    let unit = 2f32.powi(1 - tables.levels as i32);
    for (target, name) in [(TARGET_BECKMANN, "Beckmann"), (TARGET_GGX, "GGX")] {
        for (stretch, ratio) in [(1.0f32, 4.0f32), (4.0, 4.0), (8.0, 8.0), (1000.0, 8.0), (16.0, 16.0)] {
            let mut rng = Pcg64::seed_from_u64(1);
            let mut uniform = || (rng.next_u32() >> 8) as f32 / 16_777_216.0;
            let mut pixels = Vec::new();
            for _ in 0..count {
                let size = (6.0 * uniform()).exp2() * unit;
                let axis = Vec2::from_angle(std::f32::consts::TAU * uniform());
                pixels.push(PixelOnSurface {
                    position: Vec2::new(uniform(), uniform()),
                    d_dx: axis * size * stretch,
                    d_dy: axis.perp() * size,
                });
            }
            let m = material(target, 0.5, 1e9, ratio);
            let (mut least, mut cells, mut most, mut sum) = (f64::MAX, 0u64, 0, 0.0);
            for _ in 0..5 {
                let start = Instant::now();
                (cells, most) = (0, 0);
                for pixel in &pixels {
                    let found = patch_sdf(tables, &m, *pixel, Vec2::new(0.2, -0.1));
                    cells += u64::from(found.cells);
                    most = found.cells.max(most);
                    sum += f64::from(found.sdf.x);
                }
                least = least.min(start.elapsed().as_secs_f64());
            }
            assert!(sum > 0.0);
            let mean = cells as f64 / pixels.len() as f64;
            let ns = least * 1e9 / pixels.len() as f64;
            table.row(format!(
                "{name} | {stretch} | {ratio} | {ns:.0} | {:.1} | {mean:.1} | {most} | {:.0}",
                ns / mean,
                8.0 * mean
            ));
        }
    }
    document.table(&table);
}

fn furnaces(document: &mut Document, tables: &Tables, settings: &Settings) {
    let rings = settings.pick(384, 96);
    document.heading(2, "Weak white furnace");
    document.paragraph(format!(
        "Worst relative error over ln ρ = 14, 18, 22, 26 and ζ = 0.01, 2, by quadrature of the f32 run time over half \
         vectors ({rings} rings, {} directions). What is left is the quadrature's: slopes m and −m add up to the same for \
         every α and θ.",
        2 * rings
    ));
    let mut table = Table::new(1, "target | α | θ = 0 | θ = π/4 | θ = 1.56");
    let step = 2f32.powi(-12);
    let pixel = PixelOnSurface {
        position: Vec2::new(0.213, 0.577),
        d_dx: Vec2::new(1.3 * step, 0.2 * step),
        d_dy: Vec2::new(-0.4 * step, step),
    };
    for (target, name) in [(TARGET_BECKMANN, "Beckmann"), (TARGET_GGX, "GGX")] {
        for alpha in [0.01, 0.1, 0.5, 1.0] {
            let mut worst = [0.0f64; 3];
            for log_density in [14.0f32, 18.0, 22.0, 26.0] {
                for zeta in [0.01, 2.0] {
                    let mut m = material(target, alpha, log_density.exp(), 4.0);
                    m.density_randomisation = zeta;
                    let sums = furnace(tables, &m, pixel, rings);
                    for k in 0..3 {
                        worst[k] = worst[k].max((sums[k] - 1.0).abs());
                    }
                }
            }
            table.row(format!("{name} | {alpha} | {:.5} | {:.5} | {:.5}", worst[0], worst[1], worst[2]));
        }
    }
    document.table(&table);
}

/// ∫ G₁(o, h) D(h) (o·h) / (o·n) dω_h at θ = 0, π/4 and 1.56, over `n` rings of 2 `n` directions.
fn furnace(tables: &Tables, m: &DictionaryMaterial, pixel: PixelOnSurface, n: usize) -> [f64; 3] {
    let ring = 4.0 / n as f64;
    let alpha = f64::from(m.alpha.x);
    let mut sums = [0.0; 3];
    for a in 0..n {
        let t = (a as f64 + 0.5) * ring;
        let ggx = m.normal_target == TARGET_GGX;
        let r = if ggx { libm::expm1(t * t).sqrt() } else { t };
        let r_dr = if ggx { t * libm::exp(t * t) } else { t } * ring;
        for b in 0..2 * n {
            let slope = DVec2::from_angle((b as f64 + 0.37) / n as f64 * PI) * r * alpha;
            let z = 1.0 / (1.0 + slope.length_squared()).sqrt();
            let h = Vec3::new((-slope.x * z) as f32, (-slope.y * z) as f32, z as f32);
            let sdf = patch_sdf(tables, m, pixel, normal_to_slope(h)).sdf;
            let d = f64::from(sdf_to_ndf(sdf, h.z).x);
            let solid_angle = z * z * z * r_dr * PI / n as f64 * alpha * alpha;
            for (k, theta) in [0.0, PI / 4.0, 1.56f64].into_iter().enumerate() {
                let (sin, cos) = theta.sin_cos();
                let o = Vec3::new((sin * 0.8) as f32, (sin * 0.6) as f32, cos as f32);
                sums[k] += f64::from(masking(o, h)) * d * f64::from(o.dot(h)).max(0.0) / cos * solid_angle;
            }
        }
    }
    sums
}

/// Error by level on a logarithmic axis.
fn figure(levels: &[LevelQuality]) -> Figure {
    let last = levels.len() - 1;
    let curve = |name, colour, value: &dyn Fn(&LevelQuality) -> f64| {
        Series::line(name, colour, levels.iter().enumerate().map(|(level, q)| (level as f64, value(q))).collect())
    };
    let every: Vec<f64> = (0..=last).map(|level| level as f64).collect();
    Figure::of(Panel {
        title: String::new(),
        x: Axis::linear("level", (0.0, last as f64), 1).ticks(&every),
        y: Axis::logarithmic("", (1e-5, 10.0)),
        series: vec![
            curve("L1 mean", Colour::Green, &|q| q.l1_mean),
            curve("KS mean", Colour::Blue, &|q| q.ks_mean),
            curve("L1 of mean", Colour::Vermilion, &|q| q.l1_of_mean),
            curve("KS of mean", Colour::Purple, &|q| q.ks_of_mean),
            curve("contrast", Colour::Grey, &|q| q.contrast),
        ],
    })
}
