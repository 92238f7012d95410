//! What a report measures of one example.

use crate::report::settings::Settings;
use glam::{DVec2, Vec2};
use glint_bake_core::error::Result;
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::bake::bake_maps;
use glint_bake_core::ndf_maps::baked::{BakedNdfMaps, Material};
use glint_bake_core::ndf_maps::eval::{EvalSettings, Terms};
use glint_bake_core::ndf_maps::options::{NdfMapsOptions, PlacementOptions, StochasticOptions, TransformRanges};
use glint_bake_core::ndf_maps::placement::place;
use glint_bake_core::ndf_maps::quality::{FootprintErrors, footprint_errors};
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::ndf_maps::sections::to_sections;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::quality::sweep::{ANISOTROPIES, FOOTPRINTS, SIGMAS_TEXELS, footprints as sweep_footprints};
use glint_formats::ndf_maps::{MeasuredError, STEPS_PER_ROUGHNESS};
use glint_formats::{Codec, Resource};
use std::time::Instant;

/// Everything measured of one example.
pub struct Example {
    /// Bake settings, bytes, time and error.
    pub settings: Vec<Setting>,
    /// Sizes of footprints on covered surfaces.
    pub sizes: Vec<Size>,
    /// Run-time settings.
    pub dial: Vec<Dial>,
}

/// One way to bake.
pub struct Setting {
    pub roughness: f64,
    /// E₁ asked of nodes.
    pub max_error: f64,
    /// Bytes of all sections that a GPU holds, tiled placement.
    pub gpu_bytes: usize,
    pub milliseconds: f64,
    pub error: MeasuredError,
    /// No other setting of this roughness has fewer bytes and a smaller mean error.
    pub on_front: bool,
}

/// Footprints of one size.
pub struct Size {
    pub placement: &'static str,
    pub sigma: f64,
    pub anisotropy: f64,
    pub errors: FootprintErrors,
    pub cost: Cost,
}

/// One run-time setting on the stochastic surface: means over footprints of all sizes, [`DIAL_ANISOTROPY`] times as long as wide.
pub struct Dial {
    pub settings: EvalSettings,
    pub mean_error: f64,
    pub cost: Cost,
}

/// Microseconds on one thread.
#[derive(Clone, Copy, Default)]
pub struct Cost {
    /// To find a footprint's terms.
    pub gather: f64,
    /// To evaluate them for one direction.
    pub query: f64,
}

/// Ratio of axes of the footprints that run-time settings are measured at: more than the fast ones see.
pub const DIAL_ANISOTROPY: f64 = 8.0;
/// Run-time settings from fast to accurate.
const DIAL: [EvalSettings; 4] = [
    EvalSettings { max_ratio: 2.0, reach: 2.0 },
    EvalSettings::REAL_TIME,
    EvalSettings { max_ratio: 8.0, reach: 3.0 },
    EvalSettings::ACCURATE,
];

/// Measures an example with `count` footprints a size.
pub fn example(map: &NormalMap, count: u32, scale: &Settings) -> Result<Example> {
    let maps = bake_maps(map, &NdfMapsOptions::default(), &Silent)?;
    let one = |degrees: f64| TransformRanges { rotate_degrees: (degrees, degrees), ..TransformRanges::default() };
    let placements = [
        ("tiled", PlacementOptions::Tiled(one(20.0))),
        ("stochastic", PlacementOptions::Stochastic(StochasticOptions::default())),
    ];
    let mut sizes = Vec::new();
    let mut dial = Vec::new();
    for (name, options) in placements {
        let placement = place(map, maps.params.intrinsic_roughness as f64, &options)?;
        let material = Material { maps: maps.clone(), placement };
        let reference = SurfaceReference::new(map, &material);
        for anisotropy in ANISOTROPIES {
            for sigma in SIGMAS_TEXELS {
                let (errors, cost) =
                    measured(map, &reference, sigma, anisotropy, count, EvalSettings::REAL_TIME, scale);
                sizes.push(Size { placement: name, sigma, anisotropy, errors, cost });
            }
        }
        if name == "stochastic" {
            for settings in DIAL {
                dial.push(dial_setting(map, &reference, settings, count.div_ceil(8), scale));
            }
        }
    }
    Ok(Example { settings: settings(map, scale)?, sizes, dial })
}

fn dial_setting(
    map: &NormalMap,
    reference: &SurfaceReference<'_>,
    settings: EvalSettings,
    count: u32,
    scale: &Settings,
) -> Dial {
    let mut dial = Dial { settings, mean_error: 0.0, cost: Cost::default() };
    let share = 1.0 / SIGMAS_TEXELS.len() as f64;
    for sigma in SIGMAS_TEXELS {
        let (errors, cost) = measured(map, reference, sigma, DIAL_ANISOTROPY, count, settings, scale);
        dial.mean_error += errors.e1.mean * share;
        dial.cost.gather += cost.gather * share;
        dial.cost.query += cost.query * share;
    }
    dial
}

fn measured(
    map: &NormalMap,
    reference: &SurfaceReference<'_>,
    sigma: f64,
    anisotropy: f64,
    count: u32,
    settings: EvalSettings,
    scale: &Settings,
) -> (FootprintErrors, Cost) {
    const SEED: u64 = 5;
    let extent = DVec2::new(map.width as f64, map.height as f64) * 32.0;
    let footprints = sweep_footprints(sigma, anisotropy, extent, count, SEED);
    let errors = footprint_errors(reference, &footprints, settings);
    // The same 64 places whatever was asked, so that costs compare between reports.
    let places = sweep_footprints(sigma, anisotropy, extent, scale.pick(FOOTPRINTS, 4), SEED);
    (errors, cost(reference.material(), &places, settings, scale.pick(16, 2)))
}

/// Time of a footprint and of a query, over directions spread where the whole example's NDF lies: the least of so many
/// rounds, because other work on the machine only ever adds to it.
fn cost(material: &Material, footprints: &[Footprint], settings: EvalSettings, rounds: usize) -> Cost {
    const SIDE: usize = 8;
    let top = material.maps.nodes[material.maps.nodes.len() - 1];
    let step = material.maps.params.intrinsic_roughness / STEPS_PER_ROUGHNESS;
    let vec2 = |[x, y]: [u32; 2]| Vec2::new(x as f32, y as f32);
    let low = vec2(top.origin()) * step - 1.0;
    let size = vec2(top.size()) * vec2(top.spacing()) * step;
    let mut least = Cost { gather: f64::INFINITY, query: f64::INFINITY };
    for _ in 0..rounds {
        let begin = Instant::now();
        let terms: Vec<Terms> = footprints.iter().map(|footprint| material.gather(footprint, settings)).collect();
        least.gather = least.gather.min(begin.elapsed().as_secs_f64() * 1e6 / footprints.len() as f64);
        let begin = Instant::now();
        let mut sum = 0.0;
        for terms in &terms {
            for k in 0..SIDE * SIDE {
                let at = Vec2::new((k % SIDE) as f32 + 0.5, (k / SIDE) as f32 + 0.5) / SIDE as f32;
                sum += material.density(terms, low + at * size);
            }
        }
        std::hint::black_box(sum);
        let queries = (footprints.len() * SIDE * SIDE) as f64;
        least.query = least.query.min(begin.elapsed().as_secs_f64() * 1e6 / queries);
    }
    least
}

/// Bakes with several errors asked, at the roughnesses of the accuracy targets; at the largest alone for
/// a quick look.
fn settings(map: &NormalMap, scale: &Settings) -> Result<Vec<Setting>> {
    let mut all = Vec::new();
    for roughness in [0.02, 0.01, 0.005].into_iter().take(scale.pick(3, 1)) {
        let first = all.len();
        for max_error in [0.2, 0.1, 0.05, 0.03, 0.02, 0.01] {
            let options = NdfMapsOptions { roughness, max_error, ..NdfMapsOptions::default() };
            let begin = Instant::now();
            let baked = bake_maps(map, &options, &Silent)?;
            let milliseconds = begin.elapsed().as_secs_f64() * 1e3;
            let error = baked.params.measured;
            let gpu_bytes = gpu_bytes(map, roughness, baked)?;
            all.push(Setting { roughness, max_error, gpu_bytes, milliseconds, error, on_front: false });
        }
        mark_front(&mut all[first..]);
    }
    Ok(all)
}

/// Bytes of the sections of a tiled material of these maps, parameters left out.
fn gpu_bytes(map: &NormalMap, roughness: f64, maps: BakedNdfMaps) -> Result<usize> {
    let placement = place(map, roughness, &PlacementOptions::Tiled(TransformRanges::default()))?;
    let sections = to_sections("", &Material { maps, placement }, Codec::None);
    let on_gpu = sections.iter().filter(|section| section.resource != Resource::Parameters);
    Ok(on_gpu.map(|section| section.payload.len()).sum())
}

fn mark_front(settings: &mut [Setting]) {
    for k in 0..settings.len() {
        let (bytes, error) = (settings[k].gpu_bytes, settings[k].error.mean);
        let beaten = settings.iter().any(|other| {
            (other.gpu_bytes < bytes && other.error.mean <= error)
                || (other.gpu_bytes <= bytes && other.error.mean < error)
        });
        settings[k].on_front = !beaten;
    }
}
