//! `glint-bake demo`: bakes a built-in example, reads the pack back, says how accurate it is, and paints a picture of it.

mod look;

use crate::cli::Terminal;
use crate::exit::Failure;
use crate::info::Report;
use crate::input::synthetic;
use crate::methods::ndf_maps::bake::{Baked, assemble, bake_material};
use crate::output;
use crate::pack;
use crate::progress::Stages;
use crate::quantities::kib;
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, StochasticOptions, TransformRanges};
use glint_bake_core::normal_map::{GreenAxis, NormalMap, NormalOptions, RawNormals};
use glint_formats::Wrap;
use glint_formats::ndf_maps::LayeredMaterial;
use glint_formats::provenance::InputDigest;
use glint_formats::{Codec, Limits};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Lines that `--help` shows and a test runs.
const EXAMPLES: &str = "\
Examples:
  glint-bake demo --size 320x160 -o glint-demo";

/// Bake a built-in example, verify it, and paint a picture of it
///
/// Metallic paint under a scratched clear coat, and a brushed plate, from maps made by formula.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folder for the pack and the picture; it is created
    #[arg(short, long, value_name = "DIR", default_value = "glint-demo")]
    pub output: PathBuf,
    /// Size of the picture
    #[arg(long, value_name = "WxH", default_value = "1280x640", value_parser = crate::cli::values::size)]
    pub size: (u32, u32),
    /// Threads to use [default: one a core]
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
}

/// A built-in example.
struct Example {
    name: &'static str,
    make: synthetic::Material,
    edge: u32,
    ranges: TransformRanges,
}

const SEED: u64 = 7;
const COAT_F0: f32 = 0.05;
/// Deep blue paint.
const BASE_F0: [f32; 3] = [0.10, 0.26, 0.62];

fn examples() -> [Example; 3] {
    let turned = StochasticOptions::default().ranges;
    // A brushed plate keeps its direction.
    let along = TransformRanges { rotate_degrees: (-2.0, 2.0), ..TransformRanges::default() };
    [
        Example { name: "paint", make: synthetic::flakes, edge: 32, ranges: turned },
        Example { name: "coat", make: synthetic::scratches, edge: 32, ranges: turned },
        Example { name: "plate", make: synthetic::brushed, edge: 32, ranges: along },
    ]
}

/// Runs the subcommand.
pub fn run(args: &Args, terminal: Terminal) -> Result<(), Failure> {
    let folder = &args.output;
    output::create_folder(folder)?;
    let (pack_path, picture_path) = (folder.join("demo.glintpack"), folder.join("demo.png"));
    output::check_writable(&pack_path)?;
    output::check_writable(&picture_path)?;
    crate::cli::on_threads(args.threads, || {
        let start = Instant::now();
        output::write(&pack_path, &bake(terminal)?)?;
        let baked = start.elapsed();
        let report = read_back(&pack_path)?;
        for item in report.contents.items() {
            if let Some(line) = item.accuracy_line() {
                terminal.say(&format!("{:<6} {line}", format!("{}:", item.name())));
            }
        }
        let file = pack_path.display();
        terminal.say(&format!(
            "{file}: {}, baked in {:.1} s, read back, intact",
            kib(report.bytes),
            baked.as_secs_f64()
        ));
        let start = Instant::now();
        let (width, height) = args.size;
        let picture = look::Look::new(&report)?.paint(width, height);
        output::write(&picture_path, &picture.to_png())?;
        let (file, seconds) = (picture_path.display(), start.elapsed().as_secs_f64());
        terminal.say(&format!("{file}: {width} × {height} pixels, painted in {seconds:.1} s"));
        Ok(())
    })?
}

fn bake(terminal: Terminal) -> Result<Vec<u8>, Failure> {
    let stages = Stages::new(terminal);
    let mut materials = Vec::new();
    let mut inputs = Vec::new();
    for example in examples() {
        let image = (example.make)(example.edge, example.edge, SEED);
        inputs.push(InputDigest::of(&format!("built-in {}", example.name), image.as_raw()));
        let map = normal_map(&image);
        let placement = PlacementOptions::Stochastic(StochasticOptions {
            ranges: example.ranges,
            seed: SEED,
            ..Default::default()
        });
        let material = bake_material(&map, &NdfMapsOptions::default(), &placement, &stages)
            .map_err(|e| Failure::bake(Path::new(example.name), &e))?;
        materials.push(Baked { name: example.name.to_owned(), material });
    }
    let layers = LayeredMaterial { coat: "coat".into(), base: "paint".into(), coat_f0: COAT_F0, base_f0: BASE_F0 };
    let mut provenance = pack::provenance("demo");
    provenance.seed = SEED;
    provenance.inputs = inputs;
    provenance.normal_convention = "y-up".into();
    assemble(&materials, Some(&layers), &provenance, Codec::None)
}

/// The built-in maps take the same way as a file's content does.
fn normal_map(image: &image::RgbImage) -> NormalMap {
    let decode = |byte: u8| 2.0 * f32::from(byte) / 255.0 - 1.0;
    let vectors = image.pixels().map(|pixel| pixel.0.map(decode)).collect();
    let raw = RawNormals { width: image.width(), height: image.height(), vectors };
    let options = NormalOptions { wrap: Wrap::Repeat, y: GreenAxis::Up };
    NormalMap::from_vectors(&raw, &options).expect("the formulas give normals of unit length above the horizon").0
}

/// Reads the pack as any user of it would.
fn read_back(path: &Path) -> Result<Report, Failure> {
    let report = Report::of_file(path, &Limits::default());
    match report.issues.first() {
        None => report.sound().map(|_| ()).map(|()| report),
        Some(issue) => {
            // The bytes were verified before they were written.
            let what = format!("{}: it was written a moment ago and reads otherwise: {issue}", path.display());
            Err(Failure::new(report.exit(), format!("{what}; does another program write to it?")))
        }
    }
}
