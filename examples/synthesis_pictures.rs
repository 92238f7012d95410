//! A synthesised normal map as pictures, and what it measures, as a row of a markdown table on stdout.
//!
//! `synthesis_pictures MAP FOLDER [KEY=VALUE]…` writes `FOLDER/NAME-all.png`, the surface made smaller to 1024 pixels, and
//! `FOLDER/NAME-part.png`, some texels at full size; with `-` for a folder nothing. Keys: crop (256; 0 is the whole map),
//! x, y, reduce (1; the mean of so many texels a side is one), repeat (0: the crop does not), size (4096), colours (0; else corner tiles), variants, patch, overlap, alignment,
//! tolerance, candidates, alpha, seed, part (512), name. MAP may be `synthetic:leather`, or brushed, scratches, flakes: a map of 512²
//! texels made by formula.

use glint_bake::canvas::Canvas;
use glint_bake::input::{Crop, InputOptions, load_normal_map, synthetic};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::synthesis::quality::{feature_ends, repetition, whole_share};
use glint_bake_core::synthesis::{Synthesis, SynthesisOptions, Target, assemble, bake};
use glint_formats::Wrap;
use std::path::Path;

/// Edge of the overview in pixels.
const OVERVIEW: u32 = 1024;
/// Where the part begins, away from multiples of patches.
const PART_AT: (i32, i32) = (700, 900);
/// Root mean square of the projected normals in a picture: weaker ones are made stronger, to be seen.
const CONTRAST: f64 = 0.35;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [map, folder, settings @ ..] = arguments.as_slice() else {
        eprintln!("usage: synthesis_pictures MAP FOLDER [KEY=VALUE]...");
        std::process::exit(2);
    };
    let done = match map.strip_prefix("synthetic:") {
        Some(kind) => made(kind).and_then(|file| run(file.path(), folder, &Settings(settings))),
        None => run(Path::new(map), folder, &Settings(settings)),
    };
    if let Err(why) = done {
        eprintln!("{why}");
        std::process::exit(1);
    }
}

/// A map made by formula, as a file that is gone when it is dropped.
fn made(kind: &str) -> Result<tempfile::NamedTempFile, String> {
    let make = match kind {
        "brushed" => synthetic::brushed,
        "scratches" => synthetic::scratches,
        "flakes" => synthetic::flakes,
        "leather" => synthetic::leather,
        _ => return Err(format!("synthetic:{kind}: expected brushed, scratches, flakes or leather")),
    };
    let file = tempfile::Builder::new().prefix(kind).suffix(".png").tempfile().map_err(|e| e.to_string())?;
    make(512, 512, 1).save(file.path()).map_err(|e| e.to_string())?;
    Ok(file)
}

/// The arguments KEY=VALUE.
struct Settings<'a>(&'a [String]);

impl Settings<'_> {
    fn text(&self, key: &str) -> Option<&str> {
        self.0.iter().find_map(|setting| setting.strip_prefix(key)?.strip_prefix('='))
    }

    fn number<T: std::str::FromStr>(&self, key: &str, default: T) -> Result<T, String> {
        self.text(key).map_or(Ok(default), |v| v.parse().map_err(|_| format!("{key}: expected a number, found {v}")))
    }
}

fn run(path: &Path, folder: &str, settings: &Settings<'_>) -> Result<(), String> {
    let crop = settings.number("crop", 256)?;
    let (x, y) = (settings.number("x", 0)?, settings.number("y", 0)?);
    let wrap = if settings.number("repeat", 0)? == 1 { Wrap::Repeat } else { Wrap::Clamp };
    let input =
        InputOptions { crop: (crop > 0).then_some(Crop { x, y, w: crop, h: crop }), wrap, ..InputOptions::default() };
    let sample = reduced(&load_normal_map(path, &input).map_err(|e| e.to_string())?.map, settings.number("reduce", 1)?);
    let size = settings.number("size", 4096u32)?;
    let target = match settings.number("colours", 0)? {
        0 => Target::Patches { width: size, height: size },
        colours => Target::Unbounded { colours, variants: settings.number("variants", 1)? },
    };
    let usual = SynthesisOptions::default();
    let options = SynthesisOptions {
        target,
        patch: settings.number("patch", usual.patch)?,
        overlap: settings.number("overlap", usual.overlap)?,
        alignment: settings.number("alignment", usual.alignment)?,
        error_tolerance: settings.number("tolerance", usual.error_tolerance)?,
        max_candidates: settings.number("candidates", usual.max_candidates)?,
        alpha: settings.number("alpha", usual.alpha)?,
        seed: settings.number("seed", usual.seed)?,
    };
    let begin = cpu_seconds();
    let surface = bake(&sample, &options, &Silent).map_err(|e| e.to_string())?;
    let seconds = cpu_seconds() - begin;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = settings.text("name").unwrap_or(&stem);
    row(name, &surface, &sample, size, seconds);
    if folder != "-" {
        let write = |suffix: &str, canvas: Canvas| {
            let file = Path::new(folder).join(format!("{name}-{suffix}.png"));
            glint_formats::write_atomic(&file, &canvas.to_png()).map_err(|e| format!("{}: {e}", file.display()))
        };
        let shrink = size.div_ceil(OVERVIEW);
        write("all", picture(&surface, &sample, (0, 0), size, shrink)?)?;
        write("part", picture(&surface, &sample, PART_AT, settings.number("part", 512)?, 1)?)?;
    }
    Ok(())
}

/// A map whose texels are the means of `by` × `by` texels; what is left over at its right and below is not used.
fn reduced(map: &NormalMap, by: u32) -> NormalMap {
    let by = by.max(1);
    let (width, height) = (map.width / by, map.height / by);
    let mean = |x: u32, y: u32| {
        let texels = (0..by).flat_map(|j| (0..by).map(move |i| ((y * by + j) * map.width + x * by + i) as usize));
        let [sx, sy] = texels.fold([0.0; 2], |sum, at| [sum[0] + map.projected[at][0], sum[1] + map.projected[at][1]]);
        [sx / (by * by) as f32, sy / (by * by) as f32]
    };
    let projected = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
    NormalMap { width, height, wrap: map.wrap, projected }
}

/// Name, CPU-seconds, bytes, seams, ends of features in a thousand neighbours across seams, distinct offsets; shares of blocks
/// of 8, 16, 32 texels that are cells of the sample, at multiples of their own edge and of the alignment; repetition.
fn row(name: &str, surface: &Synthesis, sample: &NormalMap, size: u32, seconds: f64) {
    let params = &surface.params;
    let share =
        |log2_size: u32, exact| 100.0 * whole_share(surface, (size >> (3 + log2_size)) as i32, log2_size, exact);
    let patches = (size / params.patch) as i32;
    println!(
        "| {name} | {seconds:.2} | {} | {:.2} | {:.1} | {} | {:.0} / {:.0} / {:.0} | {:.0} / {:.0} | {:.3} |",
        4 * (surface.offsets.len() + surface.seams.len()),
        params.measured.seam_ratio,
        feature_ends(surface, sample),
        params.measured.distinct_offsets,
        share(0, true),
        share(1, true),
        share(2, true),
        share(1, false),
        share(2, false),
        repetition(surface, patches, 12.min(patches / 2)),
    );
}

/// Normals as colours; `shrink`² texels a pixel.
fn picture(surface: &Synthesis, sample: &NormalMap, at: (i32, i32), size: u32, shrink: u32) -> Result<Canvas, String> {
    let piece = assemble(surface, sample, at, (size, size)).map_err(|e| e.to_string())?;
    let squares = sample.projected.iter().map(|&[x, y]| f64::from(x * x + y * y));
    let deviation = (squares.sum::<f64>() / sample.projected.len() as f64).sqrt();
    let gain = if deviation > 0.0 { (CONTRAST / deviation).max(1.0) } else { 1.0 };
    let mut canvas = Canvas::new(size / shrink, size / shrink, [0; 3]);
    for (px, py) in (0..canvas.height).flat_map(|py| (0..size / shrink).map(move |px| (px, py))) {
        let mut sum = [0.0; 2];
        for (i, j) in (0..shrink).flat_map(|j| (0..shrink).map(move |i| (i, j))) {
            let texel = piece.projected[((py * shrink + j) * size + px * shrink + i) as usize];
            sum = [sum[0] + f64::from(texel[0]), sum[1] + f64::from(texel[1])];
        }
        let [x, y] = sum.map(|v| v * gain / f64::from(shrink * shrink));
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        canvas.set(px, py, [x, y, z].map(|v| ((0.5 * v + 0.5).clamp(0.0, 1.0) * 255.0 + 0.5) as u8));
    }
    Ok(canvas)
}

/// User and system seconds of this process.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |at: usize| fields.get(at).and_then(|v| v.parse::<f64>().ok()).unwrap_or(f64::NAN);
    (ticks(11) + ticks(12)) / 100.0
}
