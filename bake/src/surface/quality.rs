//! Error of a surface's P-NDFs against the exact one of the same surface, assembled as a map.

use super::baked::Surface;
use super::eval::level_sum;
use super::query::{SurfaceSettings, query};
use crate::footprint::Footprint;
use crate::lobes::LobesOptions;
use crate::lobes::bake::{MEASURED_REFINEMENT, MEASURED_SIGMAS, measured_footprints};
use crate::lobes::eval::ConditionalLobe;
use crate::lobes::quality::{FootprintErrors, Gathered, STRIDE, difference};
use crate::lobes::query::Detail;
use crate::lobes::reference::Reference;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use crate::quality::metrics::Summary;
use crate::quality::sweep;
use crate::rng::{ItemRng, Purpose};
use crate::synthesis::assemble;
use glam::DVec2;
use glint_formats::lobes::{Filter, FootprintError};
use glint_formats::synthesis::Layout;
use rayon::prelude::*;

/// The piece that is assembled around a footprint reaches this many standard deviations, more than the reference does.
const REACH: f64 = 4.6;
/// Patches of a surface without end that errors are measured on.
const MEASURED_PATCHES: u32 = 64;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measured {
    /// Levels as the evaluator chooses them for a footprint.
    Chosen(SurfaceSettings),
    /// One level.
    At(Detail, SurfaceSettings),
}

impl Measured {
    fn gather(&self, surface: &Surface, footprint: &Footprint, roughness: f64) -> Gathered {
        match self {
            Measured::Chosen(settings) => surface.gather(footprint, roughness as f32, settings),
            Measured::At(detail, settings) => surface.gather_detail(footprint, *detail, roughness as f32, settings),
        }
    }
}

impl Surface {
    /// The lobes that a footprint sees, shares summing to 1.
    pub fn gather(&self, footprint: &Footprint, roughness: f32, settings: &SurfaceSettings) -> Gathered {
        let q = query(self, footprint, roughness, settings);
        let add = |list: &mut Vec<ConditionalLobe>, detail| {
            level_sum(&q, detail, &mut |lobe: &ConditionalLobe| list.push(*lobe))
        };
        Gathered::of(&self.lobes.lod(&q.point.frame, &settings.lobes), add)
    }

    /// The lobes that a footprint sees at one level.
    fn gather_detail(
        &self,
        footprint: &Footprint,
        detail: Detail,
        roughness: f32,
        settings: &SurfaceSettings,
    ) -> Gathered {
        let q = query(self, footprint, roughness, settings);
        let add = |list: &mut Vec<ConditionalLobe>, detail| {
            level_sum(&q, detail, &mut |lobe: &ConditionalLobe| list.push(*lobe))
        };
        let mut gathered = Gathered::default();
        gathered.add_level(detail, 1.0, add);
        gathered
    }
}

/// The surface of a sample, and what the intrinsic lobe and the filter are.
#[derive(Clone, Copy)]
pub struct Exact<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// The map that it is made of.
    pub sample: &'a NormalMap,
    /// Intrinsic roughness σ_r.
    pub roughness: f64,
    /// Pieces of the reference, see [`Reference::refined`]: 1 is as fine as it is by itself.
    pub refinement: f64,
}

impl Exact<'_> {
    /// The map around a footprint, and the footprint on it. Empty where the sample is not the surface's.
    fn piece(&self, footprint: &Footprint) -> Option<(NormalMap, Footprint)> {
        let (_, major, _) = footprint.principal();
        let reach = DVec2::splat(REACH * major + 2.0);
        let (low, high) = ((footprint.mean - reach).floor(), (footprint.mean + reach).ceil());
        let size = (high - low).as_uvec2();
        let piece =
            assemble(&self.surface.synthesis, self.sample, (low.x as i32, low.y as i32), (size.x, size.y)).ok()?;
        Some((piece, Footprint { mean: footprint.mean - low, ..*footprint }))
    }

    /// E₁, energy and lobes of each way to measure, over `footprints`, each against the same exact P-NDFs.
    pub fn errors(&self, measured: &[Measured], footprints: &[Footprint], stride: usize) -> Vec<FootprintErrors> {
        let rows: Vec<Vec<(f64, f64, usize)>> = footprints
            .par_iter()
            .filter_map(|footprint| {
                let (map, local) = self.piece(footprint)?;
                let reference = Reference::new(&map, self.filter(), self.roughness).refined(self.refinement);
                let exact = reference.ndf(&local, stride);
                let one = |measured: &Measured| {
                    let gathered = measured.gather(self.surface, footprint, self.roughness);
                    let (e1, energy) = difference(&exact, &gathered);
                    (e1, energy, gathered.lobes.len())
                };
                Some(measured.iter().map(one).collect())
            })
            .collect();
        (0..measured.len()).map(|k| FootprintErrors::of(rows.iter().map(|row| row[k]))).collect()
    }

    fn filter(&self) -> Filter {
        self.surface.lobes.params.filter
    }
}

/// Errors over a few footprints a size, anywhere on the surface, as the evaluator chooses levels.
pub(super) fn measure(
    surface: &Surface,
    sample: &NormalMap,
    roughness: f64,
    options: &LobesOptions,
    progress: &dyn Progress,
) -> Vec<FootprintError> {
    if options.footprints == 0 {
        return Vec::new();
    }
    const SEED: u64 = 11;
    let params = &surface.synthesis.params;
    let (columns, rows) = match params.layout {
        Layout::Patches { columns, rows, .. } => (columns, rows),
        Layout::CornerTiles { .. } => (MEASURED_PATCHES, MEASURED_PATCHES),
    };
    let extent = DVec2::new(f64::from(columns), f64::from(rows)) * f64::from(params.patch);
    let exact = Exact { surface, sample, roughness, refinement: MEASURED_REFINEMENT };
    progress.begin("error", MEASURED_SIGMAS.len() as u64);
    let row = |&sigma: &f64| {
        let footprints = sweep::footprints(sigma, 1.0, extent, measured_footprints(sigma, options), SEED);
        let e1 = exact.errors(&[Measured::Chosen(SurfaceSettings::default())], &footprints, 3 * STRIDE)[0].e1;
        progress.advance(1);
        FootprintError { sigma_texels: sigma as f32, mean: e1.mean as f32, worst: e1.worst as f32 }
    };
    let rows = MEASURED_SIGMAS.iter().map(row).collect();
    progress.end();
    rows
}

/// `count` seeded footprints of `sigma` texels on a seam between two patches, or, if `inside`, in the middle of patches;
/// each is half the time under a corner of patches, or in the middle of both axes.
pub fn seam_footprints(surface: &Surface, sigma: f64, count: u32, seed: u64, inside: bool) -> Vec<Footprint> {
    let params = &surface.synthesis.params;
    let (patch, overlap) = (f64::from(params.patch), f64::from(params.overlap));
    let (seam, middle, free) = match params.layout {
        Layout::Patches { .. } => (patch - 0.5 * overlap, 0.5 * (patch - overlap), patch - overlap),
        Layout::CornerTiles { margin, .. } => {
            let border = f64::from(margin) + overlap;
            (f64::from(margin) + 0.5 * overlap, 0.5 * patch, patch - 2.0 * border)
        }
    };
    let clear = (0.5 * free - 2.0 * sigma).max(0.0);
    (0..count)
        .map(|k| {
            let mut rng = ItemRng::new(seed, Purpose::SurfaceFootprints, k);
            let tile = DVec2::new(f64::from(rng.below(16)), f64::from(rng.below(16))) * patch;
            let jitter = |rng: &mut ItemRng| 2.0 * rng.unit() - 1.0;
            let place = if inside {
                DVec2::new(middle + clear * jitter(&mut rng), middle + clear * jitter(&mut rng))
            } else {
                let on_seam = seam + 0.5 * overlap * jitter(&mut rng);
                let along = if rng.below(2) == 0 { seam } else { rng.unit() * patch };
                if rng.below(2) == 0 { DVec2::new(on_seam, along) } else { DVec2::new(along, on_seam) }
            };
            Footprint::new(tile + place, sigma, 1.0, 0.0)
        })
        .collect()
}

impl FootprintErrors {
    /// Summaries of E₁, energy and number of lobes of each footprint.
    fn of(rows: impl Iterator<Item = (f64, f64, usize)> + Clone) -> FootprintErrors {
        let count = rows.clone().count().max(1);
        FootprintErrors {
            e1: Summary::of(rows.clone().map(|row| row.0).collect()),
            energy: Summary::of(rows.clone().map(|row| row.1).collect()),
            lobes: rows.clone().map(|row| row.2 as f64).sum::<f64>() / count as f64,
            most_lobes: rows.map(|row| row.2).max().unwrap_or(0),
        }
    }
}
