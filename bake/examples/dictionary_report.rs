//! Speed against error of the slope dictionary, as markdown on stdout; every number is measured in the run.
//!
//! `dictionary_report [--svg FILE [--readme FILE]]` prints the tables, draws error by level, and puts the headline in
//! place of the line of the README that starts like it. `just report` does all three. `dictionary_report --bake-only
//! FILE` bakes the default dictionary, writes its payload and stops, for measuring the process from outside.

use glam::{DVec2, Vec2, Vec3};
use glint_bake_core::brdf::{masking, normal_to_slope, sdf_to_ndf};
use glint_bake_core::dictionary::baked::{Dictionary, Tables};
use glint_bake_core::dictionary::eval::{
    DictionaryMaterial, PixelOnSurface, TARGET_BECKMANN, TARGET_GGX, cell_sdf, patch_sdf, slope_query,
};
use glint_bake_core::dictionary::quality::{LevelQuality, domain_floor, measure_level};
use glint_bake_core::dictionary::reference::smooth_density;
use glint_bake_core::dictionary::{DictionaryOptions, bake};
use glint_bake_core::hash::cell_state;
use glint_bake_core::progress::Silent;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;
use std::fmt::Write;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let options = DictionaryOptions::default();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["--bake-only", file] => {
            let dictionary = bake(&options, &Silent).expect("the default dictionary");
            std::fs::write(file, bytemuck::cast_slice::<u32, u8>(&dictionary.pairs())).expect("writing the payload");
        }
        [] => report(&options, None, None),
        ["--svg", svg] => report(&options, Some(svg), None),
        ["--svg", svg, "--readme", readme] => report(&options, Some(svg), Some(readme)),
        _ => eprintln!("usage: dictionary_report [--svg FILE [--readme FILE] | --bake-only FILE]"),
    }
}

fn report(options: &DictionaryOptions, svg: Option<&str>, readme: Option<&str>) {
    let dictionary = bake(options, &Silent).expect("the default dictionary");
    let mut levels = Vec::new();
    for level in 0..options.levels {
        levels.push(measure_level(&dictionary, level));
    }
    let headline = headline(options, &levels);
    println!("# Slope dictionary: speed against error\n");
    println!("Written by `just report`; do not edit. The plot is [dictionary-report.svg](dictionary-report.svg).\n");
    println!("{headline}\n");
    by_level(&levels);
    sweep(options);
    queries(&dictionary.tables());
    furnaces(&dictionary.tables());
    if let Some(file) = svg {
        std::fs::write(file, plot(&levels)).expect("writing the plot");
    }
    if let Some(file) = readme {
        replace_headline(file, &headline);
    }
}

/// How the headline starts, here and in the README.
const HEADLINE: &str = "Default dictionary (";

fn replace_headline(file: &str, headline: &str) {
    let old = std::fs::read_to_string(file).expect("reading the README");
    assert!(old.lines().any(|line| line.starts_with(HEADLINE)), "{file} has no line that starts with {HEADLINE}");
    let lines = old.lines().map(|line| if line.starts_with(HEADLINE) { headline } else { line });
    let new: String = lines.flat_map(|line| [line, "\n"]).collect();
    std::fs::write(file, new).expect("writing the README");
}

/// Least time of eight bakes, in seconds. The bake has one thread, so on a quiet machine this is its processor time.
fn bake_seconds(options: &DictionaryOptions) -> (Dictionary, f64) {
    let mut least = f64::MAX;
    let mut dictionary = bake(options, &Silent).expect("a dictionary of the sweep");
    for _ in 0..8 {
        let start = Instant::now();
        dictionary = bake(options, &Silent).expect("a dictionary of the sweep");
        least = least.min(start.elapsed().as_secs_f64());
    }
    (dictionary, least)
}

fn headline(options: &DictionaryOptions, levels: &[LevelQuality]) -> String {
    let (dictionary, seconds) = bake_seconds(options);
    let normalisation = levels.iter().map(|q| q.normalisation).fold(0.0, f64::max);
    let last = levels[levels.len() - 1];
    format!(
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
    )
}

fn by_level(levels: &[LevelQuality]) {
    println!("## By level\n");
    println!(
        "L1 and KS to the target marginal. Contrast is the standard deviation over marginals as a share of the \
         density (root mean squares over slopes); the ratio compares it with independent lobe means in closed form.\n"
    );
    println!(
        "| level | L1 mean | L1 worst | KS mean | KS worst | L1 of mean | KS of mean | contrast | ratio | normalisation |"
    );
    println!("| --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |");
    for (level, q) in levels.iter().enumerate() {
        println!(
            "| {level} | {:.4} | {:.4} | {:.5} | {:.5} | {:.5} | {:.6} | {:.4} | {:.3} | {:.1e} |",
            q.l1_mean,
            q.l1_worst,
            q.ks_mean,
            q.ks_worst,
            q.l1_of_mean,
            q.ks_of_mean,
            q.contrast,
            q.contrast_ratio,
            q.normalisation
        );
    }
}

fn sweep(default: &DictionaryOptions) {
    println!("\n## By size of the dictionary\n");
    println!(
        "One cell: mean L1 of 16 cells at the last level to the smooth target, in two dimensions. Worst contrast: the \
         level whose ratio is farthest from 1. ★: no other row has both fewer bytes and a nearer cell.\n"
    );
    println!(
        "| marginals | levels | entries | KiB | bake ms | L1 of mean, level 0 | KS mean, last | KS of mean, last | \
         one cell Beckmann | one cell GGX | worst contrast | normalisation | |"
    );
    println!("| --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --- |");
    let mut settings = Vec::new();
    for marginals in [48, 96, 192, 384] {
        settings.push(DictionaryOptions { marginals, ..*default });
    }
    for levels in [10, 12, 14, 18] {
        settings.push(DictionaryOptions { levels, ..*default });
    }
    for entries in [32, 48, 128] {
        settings.push(DictionaryOptions { entries, ..*default });
    }
    let mut rows = Vec::new();
    for options in settings {
        let (dictionary, seconds) = bake_seconds(&options);
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
            "| {} | {} | {} | {:.0} | {:.1} | {:.4} | {:.5} | {:.6} | {beckmann:.4} | {:.4} | {worst:.3} | {normalisation:.1e} |",
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
        println!("{text} {} |", if beaten { "" } else { "★" });
    }
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

fn queries(tables: &Tables) {
    println!("\n## A query at run time\n");
    println!(
        "One evaluation of the slope distribution on one core, least of five passes over 20 000 random pixels, \
         footprints of 1 to 64 cells of level 0. Each cell reads four texels of two bytes.\n"
    );
    println!("| target | footprint anisotropy | γ | ns | ns a cell | cells mean | cells most | bytes read, mean |");
    println!("| --- | --: | --: | --: | --: | --: | --: | --: |");
    let unit = 2f32.powi(1 - tables.levels as i32);
    for (target, name) in [(TARGET_BECKMANN, "Beckmann"), (TARGET_GGX, "GGX")] {
        for (stretch, ratio) in [(1.0f32, 4.0f32), (4.0, 4.0), (8.0, 8.0), (1000.0, 8.0), (16.0, 16.0)] {
            let mut rng = Pcg64::seed_from_u64(1);
            let mut uniform = || (rng.next_u32() >> 8) as f32 / 16_777_216.0;
            let mut pixels = Vec::new();
            for _ in 0..20_000 {
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
            println!(
                "| {name} | {stretch} | {ratio} | {ns:.0} | {:.1} | {mean:.1} | {most} | {:.0} |",
                ns / mean,
                8.0 * mean
            );
        }
    }
}

fn furnaces(tables: &Tables) {
    println!("\n## Weak white furnace\n");
    println!(
        "Worst relative error over ln ρ = 14, 18, 22, 26 and ζ = 0.01, 2, by quadrature of the f32 run time over half \
         vectors (384 rings, 768 directions). What is left is the quadrature's: slopes m and −m add up to the same for \
         every α and θ.\n"
    );
    println!("| target | α | θ = 0 | θ = π/4 | θ = 1.56 |");
    println!("| --- | --: | --: | --: | --: |");
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
                    let sums = furnace(tables, &m, pixel);
                    for k in 0..3 {
                        worst[k] = worst[k].max((sums[k] - 1.0).abs());
                    }
                }
            }
            println!("| {name} | {alpha} | {:.5} | {:.5} | {:.5} |", worst[0], worst[1], worst[2]);
        }
    }
}

/// ∫ G₁(o, h) D(h) (o·h) / (o·n) dω_h at θ = 0, π/4 and 1.56.
fn furnace(tables: &Tables, m: &DictionaryMaterial, pixel: PixelOnSurface) -> [f64; 3] {
    let n = 384;
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
fn plot(levels: &[LevelQuality]) -> String {
    let (width, height, left, top) = (640.0, 400.0, 60.0, 20.0);
    let x = |level: usize| left + 40.0 + level as f64 * (width - left - 160.0) / (levels.len() - 1) as f64;
    let y = |value: f64| top + (height - top - 40.0) * (1.0 - (value.max(1e-5).log10() + 5.0) / 6.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\">\n"
    );
    for power in -5..=1 {
        let at = y(10f64.powi(power));
        let right = width - 110.0;
        writeln!(
            svg,
            "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#ddd\"/><text x=\"8\" y=\"{at:.1}\">1e{power}</text>"
        )
        .unwrap();
    }
    for level in 0..levels.len() {
        writeln!(svg, "<text x=\"{:.1}\" y=\"{}\">{level}</text>", x(level) - 4.0, height - 24.0).unwrap();
    }
    writeln!(svg, "<text x=\"{:.1}\" y=\"{}\">level</text>", x(0) - 4.0, height - 6.0).unwrap();
    let curves = [
        ("L1 mean", 4.0, "#1b6", levels.iter().map(|q| q.l1_mean).collect::<Vec<f64>>()),
        ("KS mean", 4.0, "#06c", levels.iter().map(|q| q.ks_mean).collect()),
        ("L1 of mean", 4.0, "#c60", levels.iter().map(|q| q.l1_of_mean).collect()),
        ("KS of mean", 4.0, "#a0a", levels.iter().map(|q| q.ks_of_mean).collect()),
        ("contrast", -10.0, "#555", levels.iter().map(|q| q.contrast).collect()),
    ];
    for (name, label_below, colour, values) in curves {
        let mut path = String::new();
        for level in 0..values.len() {
            write!(path, "{}{:.1} {:.1}", if level == 0 { "M" } else { "L" }, x(level), y(values[level])).unwrap();
        }
        let (end_x, end_y) = (x(values.len() - 1) + 6.0, y(values[values.len() - 1]) + label_below);
        writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>").unwrap();
        writeln!(svg, "<text x=\"{end_x:.1}\" y=\"{end_y:.1}\" fill=\"{colour}\">{name}</text>").unwrap();
    }
    svg + "</svg>\n"
}
