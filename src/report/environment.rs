//! Environments: time and error of the filter beside Filament's cmgen where it is installed, and the second moment of what
//! facets reflect with optimal levels and with the paper's.

use super::clock::{children_cpu_seconds, cpu_seconds};
use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glint_bake_core::environment::cube::{face_of, texel_direction, texel_solid_angle_sr};
use glint_bake_core::environment::image::luminance;
use glint_bake_core::environment::levels::{ROUGHNESSES, RadianceHistogram, even_directions, log_uniform, optimal};
use glint_bake_core::environment::quality::{Cube, compare, compare_cube, error_of};
use glint_bake_core::environment::reads;
use glint_bake_core::environment::reference::{filtered, second_moments};
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, LevelCount, bake};
use glint_bake_core::progress::Silent;
use glint_formats::environment::{Kernel, MeasuredTexels, SHARP};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the images.
const FOLDER: &str = "hdri";
/// Texels a roughness that are compared.
const TEXELS: u32 = 64;
/// Look-ups that are compared, and the seed they follow, which is not that of a bake.
const READS: u32 = 4096;
const READS_SEED: u64 = 77;
/// Mips of cmgen's cubes.
const CMGEN_MIPS: u32 = 9;
/// Directions that second moments are measured in; others than the levels were chosen with.
const DIRECTIONS: usize = 48;
/// Counts of levels.
const COUNTS: [usize; 5] = [2, 4, 6, 8, 16];
/// Floors of radiance that the paper's levels are tried with; the best counts.
const FLOORS: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// Says why the report cannot be made.
pub fn check(settings: &Settings) -> Result<(), Failure> {
    images(settings).map(|_| ())
}

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let mut tables = Tables::new();
    let mut points = Vec::new();
    for path in images(settings)? {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        settings.terminal.say(&format!("environment: {name}"));
        let image = settings.environment(&path)?;
        default_rows(&name, &image, settings, &mut tables)?;
        filter_rows(&name, &path, &image, settings, &mut tables, &mut points)?;
        moment_rows(&name, &image, settings, &mut tables.moments)?;
    }
    let mut document = Document::new("environment", "Environments: time and error", settings);
    document.paragraph(
        "Images are those of the data folder's `hdri`. CPU seconds are user and system time of all threads, of one run, from \
         decoded pixels to the finished textures; cmgen's include decoding. Exact values are sums over the source image in f64 \
         (`reference.rs`).",
    );
    document.plot("", "CPU seconds against error", &figure(&points));
    document.heading(2, "What is read");
    document.paragraph(
        "What a shader reads of what `glint-bake environment` makes of each image without flags: 4,096 look-ups, α from 0.01 to \
         1, evenly in its logarithm, half of them in directions of their own, half with the brightest pixel within their lobe, \
         as far from its middle as a facet is tilted by chance. *Relative*: root mean square of the errors of luminance, each \
         over its exact value; *worst* is the largest of them. *RMSE / mean*: root mean square error over the mean of the exact \
         values, which under a sun is that of the few look-ups that hit its core.",
    );
    document.table(&tables.reads);
    document.heading(2, "Texels");
    document.paragraph(
        "The same bakes: the factor of stored radiance, the largest RMSE over the mean luminance that rounding alone makes in a \
         roughness (over all texels, recorded in the pack), and the largest RMSE of a roughness (worst texel) over 64 random \
         texels of each, half of them chosen by luminance and weighted back, so that suns are in it. Asked of the filter are \
         0.02 where α is below 0.04, 0.005 elsewhere.",
    );
    document.table(&tables.texels);
    document.heading(2, "Filter");
    document.paragraph(
        "Error asked of the filter, faces of 128 to 1 texels, one roughness each; *default* has 16 roughnesses on faces of 128 \
         to 16. cmgen with faces of 256 to 1, `--ibl-min-lod-size=1`. RMSE and worst texel over roughnesses with α ≥ 0.04, \
         largest; each at its own roughnesses.",
    );
    document.table(&tables.filters);
    document.heading(2, "Mips of cmgen");
    document.paragraph("At 1024 samples, each mip: RMSE (worst texel).");
    document.table(&tables.mips);
    document.heading(2, "Second moment of what a facet reflects");
    document.paragraph(
        "Mean of |⟨L²⟩ with levels / ⟨L²⟩ − 1| over 48 directions and 5 roughnesses (0.05 to 0.8), exact filter. The paper's levels have the best of the floors 0.01 to 1e-5 for each number. Matched: from the stored √⟨L²⟩, \
         over the compared texels of roughnesses with α ≥ 0.04.",
    );
    document.table(&tables.moments);
    Ok(document)
}

/// Images of the data folder in the order of their names; the smallest alone for a quick look.
fn images(settings: &Settings) -> Result<Vec<PathBuf>, Failure> {
    let folder = settings.data(FOLDER)?;
    let entries = std::fs::read_dir(&folder).map_err(|e| Failure::io(&folder, "cannot be read", &e))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    if settings.quick {
        paths.sort_by_key(|path| (path.metadata().map_or(u64::MAX, |file| file.len()), path.clone()));
        paths.truncate(1);
    }
    paths.sort();
    Ok(paths)
}

/// The report's tables, which grow image by image.
struct Tables {
    reads: Table,
    texels: Table,
    filters: Table,
    mips: Table,
    moments: Table,
}

impl Tables {
    fn new() -> Tables {
        Tables {
            reads: Table::new(
                1,
                "image | KiB | α ≥ .04: relative | worst | RMSE / mean | α < .04: relative | worst | RMSE / mean",
            ),
            texels: Table::new(1, "image | factor | rounding | α = 0 | 0 < α < .04 | α ≥ .04"),
            filters: Table::new(2, "image | setting | CPU s | RMSE | worst texel | energy"),
            mips: Table::new(
                1,
                "image | 0: α 0 | 1: .004 | 2: .018 | 3: .044 | 4: .086 | 5: .15 | 6: .25 | 7: .42 | 8: 1",
            ),
            moments: Table::new(2, "image | levels | K = 1 | 2 | 4 | 6 | 8 | 16"),
        }
    }
}

/// Options of bakes that measure nothing.
fn defaults() -> EnvironmentOptions {
    EnvironmentOptions { measured_reads: 0, ..EnvironmentOptions::default() }
}

fn options(levels: u32, filter_error: f64) -> EnvironmentOptions {
    EnvironmentOptions {
        min_face_size: 1,
        per_size: 1,
        levels: LevelCount::Exactly(levels),
        filter_error,
        ..defaults()
    }
}

/// Error of a list of cubes, the largest of each.
fn largest(errors: impl Iterator<Item = MeasuredTexels>) -> MeasuredTexels {
    errors.fold(MeasuredTexels::default(), |a, b| MeasuredTexels {
        rmse: a.rmse.max(b.rmse),
        worst: a.worst.max(b.worst),
    })
}

/// Errors of the texels of an environment: of the mirror, of filtered roughnesses below [`SHARP`], and of the others.
fn texel_errors(image: &EnvironmentImage, environment: &Environment, texels: u32) -> [MeasuredTexels; 3] {
    let mean = luminance(image.mean());
    let roughness = &environment.params.roughness;
    let of = |index: usize| error_of(&compare(image, environment, index as u32, texels), mean);
    let (sharp, rest): (Vec<usize>, Vec<usize>) = (1..roughness.len()).partition(|index| roughness[*index] < SHARP);
    [of(0), largest(sharp.into_iter().map(of)), largest(rest.into_iter().map(of))]
}

fn default_rows(name: &str, image: &EnvironmentImage, settings: &Settings, tables: &mut Tables) -> Result<(), Failure> {
    let options = defaults();
    let environment = bake(image, &options, &Silent)?;
    let params = &environment.params;
    let reads = reads::random(image, &environment, (reads::LEAST_ALPHA, 1.0), READS_SEED, settings.pick(READS, 64));
    let [sharp, rest] = reads::errors_of(&environment, &reads)
        .map(|e| format!("{:.4} | {:.1} % | {:.4}", e.relative, e.worst * 100.0, e.of_mean));
    tables.reads.row(format!("{name} | {} | {rest} | {sharp}", options.texture_bytes() / 1024));
    let rounding = params.measured.rounding.iter().copied().fold(0.0, f64::max);
    let cells = texel_errors(image, &environment, settings.pick(TEXELS, 4))
        .map(|error| format!("{:.4} ({:.1} %)", error.rmse, error.worst * 100.0));
    tables.texels.row(format!("{name} | {} | {rounding:.4} | {}", params.radiance_scale, cells.join(" | ")));
    Ok(())
}

/// A point of the plot.
struct Point {
    ours: bool,
    cpu: f64,
    rmse: f64,
}

fn filter_rows(
    name: &str,
    path: &Path,
    image: &EnvironmentImage,
    settings: &Settings,
    tables: &mut Tables,
    points: &mut Vec<Point>,
) -> Result<(), Failure> {
    let texels = settings.pick(TEXELS, 4);
    let mean = luminance(image.mean());
    let mut row = |setting: &str, ours: bool, cpu: f64, error: MeasuredTexels, energy: f64| {
        let MeasuredTexels { rmse, worst } = error;
        let worst = worst * 100.0;
        tables.filters.row(format!("{name} | {setting} | {cpu:.2} | {rmse:.5} | {worst:.2} % | {energy:.1e}"));
        points.push(Point { ours, cpu, rmse });
    };
    let ours = [
        ("0.001", options(1, 0.001)),
        ("0.005", options(1, 0.005)),
        ("0.005, K = 4", options(4, 0.005)),
        ("0.02", options(1, 0.02)),
        ("default", defaults()),
    ];
    for (setting, options) in ours {
        let begin = cpu_seconds();
        let environment = bake(image, &options, &Silent)?;
        let cpu = cpu_seconds() - begin;
        let [_, _, error] = texel_errors(image, &environment, texels);
        row(setting, true, cpu, error, environment.params.measured.energy);
    }
    for samples in [64, 1024] {
        let Some((cpu, faces)) = cmgen(path, samples, settings) else { continue };
        let error = |mip: u32| {
            let size = 256 >> mip;
            let cube = Cube { kernel: Kernel::GgxNl, alpha: cmgen_alpha(mip), size };
            let texel = |face: usize, i: u32, j: u32| {
                // cmgen's world is ours turned by half a turn about y.
                let d = texel_direction(face, i, j, size);
                let (face, s, t) = face_of(glam::DVec3::new(-d.x, d.y, -d.z));
                let cell = |c: f64| (0.5 * (c + 1.0) * f64::from(size)) as u32;
                faces[mip as usize][face][(cell(t) * size + cell(s)) as usize]
            };
            error_of(&compare_cube(image, &cube, mip, texels, texel), mean)
        };
        let errors: Vec<MeasuredTexels> = (0..CMGEN_MIPS).map(error).collect();
        let rough = (0..CMGEN_MIPS).filter(|mip| cmgen_alpha(*mip) >= SHARP).map(|mip| errors[mip as usize]);
        let sum: f64 = faces[0]
            .iter()
            .flat_map(|face| face.iter().enumerate())
            .map(|(k, t)| {
                let area = texel_solid_angle_sr(k as u32 % 256, k as u32 / 256, 256);
                area * luminance([t[0], t[1], t[2]].map(f64::from))
            })
            .sum();
        let energy = (sum / (4.0 * std::f64::consts::PI * mean) - 1.0).abs();
        row(&format!("cmgen {samples}"), false, cpu, largest(rough), energy);
        if samples == 1024 {
            let cells: Vec<String> =
                errors.iter().map(|e| format!("{:.4} ({:.1} %)", e.rmse, e.worst * 100.0)).collect();
            tables.mips.row(format!("{name} | {}", cells.join(" | ")));
        }
    }
    Ok(())
}

/// GGX roughness α of a mip of cmgen's.
fn cmgen_alpha(mip: u32) -> f64 {
    let part = f64::from(mip) / f64::from(CMGEN_MIPS - 1);
    (1.0 - (1.0 - part).sqrt()).powi(2)
}

/// Texels of the six faces of a mip.
type Faces = Vec<Vec<[f32; 4]>>;

/// Faces of every mip that cmgen makes, and its CPU seconds; `None` where it is not installed.
fn cmgen(path: &Path, samples: u32, settings: &Settings) -> Option<(f64, Vec<Faces>)> {
    let folder = tempfile::tempdir().ok()?;
    let begin = children_cpu_seconds();
    let status = Command::new("cmgen")
        .args(["-q", "-s", "256", "-f", "exr", "--ibl-min-lod-size=1"])
        .arg(format!("--ibl-samples={samples}"))
        .arg(format!("--ibl-ld={}", folder.path().display()))
        .arg(path)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .ok()?;
    let cpu = children_cpu_seconds() - begin;
    let out = folder.path().join(path.file_stem()?);
    let read = |mip: usize, face: &str| {
        use exr::prelude::*;
        let file = out.join(format!("m{mip}_{face}.exr"));
        let image = read_first_flat_layer_from_file(file).ok()?;
        let channel = |name: &str| {
            let list = &image.layer_data.channel_data.list;
            Some(list.iter().find(|c| c.name.eq(name))?.sample_data.values_as_f32().collect::<Vec<f32>>())
        };
        let (r, g, b) = (channel("R")?, channel("G")?, channel("B")?);
        Some((0..r.len()).map(|k| [r[k], g[k], b[k], 0.0]).collect())
    };
    let mip = |mip| ["px", "nx", "py", "ny", "pz", "nz"].iter().map(|face| read(mip, face)).collect::<Option<Vec<_>>>();
    let mips = (0..CMGEN_MIPS as usize).map(mip).collect::<Option<Vec<_>>>();
    if !status.success() || mips.is_none() {
        settings.terminal.warn(&format!("environment: cmgen cannot be compared: {status}"));
    }
    Some((cpu, mips?))
}

fn moment_rows(name: &str, image: &EnvironmentImage, settings: &Settings, rows: &mut Table) -> Result<(), Failure> {
    let histogram = RadianceHistogram::new(image, Kernel::GgxNl);
    let ours: Vec<Vec<f64>> = COUNTS.iter().map(|count| optimal(&histogram, *count).0).collect();
    let mut all = ours;
    for count in COUNTS {
        all.extend(FLOORS.map(|floor| log_uniform(image, count, floor)));
    }
    let views: Vec<_> = even_directions(settings.pick(DIRECTIONS, 4), 0.37)
        .into_iter()
        .flat_map(|d| ROUGHNESSES.map(|alpha| (d, alpha)))
        .collect();
    let errors: Vec<(Vec<f64>, f64)> = views
        .par_iter()
        .map(|(d, alpha)| {
            let (with_levels, exact) = second_moments(image, Kernel::GgxNl, *d, *alpha, &all);
            let mean = filtered(image, Kernel::GgxNl, *d, *alpha).luminance;
            (with_levels.iter().map(|m| (m / exact - 1.0).abs()).collect(), (mean * mean / exact - 1.0).abs())
        })
        .collect();
    let mean = |k: usize| errors.iter().map(|e| e.0[k]).sum::<f64>() / errors.len() as f64;
    let one = errors.iter().map(|e| e.1).sum::<f64>() / errors.len() as f64;
    let n = COUNTS.len();
    let cells =
        |value: &dyn Fn(usize) -> f64| (0..n).map(|k| format!("{:.3}", value(k))).collect::<Vec<_>>().join(" | ");
    let best = |k: usize| (0..FLOORS.len()).map(|f| mean(n + k * FLOORS.len() + f)).fold(f64::INFINITY, f64::min);
    rows.row(format!("{name} | optimal | {one:.3} | {}", cells(&mean)));
    rows.row(format!("{name} | the paper's | {one:.3} | {}", cells(&best)));
    let environment = bake(image, &defaults(), &Silent)?;
    let (mut sum, mut count) = (0.0, 0.0);
    let rough = (1..=environment.params.filtered()).filter(|k| environment.params.roughness[*k as usize] >= SHARP);
    for index in rough {
        for c in compare(image, &environment, index, settings.pick(TEXELS, 4)) {
            sum += (f64::from(c.stored[3]).powi(2) / c.exact.square - 1.0).abs();
            count += 1.0;
        }
    }
    rows.row(format!("{name} | matched, any K | | {:.4} | | | | ", sum / count));
    Ok(())
}

/// CPU seconds against RMSE: ours filled, cmgen's hollow.
fn figure(points: &[Point]) -> Figure {
    let of = |ours| points.iter().filter(|p| p.ours == ours).map(|p| (p.cpu, p.rmse)).collect::<Vec<_>>();
    Figure::of(Panel {
        title: "RMSE at α ≥ 0.04 against CPU seconds".to_owned(),
        x: Axis::powers_around("CPU seconds", points.iter().map(|p| p.cpu)),
        y: Axis::powers_around("RMSE over mean luminance", points.iter().map(|p| p.rmse)),
        series: vec![
            Series::dots("ours", Colour::Blue, of(true)),
            Series::circles("cmgen", Colour::Vermilion, of(false)),
        ],
    })
}
