//! Error of packed lobes against the f64 reference, footprint by footprint.

use super::bake::BakedLobes;
use super::query::{Detail, Gathered, QuerySettings};
use super::reference::{GridNdf, Reference};
use crate::footprint::Footprint;
use crate::quality::metrics::{Summary, e1};
use glam::DVec2;
use rayon::prelude::*;

/// Bins of the reference between points at which densities are compared: a third of σ_r.
pub const STRIDE: usize = 2;

/// What footprints of one size cost and how far off they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootprintErrors {
    /// E₁ over the footprints.
    pub e1: Summary,
    /// |∫D̂ − 1| over the footprints.
    pub energy: Summary,
    /// Lobes a footprint, on average.
    pub lobes: f64,
    /// Most lobes a footprint.
    pub most_lobes: usize,
}

/// What is measured: the level of detail's choice, or one level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measured {
    /// Levels as the evaluator chooses them.
    Chosen(QuerySettings),
    /// Levels whose cells are 2^λ texels wide ([`BakedLobes::lod_of_edge`]).
    Edge(f32),
    /// One level.
    At(Detail),
}

impl BakedLobes {
    fn seen(&self, footprint: &Footprint, roughness: f64, measured: &Measured) -> Gathered {
        let (roughness, reach) = (roughness as f32, QuerySettings::default().reach);
        match measured {
            Measured::Chosen(settings) => self.gather(footprint, roughness, settings),
            Measured::Edge(lambda) => {
                let frame = self.frame(footprint);
                let add = |list: &mut _, detail| self.add(list, &frame, detail, roughness, reach);
                self.lod_of_edge(&frame, *lambda).gather(add)
            }
            Measured::At(detail) => self.gather_detail(footprint, *detail, roughness, reach),
        }
    }
}

/// Error of several bakes of one map over `footprints`, each against the same exact P-NDFs.
pub fn footprint_errors(
    reference: &Reference<'_>,
    bakes: &[(&BakedLobes, Measured)],
    footprints: &[Footprint],
    stride: usize,
) -> Vec<FootprintErrors> {
    let rows: Vec<Vec<(f64, f64, usize)>> = footprints
        .par_iter()
        .map(|footprint| {
            let exact = reference.ndf(footprint, stride);
            let one = |(lobes, measured): &(&BakedLobes, Measured)| {
                let seen = lobes.seen(footprint, reference.roughness(), measured);
                let (e1, energy) = difference(&exact, &seen);
                (e1, energy, seen.lobes.len())
            };
            bakes.iter().map(one).collect()
        })
        .collect();
    (0..bakes.len())
        .map(|k| FootprintErrors {
            e1: Summary::of(rows.iter().map(|row| row[k].0).collect()),
            energy: Summary::of(rows.iter().map(|row| row[k].1).collect()),
            lobes: rows.iter().map(|row| row[k].2 as f64).sum::<f64>() / rows.len().max(1) as f64,
            most_lobes: rows.iter().map(|row| row[k].2).max().unwrap_or(0),
        })
        .collect()
}

/// E₁ and |∫D̂ − 1| of what is seen against the exact P-NDF. Off the grid, on the lattice that it is a part of, the exact
/// one is 0.
pub fn difference(exact: &GridNdf, seen: &Gathered) -> (f64, f64) {
    let grid = &exact.grid;
    let mut found = vec![0.0f64; exact.values.len()];
    let mut off_grid = 0.0;
    // A lobe of so small a share is nothing, and a query may hold as many of them as others.
    let least = 1e-7 * seen.lobes.iter().fold(0.0, |most: f32, lobe| most.max(lobe.share));
    for lobe in seen.lobes.iter().filter(|lobe| lobe.share > least) {
        // Half width and height of the lobe's ellipse at the distance where its density ends.
        let [a, b, c] = lobe.inverse.map(f64::from);
        let det = a * c - b * b;
        let range = |centre: f64, along: f64, origin: f64| {
            let reach = (30.0 * along / det).sqrt();
            let at = |s: f64| (s.clamp(-1.0, 1.0) - origin) / grid.spacing;
            at(centre - reach).ceil() as i64..=at(centre + reach).floor() as i64
        };
        let mean = lobe.mean.as_dvec2();
        for j in range(mean.y, a, grid.origin.y) {
            for i in range(mean.x, c, grid.origin.x) {
                let s = grid.origin + DVec2::new(i as f64, j as f64) * grid.spacing;
                if s.length_squared() > 1.0 {
                    continue;
                }
                let value = lobe.density(s.as_vec2()) as f64;
                if (0..grid.width as i64).contains(&i) && (0..grid.height as i64).contains(&j) {
                    found[j as usize * grid.width + i as usize] += value;
                } else {
                    off_grid += value;
                }
            }
        }
    }
    let cell = grid.spacing * grid.spacing;
    let whole = exact.values.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let integral = (found.iter().sum::<f64>() + off_grid) * cell;
    (e1(&found, &exact.values) + off_grid / whole, (integral - 1.0).abs())
}
