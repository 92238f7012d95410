//! E₁ over footprint size, drawn.

use crate::by_footprint::Table;
use glint_bake_core::lobes::quality::FootprintErrors;
use std::fmt::Write;

/// E₁ over footprint size, a panel a map: ours and the better k-means.
pub fn plot(all: &[Table]) -> String {
    let (width, height) = (300.0, 190.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        3.0 * width + 20.0,
        2.0 * height + 40.0
    );
    for (at, table) in all.iter().enumerate() {
        let (left, top) = (45.0 + (at % 3) as f64 * width, 30.0 + (at / 3) as f64 * height);
        let (w, h) = (width - 60.0, height - 60.0);
        let x = |sigma: f64| left + (sigma / 0.5).log2() / 6.0 * w;
        let y = |e1: f64| top + h - (e1.clamp(0.001, 1.0) / 0.001).log10() / 3.0 * h;
        let _ = writeln!(out, "<text x=\"{left}\" y=\"{}\" font-weight=\"bold\">{}</text>", top - 8.0, table.name);
        for (value, label) in [(0.001, "0.1 %"), (0.01, "1 %"), (0.1, "10 %"), (1.0, "100 %")] {
            let line = y(value);
            let _ = writeln!(out, "<path d=\"M{left} {line}h{w}\" stroke=\"#ddd\"/>");
            let _ = writeln!(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{label}</text>", left - 4.0, line + 4.0);
        }
        for sigma in [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0] {
            let (tick, foot) = (x(sigma), top + h + 14.0);
            let _ = writeln!(out, "<text x=\"{tick}\" y=\"{foot}\" text-anchor=\"middle\">{sigma}</text>");
        }
        let mut line = |colour: &str, value: &dyn Fn(&[FootprintErrors]) -> f64| {
            let points: Vec<String> =
                table.rows.iter().map(|(sigma, row)| format!("{:.1},{:.1}", x(*sigma), y(value(row)))).collect();
            let _ = writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>",
                points.join(" ")
            );
        };
        line("#c33", &|row| row[1].e1.mean.min(row[2].e1.mean));
        line("#e90", &|row| row[3].e1.mean);
        line("#26c", &|row| row[0].e1.mean);
    }
    let foot = 2.0 * height + 20.0;
    for (x, colour, label) in [
        (45.0, "#26c", "ours"),
        (120.0, "#e90", "k-means, moments"),
        (270.0, "#c33", "k-means, averaged (the better of 1 and 4 seeds)"),
    ] {
        let _ = writeln!(out, "<text x=\"{x}\" y=\"{foot}\" fill=\"{colour}\">{label}</text>");
    }
    let _ = writeln!(out, "<text x=\"600\" y=\"{foot}\">E₁ over the footprint's σ in texels</text>\n</svg>");
    out
}
