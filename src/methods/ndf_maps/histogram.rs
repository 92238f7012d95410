//! How many tiles have which error, as an SVG.

use crate::canvas::escape;
use glint_bake_core::ndf_maps::baked::BakedNdfMaps;
use std::fmt::Write;

const BINS: usize = 40;
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 280.0;
const MARGIN: f64 = 44.0;

/// Histogram of tile errors, with lines at the mean, the 95th percentile and the error that was asked for.
pub fn svg(name: &str, maps: &BakedNdfMaps) -> String {
    let measured = maps.params.measured;
    let asked = f64::from(maps.params.max_error);
    let end = measured.worst.max(asked).max(1e-6) * 1.05;
    let mut counts = [0u32; BINS];
    for tile in &maps.tiles {
        counts[((f64::from(tile.error) / end * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let x = |error: f64| MARGIN + error / end * (WIDTH - 2.0 * MARGIN);
    let base = HEIGHT - MARGIN;
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">"
    );
    let _ = writeln!(out, "<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>");
    let _ = writeln!(out, "<text x=\"{MARGIN}\" y=\"20\">{}: E₁ of {} tiles</text>", escape(name), maps.tiles.len());
    for (bin, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let left = x(end * bin as f64 / BINS as f64);
        let tall = f64::from(count) / f64::from(most) * (base - MARGIN);
        let wide = (WIDTH - 2.0 * MARGIN) / BINS as f64 - 1.0;
        let _ = writeln!(
            out,
            "<rect x=\"{left:.1}\" y=\"{:.1}\" width=\"{wide:.1}\" height=\"{tall:.1}\" fill=\"#4a7ebb\"><title>{count} tiles</title></rect>",
            base - tall
        );
    }
    for (row, (label, error, colour)) in
        [("mean", measured.mean, "#2a2"), ("p95", measured.p95, "#d80"), ("asked", asked, "#c22")]
            .into_iter()
            .enumerate()
    {
        let at = x(error);
        let text_y = 34.0 + 13.0 * row as f64;
        let _ =
            writeln!(out, "<line x1=\"{at:.1}\" y1=\"{text_y:.1}\" x2=\"{at:.1}\" y2=\"{base}\" stroke=\"{colour}\"/>");
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{text_y:.1}\" fill=\"{colour}\">{label} {:.3} %</text>",
            at + 4.0,
            100.0 * error
        );
    }
    let _ =
        writeln!(out, "<line x1=\"{MARGIN}\" y1=\"{base}\" x2=\"{}\" y2=\"{base}\" stroke=\"#000\"/>", WIDTH - MARGIN);
    for tick in 0..=4 {
        let error = end * f64::from(tick) / 4.0;
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{:.2} %</text>",
            x(error),
            base + 18.0,
            100.0 * error
        );
    }
    out.push_str("</svg>\n");
    out
}
