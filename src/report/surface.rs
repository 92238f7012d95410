//! Surfaces of patches: bytes, and P-NDFs across seams against those inside patches.

use super::document::Document;
use super::settings::Settings;
use super::table::Table;
use crate::exit::Failure;
use crate::input::{Crop, InputOptions};
use crate::plot::{Axis, Colour, Figure, Panel, Series};
use glint_bake_core::lobes::LobesOptions;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::surface::quality::{Exact, Measured, seam_footprints};
use glint_bake_core::surface::{ALIGNMENT, Surface, SurfaceOptions, SurfaceSettings, bake};
use glint_bake_core::synthesis::{SynthesisOptions, Target};
use glint_formats::Wrap;

/// The maps; a square of 256² texels is cut from their upper left corner.
const MAPS: [(&str, &str); 4] = [
    ("leather", "leather_008_3dtextures.jpg"),
    ("scratched gold", "scratched_gold_cgbookcase_rgba.png"),
    ("noise", "bluenoise_bevy_512_rgba.png"),
    ("brushed aluminium", "brushed_aluminium_godot_745.png"),
];
const SAMPLE: u32 = 256;
const SURFACE: u32 = 4096;
/// Footprints; those above 14 texels do not fit inside a patch.
const SIGMAS: [f64; 7] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
const INSIDE_UNTIL: f64 = 14.0;
/// Most footprints of those above: each sees as much as hundreds of small ones.
const WIDE: u32 = 8;
/// Up to this size so many times as many: each sees a few texels, and they differ much.
const SMALL: f64 = 2.0;
const SMALL_FACTOR: u32 = 4;
/// Bins of the reference between points at which densities are compared: two thirds of σ_r.
const STRIDE: usize = 4;
const ROUGHNESS: f64 = 0.02;
const SEED: u64 = 5;

/// Maps that are measured, and their files.
fn maps(settings: &Settings) -> Vec<(&'static str, String)> {
    let maps = &MAPS[..settings.pick(MAPS.len(), 1)];
    maps.iter().map(|(name, file)| (*name, format!("normals/{file}"))).collect()
}

/// Says why the report cannot be made.
pub fn check(settings: &Settings) -> Result<(), Failure> {
    settings.check(maps(settings).iter().map(|(_, file)| file.as_str()))
}

/// Measures the report.
pub fn measure(settings: &Settings) -> Result<Document, Failure> {
    let footprints = settings.footprints(64, 1);
    let edge = settings.pick(SURFACE, 512);
    let mut tables = Vec::new();
    let mut all = Vec::new();
    for target in [Target::Patches { width: edge, height: edge }, Target::Unbounded { colours: 4, variants: 2 }] {
        let mut table = Table::new(2, "sample | surface | bytes | σ | on seams | inside | ratio | lobes");
        for (name, file) in maps(settings) {
            settings.terminal.say(&format!("surface: {name}, {}", title(target)));
            let sample = load(settings, &file)?;
            let curves = rows(name, &sample, target, footprints, &mut table)?;
            all.push((format!("{name}, {}", title(target)), curves));
        }
        tables.push(table);
    }
    let mut document = Document::new("surface", "Surfaces of patches: across seams and inside", settings);
    document.paragraph(format!(
        "Samples of {SAMPLE}² texels that do not repeat, surfaces of {edge}² or without end, options' defaults. E₁ = ∫|D̂ − D| / \
         ∫D in per cent, mean over {footprints} seeded footprints centred on seams ({SMALL_FACTOR} times as many where σ ≤ {SMALL}, \
         {WIDE} at most where σ > {INSIDE_UNTIL}), and as many inside patches, ±2 σ clear of seams; D of the assembled map, in f64; \
         σ in texels, σ_r = {ROUGHNESS}. Lobes a query, on average, on seams."
    ));
    document.plot("", "E₁ over footprint size", &figure(all));
    for table in &tables {
        document.table(table);
    }
    Ok(document)
}

fn load(settings: &Settings, file: &str) -> Result<NormalMap, Failure> {
    let crop = Some(Crop { x: 0, y: 0, w: SAMPLE, h: SAMPLE });
    settings.normal_map_as(file, &InputOptions { crop, wrap: Wrap::Clamp, ..InputOptions::default() })
}

fn title(target: Target) -> String {
    match target {
        Target::Patches { width, .. } => format!("{width}²"),
        Target::Unbounded { .. } => "without end".to_owned(),
    }
}

/// E₁ over σ, on seams and inside patches.
struct Curves {
    seams: Vec<(f64, f64)>,
    inside: Vec<(f64, f64)>,
}

/// E₁ over footprint size: a panel for each map, bounded surfaces above, those without end below.
fn figure(all: Vec<(String, Curves)>) -> Figure {
    let values = all.iter().flat_map(|(_, curves)| curves.seams.iter().chain(&curves.inside)).map(|point| point.1);
    let y = Axis::powers_around("E₁", values).unit(" %");
    let columns = all.len() / 2;
    let panel = |(title, curves): (String, Curves)| Panel {
        title,
        x: Axis::logarithmic("σ in texels", (0.5, 32.0)).ticks(&SIGMAS),
        y: y.clone(),
        series: vec![
            Series::line("inside patches", Colour::Grey, curves.inside).marked(),
            Series::line("on seams", Colour::Blue, curves.seams).marked(),
        ],
    };
    let panels = all.into_iter().map(panel).collect();
    Figure { title: String::new(), panels, columns, panel_size: (260, 220) }
}

fn baked(sample: &NormalMap, target: Target) -> Result<Surface, Failure> {
    let usual = SynthesisOptions { target, alignment: ALIGNMENT, ..SynthesisOptions::default() };
    let synthesis = match target {
        Target::Patches { .. } => usual,
        Target::Unbounded { .. } => SynthesisOptions { patch: 96, overlap: 6, ..usual },
    };
    let lobes = LobesOptions { roughness: ROUGHNESS, footprints: 0, ..LobesOptions::default() };
    Ok(bake(sample, &SurfaceOptions { lobes, synthesis }, &Silent)?)
}

fn rows(name: &str, sample: &NormalMap, target: Target, footprints: u32, table: &mut Table) -> Result<Curves, Failure> {
    let surface = baked(sample, target)?;
    let exact = Exact { surface: &surface, sample, roughness: ROUGHNESS, refinement: 1.0 };
    let title = title(target);
    let mut curves = Curves { seams: Vec::new(), inside: Vec::new() };
    for sigma in SIGMAS {
        let footprints = match sigma {
            small if small <= SMALL => SMALL_FACTOR * footprints,
            inside if inside < INSIDE_UNTIL => footprints,
            _ => footprints.min(WIDE),
        };
        let measured = |inside| {
            let places = seam_footprints(&surface, sigma, footprints, SEED, inside);
            exact.errors(&[Measured::Chosen(SurfaceSettings::default())], &places, STRIDE)[0]
        };
        let seams = measured(false);
        let inside = (sigma < INSIDE_UNTIL).then(|| measured(true));
        let of_inside =
            |text: &dyn Fn(f64) -> String| inside.map_or_else(|| "-".to_owned(), |found| text(found.e1.mean));
        table.row(format!(
            "{name} | {title} | {} | {sigma} | {:.2} | {} | {} | {:.0}",
            surface.gpu_bytes(),
            100.0 * seams.e1.mean,
            of_inside(&|mean| format!("{:.2}", 100.0 * mean)),
            of_inside(&|mean| format!("{:.2}", seams.e1.mean / mean)),
            seams.lobes
        ));
        curves.seams.push((sigma, 100.0 * seams.e1.mean));
        curves.inside.extend(inside.map(|found| (sigma, 100.0 * found.e1.mean)));
    }
    Ok(curves)
}
