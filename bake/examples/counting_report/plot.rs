//! Mean, variance and shape of four draws by the expected count, at N = 10⁴.

use super::measure;
use super::variants::Variant;
use std::fmt::Write;

const TRIALS: f32 = 1e4;
/// Panels: title, least and greatest value.
const PANELS: [(&str, f64, f64); 3] =
    [("E[n] / Np", 0.95, 1.35), ("variance / Npq", 0.5, 1.5), ("Wasserstein distance / σ", 0.0, 0.5)];
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 180.0;
const LEFT: f64 = 50.0;

/// One panel below the other.
pub fn plot(all: &[Variant]) -> String {
    let shown = [(0, "paper", "#c60"), (3, "moved mean", "#a0a"), (4, "two gates a side", "#06c"), (1, "ours", "#1b6")];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {}\" font-family=\"sans-serif\" font-size=\"11\">\n",
        3.0 * HEIGHT + 20.0
    );
    let x = |expected: f64| LEFT + (expected.log10() + 2.0) / 4.0 * (WIDTH - LEFT - 120.0);
    let y = |panel: usize, value: f64| {
        let (_, low, high) = PANELS[panel];
        let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
        panel as f64 * HEIGHT + 24.0 + (1.0 - share) * (HEIGHT - 50.0)
    };
    for (panel, (title, low, high)) in PANELS.into_iter().enumerate() {
        writeln!(svg, "<text x=\"{LEFT}\" y=\"{:.1}\" font-weight=\"bold\">{title}</text>", y(panel, high) - 8.0)
            .unwrap();
        for i in 0..=4 {
            let value = low + (high - low) * f64::from(i) / 4.0;
            let at = y(panel, value);
            let right = WIDTH - 120.0;
            writeln!(
                svg,
                "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"#ddd\"/><text x=\"8\" y=\"{at:.1}\">{value:.3}</text>"
            )
            .unwrap();
        }
        for power in -2..=2 {
            let below = y(panel, low) + 14.0;
            writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{below:.1}\">{}</text>",
                x(10f64.powi(power)) - 8.0,
                10f64.powi(power)
            )
            .unwrap();
        }
    }
    writeln!(svg, "<text x=\"{}\" y=\"{}\">expected count Np, N = 10⁴</text>", LEFT + 150.0, 3.0 * HEIGHT + 12.0)
        .unwrap();
    for (order, (index, name, colour)) in shown.into_iter().enumerate() {
        let mut paths = [const { String::new() }; 3];
        for i in 0..=160 {
            let expected = 10f64.powf(-2.0 + f64::from(i) / 40.0);
            let p = (expected / f64::from(TRIALS)) as f32;
            let (found, _) = measure(&all[index], TRIALS, p, 1.0 - p);
            let values = [1.0 + found.relative_mean_error, 1.0 + found.variance_error, found.wasserstein];
            for panel in 0..3 {
                let letter = if i == 0 { "M" } else { "L" };
                write!(paths[panel], "{letter}{:.1} {:.1}", x(expected), y(panel, values[panel])).unwrap();
            }
        }
        for path in paths {
            writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>").unwrap();
        }
        let (at, below) = (WIDTH - 112.0, 40.0 + 16.0 * order as f64);
        writeln!(svg, "<text x=\"{at}\" y=\"{below}\" fill=\"{colour}\">{name}</text>").unwrap();
    }
    svg + "</svg>\n"
}
