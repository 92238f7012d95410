//! The marginals of a dictionary as an SVG: one panel a level, some marginals, the mean of all, and the target.

use crate::exit::{Exit, Failure};
use crate::methods::plots::{WritePlot, stems};
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glint_bake_core::dictionary::Dictionary;
use glint_bake_core::dictionary::quality::{mean_table, target_density};
use glint_bake_core::dictionary::sections;
use glint_formats::Pack;
use glint_formats::dictionary::PARAMS;

const COLUMNS: usize = 4;
/// Marginals that are drawn; more would hide each other.
const SHOWN: u32 = 6;

/// Slopes from −domain to domain; each panel has a density axis of its own, since level 0 is peaked.
fn svg(name: &str, dictionary: &Dictionary) -> String {
    let options = &dictionary.options;
    let shown = options.marginals.min(SHOWN);
    let figure = Figure {
        title: format!("{name}: {shown} of {} marginals", options.marginals),
        panels: (0..options.levels).map(|level| panel(dictionary, level, shown)).collect(),
        columns: COLUMNS.min(options.levels as usize),
        panel_size: (240, 170),
    };
    figure.to_svg()
}

fn panel(dictionary: &Dictionary, level: u32, shown: u32) -> Panel {
    let options = &dictionary.options;
    let slope = |b: usize| (b as f64 + 0.5) * options.spacing();
    let target: Vec<f64> = (0..options.entries as usize).map(|b| target_density(options, slope(b))).collect();
    let marginals: Vec<Vec<f64>> = (0..shown).map(|i| dictionary.entries(level, i)).collect();
    let most = marginals.iter().flatten().chain(&target).fold(0.0f64, |most, &value| most.max(value));
    // A table and its mirror image.
    let even = |values: &[f64]| -> Vec<(f64, f64)> {
        let right = values.iter().enumerate().map(|(b, &value)| (slope(b), value));
        right.clone().rev().map(|(slope, value)| (-slope, value)).chain(right).collect()
    };
    let mut series: Vec<Series> =
        marginals.iter().map(|marginal| Series::line("marginals", Colour::Sky, even(marginal)).thin()).collect();
    series.push(Series::line("target", Colour::Vermilion, even(&target)));
    series.push(Series::line("mean", Colour::Black, even(&mean_table(dictionary, level))).thin());
    Panel {
        title: format!("level {level}, {} lobes", 2u64 << level),
        x: Axis::linear("", (-options.domain(), options.domain()), 2),
        y: Axis::linear("", (0.0, most), 1),
        series,
    }
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
