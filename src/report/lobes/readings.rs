//! What the readings of the paper's choice of levels would give.

use super::samples::{ROUGHNESS, SEED, STRIDE, baked, chosen, load, options, samples};
use crate::exit::Failure;
use crate::report::document::Document;
use crate::report::settings::Settings;
use crate::report::table::Table;
use glam::DVec2;
use glint_bake_core::lobes::BakedLobes;
use glint_bake_core::lobes::options::LobesOptions;
use glint_bake_core::lobes::quality::{Measured, footprint_errors};
use glint_bake_core::lobes::reference::Reference;
use glint_bake_core::quality::sweep;
use glint_formats::lobes::{Filter, Merge};

const SIGMAS: [f64; 5] = [2.0, 3.0, 5.0, 8.0, 16.0];

/// Footprint (its standard deviation in texels) to the binary logarithm of the edge of the cells that are read.
type Lambda = fn(f64) -> f64;

/// A reading of λ = ½ log₂ P, the edge of the finest clustered cells in texels, and λ.
const READINGS: [(&str, u32, Lambda); 7] = [
    ("P: area of ±2 σ", 8, |sigma| (4.0 * sigma).log2()),
    ("the same, clustered from cells of 4 on", 4, |sigma| (4.0 * sigma).log2()),
    ("P: area of ±1 σ", 8, |sigma| (2.0 * sigma).log2()),
    ("the same, clustered from cells of 4 on", 4, |sigma| (2.0 * sigma).log2()),
    ("P: area of ±3 σ", 8, |sigma| (6.0 * sigma).log2()),
    ("P: edge of ±2 σ, clustered from cells of 4 on", 4, |sigma| 0.5 * (4.0 * sigma).log2()),
    ("P: area of ±2 σ, λ = 1 the first clustered level", 8, |sigma| (4.0 * sigma).log2() + 2.0),
];

/// Adds error of k-means by reading, mean over the maps, and the worst ratio of ours to it.
pub fn table(document: &mut Document, settings: &Settings, footprints: u32) -> Result<(), Failure> {
    settings.terminal.say("lobes: by reading");
    document.heading(2, "By reading of Eq. 8");
    document.paragraph(format!(
        "The paper's k-means, averaged parameters, the better of four seeds and one, mean over the maps of *by footprint*, \
         {footprints} footprints a size; in brackets the least and the largest ratio of ours to it on any map. Lobes are a query's, from four seeds."
    ));
    let mut table = Table::new(1, "levels | σ 2 | 3 | 5 | 8 | 16 | lobes σ 5 | σ 16");
    // Of each reading and size, map by map: errors of ours and of k-means, lobes of both.
    let mut found = vec![[const { Vec::<[f64; 4]>::new() }; SIGMAS.len()]; READINGS.len()];
    for sample in samples(settings) {
        let map = load(settings, &sample)?;
        let ours = baked(&map, &options())?;
        let of =
            |cell_texels, seeds| baked(&map, &LobesOptions { merge: Merge::KMeans, cell_texels, seeds, ..options() });
        let paper = [[of(4, 4)?, of(4, 1)?], [of(8, 4)?, of(8, 1)?]];
        let of_cell = |cell: u32| &paper[usize::from(cell == 8)];
        let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
        for (size, &sigma) in SIGMAS.iter().enumerate() {
            let places = sweep::footprints(sigma, 1.0, DVec2::splat(sample.edge as f64), footprints, SEED);
            let mut variants: Vec<(&BakedLobes, Measured)> = vec![chosen(&ours)];
            for (_, cell, lambda) in READINGS {
                variants.extend(of_cell(cell).iter().map(|baked| (baked, Measured::Edge(lambda(sigma) as f32))));
            }
            let errors = footprint_errors(&reference, &variants, &places, STRIDE);
            for (pair, reading) in errors[1..].chunks_exact(2).zip(&mut found) {
                let theirs = pair[0].e1.mean.min(pair[1].e1.mean);
                reading[size].push([errors[0].e1.mean, theirs, errors[0].lobes, pair[0].lobes]);
            }
        }
    }
    let mean = |maps: &[[f64; 4]], which: usize| maps.iter().map(|map| map[which]).sum::<f64>() / maps.len() as f64;
    let mut row = |label: &str, reading: &[Vec<[f64; 4]>; SIGMAS.len()], ours: bool| {
        let cell = |maps: &Vec<[f64; 4]>| {
            let ratios = maps.iter().map(|map| map[0] / map[1]);
            let (least, most) = (ratios.clone().fold(f64::INFINITY, f64::min), ratios.fold(0.0, f64::max));
            match ours {
                true => format!("{:.2}", 100.0 * mean(maps, 0)),
                false => format!("{:.2} ({least:.2} to {most:.2})", 100.0 * mean(maps, 1)),
            }
        };
        let cells: Vec<String> = reading.iter().map(cell).collect();
        let lobes = [2, 4].map(|size| mean(&reading[size], if ours { 2 } else { 3 }));
        table.row(format!("{label} | {} | {:.0} | {:.0}", cells.join(" | "), lobes[0], lobes[1]));
    };
    row("**ours**", &found[0], true);
    for ((label, ..), reading) in READINGS.iter().zip(&found) {
        row(label, reading, false);
    }
    document.table(&table);
    Ok(())
}
