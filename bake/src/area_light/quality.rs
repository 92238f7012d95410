//! How good the tables are, and how near highlights come to the reference, over distance.

use super::baked::{LtcTables, Maps, SIZE, Tables};
use super::eval::{alpha_from_deficit, convolve_alpha, fetch, surface_radiance};
use super::fit::{DiskSet, Inverse, Target, alpha_of, cosine_of};
use super::paper::paper_alpha;
use super::rect::{RectLight, isotropic_radiance};
use super::reference::{Scene, facet_radiance, footprint_normals, lift};
use crate::footprint::Footprint;
use crate::normal_map::NormalMap;
use crate::quality::metrics::Summary;
use crate::rng::{ItemRng, Purpose};
use glam::{DVec2, DVec3};
use half::f16;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// ∫ |magnitude · LTC − GGX| / ∫ GGX of every entry but those of roughness 0, by a quadrature twenty times as fine as the
/// fit's.
pub fn table_error(tables: &LtcTables) -> Summary {
    let set = DiskSet::new(256, 32);
    let error = |at: usize| {
        let target = Target::new(cosine_of(at / SIZE), alpha_of(at % SIZE), &set);
        let [a, c, b, d] = tables.inverse[at].map(|bits| f16::from_bits(bits).to_f64());
        let magnitude = f16::from_bits(tables.terms[at][0]).to_f64();
        target.l1_scaled(&Inverse { entries: [a, b, c, d] }, magnitude / target.magnitude)
    };
    Summary::of((0..SIZE * SIZE).into_par_iter().filter(|at| at % SIZE > 0).map(error).collect())
}

/// The reference of a scene for every normal: [`facet_radiance`] at the points of a grid over the disk, read by cubic
/// interpolation. Footprints of thousands of texels ask for the same few normals over and over.
pub struct RadianceGrid {
    size: usize,
    values: Vec<f64>,
}

impl RadianceGrid {
    /// Evaluates the reference at `size`² points, to `tolerance`.
    pub fn new(scene: &Scene, size: usize, tolerance: f64) -> RadianceGrid {
        let value = |at: usize| {
            let p = DVec2::new((at % size) as f64, (at / size) as f64) / (size - 1) as f64 * 2.0 - 1.0;
            // A margin around the disk for the interpolation; beyond it nothing is read.
            let radius = p.length();
            if radius > 1.0 + 6.0 / size as f64 {
                return 0.0;
            }
            facet_radiance(scene, lift(if radius > 0.9999 { p * (0.9999 / radius) } else { p }), tolerance)
        };
        RadianceGrid { size, values: (0..size * size).into_par_iter().map(value).collect() }
    }

    /// Mean radiance of facets, by their weights from [`grid_weights`].
    pub fn mean(&self, weights: &GridWeights) -> f64 {
        let values = &self.values[weights.first..][..weights.weights.len()];
        values.iter().zip(&weights.weights).map(|(value, weight)| value * weight).sum()
    }

    /// Points along an edge.
    pub fn size(&self) -> usize {
        self.size
    }
}

/// Weights of a grid's points that stand for a set of normals: the same for every scene, so they are added up once.
pub struct GridWeights {
    /// The first point whose weight is not 0.
    first: usize,
    /// Weights from there to the last such point.
    weights: Vec<f64>,
}

/// The weights of projected normals and their shares, on a grid of `size`² points: cubic interpolation.
pub fn grid_weights(normals: &[(f64, DVec2)], size: usize) -> GridWeights {
    let last = (size - 1) as f64;
    let mut weights = vec![0.0; size * size];
    let (mut low, mut high) = (size * size, 0);
    for &(share, s) in normals {
        let p = ((s + 1.0) * 0.5 * last).clamp(DVec2::ONE, DVec2::splat(last - 1.001));
        let cell = p.floor();
        let (x, y) = (cubic_weights(p.x - cell.x), cubic_weights(p.y - cell.y));
        let first = (cell.y as usize - 1) * size + cell.x as usize - 1;
        for j in 0..4 {
            let row = &mut weights[first + j * size..][..4];
            for i in 0..4 {
                row[i] += share * x[i] * y[j];
            }
        }
        (low, high) = (low.min(first), high.max(first + 3 * size + 4));
    }
    GridWeights { first: low.min(high), weights: weights[low.min(high)..high].to_vec() }
}

/// Catmull and Rom's weights of the points at −1, 0, 1 and 2.
fn cubic_weights(f: f64) -> [f64; 4] {
    [
        ((-0.5 * f + 1.0) * f - 0.5) * f,
        (1.5 * f - 2.5) * f * f + 1.0,
        ((-1.5 * f + 2.0) * f + 0.5) * f,
        (0.5 * f - 0.5) * f * f,
    ]
}

/// Reflectance of the scenes at normal incidence.
pub const SCENE_F0: f64 = 0.9;
/// Angles of view of the scenes, in radians from the surface's normal.
pub const VIEW_ANGLES: [f64; 3] = [0.1, 0.7, 1.15];
/// How far the middle of the light is from the mirror direction, and half its edge, both over its distance.
pub const LIGHTS: [(f64, f64); 4] = [(0.0, 0.1), (0.15, 0.25), (0.3, 0.1), (0.5, 0.25)];

/// Scenes of one base roughness: every angle of view with every light, turned by seeded angles. Lights face the surface.
pub fn scenes(alpha: f64) -> Vec<Scene> {
    const SEED: u64 = 7;
    let mut all = Vec::new();
    for (i, theta) in VIEW_ANGLES.into_iter().enumerate() {
        for (k, (offset, half)) in LIGHTS.into_iter().enumerate() {
            let mut rng = ItemRng::new(SEED, Purpose::AreaLightScenes, (10 * i + k) as u32);
            let turn = TAU * rng.unit();
            let (sin, cos) = (libm::sin(theta), libm::cos(theta));
            let view = DVec3::new(sin * libm::cos(turn), sin * libm::sin(turn), cos);
            let mirror = DVec3::new(-view.x, -view.y, view.z);
            let (t, b) = mirror.any_orthonormal_pair();
            let turn = TAU * rng.unit();
            let mut middle = (mirror + (t * libm::cos(turn) + b * libm::sin(turn)) * offset).normalize();
            middle.z = middle.z.max(0.1);
            let middle = middle.normalize();
            let (t, b) = (-middle).any_orthonormal_pair();
            let edges = (t * (2.0 * half), b * (2.0 * half));
            all.push(Scene { corner: middle - 0.5 * (edges.0 + edges.1), edges, view, alpha, f0: SCENE_F0 });
        }
    }
    all
}

/// A scene's light as the run time takes it.
pub fn rect_light(scene: &Scene) -> RectLight {
    let (c, (e, f)) = (scene.corner, scene.edges);
    RectLight { corners: [c, c + e, c + e + f, c + f].map(|p| p.as_vec3()), radiance: 1.0, two_sided: false }
}

/// Methods that are compared.
pub const METHODS: [&str; 6] = ["plain", "paper", "length", "isotropic", "one lobe", "anisotropic"];

/// Radiance by each of [`METHODS`]: mipmapped normals with the base roughness alone; the paper's Eq. 5 and 7; the exact
/// inverse of the length and our convolution; ours; ours with one stretched lobe, and with `lobes`.
pub fn by_method(
    tables: &Tables,
    maps: &Maps<'_>,
    position: DVec2,
    footprint_texels: f64,
    scene: &Scene,
    lobes: u32,
) -> [f64; 6] {
    let surface = fetch(maps, position.as_vec2(), footprint_texels as f32);
    let (alpha, view, f0, light) = (scene.alpha as f32, scene.view.as_vec3(), scene.f0 as f32, rect_light(scene));
    let flat = |alpha: f32| isotropic_radiance(tables, surface.normal, alpha, view, f0, &light);
    let ours = |lobes: u32| surface_radiance(tables, &surface, alpha, view, f0, &light, lobes);
    [
        flat(alpha),
        flat(paper_alpha(scene.alpha, f64::from(surface.length)) as f32),
        flat(convolve_alpha(alpha, alpha_from_deficit(1.0 - surface.length))),
        ours(0),
        ours(1),
        ours(lobes),
    ]
    .map(f64::from)
}

/// Root mean square errors of highlights, relative to the root mean square of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighlightError {
    /// Edge of the footprint in texels.
    pub footprint_texels: f64,
    /// Root mean square radiance of the reference, for lights of radiance 1.
    pub reference: f64,
    /// Of each of [`METHODS`].
    pub rmse: [f64; 6],
    /// Each of these over the paper's.
    pub to_paper: [f64; 6],
    /// Standard error of that, as places of the map differ.
    pub to_paper_error: [f64; 6],
}

/// Index of the paper's among [`METHODS`].
const PAPER: usize = 1;

/// Ratio of two root mean squares, given the squares of each place, and its standard error (delta method).
fn ratio(over: impl Iterator<Item = (f64, f64)> + Clone) -> (f64, f64) {
    let (own, base) = over.clone().fold((0.0, 0.0), |sum, (own, base)| (sum.0 + own, sum.1 + base));
    let squared = own / base;
    let (count, spread) =
        over.fold((0.0, 0.0), |sum, (own, base)| (sum.0 + 1.0, sum.1 + (own - squared * base).powi(2)));
    let error = (spread * count / (count - 1.0f64).max(1.0)).sqrt() / base;
    (squared.sqrt(), 0.5 * error / squared.sqrt())
}

/// Place k of an even spread over the map, as shares of it: the additive recurrence of the plastic number (Roberts 2018,
/// "R2"), from a seeded start. Random places leave gaps, and few of a map's places make most of its error.
fn place_of(seed: u64, k: u32) -> DVec2 {
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_693, 0.569_840_290_998_053);
    let mut rng = ItemRng::new(seed, Purpose::AreaLightPlaces, 0);
    (DVec2::new(rng.unit(), rng.unit()) + STEP * f64::from(k)).fract()
}

/// What a comparison is made over.
pub struct Comparison<'a> {
    /// Scenes, and the reference of each; grids of one size.
    pub scenes: &'a [(Scene, RadianceGrid)],
    /// Places, spread evenly over the map.
    pub places: u32,
    /// Lobes of the anisotropic method.
    pub lobes: u32,
    /// Seed of the places.
    pub seed: u64,
}

/// Measures all methods under footprints of one size.
pub fn highlight_error(
    map: &NormalMap,
    maps: &Maps<'_>,
    tables: &Tables,
    footprint_texels: f64,
    over: &Comparison<'_>,
) -> HighlightError {
    let extent = DVec2::new(f64::from(map.width), f64::from(map.height));
    // Where fine mips were left out, texels of the maps are larger than those of the map.
    let scale = maps.scale(map.width, map.height).as_dvec2();
    let squares = |place: u32| -> ([f64; 6], f64) {
        // The same places, as shares of the map, at every distance.
        let position = place_of(over.seed, place) * extent;
        let footprint = Footprint::new(position, 0.5 * footprint_texels, 1.0, 0.0);
        let size = over.scenes.first().map_or(0, |(_, grid)| grid.size());
        let weights = grid_weights(&footprint_normals(map, &footprint, 4.0, 192), size);
        let (mut errors, mut power) = ([0.0; 6], 0.0);
        for (scene, grid) in over.scenes {
            let exact = grid.mean(&weights);
            let found = by_method(tables, maps, position * scale, footprint_texels * scale.x, scene, over.lobes);
            for k in 0..6 {
                errors[k] += (found[k] - exact).powi(2);
            }
            power += exact * exact;
        }
        (errors, power)
    };
    let all: Vec<([f64; 6], f64)> = (0..over.places).into_par_iter().map(squares).collect();
    let power: f64 = all.iter().map(|(_, power)| power).sum();
    let count = f64::from(over.places) * over.scenes.len() as f64;
    let rmse = std::array::from_fn(|k| (all.iter().map(|(errors, _)| errors[k]).sum::<f64>() / power).sqrt());
    let ratios: [(f64, f64); 6] =
        std::array::from_fn(|k| ratio(all.iter().map(|(errors, _)| (errors[k], errors[PAPER]))));
    HighlightError {
        footprint_texels,
        reference: (power / count).sqrt(),
        rmse,
        to_paper: ratios.map(|r| r.0),
        to_paper_error: ratios.map(|r| r.1),
    }
}
