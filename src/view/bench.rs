//! Time of each method over that of its smooth baseline, in one run, with the error against its reference beside it.

use crate::gpu::{Gpu, GpuError};
use crate::render::{Compare, Renderer, Shown, Side, View, picture};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BenchSettings {
    /// Frames of each method; their median counts.
    pub frames: u32,
    /// Samples of the reference that the error is taken against; 0 leaves the error out.
    pub reference_samples: u32,
    /// Pixels of the picture in which the error is taken.
    pub error_size: [u32; 2],
}

impl Default for BenchSettings {
    fn default() -> BenchSettings {
        BenchSettings { frames: 20, reference_samples: 256, error_size: [320, 180] }
    }
}

/// What was measured of a method.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchRow {
    /// Method.
    pub method: &'static str,
    /// Material.
    pub name: String,
    /// What its time is compared with.
    pub baseline: &'static str,
    /// Median seconds of a frame's surface pass.
    pub seconds: f64,
    /// That over the median of the baseline, whose frames took turns with those of the method.
    pub ratio: f64,
    /// Sum over pixels of the luminance's absolute difference from the reference over the sum of the reference's.
    pub error: Option<f64>,
}

/// Measures `shown` against `baseline` in the scene of `view_of`.
pub fn measure(
    gpu: &Gpu,
    renderer: &mut Renderer,
    view_of: &View,
    shown: &Shown,
    baseline: &Shown,
    settings: BenchSettings,
) -> Result<BenchRow, GpuError> {
    let of = |shown: &Shown, reference| View {
        compare: Compare::Single(Side { shown: shown.clone(), reference }),
        antialias: false,
        vary_seed: false,
        ..view_of.clone()
    };
    let views = [of(baseline, false), of(shown, false)];
    let mut times = [Vec::new(), Vec::new()];
    // The first frame of each compiles its program and is not counted.
    for frame in 0..=settings.frames.max(1) {
        for (view, times) in views.iter().zip(&mut times) {
            let seconds = frame_seconds(gpu, renderer, view)?;
            if frame > 0 {
                times.push(seconds);
            }
        }
    }
    let [base, own] = times.map(median);
    let error = if settings.reference_samples > 0 {
        let small = |reference| View { size: settings.error_size, ..of(shown, reference) };
        Some(error_of(gpu, renderer, &small(false), &small(true), settings.reference_samples)?)
    } else {
        None
    };
    Ok(BenchRow {
        method: shown.method.name(),
        name: shown.name.clone(),
        baseline: baseline.method.name(),
        seconds: own,
        ratio: own / base,
        error,
    })
}

/// Seconds of the surface pass of one frame: by the device's timestamps, else by the clock around the whole frame.
fn frame_seconds(gpu: &Gpu, renderer: &mut Renderer, view: &View) -> Result<f64, GpuError> {
    let start = std::time::Instant::now();
    picture(gpu, renderer, view, 1)?;
    let elapsed = start.elapsed().as_secs_f64();
    let passes = renderer.pass_seconds(gpu)?;
    Ok(passes.and_then(|passes| passes.first().map(|pass| pass.1)).unwrap_or(elapsed))
}

fn error_of(
    gpu: &Gpu,
    renderer: &mut Renderer,
    method: &View,
    reference: &View,
    samples: u32,
) -> Result<f64, GpuError> {
    picture(gpu, renderer, method, 1)?;
    let found = renderer.radiance(gpu, method, 0)?;
    picture(gpu, renderer, reference, samples)?;
    let truth = renderer.radiance(gpu, reference, 0)?;
    let luminance =
        |pixel: &[f32; 4]| f64::from(pixel[0]) * 0.2126 + f64::from(pixel[1]) * 0.7152 + f64::from(pixel[2]) * 0.0722;
    let mut difference = 0.0;
    let mut sum = 0.0;
    for (a, b) in found.iter().zip(&truth) {
        difference += (luminance(a) - luminance(b)).abs();
        sum += luminance(b);
    }
    Ok(difference / sum.max(f64::MIN_POSITIVE))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The rows as a Markdown table.
pub fn table(rows: &[BenchRow]) -> String {
    let mut text = String::from(
        "| method | material | ms a frame | ratio to | ratio | error |\n| --- | --- | ---: | --- | ---: | ---: |\n",
    );
    for row in rows {
        let error = row.error.map_or("".to_owned(), |error| format!("{:.1} %", 100.0 * error));
        text.push_str(&format!(
            "| {} | {} | {:.1} | {} | {:.2} | {error} |\n",
            row.method,
            row.name,
            1e3 * row.seconds,
            row.baseline,
            row.ratio
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
    }
}
