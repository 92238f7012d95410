//! Surfaces of patches: bytes, and P-NDFs across seams against those inside patches, as markdown on stdout; every number is
//! measured in the run.
//!
//! `surface_report DATA [--footprints N]` reads real maps in `DATA/normals`. `just report` runs it.

use glint_bake::input::{Crop, InputOptions, load_normal_map};
use glint_bake_core::lobes::LobesOptions;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::surface::quality::{Exact, Measured, seam_footprints};
use glint_bake_core::surface::{ALIGNMENT, Surface, SurfaceOptions, SurfaceSettings, bake};
use glint_bake_core::synthesis::{SynthesisOptions, Target};
use glint_formats::Wrap;
use std::path::Path;

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
/// Up to this size four times as many: each sees a few texels, and they differ much.
const SMALL: f64 = 2.0;
/// Bins of the reference between points at which densities are compared: two thirds of σ_r.
const STRIDE: usize = 4;
const ROUGHNESS: f64 = 0.02;
const SEED: u64 = 5;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (mut data, mut footprints) = (None, 64);
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--footprints" => footprints = rest.next().and_then(|n| n.parse().ok()).unwrap_or(footprints),
            _ => data = Some(argument.clone()),
        }
    }
    let Some(data) = data else {
        eprintln!("usage: surface_report DATA [--footprints N]");
        std::process::exit(2);
    };
    println!("# Surfaces of patches: across seams and inside\n");
    println!("Written by `just report`; do not edit.\n");
    println!(
        "Samples of {SAMPLE}² texels that do not repeat, surfaces of {SURFACE}² or without end, options' defaults. E₁ = ∫|D̂ − D| / \
         ∫D in per cent, mean over {footprints} seeded footprints centred on seams (four times as many where σ ≤ {SMALL}, {WIDE} where σ > {INSIDE_UNTIL}), and as many inside patches, ±2 σ \
         clear of seams; D of the assembled map, in f64; σ in texels, σ_r = {ROUGHNESS}. Lobes a query, on average, on seams.\n"
    );
    for target in [Target::Patches { width: SURFACE, height: SURFACE }, Target::Unbounded { colours: 4, variants: 2 }] {
        println!("| sample | surface | bytes | σ | on seams | inside | ratio | lobes |");
        println!("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |");
        for (name, file) in MAPS {
            let sample = load(&Path::new(&data).join("normals").join(file));
            rows(name, &sample, target, footprints);
        }
        println!();
    }
}

fn load(path: &Path) -> NormalMap {
    let crop = Some(Crop { x: 0, y: 0, w: SAMPLE, h: SAMPLE });
    let options = InputOptions { crop, wrap: Wrap::Clamp, assume_linear: true, ..InputOptions::default() };
    load_normal_map(path, &options).unwrap_or_else(|e| panic!("{e}")).map
}

fn baked(sample: &NormalMap, target: Target) -> Surface {
    let usual = SynthesisOptions { target, alignment: ALIGNMENT, ..SynthesisOptions::default() };
    let synthesis = match target {
        Target::Patches { .. } => usual,
        Target::Unbounded { .. } => SynthesisOptions { patch: 96, overlap: 6, ..usual },
    };
    let lobes = LobesOptions { roughness: ROUGHNESS, footprints: 0, ..LobesOptions::default() };
    bake(sample, &SurfaceOptions { lobes, synthesis }, &Silent).unwrap_or_else(|e| panic!("{e}"))
}

fn rows(name: &str, sample: &NormalMap, target: Target, footprints: u32) {
    let surface = baked(sample, target);
    let exact = Exact { surface: &surface, sample, roughness: ROUGHNESS, refinement: 1.0 };
    let title = match target {
        Target::Patches { width, .. } => format!("{width}²"),
        Target::Unbounded { .. } => "without end".to_owned(),
    };
    for sigma in SIGMAS {
        let footprints = match sigma {
            small if small <= SMALL => 4 * footprints,
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
        println!(
            "| {name} | {title} | {} | {sigma} | {:.2} | {} | {} | {:.0} |",
            surface.gpu_bytes(),
            100.0 * seams.e1.mean,
            of_inside(&|mean| format!("{:.2}", 100.0 * mean)),
            of_inside(&|mean| format!("{:.2}", seams.e1.mean / mean)),
            seams.lobes
        );
    }
}
