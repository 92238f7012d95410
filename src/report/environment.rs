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
use glint_bake_core::environment::quality::{Compared, compare, error_of};
use glint_bake_core::environment::reference::{filtered, second_moments};
use glint_bake_core::environment::{Environment, EnvironmentImage, EnvironmentOptions, LevelCount, bake};
use glint_bake_core::progress::Silent;
use glint_formats::environment::Kernel;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the images.
const FOLDER: &str = "hdri";
/// Texels a mip that are compared.
const TEXELS: u32 = 64;
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
        default_row(&name, &image, settings, &mut tables.defaults)?;
        filter_rows(&name, &path, &image, settings, &mut tables, &mut points)?;
        moment_rows(&name, &image, settings, &mut tables.moments)?;
    }
    let mut document = Document::new("environment", "Environments: time and error", settings);
    document.paragraph(
        "Images are those of the data folder's `hdri`. CPU seconds are user and system time of all threads, of one run, from \
         decoded pixels to the finished textures; cmgen's include decoding. Exact values are sums over the source image in f64 \
         (`reference.rs`). RMSE is that of luminance over the mean luminance, from 64 random texels a mip, half of them chosen \
         by luminance and weighted back, so that suns are in it.",
    );
    document.plot("", "CPU seconds against error", &figure(&points));
    document.heading(2, "Default options");
    document.paragraph(
        "What `glint-bake environment` makes of each image without flags: the factor of stored radiance, the largest RMSE that \
         rounding alone makes in a mip (over all texels, recorded in the pack), and each mip's RMSE (worst texel). Asked are \
         0.02 (25 %) where α is below 0.04, 0.005 (5 %) elsewhere.",
    );
    document.table(&tables.defaults);
    document.heading(2, "Filter");
    document.paragraph(
        "Faces of 256, 9 mips, `--kernel ggx-nl`, cmgen with `--ibl-min-lod-size=1`. RMSE and worst texel over mips with α ≥ \
         0.04, largest.",
    );
    document.table(&tables.filters);
    document.heading(2, "Mips");
    document.paragraph(
        "`--max-error 0.005`, each mip: RMSE (worst texel), ours and cmgen's at 1024 samples. Mip 0 is compared with means over texels that are exact along 512 lines of each.",
    );
    document.table(&tables.mips);
    document.heading(2, "Second moment of what a facet reflects");
    document.paragraph(
        "Mean of |⟨L²⟩ with levels / ⟨L²⟩ − 1| over 48 directions and 5 roughnesses (0.05 to 0.8), `--kernel ndf`, exact \
         filter. The paper's levels have the best of the floors 0.01 to 1e-5 for each number. Matched: from the stored √⟨L²⟩, \
         over the compared texels of mips with α ≥ 0.04.",
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
    defaults: Table,
    filters: Table,
    mips: Table,
    moments: Table,
}

impl Tables {
    fn new() -> Tables {
        Tables {
            defaults: Table::new(1, "image | factor | rounding | 0: α 0 | 1: .011 | 2: .051 | 3: .14 | 4: .31 | 5: 1"),
            filters: Table::new(2, "image | setting | CPU s | RMSE | worst texel | energy"),
            mips: Table::new(
                2,
                "image | filter | 0: α 0 | 1: .004 | 2: .018 | 3: .044 | 4: .086 | 5: .15 | 6: .25 | 7: .42 | 8: 1",
            ),
            moments: Table::new(2, "image | levels | K = 1 | 2 | 4 | 6 | 8 | 16"),
        }
    }
}

fn options(levels: u32, max_error: f64) -> EnvironmentOptions {
    EnvironmentOptions {
        min_face_size: 1,
        levels: LevelCount::Exactly(levels),
        kernel: Kernel::GgxNl,
        max_error,
        measured_texels: 0,
        ..EnvironmentOptions::default()
    }
}

fn default_row(name: &str, image: &EnvironmentImage, settings: &Settings, rows: &mut Table) -> Result<(), Failure> {
    let options = EnvironmentOptions { measured_texels: 0, ..EnvironmentOptions::default() };
    let environment = bake(image, &options, &Silent)?;
    let params = &environment.params;
    let rounding = params.measured.rounding.iter().copied().fold(0.0, f64::max);
    let mean = luminance(image.mean());
    let cell = |mip: u32| {
        let error = error_of(&compare(image, &environment, mip, settings.pick(TEXELS, 4)), mean);
        format!("{:.4} ({:.1} %)", error.rmse, error.worst * 100.0)
    };
    let cells: Vec<String> = (0..params.mips()).map(cell).collect();
    rows.row(format!("{name} | {} | {rounding:.4} | {}", params.radiance_scale, cells.join(" | ")));
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
    let baked = |levels, max_error| -> Result<(Environment, f64), Failure> {
        let begin = cpu_seconds();
        let environment = bake(image, &options(levels, max_error), &Silent)?;
        Ok((environment, cpu_seconds() - begin))
    };
    let (chosen, _) = baked(1, 0.005)?;
    let texels = settings.pick(TEXELS, 4);
    let compared: Vec<Vec<Compared>> = (0..9).map(|mip| compare(image, &chosen, mip, texels)).collect();
    let mean = luminance(image.mean());
    let cells = |read: &dyn Fn(u32, &Compared) -> [f32; 4]| -> Vec<(f64, f64)> {
        let of_mip = |(mip, all): (usize, &Vec<Compared>)| {
            let stored: Vec<Compared> = all.iter().map(|c| Compared { stored: read(mip as u32, c), ..*c }).collect();
            let error = error_of(&stored, mean);
            (error.rmse, error.worst)
        };
        compared.iter().enumerate().map(of_mip).collect()
    };
    let of = |environment: &Environment| {
        cells(&|mip, c| {
            let (face, i, j) = c.texel;
            environment.radiance_texel(mip, face, i, j)
        })
    };
    let mut row = |setting: &str, ours: bool, cpu: f64, cells: &[(f64, f64)], energy: f64| {
        let most = |pick: &dyn Fn(&(f64, f64)) -> f64| cells[3..].iter().map(pick).fold(0.0, f64::max);
        let (rmse, worst) = (most(&|c| c.0), most(&|c| c.1));
        let worst = worst * 100.0;
        tables.filters.row(format!("{name} | {setting} | {cpu:.2} | {rmse:.5} | {worst:.2} % | {energy:.1e}"));
        points.push(Point { ours, cpu, rmse });
    };
    let mut mip_row = |setting: &str, cells: &[(f64, f64)]| {
        let cells: Vec<String> =
            cells.iter().map(|(rmse, worst)| format!("{rmse:.4} ({:.1} %)", worst * 100.0)).collect();
        tables.mips.row(format!("{name} | {setting} | {}", cells.join(" | ")));
    };
    for max_error in [0.001, 0.005, 0.02] {
        let (environment, cpu) = baked(1, max_error)?;
        let cells = of(&environment);
        row(&format!("{max_error}"), true, cpu, &cells, environment.params.measured.energy);
        if max_error == 0.005 {
            mip_row("ours", &cells);
            let (with_levels, cpu) = baked(4, max_error)?;
            row(&format!("{max_error}, K = 4"), true, cpu, &of(&with_levels), with_levels.params.measured.energy);
        }
    }
    for samples in [64, 1024] {
        let Some((cpu, faces)) = cmgen(path, samples, settings) else { continue };
        let cells = cells(&|mip, c| {
            let (face, i, j) = c.texel;
            let size = 256 >> mip;
            // cmgen's world is ours turned by half a turn about y.
            let d = texel_direction(face, i, j, size);
            let (face, s, t) = face_of(glam::DVec3::new(-d.x, d.y, -d.z));
            let cell = |c: f64| (0.5 * (c + 1.0) * f64::from(size)) as u32;
            faces[mip as usize][face][(cell(t) * size + cell(s)) as usize]
        });
        let sum: f64 = faces[0]
            .iter()
            .flat_map(|face| face.iter().enumerate())
            .map(|(k, t)| {
                let area = texel_solid_angle_sr(k as u32 % 256, k as u32 / 256, 256);
                area * luminance([t[0], t[1], t[2]].map(f64::from))
            })
            .sum();
        row(&format!("cmgen {samples}"), false, cpu, &cells, (sum / (4.0 * std::f64::consts::PI * mean) - 1.0).abs());
        if samples == 1024 {
            mip_row("cmgen", &cells);
        }
    }
    Ok(())
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
    let mips = (0..9).map(mip).collect::<Option<Vec<_>>>();
    if !status.success() || mips.is_none() {
        settings.terminal.warn(&format!("environment: cmgen cannot be compared: {status}"));
    }
    Some((cpu, mips?))
}

fn moment_rows(name: &str, image: &EnvironmentImage, settings: &Settings, rows: &mut Table) -> Result<(), Failure> {
    let histogram = RadianceHistogram::new(image, Kernel::Ndf);
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
            let (with_levels, exact) = second_moments(image, Kernel::Ndf, *d, *alpha, &all);
            let mean = filtered(image, Kernel::Ndf, *d, *alpha).luminance;
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
    let options = EnvironmentOptions { min_face_size: 1, measured_texels: 0, ..EnvironmentOptions::default() };
    let environment = bake(image, &options, &Silent)?;
    let (mut sum, mut count) = (0.0, 0.0);
    for mip in 3..9 {
        for c in compare(image, &environment, mip, settings.pick(TEXELS, 4)) {
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
