//! MIP-mapped lobes: speed against error.

mod by_footprint;
mod readings;
mod samples;

use super::clock::{cpu_seconds, peak_mib};
use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use glam::{DVec2, Vec2};
use glint_bake_core::lobes::BakedLobes;
use glint_bake_core::lobes::options::{LobesOptions, NormalsChoice, default_cell};
use glint_bake_core::lobes::quality::{Measured, footprint_errors};
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::lobes::reference::Reference;
use glint_bake_core::quality::sweep;
use glint_formats::lobes::{Filter, LobeStorage, Merge};
use samples::{
    FLAKES, LEATHER, ROUGHNESS, SAMPLES, SEED, STRIDE, Sample, baked, chosen, load, options, percent, samples,
};
use std::time::Instant;

/// Says why the report cannot be made.
pub fn check(settings: &Settings) -> Result<(), Failure> {
    settings.check(SAMPLES.iter().map(|sample| sample.file))
}

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let footprints = settings.footprints(16, 1);
    let fewer = settings.pick((footprints / 4).max(2), 1);
    let mut document = Document::new("lobes", "MIP-mapped lobes: speed against error", settings);
    document.paragraph(format!(
        "E₁ = ∫|D̂ − D| / ∫D over the disk in per cent, against the exact integral in f64, over {footprints} seeded footprints \
         a size (means unless told otherwise); σ is the footprint's standard deviation in texels, σ_r = {ROUGHNESS}. Squares of \
         256² texels (flakes 128²) from the maps' upper left corner, repeated."
    ));
    by_footprint::tables(&mut document, settings, footprints)?;
    readings::table(&mut document, settings, fewer)?;
    by_setting(&mut document, settings, fewer)?;
    extremes(&mut document, settings, fewer)?;
    sizes(&mut document, settings)?;
    Ok(document)
}

/// Bytes, bake, cost and error of several settings, mean over the maps.
fn by_setting(document: &mut Document, settings: &Settings, footprints: u32) -> Result<(), Failure> {
    settings.terminal.say("lobes: by setting");
    document.heading(2, "By setting");
    document.paragraph(format!(
        "Means over scratched gold, brushed aluminium, leather and wicker, {footprints} footprints a size. Bytes and CPU-seconds of a 256² map, error not measured in the \
         bake; ns: one query (footprint and direction) of σ = 8 on one core, with the lobes it touches."
    ));
    let mut table = Table::new(1, "setting | KiB | bake CPU-s | E₁ σ 2 | σ 5 | σ 8 | σ 16 | lobes σ 8 | ns σ 8");
    let q = QuerySettings::default();
    let mut variants: Vec<(&str, LobesOptions, QuerySettings)> = vec![
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
    variants.truncate(settings.pick(usize::MAX, 2));
    let sigmas = [2.0, 5.0, 8.0, 16.0];
    let mut sums = vec![([0.0; 4], 0.0); variants.len()];
    let mut costs = vec![(0, 0.0, 0.0); variants.len()];
    let mut maps = samples(settings);
    maps.truncate(4);
    for sample in &maps {
        let map = load(settings, sample)?;
        let mut all = Vec::new();
        for (variant, cost) in variants.iter().zip(&mut costs) {
            let begin = cpu_seconds();
            let lobes = baked(&map, &variant.1)?;
            if sample.name == LEATHER.name {
                *cost = (lobes.gpu_bytes(), cpu_seconds() - begin, nanoseconds(&lobes, 8.0, &variant.2));
            }
            all.push(lobes);
        }
        let bakes: Vec<_> = all.iter().zip(&variants).map(|(b, v)| (b, Measured::Chosen(v.2))).collect();
        let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
        for (k, sigma) in sigmas.into_iter().enumerate() {
            let places = sweep::footprints(sigma, 1.0, DVec2::splat(sample.edge as f64), footprints, SEED);
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
        table.row(format!("{name} | {} | {cpu:.1} | {a} | {b} | {c} | {d} | {lobes:.0} | {ns:.0}", bytes / 1024));
    }
    document.table(&table);
    Ok(())
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
fn extremes(document: &mut Document, settings: &Settings, footprints: u32) -> Result<(), Failure> {
    settings.terminal.say("lobes: long and wide footprints");
    document.heading(2, "Long and wide footprints, other roughnesses");
    document.paragraph(format!(
        "{footprints} footprints. *wide*: σ in edges of the map. *long*: anisotropy, σ = 2 and 8 along the minor axis. *σ_r*: the \
         same lobes, merged for 0.02, read with another roughness."
    ));
    let mut table = Table::new(
        1,
        "map | wide ¼ | ½ | 1 | long 4, σ 2 | 4, σ 8 | 16, σ 2 | most lobes | σ_r 0.005, σ 5 | 0.01 | 0.05",
    );
    for sample in samples(settings) {
        let (name, edge) = (sample.name, sample.edge);
        let map = load(settings, &sample)?;
        let lobes = baked(&map, &options())?;
        let extent = DVec2::splat(edge as f64);
        let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
        let mut line = name.to_owned();
        let mut most = 0;
        let mut sizes: Vec<(f64, f64)> = [0.25, 0.5, 1.0].map(|wide| (wide * edge as f64, 1.0)).to_vec();
        sizes.extend([(2.0, 4.0), (8.0, 4.0), (2.0, 16.0)]);
        for (sigma, anisotropy) in sizes {
            // The widest see nearly the same, wherever they lie.
            let count = if sigma >= 0.5 * edge as f64 { 2 } else { footprints };
            let places = sweep::footprints(sigma, anisotropy, extent, count, SEED);
            let errors = footprint_errors(&reference, &[chosen(&lobes)], &places, STRIDE)[0];
            most = most.max(errors.most_lobes);
            line += &format!(" | {}", percent(&errors));
        }
        line += &format!(" | {most}");
        for roughness in [0.005, 0.01, 0.05] {
            let reference = Reference::new(&map, Filter::Linear, roughness);
            let places = sweep::footprints(5.0, 1.0, extent, footprints.min(4), SEED);
            let errors = footprint_errors(&reference, &[chosen(&lobes)], &places, STRIDE)[0];
            line += &format!(" | {}", percent(&errors));
        }
        table.row(line);
    }
    document.table(&table);
    let flakes = Sample { edge: settings.pick(FLAKES.edge, 64), ..FLAKES };
    let map = load(settings, &flakes)?;
    let nearest = baked(&map, &LobesOptions { filter: Filter::Nearest, ..options() })?;
    let reference = Reference::new(&map, Filter::Nearest, ROUGHNESS);
    let row: Vec<String> = [1.0, 2.0, 5.0, 8.0, 16.0]
        .into_iter()
        .map(|sigma| {
            let places = sweep::footprints(sigma, 1.0, DVec2::splat(flakes.edge as f64), footprints, SEED);
            format!("{} at σ {sigma}", percent(&footprint_errors(&reference, &[chosen(&nearest)], &places, STRIDE)[0]))
        })
        .collect();
    document.paragraph(format!("Car-paint flakes with `--nearest`, against the unfiltered map: {}.", row.join(", ")));
    Ok(())
}

/// Bytes and bake of larger maps, and their growth.
fn sizes(document: &mut Document, settings: &Settings) -> Result<(), Failure> {
    settings.terminal.say("lobes: by size of the map");
    document.heading(2, "By size of the map");
    document.paragraph(
        "Squares of leather, defaults; CPU-seconds of the bake with its own measurement of E₁ (8 footprints a size) and without. \
         *peak*: most memory of this process up to then.",
    );
    let mut table = Table::new(0, "texels | cell | bytes | bake CPU-s | µs a texel | with measurement | peak MiB");
    let sizes = [(64, None), (128, None), (256, None), (512, None), (1024, Some(8)), (1024, None)];
    for &(edge, cell) in &sizes[..settings.pick(sizes.len(), 1)] {
        let map = load(settings, &Sample { edge, ..LEATHER })?;
        let cell_texels = cell.unwrap_or(default_cell(edge, edge));
        let begin = cpu_seconds();
        let lobes = baked(&map, &LobesOptions { cell_texels, ..options() })?;
        let cpu = cpu_seconds() - begin;
        let begin = cpu_seconds();
        baked(&map, &LobesOptions { cell_texels, footprints: LobesOptions::default().footprints, ..options() })?;
        let measured = cpu_seconds() - begin;
        table.row(format!(
            "{edge}² | {cell_texels} | {} | {cpu:.2} | {:.1} | {measured:.2} | {:.0}",
            lobes.gpu_bytes(),
            1e6 * cpu / (edge as f64 * edge as f64),
            peak_mib()
        ));
    }
    document.table(&table);
    Ok(())
}
