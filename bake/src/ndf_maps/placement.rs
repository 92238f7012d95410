//! Where examples lie on the surface: a noise map of centres, offsets and transforms, with occlusion resolved.
//!
//! Xing et al. 2024, section 6.2 and Fig. 3. The paper lets placed examples overlap and gives each of the four
//! sub-regions of an overlap to the example whose centre is nearest. Here the surface is a grid of cells with one centre
//! each; every cell is divided in four sub-regions, and each shows the example, of the 3 × 3 cells around, whose centre
//! is nearest to the sub-region's centre. Examples go on periodically beyond their edge, so nothing is left uncovered.
//! Owners are found once, here: the noise map holds of every sub-region the example that it shows.
//!
//! Spatial transforms are rotation, mirror, scale, stretch and shear (section 6.1). The paper's matrix M acts on positions and on
//! normals alike. That is right for rotation, mirror and shear; for a scale it is a choice: `scale` changes an example's size on
//! the surface and leaves its normals, `stretch` widens its normals and leaves its size. The paper's scaling is both together.
//! The translation part of M is the noise map's offset.

use super::baked::BakedPlacement;
use super::options::{PlacementOptions, StochasticOptions, TransformRanges};
use crate::error::Result;
use crate::normal_map::NormalMap;
use crate::rng::{ItemRng, Purpose};
use glam::{DMat2, DVec2};
use glint_formats::ndf_maps::{MAX_PALETTE, NoiseTexel, PlacementKind, PlacementParams, TransformRecord};

/// Places examples of `map`, whose lobes have the standard deviation `roughness`, on a surface.
///
/// # Errors
/// Options out of range, or transforms that would push normals of this map over the horizon.
pub fn place(map: &NormalMap, roughness: f64, options: &PlacementOptions) -> Result<BakedPlacement> {
    match options {
        PlacementOptions::Tiled(ranges) => {
            ranges.check(map, roughness)?;
            let one = |(lo, _): (f64, f64)| (lo, lo);
            let ranges = TransformRanges {
                rotate_degrees: one(ranges.rotate_degrees),
                scale: one(ranges.scale),
                stretch: one(ranges.stretch),
                shear: one(ranges.shear),
                mirror: false,
            };
            let palette = vec![draw_palette(&ranges, 1, 0)[0].record()];
            let params = PlacementParams { kind: PlacementKind::Tiled, palette_len: 1 };
            Ok(BakedPlacement { params, palette, noise: Vec::new(), classes: Vec::new() })
        }
        PlacementOptions::Stochastic(options) => place_stochastic(map, roughness, options),
    }
}

fn place_stochastic(map: &NormalMap, roughness: f64, options: &StochasticOptions) -> Result<BakedPlacement> {
    options.ranges.check(map, roughness)?;
    options.check()?;
    let palette = draw_palette(&options.ranges, options.palette, options.seed);
    let cells = options.cells;
    let centres: Vec<Centre> = (0..cells * cells).map(|k| Centre::draw(options, k)).collect();
    let owners: Vec<[u32; 4]> = (0..cells * cells).map(|k| owners(&centres, cells, k)).collect();
    let noise: Vec<NoiseTexel> = (0..4 * cells * cells).map(|k| shown(&centres, &owners, cells, k)).collect();
    let cell_texels = (map.width.max(map.height) as f64 * options.spacing) as f32;
    Ok(BakedPlacement {
        params: PlacementParams {
            kind: PlacementKind::Stochastic { cells_x: cells, cells_y: cells, cell_texels, seed: options.seed },
            palette_len: options.palette,
        },
        palette: palette.iter().map(Transform::record).collect(),
        classes: class_mips(&noise, cells, options.palette),
        noise,
    })
}

/// One transform, example → surface, in the tangent plane (+X right, +Y up).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Transform {
    /// Acts on offsets in texels.
    position: DMat2,
    /// Acts on projected normals.
    normal: DMat2,
}

impl Transform {
    /// Transform of given angle (degrees), mirror, scale, stretch and shear.
    fn new(degrees: f64, mirror: bool, scale: f64, stretch: f64, shear: f64) -> Transform {
        let (sin, cos) = (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians()));
        let rotation = DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos));
        let shear = DMat2::from_cols(DVec2::X, DVec2::new(shear, 1.0));
        let mirror = DMat2::from_diagonal(DVec2::new(if mirror { -1.0 } else { 1.0 }, 1.0));
        let linear = rotation * shear * mirror;
        Transform { position: linear * scale, normal: linear * stretch }
    }

    /// As the pack holds it: inverse matrices, positions with v down.
    fn record(&self) -> TransformRecord {
        let flip = DMat2::from_diagonal(DVec2::new(1.0, -1.0));
        let rows = |m: DMat2| [m.x_axis.x as f32, m.y_axis.x as f32, m.x_axis.y as f32, m.y_axis.y as f32];
        TransformRecord {
            position_to_local: rows(flip * self.position.inverse() * flip),
            normal_to_local: rows(self.normal.inverse()),
        }
    }
}

/// Draws `count` transforms, stratified in every parameter, one seed one result.
fn draw_palette(ranges: &TransformRanges, count: u32, seed: u64) -> Vec<Transform> {
    let mut rng = ItemRng::new(seed, Purpose::NdfPalette, 0);
    let orders: Vec<Vec<u32>> = (0..4).map(|_| rng.permutation(count)).collect();
    let mirrored = rng.permutation(count);
    (0..count as usize)
        .map(|k| {
            let mut draw = |(lo, hi): (f64, f64), order: &[u32]| {
                if lo == hi { lo } else { lo + (hi - lo) * (order[k] as f64 + rng.unit()) / count as f64 }
            };
            let degrees = draw(ranges.rotate_degrees, &orders[0]);
            let scale = draw(ranges.scale, &orders[1]);
            let stretch = draw(ranges.stretch, &orders[2]);
            let shear = draw(ranges.shear, &orders[3]);
            Transform::new(degrees, ranges.mirror && mirrored[k] % 2 == 1, scale, stretch, shear)
        })
        .collect()
}

/// A cell's random numbers.
struct Centre {
    position: [u16; 2],
    offset: [u16; 2],
    class: u32,
}

impl Centre {
    fn draw(options: &StochasticOptions, cell: u32) -> Centre {
        // Centres keep to the middle of their cell, so that the nearest one is always among the 3 × 3 cells around.
        const JITTER: f64 = 0.75;
        let mut rng = ItemRng::new(options.seed, Purpose::NdfCentres, cell);
        let mut unorm = |spread: f64| ((0.5 + spread * (rng.unit() - 0.5)) * 65535.0).round() as u16;
        let position = [unorm(JITTER), unorm(JITTER)];
        let offset = [unorm(1.0), unorm(1.0)];
        Centre { position, offset, class: rng.below(options.palette) }
    }
}

/// Which of the 3 × 3 cells around own the four sub-regions of cell `k`.
fn owners(centres: &[Centre], cells: u32, k: u32) -> [u32; 4] {
    [0, 1, 2, 3].map(|quadrant: u32| {
        let middle = DVec2::new((quadrant % 2) as f64 * 0.5 + 0.25, (quadrant / 2) as f64 * 0.5 + 0.25);
        let mut nearest = (f64::INFINITY, 4);
        for neighbour in 0..9u32 {
            let [px, py] = centres[cell_at(k, neighbour, cells)].position.map(|v| v as f64 / 65535.0);
            let centre = DVec2::new(px + (neighbour % 3) as f64 - 1.0, py + (neighbour / 3) as f64 - 1.0);
            let distance = centre.distance_squared(middle);
            if distance < nearest.0 {
                nearest = (distance, neighbour);
            }
        }
        nearest.1
    })
}

/// The cell that is neighbour `neighbour` of the 3 × 3 around cell `k`.
fn cell_at(k: u32, neighbour: u32, cells: u32) -> usize {
    let x = (k % cells + cells + neighbour % 3 - 1) % cells;
    let y = (k / cells + cells + neighbour / 3 - 1) % cells;
    (y * cells + x) as usize
}

/// What sub-region `k` shows, rows of 2 `cells`.
fn shown(centres: &[Centre], owners: &[[u32; 4]], cells: u32, k: u32) -> NoiseTexel {
    let (x, y) = (k % (2 * cells), k / (2 * cells));
    let cell = y / 2 * cells + x / 2;
    let neighbour = owners[cell as usize][(x % 2 + 2 * (y % 2)) as usize];
    let owner = &centres[cell_at(cell, neighbour, cells)];
    let pair = |[x, y]: [u16; 2]| u32::from(x) | u32::from(y) << 16;
    NoiseTexel {
        centre: pair(owner.position),
        offset: pair(owner.offset),
        class_and_neighbour: owner.class | neighbour << 16,
        reserved: 0,
    }
}

/// Variance of the windows of the class texture's first mip, in squares of a sub-region's edge, and what each has more than the one before,
/// in squares of that one's texels: read linearly, which adds a sixth, mip m has the variance 4ᵐ⁺¹/6.
const CLASS_WINDOW: (f64, f64) = (0.5, 1.5);

/// Shares of each palette entry under Gaussian windows around every sub-region, every second, every fourth and so on, as the mips of a
/// texture of 16 bytes a texel.
fn class_mips(noise: &[NoiseTexel], cells: u32, palette: u32) -> Vec<[u8; MAX_PALETTE as usize]> {
    let regions = 2 * cells as usize;
    let texels: usize = (0..=regions.trailing_zeros()).map(|mip| (regions >> mip).pow(2)).sum();
    let mut mips = vec![[0; MAX_PALETTE as usize]; texels];
    for class in 0..palette {
        let own = |texel: &NoiseTexel| if texel.class() == class { 1.0 } else { 0.0 };
        let mut shares = periodic_blur(&noise.iter().map(own).collect::<Vec<f64>>(), regions, CLASS_WINDOW.0);
        let (mut size, mut first) = (regions, 0);
        loop {
            for (texel, share) in mips[first..].iter_mut().zip(&shares) {
                texel[class as usize] = (share * 255.0).round() as u8;
            }
            if size == 1 {
                break;
            }
            first += size * size;
            let blurred = periodic_blur(&shares, size, CLASS_WINDOW.1);
            size /= 2;
            shares = (0..size * size).map(|k| blurred[2 * (k / size) * 2 * size + 2 * (k % size)]).collect();
        }
    }
    mips
}

/// A grid of `size` × `size` that repeats, under a Gaussian of a variance in squares of its spacing.
fn periodic_blur(grid: &[f64], size: usize, variance: f64) -> Vec<f64> {
    let reach = (5.0 * variance.sqrt()).ceil() as i64;
    let weights: Vec<f64> = (-reach..=reach).map(|k| libm::exp(-0.5 * (k * k) as f64 / variance)).collect();
    let total: f64 = weights.iter().sum();
    let around = |k: usize, step: i64| (k as i64 + step).rem_euclid(size as i64) as usize;
    let along = |grid: &[f64], place: &dyn Fn(usize, i64) -> usize| -> Vec<f64> {
        let mean =
            |k: usize| weights.iter().zip(-reach..).map(|(w, step)| w * grid[place(k, step)]).sum::<f64>() / total;
        (0..size * size).map(mean).collect()
    };
    let rows = along(grid, &|k, step| k / size * size + around(k % size, step));
    along(&rows, &|k, step| around(k / size, step) * size + k % size)
}
