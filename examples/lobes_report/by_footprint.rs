//! Error by footprint on every map, ours and the paper's.

use crate::plot::plot;
use crate::{MAPS, ROUGHNESS, SEED, SIGMAS, STRIDE, baked, chosen, load, options, percent};
use glam::DVec2;
use glint_bake_core::lobes::options::LobesOptions;
use glint_bake_core::lobes::quality::{FootprintErrors, Measured, footprint_errors};
use glint_bake_core::lobes::query::Detail;
use glint_bake_core::lobes::reference::Reference;
use glint_bake_core::quality::sweep;
use glint_formats::lobes::{Filter, Merge};
use std::path::Path;

/// The head of the report, error by footprint on every map, and the plot of it.
pub fn tables(folder: &Path, footprints: u32, svg: Option<String>) {
    println!("# MIP-mapped lobes: speed against error\n");
    println!("Written by `just report`; do not edit. The plot is [lobes-report.svg](lobes-report.svg).\n");
    println!(
        "E₁ = ∫|D̂ − D| / ∫D over the disk in per cent, against the exact integral in f64, over {footprints} seeded footprints \
         a size (means unless told otherwise); σ is the footprint's standard deviation in texels, σ_r = {ROUGHNESS}. Squares of \
         256² texels (flakes 128²) from the maps' upper left corner, repeated."
    );
    explain_tables();
    let all: Vec<Table> = MAPS
        .iter()
        .map(|map| {
            let table = by_footprint(folder, map, footprints);
            print_table(&table);
            table
        })
        .collect();
    if let Some(file) = svg {
        std::fs::write(file, plot(&all)).expect("writing the plot");
    }
}

/// What is measured at every footprint size of a map.
const COLUMNS: usize = 8;

/// Errors on a map, by footprint size.
pub struct Table {
    /// The map.
    pub name: &'static str,
    /// Standard deviations in texels, and what is measured there.
    pub rows: Vec<(f64, Vec<FootprintErrors>)>,
}

fn by_footprint(folder: &Path, &(name, file, edge): &(&'static str, &str, u32), footprints: u32) -> Table {
    let map = load(folder, file, edge);
    let ours = baked(&map, &options());
    let of = |merge, seeds| baked(&map, &LobesOptions { merge, seeds, ..options() });
    let (paper, paper_one, moments) = (of(Merge::KMeans, 4), of(Merge::KMeans, 1), of(Merge::Moments, 4));
    let finest = Measured::At(Detail::Cells(0));
    let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
    let rows = SIGMAS.iter().map(|&sigma| {
        let places = sweep::footprints(sigma, 1.0, DVec2::splat(edge as f64), footprints, SEED);
        let eq8 = Measured::Edge((4.0 * sigma).log2() as f32);
        let variants = [
            chosen(&ours),
            chosen(&paper),
            chosen(&paper_one),
            chosen(&moments),
            (&paper, eq8),
            (&paper_one, eq8),
            (&ours, finest),
            (&paper, finest),
        ];
        // One level of small cells under a large footprint is measured no further than it says something.
        let count = if sigma <= 8.0 { COLUMNS } else { COLUMNS - 2 };
        (sigma, footprint_errors(&reference, &variants[..count], &places, STRIDE))
    });
    Table { name, rows: rows.collect() }
}

fn explain_tables() {
    println!("\n## By footprint\n");
    println!(
        "*ours*: Runnalls' merging from four seeds a texel, k = 32, cells of 8 texels, 16 bytes a lobe, levels as the evaluator \
         chooses them. *k-means*: the paper's, averaged parameters, from four seeds and from one, read at the same levels as \
         ours. *ratio*: ours over the better of the two. *Eq. 8*: the better of the two again, read at the levels that the paper \
         chooses, cells of 4 σ (λ = log₂ 4σ, in texels; [lobes](methods/lobes.md#levels) has the other readings), and ours \
         over it. *moments*: k-means with moment matching. *level 1* is the finest stored level alone, ours and k-means from \
         four seeds.\n\n\
         At σ ≤ 2 our choice of levels reads the map itself, which nobody clusters, so that *ratio* is 1.00 there whatever the \
         reduction. That ours is ahead at σ = 2 is the choice of levels: the paper's reads its first clustered cells there."
    );
}

fn print_table(table: &Table) {
    println!("\n### {}\n", table.name);
    println!(
        "| σ | ours | p95 | worst | energy | k-means 4 | k-means 1 | ratio | Eq. 8 | ratio | moments | level 1 | level 1 k-means | lobes | most |"
    );
    println!("{}", "| --: ".repeat(15) + "|");
    for (sigma, row) in &table.rows {
        let better = |first: usize| row[first].e1.mean.min(row[first + 1].e1.mean);
        let (k_means, eq8) = (better(1), better(4));
        let level = if row.len() == COLUMNS {
            format!("{} | {}", percent(&row[6]), percent(&row[7]))
        } else {
            " | ".to_owned()
        };
        println!(
            "| {sigma} | **{}** | {:.2} | {:.2} | {:.1e} | {} | {} | {:.2} | {:.2} | {:.2} | {} | {level} | {:.0} | {} |",
            percent(&row[0]),
            100.0 * row[0].e1.p95,
            100.0 * row[0].e1.worst,
            row[0].energy.mean,
            percent(&row[1]),
            percent(&row[2]),
            row[0].e1.mean / k_means,
            100.0 * eq8,
            row[0].e1.mean / eq8,
            percent(&row[3]),
            row[0].lobes,
            row[0].most_lobes,
        );
    }
}
