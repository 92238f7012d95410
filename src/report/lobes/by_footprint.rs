//! Error by footprint on every map, ours and the paper's.

use super::samples::{ROUGHNESS, SEED, STRIDE, Sample, baked, chosen, load, options, percent, samples};
use crate::exit::Failure;
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use crate::report::document::Document;
use crate::report::settings::Settings;
use crate::report::table::Table;
use glam::DVec2;
use glint_bake_core::lobes::options::LobesOptions;
use glint_bake_core::lobes::quality::{FootprintErrors, Measured, footprint_errors};
use glint_bake_core::lobes::query::Detail;
use glint_bake_core::lobes::reference::Reference;
use glint_bake_core::quality::sweep;
use glint_formats::lobes::{Filter, Merge};

/// Standard deviations of footprints in texels; 5 is where the paper's peers were measured.
const SIGMAS: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 8.0, 11.3, 16.0, 32.0];

/// Adds error by footprint on every map, and the plot of it.
pub fn tables(document: &mut Document, settings: &Settings, footprints: u32) -> Result<(), Failure> {
    let mut all = Vec::new();
    for sample in samples(settings) {
        settings.terminal.say(&format!("lobes: {}", sample.name));
        all.push(by_footprint(settings, &sample, footprints)?);
    }
    document.plot("", "E₁ over the footprint's σ", &figure(&all));
    document.heading(2, "By footprint");
    document.paragraph(
        "*ours*: Runnalls' merging from four seeds a texel, k = 32, cells of 8 texels, 16 bytes a lobe, levels as the evaluator \
         chooses them. *k-means*: the paper's, averaged parameters, from four seeds and from one, read at the same levels as \
         ours. *ratio*: ours over the better of the two. *Eq. 8*: the better of the two again, read at the levels that the paper \
         chooses, cells of 4 σ (λ = log₂ 4σ, in texels; [lobes](../methods/lobes.md#levels) has the other readings), and \
         ours over it. *moments*: k-means with moment matching. *level 1* is the finest stored level alone, ours and k-means from \
         four seeds.",
    );
    document.paragraph(
        "At σ ≤ 2 our choice of levels reads the map itself, which nobody clusters, so that *ratio* is 1.00 there whatever the \
         reduction. That ours is ahead at σ = 2 is the choice of levels: the paper's reads its first clustered cells there.",
    );
    for errors in &all {
        document.heading(3, errors.name);
        document.table(&table(errors));
    }
    Ok(())
}

/// What is measured at every footprint size of a map.
const COLUMNS: usize = 8;

/// Errors on a map, by footprint size.
struct Errors {
    /// The map.
    name: &'static str,
    /// Standard deviations in texels, and what is measured there.
    rows: Vec<(f64, Vec<FootprintErrors>)>,
}

fn by_footprint(settings: &Settings, sample: &Sample, footprints: u32) -> Result<Errors, Failure> {
    let map = load(settings, sample)?;
    let ours = baked(&map, &options())?;
    let of = |merge, seeds| baked(&map, &LobesOptions { merge, seeds, ..options() });
    let (paper, paper_one, moments) = (of(Merge::KMeans, 4)?, of(Merge::KMeans, 1)?, of(Merge::Moments, 4)?);
    let finest = Measured::At(Detail::Cells(0));
    let reference = Reference::new(&map, Filter::Linear, ROUGHNESS);
    let rows = SIGMAS.iter().map(|&sigma| {
        let places = sweep::footprints(sigma, 1.0, DVec2::splat(sample.edge as f64), footprints, SEED);
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
    Ok(Errors { name: sample.name, rows: rows.collect() })
}

fn table(errors: &Errors) -> Table {
    let mut table = Table::new(
        0,
        "σ | ours | p95 | worst | energy | k-means 4 | k-means 1 | ratio | Eq. 8 | ratio | moments | level 1 | \
         level 1 k-means | lobes | most",
    );
    for (sigma, row) in &errors.rows {
        let better = |first: usize| row[first].e1.mean.min(row[first + 1].e1.mean);
        let (k_means, eq8) = (better(1), better(4));
        let level = if row.len() == COLUMNS {
            format!("{} | {}", percent(&row[6]), percent(&row[7]))
        } else {
            " | ".to_owned()
        };
        table.row(format!(
            "{sigma} | **{}** | {:.2} | {:.2} | {:.1e} | {} | {} | {:.2} | {:.2} | {:.2} | {} | {level} | {:.0} | {}",
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
        ));
    }
    table
}

/// E₁ over footprint size, a panel a map: ours and the better k-means.
fn figure(all: &[Errors]) -> Figure {
    let panel = |errors: &Errors| {
        let curve = |value: &dyn Fn(&[FootprintErrors]) -> f64| {
            errors.rows.iter().map(|(sigma, row)| (*sigma, 100.0 * value(row))).collect()
        };
        Panel {
            title: errors.name.to_owned(),
            x: Axis::logarithmic("σ in texels", (0.5, 32.0)).ticks(&[0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]),
            y: Axis::logarithmic("E₁", (0.1, 100.0)).unit(" %"),
            series: vec![
                Series::line(
                    "k-means, averaged (the better of 1 and 4 seeds)",
                    Colour::Vermilion,
                    curve(&|row| row[1].e1.mean.min(row[2].e1.mean)),
                ),
                Series::line("k-means, moments", Colour::Orange, curve(&|row| row[3].e1.mean)),
                Series::line("ours", Colour::Blue, curve(&|row| row[0].e1.mean)),
            ],
        }
    };
    let panels: Vec<Panel> = all.iter().map(panel).collect();
    let columns = panels.len().clamp(1, 3);
    Figure { title: String::new(), panels, columns, panel_size: (300, 230) }
}
