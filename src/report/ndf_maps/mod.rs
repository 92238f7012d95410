//! Speed against error of the NDF maps of small examples: those of the data folder, or the user's own.
//!
//! Timings are of the machine that runs the command, on one thread, beside the error that they buy.

mod measurement;

use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use crate::input::load_normal_map;
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::quality::sweep::ANISOTROPIES;
use measurement::{DIAL_ANISOTROPY, Dial, Example, Setting, Size};
use std::path::PathBuf;

/// The example that is measured when the user has none.
const MAP: &str = "tiny/brushed_16x16.png";

/// Says why the report cannot be made.
pub fn check(settings: &Settings) -> Result<(), Failure> {
    load(settings).map(|_| ())
}

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let footprints = settings.footprints(64, 1);
    let mut document = Document::new("ndf-maps", "NDF maps: speed against error", settings);
    document.paragraph(format!(
        "E₁ = ∫|D̂ − D| / ∫D over the unit disk of projected normals; {footprints} footprints of each size. Times are of the \
         machine that ran the command: read them against each other. A row with a star is on the Pareto front of bytes and \
         mean E₁ for its roughness."
    ));
    for (path, map) in load(settings)? {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        settings.terminal.say(&format!("ndf-maps: {name}"));
        let measured = measurement::example(&map, footprints, settings).map_err(|e| Failure::bake(&path, &e))?;
        document.heading(2, &format!("{name}, {} × {}", map.width, map.height));
        document.plot(&name, "bytes against error", &figure(&name, &measured.settings));
        tables(&mut document, &measured);
    }
    Ok(document)
}

fn load(settings: &Settings) -> Result<Vec<(PathBuf, NormalMap)>, Failure> {
    if settings.maps.is_empty() {
        return Ok(vec![(settings.data(MAP)?, settings.normal_map(MAP, None)?)]);
    }
    let load = |path: &PathBuf| Ok((path.clone(), load_normal_map(path, &settings.input)?.map));
    settings.maps.iter().map(load).collect()
}

fn tables(document: &mut Document, measured: &Example) {
    document.paragraph("Bake: every node against the bake's own exact grid.");
    let mut table = Table::new(2, "σ_r | E₁ asked | KiB on the GPU | bake ms | E₁ mean | p95 | worst | energy | ");
    for s in &measured.settings {
        table.row(format!(
            "{} | {} % | {:.1} | {:.0} | {} | {} | {} | {:.0e} | {}",
            s.roughness,
            100.0 * s.max_error,
            s.gpu_bytes as f64 / 1024.0,
            s.milliseconds,
            percent(s.error.mean),
            percent(s.error.p95),
            percent(s.error.worst),
            s.error.energy,
            if s.on_front { "★" } else { "" }
        ));
    }
    document.table(&table);
    document.paragraph(
        "Surfaces: footprints on 32 × 32 placed examples (and their repetition) against the normal map that the placement \
         describes, σ_r = 0.02, 3 % asked of nodes, run-time settings of pictures. σ is the footprint's minor standard \
         deviation in texels; nodes and patches are what a query evaluates.",
    );
    let mut table = Table::new(
        1,
        "placement | σ | anisotropy | E₁ mean | p95 | worst | nodes and patches | footprint µs | query µs",
    );
    for s in &measured.sizes {
        table.row(format!(
            "{} | {} | {} | {} | {} | {} | {:.0} | {:.1} | {:.2}",
            s.placement,
            s.sigma,
            s.anisotropy,
            percent(s.errors.e1.mean),
            percent(s.errors.e1.p95),
            percent(s.errors.e1.worst),
            s.errors.terms,
            s.cost.gather,
            s.cost.query
        ));
    }
    document.table(&table);
    for placement in ["tiled", "stochastic"] {
        let rows: Vec<&Size> = measured.sizes.iter().filter(|s| s.placement == placement).collect();
        let mean = rows.iter().map(|s| s.errors.e1.mean).sum::<f64>() / rows.len() as f64;
        let total = |s: &&&Size| s.cost.gather + s.cost.query;
        for anisotropy in ANISOTROPIES {
            let costs: Vec<f64> = rows.iter().filter(|s| s.anisotropy == anisotropy).map(|s| total(&s)).collect();
            let dearest = costs.iter().copied().fold(0.0, f64::max);
            let cheapest = costs.iter().copied().fold(f64::INFINITY, f64::min);
            document.paragraph(format!(
                "{placement}, anisotropy {anisotropy}: a footprint and a query of the dearest size cost {:.2} times \
                 those of the smallest, of the cheapest {:.2} times.",
                dearest / costs[0],
                cheapest / costs[0]
            ));
        }
        document.paragraph(format!("{placement}: mean E₁ over all sizes {}.", percent(mean)));
    }
    document.paragraph(format!(
        "Run-time settings on the stochastic surface, means over footprints of all sizes, {DIAL_ANISOTROPY} times as long as wide."
    ));
    let mut table =
        Table::new(0, "major axis at most, in minor ones | patches within, in σ | E₁ mean | footprint µs | query µs");
    for Dial { settings: s, mean_error, cost } in &measured.dial {
        table.row(format!(
            "{} | {} | {} | {:.1} | {:.2}",
            s.max_ratio,
            s.reach,
            percent(*mean_error),
            cost.gather,
            cost.query
        ));
    }
    document.table(&table);
}

fn percent(error: f64) -> String {
    format!("{:.2} %", error * 100.0)
}

/// Bytes against error: a line for each roughness along its Pareto front, circles for what lies off it.
fn figure(name: &str, settings: &[Setting]) -> Figure {
    let point = |s: &Setting| (s.gpu_bytes as f64 / 1024.0, s.error.mean * 100.0);
    let mut roughnesses: Vec<f64> = settings.iter().map(|s| s.roughness).collect();
    roughnesses.dedup();
    let mut series = Vec::new();
    for (roughness, colour) in roughnesses.into_iter().zip(Colour::EACH.into_iter().cycle()) {
        let of = |on_front| {
            let mut points: Vec<(f64, f64)> =
                settings.iter().filter(|s| s.roughness == roughness && s.on_front == on_front).map(point).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points
        };
        series.push(Series::line(&format!("σ_r {roughness}"), colour, of(true)).marked());
        series.push(Series::circles("", colour, of(false)));
    }
    let points = || settings.iter().map(point);
    Figure::of(Panel {
        title: format!("{name}: mean E₁ of nodes against bytes"),
        x: Axis::powers_around("KiB on the GPU", points().map(|point| point.0)),
        y: Axis::powers_around("mean E₁", points().map(|point| point.1)).unit(" %"),
        series,
    })
}
