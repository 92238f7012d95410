//! Continuity of what a pixel of NDF maps shows: how much it changes when the picture is zoomed by 1 %, shifted by 1/16 pixel or turned
//! by 1°, beside what the exact picture changes. Skips, and says so, where the data folder is missing.

mod real_maps;

use glam::{DVec2, Mat2, Vec2};
use glint_bake_core::footprint::Footprint;
use glint_bake_core::ndf_maps::bake::bake;
use glint_bake_core::ndf_maps::baked::Material;
use glint_bake_core::ndf_maps::eval::{EvalSettings, matrix};
use glint_bake_core::ndf_maps::options::{
    NdfMapsOptions, Options, PlacementOptions, StochasticOptions, TransformRanges,
};
use glint_bake_core::ndf_maps::reference_surface::SurfaceReference;
use glint_bake_core::normal_map::NormalMap;
use glint_bake_core::progress::Silent;
use glint_bake_core::rng::{ItemRng, Purpose};
use glint_formats::Wrap;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Directions s that a pixel is seen from.
const DIRECTIONS: usize = 8;
/// Points of the example's tables along a texel.
const PER_TEXEL: f64 = 16.0;
/// Footprints are summed to so many standard deviations.
const REACH: f64 = 4.5;
/// Ratio of axes of the pixels that are turned: a round one stays as it is.
const TURNED_RATIO: f64 = 2.0;

/// The exact picture at fixed directions: sums, over a lattice that stays where it is, of the lobes of the normals there. So a change is
/// that of the footprints' weights alone.
struct Exact<'a> {
    reference: SurfaceReference<'a>,
    /// Columns of a table.
    width: usize,
    /// Density at every point of the example and direction, a palette entry.
    tables: Vec<Vec<[f32; DIRECTIONS]>>,
}

impl<'a> Exact<'a> {
    fn new(map: &'a NormalMap, material: &'a Material, directions: &[Vec2; DIRECTIONS]) -> Exact<'a> {
        let sigma = material.maps.params.intrinsic_roughness;
        let (width, height) =
            ((f64::from(map.width) * PER_TEXEL) as usize, (f64::from(map.height) * PER_TEXEL) as usize);
        let table = |to_local: Mat2| {
            let at = |k: usize| {
                let local = (DVec2::new((k % width) as f64, (k / width) as f64) + 0.5) / PER_TEXEL;
                let normal = map.bilinear(local).0.as_vec2();
                let peak = to_local.determinant().abs() / (std::f32::consts::TAU * sigma * sigma);
                directions.map(|s| {
                    let away = to_local * s - normal;
                    peak * (-0.5 * away.length_squared() / (sigma * sigma)).exp()
                })
            };
            (0..width * height).into_par_iter().map(at).collect()
        };
        let palette = material.placement.palette.iter();
        let tables = palette.map(|entry| table(matrix(entry.normal_to_local))).collect();
        Exact { reference: SurfaceReference::new(map, material), width, tables }
    }

    /// What footprints that overlap show.
    fn pictures(&self, footprints: &[Footprint]) -> Vec<[f64; DIRECTIONS]> {
        let (minor, major, _) = footprints[0].principal();
        let spacing = (minor / 16.0).clamp(0.02, 1.0 / 8.0);
        let half = ((REACH * major + 0.2 * minor) / spacing).ceil() as i64;
        let middle = (footprints[0].mean / spacing).floor();
        let inverses: Vec<_> = footprints.iter().map(|footprint| footprint.covariance.inverse()).collect();
        let mut sums = vec![([0.0; DIRECTIONS], 0.0); footprints.len()];
        for y in -half..=half {
            for x in -half..=half {
                let place = (middle + DVec2::new(x as f64, y as f64)) * spacing;
                let weight = |(footprint, inverse): (&Footprint, &glam::DMat2)| {
                    let away = place - footprint.mean;
                    let q = away.dot(*inverse * away);
                    if q < REACH * REACH { (-0.5 * q).exp() } else { 0.0 }
                };
                let weights: Vec<f64> = footprints.iter().zip(&inverses).map(weight).collect();
                if weights.iter().all(|weight| *weight == 0.0) {
                    continue;
                }
                let mut seen = [0.0; DIRECTIONS];
                for (class, local, part) in self.reference.shown_at(place) {
                    let at = (local * PER_TEXEL).as_usizevec2();
                    let table = &self.tables[class];
                    let row = (at.y * self.width).min(table.len() - self.width);
                    let densities = &table[row + at.x.min(self.width - 1)];
                    for (sum, density) in seen.iter_mut().zip(densities) {
                        *sum += part * f64::from(*density);
                    }
                }
                for ((sum, total), weight) in sums.iter_mut().zip(weights) {
                    *total += weight;
                    sum.iter_mut().zip(seen).for_each(|(sum, seen)| *sum += weight * seen);
                }
            }
        }
        sums.into_iter().map(|(sum, total)| sum.map(|value| value / total)).collect()
    }
}

/// What a shader shows of a footprint.
fn picture(material: &Material, footprint: &Footprint, directions: &[Vec2; DIRECTIONS]) -> [f64; DIRECTIONS] {
    let terms = material.gather(footprint, EvalSettings::REAL_TIME);
    directions.map(|s| f64::from(material.density(&terms, s)))
}

/// A pixel, and the same after each of the three changes: it, wider; it, shifted; a long one, turned; that one before.
fn variants(sigma: f64, mean: DVec2, angle: f64) -> [Footprint; 5] {
    let round = |sigma: f64, mean: DVec2| Footprint::new(mean, sigma, 1.0, 0.0);
    let long = |angle: f64| Footprint::new(mean, sigma, TURNED_RATIO, angle);
    // A pixel is two standard deviations wide.
    let shift = DVec2::from_angle(angle) * (2.0 * sigma / 16.0);
    [
        round(sigma, mean),
        round(1.01 * sigma, mean),
        round(sigma, mean + shift),
        long(angle),
        long(angle + 1.0f64.to_radians()),
    ]
}

/// The pictures that are compared, as indices of [`variants`].
const CHANGES: [(&str, usize, usize); 3] = [("zoom", 0, 1), ("shift", 0, 2), ("turn", 3, 4)];

/// 99th percentile of changes.
fn p99(mut changes: Vec<f64>) -> f64 {
    changes.sort_by(f64::total_cmp);
    changes[(changes.len() as f64 * 0.99).ceil() as usize - 1]
}

/// 99th percentiles of what pixels of one size change, in parts of the mean density: found and exact, a kind of change.
fn changes(exact: &Exact, directions: &[Vec2; DIRECTIONS], sigma: f64, places: u32) -> [[f64; 2]; 3] {
    let material = exact.reference.material();
    let extent = f64::from(material.maps.params.width.max(material.maps.params.height)) * 32.0;
    let pictures = (0..places).into_par_iter().map(|k| {
        let mut rng = ItemRng::new(7, Purpose::Test(1800), k);
        let mean = DVec2::new(rng.unit(), rng.unit()) * extent;
        let footprints = variants(sigma, mean, rng.unit() * std::f64::consts::TAU);
        let found: Vec<_> = footprints.iter().map(|footprint| picture(material, footprint, directions)).collect();
        [found, exact.pictures(&footprints)]
    });
    let pictures: Vec<[Vec<[f64; DIRECTIONS]>; 2]> = pictures.collect();
    let mean = pictures.iter().flat_map(|[_, exact]| exact[0]).sum::<f64>() / f64::from(places) / DIRECTIONS as f64;
    CHANGES.map(|(_, before, after)| {
        [0, 1].map(|which| {
            let change = |pictures: &[Vec<[f64; DIRECTIONS]>; 2]| {
                let (a, b) = (pictures[which][before], pictures[which][after]);
                a.into_iter().zip(b).map(|(a, b)| (b - a).abs() / mean).collect::<Vec<_>>()
            };
            p99(pictures.iter().flat_map(change).collect())
        })
    })
}

/// What changes are more than twice the exact ones, in parts of the mean density, the most of all sizes, a kind of change; prints all
/// changes.
fn beyond_twice(name: &str, placement: PlacementOptions, sizes: &[f64], places: u32) -> Option<[f64; 3]> {
    let data = real_maps::data()?;
    let map = NormalMap { wrap: Wrap::Repeat, ..real_maps::load(&data, name, None) };
    let finest_window = match placement {
        PlacementOptions::Tiled(_) => 0.85,
        PlacementOptions::Stochastic(_) => 0.6,
    };
    let maps = NdfMapsOptions { finest_window, ..NdfMapsOptions::default() };
    let material = bake(&map, &Options { maps, placement }, &Silent).unwrap();
    // Normals of the map are where something shines.
    let mut rng = ItemRng::new(7, Purpose::Test(1801), 0);
    let texels = map.projected.len() as u32;
    let directions = [(); DIRECTIONS].map(|()| Vec2::from(map.projected[rng.below(texels) as usize]));
    let exact = Exact::new(&map, &material, &directions);
    let mut worst = [0.0f64; 3];
    println!("{name}, {}", if finest_window == 0.85 { "tiled" } else { "at random" });
    for sigma in sizes {
        let found = changes(&exact, &directions, *sigma, places);
        print!("σ {sigma:5.2}:");
        for (((what, ..), [found, exact]), worst) in CHANGES.iter().zip(found).zip(&mut worst) {
            print!("  {what} {:.2} % of {:.2} %, {:.2} ×", 100.0 * found, 100.0 * exact, found / exact);
            *worst = worst.max(found - 2.0 * exact);
        }
        println!();
    }
    Some(worst)
}

/// Sizes of half octaves, and one octave in eighths, so that no step between levels hides. Wider pixels of these examples hardly change.
const SIZES: [f64; 16] = [
    0.35,
    0.5,
    FRAC_1_SQRT_2,
    0.7711,
    0.8409,
    0.917,
    1.0,
    1.0905,
    1.1892,
    1.2968,
    SQRT_2,
    2.0,
    2.8284,
    4.0,
    5.6569,
    8.0,
];

/// Asserts that changes of zoom, shift and turn are at most twice the exact ones and `most` of the mean density more.
fn check(names: &[&str], placement: PlacementOptions, places: u32, most: [f64; 3]) {
    for name in names {
        let Some(beyond) = beyond_twice(name, placement, &SIZES, places) else { return };
        println!("{name}: at most {beyond:.4?} of the mean density beyond twice the exact change");
        let within = beyond.iter().zip(most).all(|(beyond, most)| *beyond <= most);
        assert!(
            within,
            "{name}: {beyond:?} of the mean density beyond twice the exact change, expected at most {most:?}"
        );
    }
}

/// Brushed metal under pixels as wide as half of it is nearly the same everywhere, and shifts by 2 % of its density where it should by .4.
#[test]
fn a_pixel_of_a_tiled_surface_changes_as_the_exact_one() {
    let names = ["tiny/brushed_16x16.png", "tiny/scratches_32x32.png", "tiny/flakes_8x8.png"];
    check(&names, PlacementOptions::Tiled(TransformRanges::default()), 48, [0.0003, 0.0125, 0.002]);
}

#[test]
fn a_pixel_of_a_random_surface_changes_as_the_exact_one() {
    let names = ["tiny/brushed_16x16.png", "tiny/flakes_8x8.png"];
    check(&names, PlacementOptions::Stochastic(StochasticOptions::default()), 32, [0.0018, 0.0, 0.0]);
}
