//! How many nodes have which error, as an SVG.

use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glint_bake_core::ndf_maps::baked::BakedNdfMaps;

const BINS: usize = 40;

/// Histogram of node errors, with lines at the mean, the 95th percentile and the error that was asked for.
pub fn svg(name: &str, maps: &BakedNdfMaps) -> String {
    let measured = maps.params.measured;
    let asked = f64::from(maps.params.max_error);
    let end = measured.worst.max(asked).max(1e-6) * 1.05;
    let mut counts = [0u32; BINS];
    for error in &maps.params.node_errors {
        counts[((f64::from(*error) / end * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let most = f64::from(counts.iter().copied().max().unwrap_or(0).max(1));
    let wide = 100.0 * end / BINS as f64;
    let bins = counts.iter().enumerate().filter(|(_, count)| **count > 0);
    let bars = bins.map(|(bin, count)| (wide * bin as f64, f64::from(*count))).collect();
    let rule = |label: &str, error: f64, colour| {
        let at = 100.0 * error;
        Series::line(&format!("{label} {at:.3} %"), colour, vec![(at, 0.0), (at, most)])
    };
    let mut figure = Figure::of(Panel {
        title: format!("{name}: E₁ of {} nodes", maps.nodes.len()),
        x: Axis::linear("E₁", (0.0, 100.0 * end), 4).unit(" %"),
        y: Axis::linear("nodes", (0.0, most), 1),
        series: vec![
            Series::bars("", Colour::Sky, 0.9 * wide, bars),
            rule("mean", measured.mean, Colour::Green),
            rule("p95", measured.p95, Colour::Orange),
            rule("asked", asked, Colour::Vermilion),
        ],
    });
    figure.panel_size = (640, 280);
    figure.to_svg()
}
