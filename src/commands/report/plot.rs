//! Bytes against error as an SVG: both axes logarithmic, a line a roughness along its Pareto front.

use super::measure::Setting;
use std::fmt::Write;

const SIZE: (f64, f64) = (640.0, 420.0);
const MARGIN: (f64, f64) = (64.0, 48.0);

/// The plot of one example's settings.
pub fn bytes_against_error(name: &str, settings: &[Setting]) -> String {
    let log = |v: f64| v.max(1e-12).log10();
    let range = |value: &dyn Fn(&Setting) -> f64| {
        let values = settings.iter().map(value);
        let (lo, hi) = values.fold((f64::MAX, f64::MIN), |(lo, hi), v| (lo.min(log(v)), hi.max(log(v))));
        (lo.floor(), hi.ceil().max(lo.floor() + 1.0))
    };
    let kib = |s: &Setting| s.bytes as f64 / 1024.0;
    let percent = |s: &Setting| s.error.mean * 100.0;
    let (x_range, y_range) = (range(&kib), range(&percent));
    let place = |v: f64, (lo, hi): (f64, f64)| (log(v) - lo) / (hi - lo);
    let x = |v: f64| MARGIN.0 + place(v, x_range) * (SIZE.0 - MARGIN.0 - 140.0);
    let y = |v: f64| SIZE.1 - MARGIN.1 - place(v, y_range) * (SIZE.1 - 2.0 * MARGIN.1);

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{}\" y=\"24\" font-size=\"15\">{name}: KiB on the GPU against mean E₁ of tiles</text>\n",
        SIZE.0, SIZE.1, MARGIN.0
    );
    for exponent in x_range.0 as i32..=x_range.1 as i32 {
        let value = 10f64.powi(exponent);
        let (at, low, high) = (x(value), SIZE.1 - MARGIN.1, MARGIN.1);
        let _ = writeln!(svg, "<path d=\"M{at:.1} {low:.1}V{high:.1}\" stroke=\"#ddd\"/>");
        let _ = writeln!(svg, "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{value} KiB</text>", low + 18.0);
    }
    for exponent in y_range.0 as i32..=y_range.1 as i32 {
        let value = 10f64.powi(exponent);
        let (at, left, right) = (y(value), MARGIN.0, SIZE.0 - 140.0);
        let _ = writeln!(svg, "<path d=\"M{left:.1} {at:.1}H{right:.1}\" stroke=\"#ddd\"/>");
        let _ =
            writeln!(svg, "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{value} %</text>", left - 6.0, at + 4.0);
    }
    let mut roughnesses: Vec<f64> = settings.iter().map(|s| s.roughness).collect();
    roughnesses.dedup();
    let colours = ["#1f77b4", "#d62728", "#2ca02c", "#9467bd"].iter().cycle();
    for (k, (roughness, colour)) in roughnesses.iter().zip(colours).enumerate() {
        let mut front: Vec<&Setting> = settings.iter().filter(|s| s.roughness == *roughness && s.on_front).collect();
        front.sort_by_key(|s| s.bytes);
        let path: Vec<String> = front.iter().map(|s| format!("{:.1} {:.1}", x(kib(s)), y(percent(s)))).collect();
        let _ = writeln!(svg, "<path d=\"M{}\" fill=\"none\" stroke=\"{colour}\"/>", path.join("L"));
        for s in settings.iter().filter(|s| s.roughness == *roughness) {
            let fill = if s.on_front { *colour } else { "white" };
            let (cx, cy) = (x(kib(s)), y(percent(s)));
            let _ = writeln!(
                svg,
                "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"4\" fill=\"{fill}\" stroke=\"{colour}\"><title>{}</title></circle>",
                s.label
            );
        }
        let (left, line) = (SIZE.0 - 128.0, MARGIN.1 + 18.0 * (k as f64 + 1.0));
        let _ = writeln!(svg, "<text x=\"{left}\" y=\"{line}\" fill=\"{colour}\">σ_r {roughness}</text>");
    }
    svg + "</svg>\n"
}
