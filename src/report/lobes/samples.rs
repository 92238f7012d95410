//! What every part of the report of lobes measures on, and how.

use crate::exit::Failure;
use crate::report::settings::Settings;
use glint_bake_core::lobes::options::LobesOptions;
use glint_bake_core::lobes::quality::{FootprintErrors, Measured};
use glint_bake_core::lobes::query::QuerySettings;
use glint_bake_core::lobes::{BakedLobes, bake};
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;

/// A map and the edge of the square that is cut from its corner.
#[derive(Clone, Copy)]
pub struct Sample {
    pub name: &'static str,
    pub file: &'static str,
    pub edge: u32,
}

const fn sample(name: &'static str, file: &'static str, edge: u32) -> Sample {
    Sample { name, file, edge }
}

/// The maps.
pub const SAMPLES: [Sample; 6] = [
    sample("scratched gold", "normals/scratched_gold_cgbookcase_rgba.png", 256),
    sample("brushed aluminium", "normals/brushed_aluminium_godot_745.png", 256),
    LEATHER,
    sample("wicker", "normals/wicker_khronos_512.png", 256),
    FLAKES,
    sample("diamond plate", "normals/diamond_plate_pmndrs0008.jpg", 256),
];
/// The map whose bakes are timed.
pub const LEATHER: Sample = sample("leather", "normals/leather_008_3dtextures.jpg", 256);
/// The map of facets that do not want filtering.
pub const FLAKES: Sample = sample("car-paint flakes", "normals/carpaint_flakes_khronos_128.png", 128);

/// Bins of the reference between points at which densities are compared: σ_r.
pub const STRIDE: usize = 6;
pub const ROUGHNESS: f64 = 0.02;
pub const SEED: u64 = 5;

/// The maps that are measured; leather alone for a quick look.
pub fn samples(settings: &Settings) -> Vec<Sample> {
    if settings.quick { vec![Sample { edge: 64, ..LEATHER }] } else { SAMPLES.to_vec() }
}

pub fn load(settings: &Settings, sample: &Sample) -> Result<NormalMap, Failure> {
    settings.normal_map(sample.file, Some(sample.edge))
}

pub fn options() -> LobesOptions {
    LobesOptions { roughness: ROUGHNESS, footprints: 0, ..LobesOptions::default() }
}

pub fn baked(map: &NormalMap, options: &LobesOptions) -> Result<BakedLobes, Failure> {
    Ok(bake(map, options, &Silent)?)
}

/// Lobes read as the evaluator chooses.
pub fn chosen(lobes: &BakedLobes) -> (&BakedLobes, Measured) {
    (lobes, Measured::Chosen(QuerySettings::default()))
}

/// Mean E₁ in per cent.
pub fn percent(errors: &FootprintErrors) -> String {
    format!("{:.2}", 100.0 * errors.e1.mean)
}
