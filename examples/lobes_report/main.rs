//! MIP-mapped lobes: speed against error, as markdown on stdout; every number is measured in the run.
//!
//! `lobes_report DATA [--svg FILE] [--footprints N] [--part NAME]…` reads the real maps in `DATA/normals`, prints the tables
//! and draws error over footprint size. Parts are footprints, readings, settings, extremes and sizes; all when none is
//! named.
//! `just report` runs it.

mod by_footprint;
mod plot;
mod readings;

use glam::{DVec2, Vec2};
use glint_bake::input::{Crop, InputOptions, load_normal_map};
use glint_bake_core::lobes::options::{LobesOptions, NormalsChoice, default_cell};
use glint_bake_core::lobes::quality::{FootprintErrors, Measured, footprint_errors};
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::lobes::reference::Reference;
use glint_bake_core::lobes::{BakedLobes, bake};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::sweep;
use glint_formats::lobes::{Filter, LobeStorage, Merge};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// The maps, and the edge of the square that is cut from their corner.
const MAPS: [(&str, &str, u32); 6] = [
    ("scratched gold", "scratched_gold_cgbookcase_rgba.png", 256),
    ("brushed aluminium", "brushed_aluminium_godot_745.png", 256),
    ("leather", "leather_008_3dtextures.jpg", 256),
    ("wicker", "wicker_khronos_512.png", 256),
    ("car-paint flakes", "carpaint_flakes_khronos_128.png", 128),
    ("diamond plate", "diamond_plate_pmndrs0008.jpg", 256),
];
/// Standard deviations of footprints in texels; 5 is where the paper's peers were measured.
const SIGMAS: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 8.0, 11.3, 16.0, 32.0];
/// Bins of the reference between points at which densities are compared: σ_r.
const STRIDE: usize = 6;
const ROUGHNESS: f64 = 0.02;
const SEED: u64 = 5;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (mut data, mut svg, mut footprints, mut parts) = (None, None, 16, Vec::new());
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--svg" => svg = rest.next().cloned(),
            "--footprints" => footprints = rest.next().and_then(|n| n.parse().ok()).unwrap_or(footprints),
            "--part" => parts.extend(rest.next().cloned()),
            _ => data = Some(argument.clone()),
        }
    }
    let Some(data) = data else {
        eprintln!("usage: lobes_report DATA [--svg FILE] [--footprints N] [--part NAME]...");
        std::process::exit(2);
    };
    let wanted = |part: &str| parts.is_empty() || parts.iter().any(|name| name == part);
    let folder = Path::new(&data).join("normals");
    if wanted("footprints") {
        by_footprint::tables(&folder, footprints, svg);
    }
    if wanted("readings") {
        readings::table(&folder, (footprints / 4).max(2));
    }
    if wanted("settings") {
        settings(&folder, (footprints / 4).max(2));
    }
    if wanted("extremes") {
        extremes(&folder, (footprints / 4).max(2));
    }
    if wanted("sizes") {
        sizes(&folder);
    }
}

fn load(folder: &Path, file: &str, edge: u32) -> NormalMap {
    let crop = Some(Crop { x: 0, y: 0, w: edge, h: edge });
    let options = InputOptions { crop, assume_linear: true, ..InputOptions::default() };
    load_normal_map(&folder.join(file), &options).unwrap_or_else(|e| panic!("{e}")).map
}

fn options() -> LobesOptions {
    LobesOptions { roughness: ROUGHNESS, footprints: 0, ..LobesOptions::default() }
}

fn baked(map: &NormalMap, options: &LobesOptions) -> BakedLobes {
    bake(map, options, &Silent).unwrap_or_else(|e| panic!("{e}"))
}

fn chosen(lobes: &BakedLobes) -> (&BakedLobes, Measured) {
    (lobes, Measured::Chosen(QuerySettings::default()))
}

fn percent(errors: &FootprintErrors) -> String {
    format!("{:.2}", 100.0 * errors.e1.mean)
}

/// Bytes, bake, cost and error of several settings, mean over the maps.
fn settings(folder: &Path, footprints: u32) {
    println!("\n## By setting\n");
    println!(
        "Means over scratched gold, brushed aluminium, leather and wicker, {footprints} footprints a size. Bytes and CPU-seconds of a 256² map, error not measured in the \
         bake; ns: one query (footprint and direction) of σ = 8 on one core, with the lobes it touches."
    );
    println!("\n| setting | KiB | bake CPU-s | E₁ σ 2 | σ 5 | σ 8 | σ 16 | lobes σ 8 | ns σ 8 |");
    println!("{}", "| --- ".to_owned() + &"| --: ".repeat(8) + "|");
    let q = QuerySettings::default();
    let variants: Vec<(&str, LobesOptions, QuerySettings)> = vec![
        ("**default**: Runnalls, k 32, cell 8, 4 seeds, packed", options(), q),
        ("1 seed", LobesOptions { seeds: 1, ..options() }, q),
        ("k-means, averaged", LobesOptions { merge: Merge::KMeans, ..options() }, q),
        ("k-means, moments", LobesOptions { merge: Merge::Moments, ..options() }, q),
        ("k 16", LobesOptions { lobes_per_cell: 16, ..options() }, q),
        ("k 64", LobesOptions { lobes_per_cell: 64, ..options() }, q),
        ("cell 4", LobesOptions { cell_texels: 4, ..options() }, q),
        ("cell 16", LobesOptions { cell_texels: 16, ..options() }, q),
        ("f16", LobesOptions { storage: LobeStorage::Half, ..options() }, q),
        ("normals 16 bits", LobesOptions { normals: NormalsChoice::Snorm16, ..options() }, q),
        ("normals 8 bits", LobesOptions { normals: NormalsChoice::Unorm8, ..options() }, q),
        ("levels from σ = 0.4 cells on", options(), QuerySettings { cell_sigmas: 0.4, ..q }),
        ("levels from σ = 0.9 cells on", options(), QuerySettings { cell_sigmas: 0.9, max_cells: 72.0, ..q }),
    ];
    let sigmas = [2.0, 5.0, 8.0, 16.0];
    let mut sums = vec![([0.0; 4], 0.0); variants.len()];
    let mut costs = vec![(0, 0.0, 0.0); variants.len()];
    let maps = &MAPS[..4];
    for &(name, file, edge) in maps {
        let map = load(folder, file, edge);
        let mut all = Vec::new();
        for (variant, cost) in variants.iter().zip(&mut costs) {
            let begin = cpu_seconds();
            let lobes = baked(&map, &variant.1);
            if name == "leather" {
                *cost = (lobes.gpu_bytes(), cpu_seconds() - begin, nanoseconds(&lobes, 8.0, &variant.2));
            }
            all.push(lobes);
        }
        let bakes: Vec<_> = all.iter().zip(&variants).map(|(b, v)| (b, Measured::Chosen(v.2))).collect();
        let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
        for (k, sigma) in sigmas.into_iter().enumerate() {
            let places = sweep::footprints(sigma, 1.0, DVec2::splat(edge as f64), footprints, SEED);
            for (sum, errors) in sums.iter_mut().zip(footprint_errors(&reference, &bakes, &places, STRIDE)) {
                sum.0[k] += errors.e1.mean / maps.len() as f64;
                if sigma == 8.0 {
                    sum.1 += errors.lobes / maps.len() as f64;
                }
            }
        }
    }
    for ((name, ..), ((errors, lobes), (bytes, cpu, ns))) in variants.iter().zip(sums.iter().zip(&costs)) {
        let [a, b, c, d] = errors.map(|e| format!("{:.2}", 100.0 * e));
        println!("| {name} | {} | {cpu:.1} | {a} | {b} | {c} | {d} | {lobes:.0} | {ns:.0} |", bytes / 1024);
    }
}

/// Nanoseconds of one query, the least of a few runs.
fn nanoseconds(lobes: &BakedLobes, sigma: f64, settings: &QuerySettings) -> f64 {
    let extent = DVec2::new(lobes.params.width as f64, lobes.params.height as f64);
    let places = sweep::footprints(sigma, 1.0, extent, 100, SEED);
    let mut least = f64::INFINITY;
    let mut sum = 0.0;
    for _ in 0..5 {
        let begin = Instant::now();
        for place in &places {
            sum += lobes.p_ndf(place, Vec2::new(0.03, -0.02), ROUGHNESS as f32, settings);
        }
        least = least.min(begin.elapsed().as_secs_f64() / places.len() as f64 * 1e9);
    }
    assert!(sum.is_finite());
    least
}

/// Long footprints, wide ones, other roughnesses, and flakes without filtering.
fn extremes(folder: &Path, footprints: u32) {
    println!("\n## Long and wide footprints, other roughnesses\n");
    println!(
        "{footprints} footprints. *wide*: σ in edges of the map. *long*: anisotropy, σ = 2 and 8 along the minor axis. *σ_r*: the \
         same lobes, merged for 0.02, read with another roughness."
    );
    println!("\n| map | wide ¼ | ½ | 1 | long 4, σ 2 | 4, σ 8 | 16, σ 2 | most lobes | σ_r 0.005, σ 5 | 0.01 | 0.05 |");
    println!("{}", "| --- ".to_owned() + &"| --: ".repeat(10) + "|");
    for (name, file, edge) in MAPS {
        let map = load(folder, file, edge);
        let lobes = baked(&map, &options());
        let extent = DVec2::splat(edge as f64);
        let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
        let mut line = format!("| {name} ");
        let mut most = 0;
        let mut sizes: Vec<(f64, f64)> = [0.25, 0.5, 1.0].map(|wide| (wide * edge as f64, 1.0)).to_vec();
        sizes.extend([(2.0, 4.0), (8.0, 4.0), (2.0, 16.0)]);
        for (sigma, anisotropy) in sizes {
            // The widest see nearly the same, wherever they lie.
            let count = if sigma >= 0.5 * edge as f64 { 2 } else { footprints };
            let places = sweep::footprints(sigma, anisotropy, extent, count, SEED);
            let errors = footprint_errors(&reference, &[chosen(&lobes)], &places, STRIDE)[0];
            most = most.max(errors.most_lobes);
            let _ = write!(line, "| {} ", percent(&errors));
        }
        let _ = write!(line, "| {most} ");
        for roughness in [0.005, 0.01, 0.05] {
            let reference = Reference::new(&map, Filter::Linear, roughness);
            let places = sweep::footprints(5.0, 1.0, extent, footprints.min(4), SEED);
            let _ =
                write!(line, "| {} ", percent(&footprint_errors(&reference, &[chosen(&lobes)], &places, STRIDE)[0]));
        }
        println!("{line}|");
    }
    let map = load(folder, MAPS[4].1, MAPS[4].2);
    let nearest = baked(&map, &LobesOptions { filter: Filter::Nearest, ..options() });
    let reference = Reference::new(&map, Filter::Nearest, ROUGHNESS);
    let row: Vec<String> = [1.0, 2.0, 5.0, 8.0, 16.0]
        .into_iter()
        .map(|sigma| {
            let places = sweep::footprints(sigma, 1.0, DVec2::splat(MAPS[4].2 as f64), footprints, SEED);
            format!("{} at σ {sigma}", percent(&footprint_errors(&reference, &[chosen(&nearest)], &places, STRIDE)[0]))
        })
        .collect();
    println!("\nCar-paint flakes with `--nearest`, against the unfiltered map: {}.", row.join(", "));
}

/// Bytes and bake of larger maps, and their growth.
fn sizes(folder: &Path) {
    println!("\n## By size of the map\n");
    println!(
        "Squares of leather, defaults; CPU-seconds of the bake with its own measurement of E₁ (8 footprints a size) and without. \
         *peak*: most memory of this process up to then."
    );
    println!("\n| texels | cell | bytes | bake CPU-s | µs a texel | with measurement | peak MiB |");
    println!("{}", "| --: ".repeat(7) + "|");
    for (edge, cell) in [(64, None), (128, None), (256, None), (512, None), (1024, Some(8)), (1024, None)] {
        let map = load(folder, MAPS[2].1, edge);
        let cell_texels = cell.unwrap_or(default_cell(edge, edge));
        let begin = cpu_seconds();
        let lobes = baked(&map, &LobesOptions { cell_texels, ..options() });
        let cpu = cpu_seconds() - begin;
        let begin = cpu_seconds();
        baked(&map, &LobesOptions { cell_texels, footprints: LobesOptions::default().footprints, ..options() });
        let measured = cpu_seconds() - begin;
        println!(
            "| {edge}² | {cell_texels} | {} | {cpu:.2} | {:.1} | {measured:.2} | {:.0} |",
            lobes.gpu_bytes(),
            1e6 * cpu / (edge as f64 * edge as f64),
            peak_mib()
        );
    }
}

/// User and system seconds of this process.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |at: usize| fields.get(at).and_then(|v| v.parse::<f64>().ok()).unwrap_or(f64::NAN);
    (ticks(11) + ticks(12)) / 100.0
}

fn peak_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok()).map_or(f64::NAN, |kib| kib / 1024.0)
}
