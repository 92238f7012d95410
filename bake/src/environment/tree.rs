//! The source image as a binary tree of blocks of pixels, each with its sums and with what it takes to say how wrong it
//! would be to take the block as one point.
//!
//! A block is split across its longer side as the sphere sees it, so blocks stay compact up to the poles whatever the
//! image's size. Its point is the luminance-weighted mean direction, left shorter than 1: the mean of t = 1 − n·ω over
//! the block's light is then exact for every n, and a kernel in t is wrong by its second derivative only.

use super::image::{EnvironmentImage, direction, luminance};
use glam::DVec3;
use std::f64::consts::PI;

/// Channels that every block sums: red, green, blue and squared luminance.
pub const BASE_CHANNELS: usize = 4;

/// A block of pixels.
#[derive(Clone, Copy, Debug, Default)]
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
    /// Index of the second child; the first follows the block. 0 in a pixel, whose `pixel` then counts.
    pub second: u32,
    /// Index of the pixel, in a pixel.
    pub pixel: u32,
}

/// The tree. Block 0 is the whole sphere.
pub struct Tree {
    /// Columns of the image.
    pub width: u32,
    /// Rows of the image.
    pub height: u32,
    /// Blocks in order of depth-first search.
    pub blocks: Vec<Block>,
    /// Numbers a block, a multiple of 4: [`BASE_CHANNELS`] and then more, zeros at the end.
    pub channels: usize,
    /// For each block, each channel's integral over it.
    pub sums: Vec<f32>,
    /// Sines and cosines of longitude at column edges.
    pub columns: Vec<[f64; 2]>,
    /// Sines and latitudes of row edges.
    pub rows: Vec<[f64; 2]>,
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

impl Tree {
    /// The tree of `image`, with `extra` more numbers a pixel, interleaved, besides the base channels. `has_levels`
    /// says whether indicators are among them, which are worth finer blocks.
    pub fn new(image: &EnvironmentImage, extra_channels: usize, extra: &[f32], has_levels: bool) -> Tree {
        let (width, height) = (image.width, image.height);
        let channels = (BASE_CHANNELS + extra_channels).next_multiple_of(4);
        let columns = (0..=width).map(|x| longitude(f64::from(x), width)).map(|l| [libm::sin(l), libm::cos(l)]);
        let rows = (0..=height).map(|y| [image.sine(f64::from(y)), PI * (0.5 - f64::from(y) / f64::from(height))]);
        let count = 2 * image.pixels.len() - 1;
        let mut tree = Tree {
            width,
            height,
            blocks: Vec::new(),
            channels,
            sums: Vec::new(),
            columns: columns.collect(),
            rows: rows.collect(),
        };
        let mut blocks = vec![Block::default(); count];
        let mut sums = vec![0.0; count * channels];
        let build = Build { image, tree: &tree, extra_channels, extra, has_levels };
        build.block(Rectangle { x: 0, y: 0, w: width, h: height }, 0, &mut blocks, &mut sums);
        (tree.blocks, tree.sums) = (blocks, sums);
        tree
    }
}

/// Longitude of a column, which may lie between two.
pub fn longitude(column: f64, width: u32) -> f64 {
    2.0 * PI * (column / f64::from(width) - 0.5)
}

struct Build<'a> {
    image: &'a EnvironmentImage,
    tree: &'a Tree,
    extra_channels: usize,
    extra: &'a [f32],
    has_levels: bool,
}

impl Build<'_> {
    /// Fills the blocks of a rectangle, whose first has index `index` in the tree.
    fn block(&self, r: Rectangle, index: u32, blocks: &mut [Block], sums: &mut [f32]) -> Moments {
        let moments = if r.w * r.h == 1 {
            let pixel = r.y * self.tree.width + r.x;
            blocks[0].pixel = pixel;
            self.pixel(r, pixel as usize, sums)
        } else {
            let (a, b) = self.split(r);
            let first = 2 * (a.w * a.h) as usize - 1;
            let channels = self.tree.channels;
            let second_index = index + 1 + first as u32;
            let (own, below) = blocks.split_at_mut(1);
            let (own_sums, below_sums) = sums.split_at_mut(channels);
            let (blocks_a, blocks_b) = below.split_at_mut(first);
            let (sums_a, sums_b) = below_sums.split_at_mut(first * channels);
            let mut build_a = || self.block(a, index + 1, blocks_a, sums_a);
            let mut build_b = || self.block(b, second_index, blocks_b, sums_b);
            // Small blocks are not worth a task.
            let (a, b) = if first > 1 << 14 { rayon::join(build_a, build_b) } else { (build_a(), build_b()) };
            own[0].second = second_index;
            for c in 0..channels {
                own_sums[c] = below_sums[c] + below_sums[first * channels + c];
            }
            a.add(b)
        };
        self.describe(r, &moments, &mut blocks[0]);
        moments
    }

    /// Two halves across the longer side.
    fn split(&self, r: Rectangle) -> (Rectangle, Rectangle) {
        let tall = PI * f64::from(r.h) / f64::from(self.tree.height);
        let middle = self.tree.rows[(r.y + r.h / 2) as usize][1];
        let wide = 2.0 * PI * f64::from(r.w) / f64::from(self.tree.width) * libm::cos(middle).max(1e-9);
        if r.h > 1 && (tall >= wide || r.w == 1) {
            let h = r.h / 2;
            (Rectangle { h, ..r }, Rectangle { y: r.y + h, h: r.h - h, ..r })
        } else {
            let w = r.w / 2;
            (Rectangle { w, ..r }, Rectangle { x: r.x + w, w: r.w - w, ..r })
        }
    }

    fn pixel(&self, r: Rectangle, pixel: usize, sums: &mut [f32]) -> Moments {
        let solid_angle = self.image.solid_angle_sr(r.y);
        let rgb = self.image.pixels[pixel].map(f64::from);
        let y = luminance(rgb);
        let mean = self.mean_direction(r);
        for (sum, value) in sums.iter_mut().zip(rgb.into_iter().chain([y * y])) {
            *sum = (value * solid_angle) as f32;
        }
        let more = &self.extra[pixel * self.extra_channels..][..self.extra_channels];
        for (sum, value) in sums[BASE_CHANNELS..].iter_mut().zip(more) {
            *sum = (f64::from(*value) * solid_angle) as f32;
        }
        let area = mean * solid_angle;
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

    /// Mean direction over a pixel, exact.
    fn mean_direction(&self, r: Rectangle) -> DVec3 {
        let [top, bottom] = [r.y, r.y + 1].map(|row| self.tree.rows[row as usize]);
        // ∫ cos² lat d lat, over the difference of the sines.
        let part = |[sine, lat]: [f64; 2]| 0.5 * (lat + sine * (1.0 - sine * sine).max(0.0).sqrt());
        let cosine = (part(top) - part(bottom)) / (top[0] - bottom[0]);
        let half = PI / f64::from(self.tree.width);
        let chord = cosine * libm::sin(half) / half;
        let lambda = longitude(f64::from(r.x) + 0.5, self.tree.width);
        DVec3::new(chord * libm::sin(lambda), 0.5 * (top[0] + bottom[0]), -chord * libm::cos(lambda))
    }

    fn describe(&self, r: Rectangle, m: &Moments, block: &mut Block) {
        let centroid = m.area / m.solid_angle;
        let mean = if m.light > 0.0 { m.luminance / m.light } else { centroid };
        let shifted = |vector: DVec3, sum: f64| (vector - mean * sum).length();
        block.mean = mean.as_vec3().to_array();
        block.half_variance = (0.5 * (1.0 - mean.length_squared())).max(0.0) as f32;
        block.radius = self.radius(r, mean) as f32;
        block.light = m.light as f32;
        block.square = m.square as f32;
        if r.w * r.h > 1 {
            let [red, blue] = [0, 1].map(|c| shifted(m.red_blue_vectors[c], m.red_blue[c]));
            block.colour_moment = red.max(blue) as f32;
            block.square_moment = shifted(m.square_vector, m.square) as f32;
            if self.has_levels {
                block.level_moment = (0.5 * m.brightest * m.solid_angle * (centroid - mean).length()) as f32;
            }
        }
    }

    /// Largest distance of the rectangle from `mean`: of its corners, and of the middles of its edges, since parallels
    /// are no great circles.
    fn radius(&self, r: Rectangle, mean: DVec3) -> f64 {
        if 2 * r.w >= self.tree.width && r.h > 1 {
            // Corners say nothing of a block that goes around the pole.
            return 1.0 + mean.length();
        }
        let sines = [r.y, r.y + r.h].map(|y| self.tree.rows[y as usize][0]);
        let middle = direction(longitude(f64::from(r.x) + 0.5 * f64::from(r.w), self.tree.width), sines[0]);
        let other = direction(longitude(f64::from(r.x) + 0.5 * f64::from(r.w), self.tree.width), sines[1]);
        let mut far = (middle - mean).length_squared().max((other - mean).length_squared());
        for sine in sines {
            let cosine = (1.0 - sine * sine).max(0.0).sqrt();
            for x in [r.x, r.x + r.w] {
                let [s, c] = self.tree.columns[x as usize];
                far = far.max((DVec3::new(cosine * s, sine, -cosine * c) - mean).length_squared());
            }
        }
        far.sqrt()
    }
}
