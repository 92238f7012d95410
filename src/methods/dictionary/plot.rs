//! The marginals of a dictionary as an SVG: one panel a level, some marginals, the mean of all, and the target.

use crate::canvas::escape;
use crate::exit::{Exit, Failure};
use crate::methods::plots::{WritePlot, stems};
use glint_bake_core::dictionary::Dictionary;
use glint_bake_core::dictionary::quality::{mean_table, target_density};
use glint_bake_core::dictionary::sections;
use glint_formats::Pack;
use glint_formats::dictionary::PARAMS;
use std::fmt::Write;

const COLUMNS: u32 = 4;
const PANEL: (f64, f64) = (240.0, 170.0);
/// Left, right, top and bottom of the axes in a panel.
const AXES: (f64, f64, f64, f64) = (30.0, 228.0, 26.0, 146.0);
const TITLE: f64 = 36.0;
/// Marginals that are drawn; more would hide each other.
const SHOWN: u32 = 6;

/// Slopes from −domain to domain; each panel has a density axis of its own, since level 0 is peaked.
fn svg(name: &str, dictionary: &Dictionary) -> String {
    let options = &dictionary.options;
    let (width, height) = (
        PANEL.0 * f64::from(options.levels.min(COLUMNS)),
        TITLE + PANEL.1 * f64::from(options.levels.div_ceil(COLUMNS)),
    );
    let shown = options.marginals.min(SHOWN);
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\">"
    );
    let _ = writeln!(out, "<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>");
    let _ = writeln!(
        out,
        "<text x=\"8\" y=\"16\">{}: {shown} of {} marginals, <tspan fill=\"#000\" font-weight=\"bold\">mean</tspan>, <tspan fill=\"#c22\">target</tspan></text>",
        escape(name),
        options.marginals
    );
    for level in 0..options.levels {
        let (x, y) = (PANEL.0 * f64::from(level % COLUMNS), TITLE + PANEL.1 * f64::from(level / COLUMNS));
        let _ = writeln!(out, "<g transform=\"translate({x} {y})\">");
        panel(&mut out, dictionary, level, shown);
        out.push_str("</g>\n");
    }
    out.push_str("</svg>\n");
    out
}

fn panel(out: &mut String, dictionary: &Dictionary, level: u32, shown: u32) {
    let options = &dictionary.options;
    let slope = |b: usize| (b as f64 + 0.5) * options.spacing();
    let target: Vec<f64> = (0..options.entries as usize).map(|b| target_density(options, slope(b))).collect();
    let marginals: Vec<Vec<f64>> = (0..shown).map(|i| dictionary.entries(level, i)).collect();
    let most = marginals.iter().flatten().chain(&target).fold(0.0f64, |most, &value| most.max(value));
    let (left, right, top, base) = AXES;
    let _ = writeln!(
        out,
        "<text x=\"{left}\" y=\"{:.1}\">level {level}, {} lobes</text><text x=\"2\" y=\"{:.1}\">{most:.3}</text>",
        top - 12.0,
        2u64 << level,
        top + 4.0
    );
    let _ = writeln!(out, "<path d=\"M{left} {base}H{right}\" stroke=\"#000\"/>");
    for (at, value) in [(left, -options.domain()), (0.5 * (left + right), 0.0), (right, options.domain())] {
        let _ = writeln!(out, "<text x=\"{at}\" y=\"{:.1}\" text-anchor=\"middle\">{value:.2}</text>", base + 14.0);
    }
    let mut curve = |values: &[f64], stroke: &str| {
        let _ = writeln!(out, "<path d=\"{}\" fill=\"none\" {stroke}/>", even_path(values, most));
    };
    for (i, marginal) in marginals.iter().enumerate() {
        let hue = 200 + 120 * i / marginals.len();
        curve(marginal, &format!("stroke=\"hsl({hue},60%,60%)\" stroke-width=\"0.8\""));
    }
    curve(&mean_table(dictionary, level), "stroke=\"#000\" stroke-width=\"1.4\"");
    curve(&target, "stroke=\"#c22\" stroke-dasharray=\"4 3\"");
}

/// A table and its mirror image.
fn even_path(values: &[f64], most: f64) -> String {
    let (left, right, top, base) = AXES;
    let middle = 0.5 * (left + right);
    let step = 0.5 * (right - left) / values.len() as f64;
    let mut path = String::new();
    let mut point = |x: f64, value: f64| {
        let command = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{command}{x:.1} {:.1}", base - (base - top) * value / most);
    };
    for b in (0..values.len()).rev() {
        point(middle - (b as f64 + 0.5) * step, values[b]);
    }
    for b in 0..values.len() {
        point(middle + (b as f64 + 0.5) * step, values[b]);
    }
    path
}

/// A picture of every dictionary: its marginals.
///
/// # Errors
/// Bad input, when a dictionary cannot be used; those of `write`.
pub fn write_all(pack: &Pack, write: &mut WritePlot<'_>) -> Result<(), Failure> {
    for (stem, name) in stems(pack, PARAMS) {
        let (dictionary, _) = sections::from_pack(pack, name)
            .map_err(|e| Failure::new(Exit::BadInput, format!("dictionary {name}: {e}")))?;
        write(format!("{stem}-marginals.svg"), svg(name, &dictionary).into_bytes())?;
    }
    Ok(())
}
