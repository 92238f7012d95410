//! Where examples lie on the surface: a noise map of centres, offsets and transforms, with occlusion resolved.
//!
//! Xing et al. 2024, section 6.2 and Fig. 3. The paper lets placed examples overlap and gives each of the four
//! sub-regions of an overlap to the example whose centre is nearest. Here the surface is a grid of cells with one centre
//! each; every cell is divided in four sub-regions, and each shows the example, of the 3 × 3 cells around, whose centre
//! is nearest to the sub-region's centre. Examples go on periodically beyond their edge, so nothing is left uncovered.
//! Owners are found once, here, and stored.

use super::transform::{self, TransformRanges};
use crate::error::{BakeError, Result};
use crate::normal_map::NormalMap;
use crate::rng::{ItemRng, Purpose};
use glam::DVec2;
use glint_formats::ndf_maps::{NoiseTexel, PlacementKind, PlacementParams, TransformRecord};

/// Largest palette: the runtime keeps one weight an entry.
pub const MAX_PALETTE: u32 = 32;

/// Options of a placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacementOptions {
    /// Examples side by side under one transform, the ranges' lower ends.
    Tiled(TransformRanges),
    /// Examples around random centres.
    Stochastic(StochasticOptions),
}

/// Options of a stochastic placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StochasticOptions {
    /// Ranges of the palette's transforms.
    pub ranges: TransformRanges,
    /// Transforms in the palette, 1 … [`MAX_PALETTE`].
    pub palette: u32,
    /// Cells along both axes before the surface repeats, a power of two from 2 to 1024.
    pub cells: u32,
    /// Edge of a cell relative to the example's longer edge.
    pub spacing: f64,
    /// Seed.
    pub seed: u64,
}

impl Default for StochasticOptions {
    fn default() -> StochasticOptions {
        let ranges = TransformRanges { rotate_degrees: (0.0, 360.0), mirror: true, ..TransformRanges::default() };
        StochasticOptions { ranges, palette: 16, cells: 32, spacing: 1.0, seed: 1 }
    }
}

/// A placement, ready for a pack.
#[derive(Clone, Debug)]
pub struct BakedPlacement {
    /// Parameters.
    pub params: PlacementParams,
    /// Transforms.
    pub palette: Vec<TransformRecord>,
    /// One texel a cell; empty when tiled.
    pub noise: Vec<NoiseTexel>,
    /// Shares of palette entries, unorm8: all mips, each with ⌈palette / 4⌉ layers of RGBA texels; empty when tiled.
    pub classes: Vec<u8>,
}

/// Bakes a placement of `map` with lobes of `roughness`. Errors: options without meaning for this map.
pub fn bake(map: &NormalMap, roughness: f64, options: &PlacementOptions) -> Result<BakedPlacement> {
    match options {
        PlacementOptions::Tiled(ranges) => {
            transform::check(ranges, map, roughness)?;
            let one = |(lo, _): (f64, f64)| (lo, lo);
            let ranges = TransformRanges {
                rotate_degrees: one(ranges.rotate_degrees),
                scale: one(ranges.scale),
                stretch: one(ranges.stretch),
                shear: one(ranges.shear),
                mirror: false,
            };
            let palette = vec![transform::draw_palette(&ranges, 1, 0)[0].record()];
            let params = PlacementParams { kind: PlacementKind::Tiled, palette_len: 1 };
            Ok(BakedPlacement { params, palette, noise: Vec::new(), classes: Vec::new() })
        }
        PlacementOptions::Stochastic(options) => bake_stochastic(map, roughness, options),
    }
}

fn bake_stochastic(map: &NormalMap, roughness: f64, options: &StochasticOptions) -> Result<BakedPlacement> {
    transform::check(&options.ranges, map, roughness)?;
    let bad = |what: String| Err(BakeError::BadOption(what));
    if !(1..=MAX_PALETTE).contains(&options.palette) {
        return bad(format!("a palette of {} transforms is outside 1 … {MAX_PALETTE}", options.palette));
    }
    if !options.cells.is_power_of_two() || !(2..=1024).contains(&options.cells) {
        return bad(format!("{} cells are not a power of two from 2 to 1024", options.cells));
    }
    if !(0.25..=8.0).contains(&options.spacing) {
        return bad(format!("a spacing of {} example edges is outside 0.25 … 8", options.spacing));
    }
    let palette = transform::draw_palette(&options.ranges, options.palette, options.seed);
    let cells = options.cells;
    let centres: Vec<Centre> = (0..cells * cells).map(|k| Centre::draw(options, k)).collect();
    let noise: Vec<NoiseTexel> = (0..cells * cells)
        .map(|k| {
            let c = &centres[k as usize];
            NoiseTexel {
                centre: c.position[0] as u32 | (c.position[1] as u32) << 16,
                offset: c.offset[0] as u32 | (c.offset[1] as u32) << 16,
                class_and_owners: c.class | owners(&centres, cells, k) << 16,
                reserved: 0,
            }
        })
        .collect();
    let cell_texels = (map.width.max(map.height) as f64 * options.spacing) as f32;
    Ok(BakedPlacement {
        params: PlacementParams {
            kind: PlacementKind::Stochastic { cells_x: cells, cells_y: cells, cell_texels, seed: options.seed },
            palette_len: options.palette,
        },
        palette: palette.iter().map(transform::Transform::record).collect(),
        classes: class_mips(&noise, cells, options.palette),
        noise,
    })
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

/// The four owners of cell `k`, 4 bits each.
fn owners(centres: &[Centre], cells: u32, k: u32) -> u32 {
    let (cx, cy) = (k % cells, k / cells);
    let mut bits = 0;
    for quadrant in 0..4u32 {
        let middle = DVec2::new((quadrant % 2) as f64 * 0.5 + 0.25, (quadrant / 2) as f64 * 0.5 + 0.25);
        let mut nearest = (f64::INFINITY, 4);
        for neighbour in 0..9u32 {
            let (dx, dy) = (neighbour % 3, neighbour / 3);
            let (x, y) = ((cx + cells + dx - 1) % cells, (cy + cells + dy - 1) % cells);
            let [px, py] = centres[(y * cells + x) as usize].position.map(|v| v as f64 / 65535.0);
            let centre = DVec2::new(px + dx as f64 - 1.0, py + dy as f64 - 1.0);
            let distance = centre.distance_squared(middle);
            if distance < nearest.0 {
                nearest = (distance, neighbour);
            }
        }
        bits |= nearest.1 << (4 * quadrant);
    }
    bits
}

/// Shares of each palette entry in blocks of 1, 2², 4², … cells, as the mips of a layered RGBA texture.
fn class_mips(noise: &[NoiseTexel], cells: u32, palette: u32) -> Vec<u8> {
    let layers = palette.div_ceil(4) as usize;
    let entries = layers * 4;
    let n = cells as usize;
    let mut shares = vec![0.0f32; n * n * entries];
    for k in 0..n * n {
        for quadrant in 0..4 {
            let owner = owner_cell(noise[k].class_and_owners, k as u32, cells, quadrant);
            let class = noise[owner as usize].class_and_owners & 0xff;
            shares[k * entries + class as usize] += 0.25;
        }
    }
    let mut bytes = Vec::new();
    let mut size = n;
    loop {
        for layer in 0..layers {
            for texel in shares.chunks_exact(entries) {
                bytes.extend(texel[layer * 4..layer * 4 + 4].iter().map(|v| (v * 255.0).round() as u8));
            }
        }
        if size == 1 {
            return bytes;
        }
        let half = size / 2;
        let mut next = vec![0.0f32; half * half * entries];
        for y in 0..size {
            for x in 0..size {
                for e in 0..entries {
                    next[((y / 2) * half + x / 2) * entries + e] += 0.25 * shares[(y * size + x) * entries + e];
                }
            }
        }
        (shares, size) = (next, half);
    }
}

/// Index of the cell whose example sub-region `quadrant` of cell `k` shows.
fn owner_cell(class_and_owners: u32, k: u32, cells: u32, quadrant: u32) -> u32 {
    let neighbour = class_and_owners >> (16 + 4 * quadrant) & 0xf;
    let x = (k % cells + cells + neighbour % 3 - 1) % cells;
    let y = (k / cells + cells + neighbour / 3 - 1) % cells;
    y * cells + x
}
