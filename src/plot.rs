//! Plots with axes, as SVG: the one place that draws them, through plotters. Text stays text, and equal plots are equal bytes.

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Plotters places everything on whole pixels, so a plot is drawn so many times as large as it is shown.
const FINE: u32 = 4;
const FONT: &str = "sans-serif";
/// Heights of text in shown pixels: ticks, names of axes and of series; titles.
const TEXT: u32 = 11;
const TITLE: u32 = 14;
/// Height of a row of the legend, and width of its sample of a line.
const LEGEND: u32 = 18;
const SAMPLE: u32 = 22;

/// Panels beside and below each other with one title and one legend.
pub struct Figure {
    /// Title; empty for none.
    pub title: String,
    /// Panels in reading order.
    pub panels: Vec<Panel>,
    /// Panels beside each other.
    pub columns: usize,
    /// Width and height of a panel in pixels.
    pub panel_size: (u32, u32),
}

/// One pair of axes with what is drawn between them.
pub struct Panel {
    /// Title; empty for none.
    pub title: String,
    /// Axis to the right.
    pub x: Axis,
    /// Axis upwards.
    pub y: Axis,
    /// What is drawn; later ones cover earlier ones.
    pub series: Vec<Series>,
}

/// An axis: where it begins and ends, and what stands at it.
#[derive(Clone)]
pub struct Axis {
    title: String,
    logarithmic: bool,
    range: (f64, f64),
    ticks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis in equal steps, with `steps` + 1 ticks.
    pub fn linear(title: &str, (low, high): (f64, f64), steps: u32) -> Axis {
        let step = (high - low) / f64::from(steps);
        let value = |k| low + step * f64::from(k);
        let whole = |value: f64| (value - value.round()).abs() < 1e-6;
        let exact = |digits: &i32| whole(low * 10f64.powi(*digits)) && whole(step * 10f64.powi(*digits));
        let digits = (0..4).find(exact).unwrap_or(3) as usize;
        let ticks = (0..=steps).map(|k| (value(k), format!("{:.digits$}", value(k)))).collect();
        Axis { title: title.to_owned(), logarithmic: false, range: (low, high), ticks }
    }

    /// An axis in equal factors. Ticks are powers of ten within it, and twice and five times those where there are few.
    pub fn logarithmic(title: &str, (low, high): (f64, f64)) -> Axis {
        let factors: &[f64] = if high / low <= 200.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let values = powers.flat_map(|power| factors.iter().map(move |factor| factor * 10f64.powi(power)));
        let inside = low * (1.0 - 1e-9)..=high * (1.0 + 1e-9);
        let ticks = values.filter(|value| inside.contains(value)).map(|value| (value, number(value))).collect();
        Axis { title: title.to_owned(), logarithmic: true, range: (low, high), ticks }
    }

    /// A logarithmic axis from the power of ten below all `values` to the one above them. What is not above 0 lies at its
    /// beginning.
    pub fn powers_around(title: &str, values: impl Iterator<Item = f64>) -> Axis {
        let positive = values.filter(|value| *value > 0.0 && value.is_finite());
        let (low, high) = positive.fold((f64::MAX, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if high > 0.0 { (low.log10().floor(), high.log10().ceil()) } else { (0.0, 1.0) };
        Axis::logarithmic(title, (10f64.powf(low), 10f64.powf(high.max(low + 1.0))))
    }

    /// The same with these ticks.
    pub fn ticks(self, values: &[f64]) -> Axis {
        Axis { ticks: values.iter().map(|value| (*value, value.to_string())).collect(), ..self }
    }

    /// The same with this behind the number at each tick.
    pub fn unit(mut self, unit: &str) -> Axis {
        for (_, label) in &mut self.ticks {
            label.push_str(unit);
        }
        self
    }

    /// Place of a value on the axis, in its own units: what lies outside lies at an end.
    fn place(&self, value: f64) -> f64 {
        let value = if value.is_nan() { self.range.0 } else { value.clamp(self.range.0, self.range.1) };
        if self.logarithmic { value.log10() } else { value }
    }

    fn coordinate(&self) -> Coordinate {
        Coordinate {
            range: self.place(self.range.0)..self.place(self.range.1),
            ticks: self.ticks.iter().map(|(value, label)| (self.place(*value), label.clone())).collect(),
        }
    }
}

/// One, two or five times a power of ten.
fn number(value: f64) -> String {
    if (0.9e-4..1e6).contains(&value) {
        let digits = (-value.log10() - 1e-9).ceil().max(0.0) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.0e}")
    }
}

/// Colours that people tell apart who see red and green as one (Okabe and Ito).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// For what is ours.
    Blue,
    /// For the paper's.
    Vermilion,
    /// Of others.
    Green,
    /// Of others.
    Purple,
    /// Of others.
    Orange,
    /// Of others.
    Sky,
    /// For what is usual.
    Grey,
    /// For means.
    Black,
}

impl Colour {
    /// Colours for series that have no meaning of their own, again and again.
    pub const EACH: [Colour; 6] =
        [Colour::Blue, Colour::Vermilion, Colour::Green, Colour::Purple, Colour::Orange, Colour::Sky];

    fn rgb(self) -> RGBColor {
        match self {
            Colour::Blue => RGBColor(0, 114, 178),
            Colour::Vermilion => RGBColor(213, 94, 0),
            Colour::Green => RGBColor(0, 158, 115),
            Colour::Purple => RGBColor(204, 121, 167),
            Colour::Orange => RGBColor(230, 159, 0),
            Colour::Sky => RGBColor(86, 180, 233),
            Colour::Grey => RGBColor(128, 128, 128),
            Colour::Black => RGBColor(0, 0, 0),
        }
    }
}

/// Points with one name and colour.
#[derive(Clone)]
pub struct Series {
    /// Name in the legend, where each name stands once; empty for none.
    name: String,
    colour: Colour,
    points: Vec<(f64, f64)>,
    line: bool,
    dots: Dots,
    thin: bool,
    /// Width of bars from the points to the right.
    bars: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Dots {
    None,
    Filled,
    Hollow,
}

impl Series {
    /// A line through points.
    pub fn line(name: &str, colour: Colour, points: Vec<(f64, f64)>) -> Series {
        Series { name: name.to_owned(), colour, points, line: true, dots: Dots::None, thin: false, bars: None }
    }

    /// The same line with a filled dot at every point.
    pub fn marked(self) -> Series {
        Series { dots: Dots::Filled, ..self }
    }

    /// The same line, thin.
    pub fn thin(self) -> Series {
        Series { thin: true, ..self }
    }

    /// Bars of this width, each with its left upper corner at a point.
    pub fn bars(name: &str, colour: Colour, width: f64, points: Vec<(f64, f64)>) -> Series {
        Series { line: false, bars: Some(width), ..Series::line(name, colour, points) }
    }

    /// Filled dots.
    pub fn dots(name: &str, colour: Colour, points: Vec<(f64, f64)>) -> Series {
        Series { line: false, dots: Dots::Filled, ..Series::line(name, colour, points) }
    }

    /// Circles.
    pub fn circles(name: &str, colour: Colour, points: Vec<(f64, f64)>) -> Series {
        Series { line: false, dots: Dots::Hollow, ..Series::line(name, colour, points) }
    }
}

impl Figure {
    /// A figure of one panel of usual size.
    pub fn of(panel: Panel) -> Figure {
        Figure { title: String::new(), panels: vec![panel], columns: 1, panel_size: (640, 400) }
    }

    /// The figure as an SVG file.
    pub fn to_svg(&self) -> String {
        let legend = self.legend();
        let rows = self.panels.len().div_ceil(self.columns.max(1)) as u32;
        let title = if self.title.is_empty() { 0 } else { 2 * TITLE };
        let legend_rows = legend.last().map_or(0, |entry| entry.row + 1);
        let width = self.width();
        let height = title + rows * self.panel_size.1 + legend_rows * LEGEND + 6;
        let mut svg = String::new();
        self.draw(&mut svg, (width, height), title, rows, &legend).expect("a string takes every plot");
        let size = |factor: u32| format!("width=\"{}\" height=\"{}\"", width * factor, height * factor);
        svg.replacen(&size(FINE), &size(1), 1)
    }

    fn width(&self) -> u32 {
        self.columns as u32 * self.panel_size.0
    }

    /// Names of all series that have points, each once, in rows as wide as the figure.
    fn legend(&self) -> Vec<Entry<'_>> {
        let mut entries: Vec<Entry<'_>> = Vec::new();
        let (mut row, mut left) = (0, 8);
        for series in self.panels.iter().flat_map(|panel| &panel.series) {
            if series.name.is_empty()
                || series.points.is_empty()
                || entries.iter().any(|entry| entry.series.name == series.name)
            {
                continue;
            }
            let wide = SAMPLE + 6 + text_width(&series.name) + 14;
            if left + wide > self.width() && left > 8 {
                (row, left) = (row + 1, 8);
            }
            entries.push(Entry { series, row, left });
            left += wide;
        }
        entries
    }

    fn draw(
        &self,
        svg: &mut String,
        (width, height): (u32, u32),
        title: u32,
        rows: u32,
        legend: &[Entry<'_>],
    ) -> Result<(), Box<dyn std::error::Error>> {
        let root = SVGBackend::with_string(svg, (width * FINE, height * FINE)).into_drawing_area();
        root.fill(&WHITE)?;
        let text = |size: u32| (FONT, size * FINE).into_font();
        if title > 0 {
            let at = ((8 * FINE) as i32, (6 * FINE) as i32);
            root.draw(&Text::new(self.title.as_str(), at, text(TITLE)))?;
        }
        let (_, below) = root.split_vertically(title * FINE);
        let (panels, bottom) = below.split_vertically(rows * self.panel_size.1 * FINE);
        let areas = panels.split_evenly((rows as usize, self.columns));
        for (panel, area) in self.panels.iter().zip(&areas) {
            panel.draw(area)?;
        }
        for Entry { series, row, left } in legend {
            let middle = ((row * LEGEND + LEGEND / 2) * FINE) as i32;
            let (from, to) = ((left * FINE) as i32, ((left + SAMPLE) * FINE) as i32);
            series.draw(&bottom, vec![(from, middle), ((from + to) / 2, middle), (to, middle)], 1)?;
            let at = (to + (6 * FINE) as i32, middle - (TEXT * FINE) as i32 / 2);
            bottom.draw(&Text::new(series.name.as_str(), at, text(TEXT)))?;
        }
        root.present()?;
        Ok(())
    }
}

/// A series in the legend.
struct Entry<'a> {
    series: &'a Series,
    row: u32,
    left: u32,
}

/// About how wide a text is.
fn text_width(text: &str) -> u32 {
    (text.chars().count() as u32 * TEXT * 3).div_ceil(5)
}

type Area<'a, C> = DrawingArea<SVGBackend<'a>, C>;

impl Panel {
    fn draw(&self, area: &Area<'_, plotters::coord::Shift>) -> Result<(), Box<dyn std::error::Error>> {
        let text = |size: u32| (FONT, size * FINE).into_font();
        let (title, area) = area.split_vertically(if self.title.is_empty() { 0 } else { (TEXT + 12) * FINE });
        if !self.title.is_empty() {
            let style = text(TEXT + 1).style(FontStyle::Bold).into_text_style(&title);
            let at = ((title.dim_in_pixel().0 / 2) as i32, (8 * FINE) as i32);
            title.draw_text(&self.title, &style.pos(Pos::new(HPos::Center, VPos::Top)), at)?;
        }
        let mut builder = ChartBuilder::on(&area);
        let widest = self.y.ticks.iter().map(|(_, label)| text_width(label)).max().unwrap_or(0);
        let named = |title: &str| if title.is_empty() { 0 } else { TEXT + 6 };
        builder
            .margin(8 * FINE)
            .margin_right(16 * FINE)
            .x_label_area_size((TEXT + 7 + named(&self.x.title)) * FINE)
            .y_label_area_size((widest + 10 + named(&self.y.title)) * FINE);
        let mut chart = builder.build_cartesian_2d(self.x.coordinate(), self.y.coordinate())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(221, 221, 221).stroke_width(FINE))
            .axis_style(RGBColor(90, 90, 90).stroke_width(FINE))
            .set_all_tick_mark_size(4 * FINE)
            .x_labels(self.x.ticks.len())
            .y_labels(self.y.ticks.len())
            .x_desc(self.x.title.as_str())
            .y_desc(self.y.title.as_str())
            .label_style(text(TEXT))
            .axis_desc_style(text(TEXT))
            .draw()?;
        for series in &self.series {
            let place = |&(x, y): &(f64, f64)| chart.backend_coord(&(self.x.place(x), self.y.place(y)));
            if let Some(width) = series.bars {
                let (left, top) = area.get_base_pixel();
                for &(x, y) in &series.points {
                    let corners = [place(&(x, y)), place(&(x + width, 0.0))].map(|(x, y)| (x - left, y - top));
                    area.draw(&Rectangle::new(corners, series.colour.rgb().filled()))?;
                }
            }
            series.draw(&area, series.points.iter().map(place).collect(), 0)?;
        }
        Ok(())
    }
}

impl Series {
    /// Draws a line through pixels, and dots at all of them but so many at both ends.
    fn draw(
        &self,
        area: &Area<'_, plotters::coord::Shift>,
        pixels: Vec<(i32, i32)>,
        bare: usize,
    ) -> Result<(), Box<dyn std::error::Error>> {
        // What is drawn lies in pixels of the whole picture, what an area draws in its own.
        let (left, top) = if bare == 0 { area.get_base_pixel() } else { (0, 0) };
        let pixels: Vec<(i32, i32)> = pixels.into_iter().map(|(x, y)| (x - left, y - top)).collect();
        let pen = self.colour.rgb().stroke_width(if self.thin { 3 * FINE / 4 } else { 3 * FINE / 2 });
        if self.line && pixels.len() > 1 {
            area.draw(&PathElement::new(pixels.clone(), pen))?;
        }
        for &at in pixels.get(bare..pixels.len() - bare).unwrap_or_default() {
            match self.dots {
                Dots::None => {}
                Dots::Filled => area.draw(&Circle::new(at, 4 * FINE as i32, self.colour.rgb().filled()))?,
                Dots::Hollow => {
                    area.draw(&Circle::new(at, 4 * FINE as i32, WHITE.filled()))?;
                    area.draw(&Circle::new(at, 4 * FINE as i32, pen))?;
                }
            }
        }
        Ok(())
    }
}

/// An axis as plotters asks for it: its own ticks, whatever room there is.
struct Coordinate {
    range: Range<f64>,
    ticks: Vec<(f64, String)>,
}

impl Ranged for Coordinate {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        RangedCoordf64::from(self.range.clone()).map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.iter().map(|tick| tick.0).collect() }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Coordinate {
    fn format(value: &f64) -> String {
        value.to_string()
    }

    fn format_ext(&self, value: &f64) -> String {
        let tick = self.ticks.iter().find(|tick| tick.0 == *value);
        tick.map_or_else(|| Coordinate::format(value), |tick| tick.1.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_logarithm_lies_at_the_beginning() {
        let axis = Axis::powers_around("", [0.02, 0.0, 3.0].into_iter());
        assert_eq!((axis.place(0.0), axis.place(f64::NAN), axis.place(100.0)), (-2.0, -2.0, 1.0));
        assert_eq!(labels(&axis), ["0.01", "0.1", "1", "10"]);
    }

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|tick| tick.1.as_str()).collect()
    }

    #[test]
    fn ticks_say_what_they_stand_at() {
        assert_eq!(labels(&Axis::linear("", (0.0, 0.5), 4)), ["0.000", "0.125", "0.250", "0.375", "0.500"]);
        assert_eq!(labels(&Axis::linear("", (0.95, 1.35), 4)), ["0.95", "1.05", "1.15", "1.25", "1.35"]);
        assert_eq!(labels(&Axis::logarithmic("", (0.05, 2.0))), ["0.05", "0.1", "0.2", "0.5", "1", "2"]);
        assert_eq!(labels(&Axis::logarithmic("", (1e-6, 1e-3))), ["1e-6", "1e-5", "0.0001", "0.001"]);
    }

    #[test]
    fn equal_plots_are_equal_bytes() {
        let panel = || Panel {
            title: "<a> & b".to_owned(),
            x: Axis::linear("x", (0.0, 1.0), 2),
            y: Axis::linear("y", (0.0, 1.0), 2),
            series: vec![Series::line("line", Colour::Blue, vec![(0.0, 0.0), (1.0, 2.0)]).marked()],
        };
        let svg = Figure::of(panel()).to_svg();
        assert_eq!(svg, Figure::of(panel()).to_svg());
        assert!(svg.contains("&lt;a&gt; &amp; b") && svg.starts_with("<svg width=\"640\""), "{svg}");
    }
}
