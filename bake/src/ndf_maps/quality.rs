//! Error of packed NDF maps against the f64 reference: node by node, and footprint by footprint on a covered surface.

use super::bake;
use super::baked::BakedNdfMaps;
use super::eval::EvalSettings;
use super::reference::ReferenceNdf;
use super::reference_surface::SurfaceReference;
use crate::footprint::Footprint;
use crate::normal_map::NormalMap;
use crate::quality::metrics::{DiskGrid, Summary, e1};
use glam::Vec2;
use rayon::prelude::*;

/// Points of the measuring grid a standard deviation of the intrinsic lobe.
const GRID_PER_SIGMA: f64 = 3.0;

/// Error of one decoded NDF.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NdfError {
    /// E₁ = ∫|D̂ − D| / ∫D over the unit disk.
    pub e1: f64,
    /// |∫D̂ − 1| over the unit disk.
    pub energy: f64,
}

impl NdfError {
    /// Error of `density` against `exact`.
    pub fn of(exact: &ReferenceNdf, density: impl Fn(Vec2) -> f32) -> NdfError {
        ExactNdf::new(exact).error(density)
    }
}

/// An exact NDF on the grid that errors are measured on: made once, it measures any number of bakes.
#[derive(Clone, Debug)]
pub struct ExactNdf {
    grid: DiskGrid,
    values: Vec<f64>,
}

impl ExactNdf {
    /// Evaluates the reference on its grid.
    pub fn new(exact: &ReferenceNdf) -> ExactNdf {
        let grid = exact.grid(GRID_PER_SIGMA);
        ExactNdf { values: exact.on_grid(&grid), grid }
    }

    /// Error of `density` against it.
    pub fn error(&self, density: impl Fn(Vec2) -> f32) -> NdfError {
        let decoded = self.grid.evaluate(|s| density(s.as_vec2()) as f64);
        NdfError { e1: e1(&decoded, &self.values), energy: (self.grid.integral(&decoded) - 1.0).abs() }
    }
}

/// Error of every node's decoded NDF against the integral under its window, in the order of the node records. `select`
/// says which nodes to measure; the exact integral of a steep map at a small roughness takes seconds a node.
pub fn node_errors(map: &NormalMap, baked: &BakedNdfMaps, select: impl Fn(usize) -> bool + Sync) -> Vec<NdfError> {
    let roughness = baked.params.intrinsic_roughness as f64;
    let map = &bake::repeating(map);
    let windows = bake::windows(map, &baked.params.levels, f64::from(baked.params.finest_variance));
    windows
        .par_iter()
        .enumerate()
        .filter(|(node, _)| select(*node))
        .map(|(node, window)| {
            let exact = ReferenceNdf::of_window(map, window, roughness);
            NdfError::of(&exact, |s| baked.node_density(node as u32, s))
        })
        .collect()
}

/// What footprints of one size cost and how far off they are.
#[derive(Clone, Debug, PartialEq)]
pub struct FootprintErrors {
    /// E₁ over the footprints.
    pub e1: Summary,
    /// |∫D̂ − 1| over the footprints.
    pub energy: Summary,
    /// Nodes and lobes a footprint, on average.
    pub terms: f64,
}

/// Error over `footprints` of the material that `reference` is of.
pub fn footprint_errors(
    reference: &SurfaceReference<'_>,
    footprints: &[Footprint],
    settings: EvalSettings,
) -> FootprintErrors {
    let material = reference.material();
    let measured: Vec<(NdfError, usize)> = footprints
        .par_iter()
        .map(|footprint| {
            let terms = material.gather(footprint, settings);
            let exact = reference.ndf(footprint);
            let error = NdfError::of(&exact, |s| material.density(&terms, s));
            (error, terms.len())
        })
        .collect();
    let count = measured.len().max(1) as f64;
    FootprintErrors {
        e1: Summary::of(measured.iter().map(|m| m.0.e1).collect()),
        energy: Summary::of(measured.iter().map(|m| m.0.energy).collect()),
        terms: measured.iter().map(|m| m.1 as f64).sum::<f64>() / count,
    }
}
