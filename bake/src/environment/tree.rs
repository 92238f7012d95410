//! The source image as a binary tree of blocks of pixels, each with its sums and with what it takes to say how wrong it
//! would be to take the block as one point.
//!
//! A block is split across its longer side as the sphere sees it, so blocks stay compact up to the poles whatever the
//! image's size. Its point is the luminance-weighted mean direction, left shorter than 1: the mean of t = 1 − n·ω over
//! the block's light is then exact for every n, and a kernel in t is wrong by its second derivative only.
//!
//! Most blocks are those of a few pixels, and few of them are looked at. So the tree ends at cells of up to [`CELL`] pixels, and
//! what lies below a cell is made when a walk enters it ([`Walk`]). It is the same, bit for bit, as if it had been kept.

use super::image::longitude;
use super::source::Source;
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Most pixels of a cell. Fewer make more blocks to keep, more make more to be made again by every field of texels.
pub const CELL: u32 = 16;
/// Blocks of cells that a walk remembers from one field of texels to the next, which enters many of the same.
pub const REMEMBERED: usize = 1 << 15;
/// Bytes of a block without its sums.
pub const BLOCK_BYTES: u64 = size_of::<Block>() as u64;
/// Pixels of a part of the tree that is one task.
const TASK: u32 = 1 << 14;

/// A block of pixels.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Mean direction of its light, shorter than 1.
    pub mean: [f32; 3],
    /// Half the variance of the directions of its light, (1 − |mean|²) / 2: what its extent adds to t.
    pub half_variance: f32,
    /// No part of the block is farther than this from `mean`.
    pub radius: f32,
    /// Luminance times solid angle.
    pub light: f32,
    /// Length of the first moments about `mean` of colour that luminance does not have.
    pub colour_moment: f32,
    /// The same of squared luminance.
    pub square_moment: f32,
    /// The same of the indicators of radiance levels, each times its level: an upper estimate.
    pub level_moment: f32,
    /// Squared luminance times solid angle.
    pub square: f32,
    /// What it is made of.
    pub below: Below,
}

/// What a block is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Below {
    /// One pixel, by its index.
    Pixel(u32),
    /// A rectangle of pixels from this one on, whose blocks are not kept.
    Cell {
        /// Index of the pixel at the top left.
        first: u32,
        /// Columns.
        columns: u8,
        /// Rows.
        rows: u8,
    },
    /// Two blocks: the one that follows, and the one at this index.
    Blocks(u32),
}

/// A block that is yet to be made.
const EMPTY: Block = Block {
    mean: [0.0; 3],
    half_variance: 0.0,
    radius: 0.0,
    light: 0.0,
    colour_moment: 0.0,
    square_moment: 0.0,
    level_moment: 0.0,
    square: 0.0,
    below: Below::Pixel(0),
};

/// A circle of latitude at the edge of a row.
#[derive(Clone, Copy, Debug)]
pub struct Parallel {
    /// Sine of its latitude.
    pub sine: f64,
    /// Its latitude.
    pub latitude: f64,
    /// Its radius, from the sine.
    radius: f64,
    /// Cosine of the latitude, from the latitude.
    cosine: f64,
}

/// What the pixels of a row have in common.
#[derive(Clone, Copy)]
struct Row {
    solid_angle: f64,
    /// Mean direction over a pixel: its part in the plane of the equator, and its height.
    chord: f64,
    height: f64,
}

/// The tree. Block 0 is the whole sphere.
pub struct Tree<'a> {
    /// The pixels.
    pub source: Source<'a>,
    /// Blocks in order of depth-first search, down to cells.
    pub blocks: Vec<Block>,
    /// For each block, each channel's integral over it: as many as the source has.
    pub sums: Vec<f32>,
    /// Edges of rows.
    pub parallels: Vec<Parallel>,
    rows: Vec<Row>,
    /// Sines and cosines of longitude at edges and middles of columns, in turn.
    meridians: Vec<[f64; 2]>,
}

/// What a block hands to the one above.
#[derive(Clone, Copy)]
struct Moments {
    solid_angle: f64,
    area: DVec3,
    light: f64,
    luminance: DVec3,
    red_blue: [f64; 2],
    red_blue_vectors: [DVec3; 2],
    square: f64,
    square_vector: DVec3,
    brightest: f64,
}

impl Moments {
    fn add(self, other: Moments) -> Moments {
        Moments {
            solid_angle: self.solid_angle + other.solid_angle,
            area: self.area + other.area,
            light: self.light + other.light,
            luminance: self.luminance + other.luminance,
            red_blue: [self.red_blue[0] + other.red_blue[0], self.red_blue[1] + other.red_blue[1]],
            red_blue_vectors: [
                self.red_blue_vectors[0] + other.red_blue_vectors[0],
                self.red_blue_vectors[1] + other.red_blue_vectors[1],
            ],
            square: self.square + other.square,
            square_vector: self.square_vector + other.square_vector,
            brightest: self.brightest.max(other.brightest),
        }
    }
}

/// A rectangle of pixels.
#[derive(Clone, Copy)]
struct Rectangle {
    x: u32,
    y: u32,
    w: u32,
    h: u32,
}

impl Rectangle {
    fn pixels(self) -> u32 {
        self.w * self.h
    }
}

/// How many blocks a rectangle has, and its halves where they are tasks of their own.
struct Plan {
    blocks: usize,
    halves: Option<Box<[Plan; 2]>>,
}

impl<'a> Tree<'a> {
    /// The tree of a source.
    pub fn new(source: Source<'a>) -> Tree<'a> {
        let (width, height) = (source.width, source.height);
        let meridian = |k: u32| {
            let lambda = longitude(0.5 * f64::from(k), width);
            [libm::sin(lambda), libm::cos(lambda)]
        };
        let parallels: Vec<Parallel> = (0..=height).map(|y| parallel(y, height)).collect();
        let half = PI / f64::from(width);
        let rows = parallels.windows(2).map(|edges| row(edges[0], edges[1], width, half)).collect();
        let meridians = (0..=2 * width).map(meridian).collect();
        let mut tree = Tree { source, blocks: Vec::new(), sums: Vec::new(), parallels, rows, meridians };
        let whole = Rectangle { x: 0, y: 0, w: width, h: height };
        let plan = tree.plan(whole);
        let mut blocks = vec![EMPTY; plan.blocks];
        let mut sums = vec![0.0; plan.blocks * tree.source.channels];
        tree.planned(whole, &plan, 0, &mut blocks, &mut sums);
        (tree.blocks, tree.sums) = (blocks, sums);
        tree
    }

    fn plan(&self, r: Rectangle) -> Plan {
        if r.pixels() <= TASK {
            return Plan { blocks: self.count(r), halves: None };
        }
        let (a, b) = self.split(r);
        let (a, b) = rayon::join(|| self.plan(a), || self.plan(b));
        Plan { blocks: 1 + a.blocks + b.blocks, halves: Some(Box::new([a, b])) }
    }

    fn count(&self, r: Rectangle) -> usize {
        if r.pixels() <= CELL {
            return 1;
        }
        let (a, b) = self.split(r);
        1 + self.count(a) + self.count(b)
    }

    /// Fills the blocks of a rectangle, whose first has index `index` in the tree.
    fn planned(&self, r: Rectangle, plan: &Plan, index: u32, blocks: &mut [Block], sums: &mut [f32]) -> Moments {
        let Some(halves) = &plan.halves else {
            return self.down_to_cells(r, index, blocks, sums, &mut Vec::new()).0;
        };
        let channels = self.source.channels;
        let first = halves[0].blocks;
        let (a, b) = self.split(r);
        let second = index + 1 + first as u32;
        let (own, below) = blocks.split_at_mut(1);
        let (own_sums, below_sums) = sums.split_at_mut(channels);
        let (blocks_a, blocks_b) = below.split_at_mut(first);
        let (sums_a, sums_b) = below_sums.split_at_mut(first * channels);
        let (a, b) = rayon::join(
            || self.planned(a, &halves[0], index + 1, blocks_a, sums_a),
            || self.planned(b, &halves[1], second, blocks_b, sums_b),
        );
        for c in 0..channels {
            own_sums[c] = sums_a[c] + sums_b[c];
        }
        let moments = a.add(b);
        own[0] = self.described(r, &moments, Below::Blocks(second));
        moments
    }

    /// The same without tasks; also says how many blocks there are. `stack` is room for sums.
    fn down_to_cells(
        &self,
        r: Rectangle,
        index: u32,
        blocks: &mut [Block],
        sums: &mut [f32],
        stack: &mut Vec<f32>,
    ) -> (Moments, usize) {
        let channels = self.source.channels;
        if r.pixels() <= CELL {
            stack.clear();
            let moments = self.sum(r, stack);
            sums[..channels].copy_from_slice(stack);
            let first = r.y * self.source.width + r.x;
            let below = match r.pixels() {
                1 => Below::Pixel(first),
                _ => Below::Cell { first, columns: r.w as u8, rows: r.h as u8 },
            };
            blocks[0] = self.described(r, &moments, below);
            return (moments, 1);
        }
        let (a, b) = self.split(r);
        let (a, count) = self.down_to_cells(a, index + 1, &mut blocks[1..], &mut sums[channels..], stack);
        let first = 1 + count;
        let second = index + first as u32;
        let (b, count) = self.down_to_cells(b, second, &mut blocks[first..], &mut sums[first * channels..], stack);
        for c in 0..channels {
            sums[c] = sums[channels + c] + sums[first * channels + c];
        }
        let moments = a.add(b);
        blocks[0] = self.described(r, &moments, Below::Blocks(second));
        (moments, first + count)
    }

    /// Sums of a rectangle, added at the end of `stack`, in the order in which its blocks would add them.
    fn sum(&self, r: Rectangle, stack: &mut Vec<f32>) -> Moments {
        let channels = self.source.channels;
        if r.pixels() == 1 {
            let at = stack.len();
            stack.resize(at + channels, 0.0);
            return self.pixel(r, &mut stack[at..]);
        }
        let (a, b) = self.split(r);
        let moments = self.sum(a, stack).add(self.sum(b, stack));
        let second = stack.len() - channels;
        let (below, second_sums) = stack.split_at_mut(second);
        for (sum, more) in below[second - channels..].iter_mut().zip(second_sums) {
            *sum += *more;
        }
        stack.truncate(second);
        moments
    }

    /// Adds all blocks of a rectangle, down to pixels, to blocks of which the first has index `base`.
    fn down_to_pixels(&self, r: Rectangle, base: u32, blocks: &mut Vec<Block>, sums: &mut Vec<f32>) -> Moments {
        let channels = self.source.channels;
        let own = blocks.len();
        blocks.push(EMPTY);
        sums.resize((own + 1) * channels, 0.0);
        if r.pixels() == 1 {
            let moments = self.pixel(r, &mut sums[own * channels..]);
            blocks[own] = self.described(r, &moments, Below::Pixel(r.y * self.source.width + r.x));
            return moments;
        }
        let (a, b) = self.split(r);
        let a = self.down_to_pixels(a, base, blocks, sums);
        let second = blocks.len();
        let b = self.down_to_pixels(b, base, blocks, sums);
        let (before, after) = sums.split_at_mut((own + 1) * channels);
        let (first_sums, second_sums) = after.split_at((second - own - 1) * channels);
        for c in 0..channels {
            before[own * channels + c] = first_sums[c] + second_sums[c];
        }
        let moments = a.add(b);
        blocks[own] = self.described(r, &moments, Below::Blocks(base + second as u32));
        moments
    }

    /// Two halves across the longer side.
    fn split(&self, r: Rectangle) -> (Rectangle, Rectangle) {
        let tall = PI * f64::from(r.h) / f64::from(self.source.height);
        let middle = self.parallels[(r.y + r.h / 2) as usize].cosine;
        let wide = 2.0 * PI * f64::from(r.w) / f64::from(self.source.width) * middle.max(1e-9);
        if r.h > 1 && (tall >= wide || r.w == 1) {
            let h = r.h / 2;
            (Rectangle { h, ..r }, Rectangle { y: r.y + h, h: r.h - h, ..r })
        } else {
            let w = r.w / 2;
            (Rectangle { w, ..r }, Rectangle { x: r.x + w, w: r.w - w, ..r })
        }
    }

    fn pixel(&self, r: Rectangle, sums: &mut [f32]) -> Moments {
        let row = self.rows[r.y as usize];
        let solid_angle = row.solid_angle;
        let (rgb, y) = self.source.sums(r.x, r.y, solid_angle, sums);
        let [sine, cosine] = self.meridians[(2 * r.x + 1) as usize];
        let area = DVec3::new(row.chord * sine, row.height, -row.chord * cosine) * solid_angle;
        Moments {
            solid_angle,
            area,
            light: y * solid_angle,
            luminance: area * y,
            red_blue: [rgb[0] * solid_angle, rgb[2] * solid_angle],
            red_blue_vectors: [area * rgb[0], area * rgb[2]],
            square: y * y * solid_angle,
            square_vector: area * (y * y),
            brightest: y,
        }
    }

    fn described(&self, r: Rectangle, m: &Moments, below: Below) -> Block {
        let centroid = m.area / m.solid_angle;
        let mean = if m.light > 0.0 { m.luminance / m.light } else { centroid };
        let shifted = |vector: DVec3, sum: f64| (vector - mean * sum).length();
        let mut block = Block {
            mean: mean.as_vec3().to_array(),
            half_variance: (0.5 * (1.0 - mean.length_squared())).max(0.0) as f32,
            radius: self.radius(r, mean) as f32,
            light: m.light as f32,
            square: m.square as f32,
            below,
            ..EMPTY
        };
        if r.pixels() > 1 {
            let [red, blue] = [0, 1].map(|c| shifted(m.red_blue_vectors[c], m.red_blue[c]));
            block.colour_moment = red.max(blue) as f32;
            block.square_moment = shifted(m.square_vector, m.square) as f32;
            if self.source.has_levels() {
                block.level_moment = (0.5 * m.brightest * m.solid_angle * (centroid - mean).length()) as f32;
            }
        }
        block
    }

    /// Largest distance of the rectangle from `mean`: of its corners, and of the middles of its edges, since parallels
    /// are no great circles.
    fn radius(&self, r: Rectangle, mean: DVec3) -> f64 {
        if 2 * r.w >= self.source.width && r.h > 1 {
            // Corners say nothing of a block that goes around the pole.
            return 1.0 + mean.length();
        }
        let mut far = 0.0f64;
        for parallel in [r.y, r.y + r.h].map(|y| self.parallels[y as usize]) {
            for k in [2 * r.x, 2 * r.x + r.w, 2 * (r.x + r.w)] {
                let [s, c] = self.meridians[k as usize];
                let corner = DVec3::new(parallel.radius * s, parallel.sine, -parallel.radius * c);
                far = far.max((corner - mean).length_squared());
            }
        }
        far.sqrt()
    }
}

/// A way through the tree down to pixels, with the cells that were entered.
pub struct Walk<'a> {
    /// The tree.
    pub tree: &'a Tree<'a>,
    /// Blocks of the cells that were entered; their indices go on after those of the tree.
    blocks: Vec<Block>,
    sums: Vec<f32>,
    /// Index of a cell in the tree, and of its block here.
    entered: HashMap<u32, u32>,
}

impl<'a> Walk<'a> {
    /// A walk that has entered no cell.
    pub fn new(tree: &'a Tree<'a>) -> Walk<'a> {
        Walk { tree, blocks: Vec::new(), sums: Vec::new(), entered: HashMap::new() }
    }

    /// Forgets all cells where they are many; their indices are then those of others. Keeps the memory.
    pub fn forget_if_many(&mut self) {
        if self.blocks.len() > REMEMBERED {
            self.blocks.clear();
            self.sums.clear();
            self.entered.clear();
        }
    }

    /// A block by its index.
    pub fn block(&self, index: u32) -> Block {
        let index = index as usize;
        let kept = self.tree.blocks.len();
        if index < kept { self.tree.blocks[index] } else { self.blocks[index - kept] }
    }

    /// The sums of a block.
    pub fn sums(&self, index: u32) -> &[f32] {
        let index = index as usize;
        let channels = self.tree.source.channels;
        let kept = self.tree.blocks.len();
        let (sums, index) = if index < kept { (&self.tree.sums, index) } else { (&self.sums, index - kept) };
        &sums[index * channels..][..channels]
    }

    /// The two blocks that a block is made of; none below a pixel.
    pub fn halves(&mut self, index: u32, block: &Block) -> Option<[u32; 2]> {
        match block.below {
            Below::Pixel(_) => None,
            Below::Blocks(second) => Some([index + 1, second]),
            Below::Cell { first, columns, rows } => {
                let kept = self.tree.blocks.len() as u32;
                let at = match self.entered.get(&index) {
                    Some(at) => *at,
                    None => {
                        let at = self.blocks.len() as u32;
                        let (x, y) = (first % self.tree.source.width, first / self.tree.source.width);
                        let cell = Rectangle { x, y, w: u32::from(columns), h: u32::from(rows) };
                        self.tree.down_to_pixels(cell, kept, &mut self.blocks, &mut self.sums);
                        self.entered.insert(index, at);
                        at
                    }
                };
                match self.blocks[at as usize].below {
                    Below::Blocks(second) => Some([kept + at + 1, second]),
                    _ => None,
                }
            }
        }
    }
}

fn parallel(y: u32, height: u32) -> Parallel {
    let latitude = PI * (0.5 - f64::from(y) / f64::from(height));
    let sine = libm::sin(latitude);
    Parallel { sine, latitude, radius: (1.0 - sine * sine).max(0.0).sqrt(), cosine: libm::cos(latitude) }
}

/// The row between two parallels, whose pixels are twice `half` wide.
fn row(top: Parallel, bottom: Parallel, width: u32, half: f64) -> Row {
    // ∫ cos² lat d lat, over the difference of the sines.
    let part = |edge: Parallel| 0.5 * (edge.latitude + edge.sine * edge.radius);
    let cosine = (part(top) - part(bottom)) / (top.sine - bottom.sine);
    Row {
        solid_angle: (top.sine - bottom.sine) * 2.0 * PI / f64::from(width),
        chord: cosine * libm::sin(half) / half,
        height: 0.5 * (top.sine + bottom.sine),
    }
}
