//! Filters the source with the lobe of one roughness into a cube, to an error bound.
//!
//! Paper: sections 3.4 and 5, which filter by importance sampling with a sample count. Here a group of texels walks the
//! tree of the source from coarse to fine and sums the blocks it may take as points, for all texels
//! and channels at once ([`filter_sum`]). Nothing is random, so a sun is as exact as a grey sky; sharp lobes see
//! single pixels and parts of them in the core of the lobe, rough ones large blocks.
//!
//! Which blocks a group may take as points is an error bound. //! With s the distance of a texel's direction from a block's mean, u = a + b s²/2 and k = (a/u)², t over the block's light
//! has a variance of at most s² e + 0.4 e² (e half the variance of its light's directions). A point at the mean is wrong by
//!
//! - ½ k_tt Var t = 3 (b/u)² k Var t of the block's light (its first moment about the mean is 0), most of which
//!   [`filter_sum`] puts right,
//! - the same with the derivatives of the last factor, cosine or masking,
//! - |k_s| times the first moments that colour, squared luminance and indicators have about the mean of luminance.
//!
//! A block is taken when the first two are below a share of what it gives or of what the texel will have, and the last
//! below a share of what the texel will have. Pixels are constant; one that cannot be taken whole is divided evenly.

use super::cube::texel_direction;
use super::image::{longitude, luminance};
use super::kernel::{Directions, LANES, Lobe, Points, filter_sum, reach};
use super::tree::{Below, Block, Tree, Walk};
use crate::progress::Progress;
use glam::Vec3;
use glint_formats::environment::{Kernel, SHARP, SOFT_TOE};
use rayon::prelude::*;

/// Error that a block may have as a share of what it gives, before correction, in units of the error that is asked.
const OF_BLOCK: f64 = 8.0;
/// Error that a block may have as a share of its texel's value, in the same units; there are some thousands of blocks.
const OF_TEXEL: f64 = 5e-3;
/// Shares of blocks in the first look, which only finds the size of a texel's value.
const FIRST_LOOK: f32 = 0.2;
/// Fields whose brightest texel is at most 1/ALIKE² times as bright as the mean are done once.
const ALIKE: f64 = 0.7;
/// Edge of a field of texels that share what is far from all of them, and of the groups within that share the rest.
const FIELD: u32 = 16;
/// See [`FIELD`]; its square is [`LANES`].
const GROUP: u32 = 4;
/// Below roughness [`SHARP`] this times the error is allowed.
pub const OF_SHARP: f64 = 4.0;

/// Most parts of a pixel along one side.
const MAX_PARTS: f32 = 16.0;

/// What first moments of colour and squared luminance may do, in units of a texel's allowance. Theirs have any sign, so
/// they do not add up as curvature does.
const OF_COLOUR: f32 = 40.0;
/// The same of indicators, whose moments are estimates from above.
const OF_LEVELS: f32 = 160.0;
/// What curvature may do to squared luminance, in units of a texel's allowance.
const OF_SQUARE: f32 = 4.0;
/// What a block across the horizon may do, in the same units; only few blocks are.
const OF_KINK: f32 = 20.0;
/// Blocks of a first look are no larger, so that even a lobe as wide as the hemisphere sees where it ends.
const LOOK_RADIUS: f32 = 0.3;

/// What the texels of a cube have in common.
struct Filter<'a> {
    tree: &'a Tree<'a>,
    lobe: &'a Lobe,
    bound: Bound,
    size: u32,
    max_error: f64,
    /// Mean luminance of the source.
    mean: f64,
}

/// Texels of one roughness, 6 · size² of as many numbers each as the source has channels: face by face, row by row. Means under the lobe.
pub fn filter_cube(tree: &Tree<'_>, lobe: &Lobe, size: u32, max_error: f64, progress: &dyn Progress) -> Vec<f64> {
    // Half of what is allowed, since some texels of a sharp lobe look at a sun directly.
    let max_error = if lobe.a < SHARP * SHARP { 0.5 * OF_SHARP * max_error } else { max_error };
    let mean = f64::from(tree.blocks[0].light) / (4.0 * std::f64::consts::PI);
    let filter = Filter { tree, lobe, bound: Bound::new(lobe), size, max_error, mean };
    let edge = size.min(FIELD);
    let squares = squares_of(size, edge);
    let of = |walk: &mut Walk<'_>, square: &Square| {
        let texels = filter.field(walk, *square);
        progress.advance(u64::from(edge * edge));
        texels
    };
    let fields: Vec<Vec<f64>> = squares.par_iter().map_init(|| Walk::new(tree), of).collect();
    let channels = tree.source.channels;
    let row = edge as usize * channels;
    let mut texels = vec![0.0; 6 * (size * size) as usize * channels];
    for (square, field) in squares.iter().zip(&fields) {
        for (j, from) in field.chunks_exact(row).enumerate() {
            let first = ((square.face as u32 * size + square.j + j as u32) * size + square.i) as usize * channels;
            texels[first..first + row].copy_from_slice(from);
        }
    }
    texels
}

/// A square of texels of a face.
#[derive(Clone, Copy)]
struct Square {
    face: usize,
    i: u32,
    j: u32,
    edge: u32,
}

/// The squares of `edge` texels that a cube of `size` is divided in.
fn squares_of(size: u32, edge: u32) -> Vec<Square> {
    let per_face = size / edge;
    let square = |k: u32| Square {
        face: (k / (per_face * per_face)) as usize,
        i: k % per_face * edge,
        j: k / per_face % per_face * edge,
        edge,
    };
    (0..6 * per_face * per_face).map(square).collect()
}

impl Filter<'_> {
    /// Means of a field's texels, row by row. A texel brighter than the mean has less error as a share, by the root
    /// of their ratio: then bright and dark texels weigh alike in the root mean square. How bright a field gets is
    /// seen once it is done, so fields next to a sun are done twice.
    fn field(&self, walk: &mut Walk<'_>, field: Square) -> Vec<f64> {
        walk.forget_if_many();
        let texels = self.field_within(walk, field, 1.0);
        let light = texels.chunks_exact(self.tree.source.channels).map(|t| luminance([t[0], t[1], t[2]]));
        let share = (self.mean / light.fold(self.mean, f64::max)).sqrt();
        if share < ALIKE { self.field_within(walk, field, share) } else { texels }
    }

    /// Means of a field's texels to `share` of the error.
    fn field_within(&self, walk: &mut Walk<'_>, field: Square, share: f64) -> Vec<f64> {
        let channels = self.tree.source.channels;
        let edge = field.edge.min(GROUP);
        let groups: Vec<(Square, Group)> = (0..(field.edge / edge).pow(2))
            .map(|k| {
                let per_row = field.edge / edge;
                let (i, j) = (field.i + k % per_row * edge, field.j + k / per_row * edge);
                let square = Square { i, j, edge, ..field };
                (square, Group::new(&self.directions(square)))
            })
            .collect();
        let whole = Group::new(&self.directions(field));
        let largest = groups.iter().map(|(_, group)| group.radius).fold(0.0, f32::max);
        let allowance = self.allowance(walk, &whole, &groups, share);
        let (mut far, mut near) = (Points::default(), Points::default());
        let (mut stack, mut put_off) = (vec![0], Vec::new());
        self.bound.gather(walk, &whole, &allowance, &mut stack, &mut far, Some((largest, &mut put_off)));
        let mut texels = vec![0.0; (field.edge * field.edge) as usize * channels];
        let mut totals = vec![0.0; channels * LANES];
        for (square, group) in &groups {
            stack.extend_from_slice(&put_off);
            self.bound.gather(walk, group, &allowance, &mut stack, &mut near, None);
            totals.fill(0.0);
            for points in [&far, &near] {
                filter_sum(points, channels, &group.directions, self.lobe, &mut totals);
            }
            for lane in 0..(edge * edge) as usize {
                let (i, j) = (square.i - field.i + lane as u32 % edge, square.j - field.j + lane as u32 / edge);
                let first = (j * field.edge + i) as usize * channels;
                for c in 0..channels {
                    texels[first + c] = totals[c * LANES + lane] / self.lobe.integral_sr;
                }
            }
        }
        texels
    }

    /// Directions of a square's texels, row by row.
    fn directions(&self, square: Square) -> Vec<Vec3> {
        let texel = |k: u32| (square.i + k % square.edge, square.j + k / square.edge);
        (0..square.edge * square.edge)
            .map(texel)
            .map(|(i, j)| texel_direction(square.face, i, j, self.size).as_vec3())
            .collect()
    }

    /// What the darkest group of a field allows, by a first look in the directions of the groups.
    fn allowance(&self, walk: &mut Walk<'_>, whole: &Group, groups: &[(Square, Group)], share: f64) -> Allowance {
        let centres: Vec<Vec3> = groups.iter().map(|(_, group)| group.centre).collect();
        let look = Group { radius: whole.radius, centre: whole.centre, ..Group::new(&centres) };
        let coarse = Allowance { of_block: FIRST_LOOK, of_texel: [0.0; 2] };
        let (mut points, mut stack) = (Points::default(), vec![0]);
        let mut totals = vec![0.0; self.tree.source.channels * LANES];
        self.bound.gather(walk, &look, &coarse, &mut stack, &mut points, None);
        filter_sum(&points, self.tree.source.channels, &look.directions, self.lobe, &mut totals);
        let of = |c: usize, lane: usize| totals[c * LANES + lane];
        let least = |value: &dyn Fn(usize) -> f64| (0..LANES).map(value).fold(f64::INFINITY, f64::min);
        let light = least(&|lane| luminance([of(0, lane), of(1, lane), of(2, lane)]));
        let square = least(&|lane| of(3, lane));
        let max_error = share * self.max_error;
        let share = OF_TEXEL * max_error;
        Allowance {
            of_block: (OF_BLOCK * max_error) as f32,
            of_texel: [(share * light) as f32, (share * square) as f32],
        }
    }
}

/// Directions that share their blocks.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// The directions.
    pub directions: Directions,
    /// Their mean, of unit length.
    pub centre: Vec3,
    /// Largest distance of one from `centre`.
    pub radius: f32,
}

impl Group {
    /// A group of 1 to [`LANES`] directions; lanes that are left over repeat the first.
    pub fn new(members: &[Vec3]) -> Group {
        let centre = members.iter().sum::<Vec3>().normalize();
        let radius = members.iter().map(|d| d.distance(centre)).fold(0.0, f32::max);
        let mut directions = Directions::default();
        for lane in 0..LANES {
            let d = members.get(lane).unwrap_or(&members[0]);
            (directions.x[lane], directions.y[lane], directions.z[lane]) = (d.x, d.y, d.z);
        }
        Group { directions, centre, radius }
    }
}

/// What is allowed.
#[derive(Clone, Copy, Debug)]
pub struct Allowance {
    /// Error of a block as a share of what it gives.
    pub of_block: f32,
    /// Error of a block, in units of a filter sum: luminance, then its square.
    pub of_texel: [f32; 2],
}

/// A lobe with the constants of the error bound.
pub struct Bound {
    a: f32,
    b: f32,
    kernel: Kernel,
    reach: f32,
    alpha: f32,
    /// s² where b² s² / u² is largest.
    steepest: f32,
}

impl Bound {
    /// The bound of a lobe.
    pub fn new(lobe: &Lobe) -> Bound {
        let (a, b) = (lobe.a as f32, lobe.b as f32);
        let steepest = if b > 0.0 { 2.0 * a / b } else { 4.0 };
        Bound { a, b, kernel: lobe.kernel, reach: reach(lobe.kernel) as f32, alpha: a.sqrt(), steepest }
    }

    /// Gathers the points of a group among the blocks of `stack` and below, and empties it. Blocks that the group may
    /// not take, but that are no larger than `leave`, are put off: smaller groups within may take them.
    pub fn gather(
        &self,
        walk: &mut Walk<'_>,
        group: &Group,
        allowance: &Allowance,
        stack: &mut Vec<u32>,
        points: &mut Points,
        mut put_off: Option<(f32, &mut Vec<u32>)>,
    ) {
        points.clear();
        while let Some(index) = stack.pop() {
            let block = walk.block(index);
            let distance = Vec3::from(block.mean).distance(group.centre);
            let reach = block.radius + group.radius;
            let near = (distance - reach).max(0.0);
            // All of the block lies below every texel's horizon.
            if near * near > 2.0 * self.reach {
                continue;
            }
            let parts = self.parts(&block, near, distance + reach, allowance);
            if parts <= 1.0 {
                points.places.push([block.mean[0], block.mean[1], block.mean[2], block.half_variance]);
                points.sums.extend_from_slice(walk.sums(index));
                continue;
            }
            if let Some((leave, list)) = &mut put_off
                && block.radius <= *leave
            {
                list.push(index);
            } else if let Below::Pixel(pixel) = block.below {
                divide(walk.tree, pixel, walk.sums(index), parts.min(MAX_PARTS).ceil(), points);
            } else if let Some([first, second]) = walk.halves(index, &block) {
                stack.extend([second, first]);
            }
        }
    }

    /// 1 when the block may be a point; else into how many parts along its side it would have to be divided.
    fn parts(&self, block: &Block, near: f32, far: f32, allowance: &Allowance) -> f32 {
        let (near2, far2) = (near * near, far * far);
        let s2 = self.steepest.clamp(near2, far2);
        let slope = 2.0 * self.b / (self.a + 0.5 * self.b * s2);
        let first_slope = 2.0 * self.b / (self.a + 0.5 * self.b * near2);
        let e = block.half_variance;
        let core = 0.4 * e * e;
        let variance = s2 * e + core;
        let [light, square] = allowance.of_texel;
        if light == 0.0 && block.radius > LOOK_RADIUS {
            return 2.0;
        }
        // A first look at how bright a texel is need not follow the horizon, where there is next to no weight.
        let (edge_slope, edge_curve) = if light > 0.0 { self.edge(1.0 - 0.5 * far2) } else { (0.0, 0.0) };
        // 3 (b/u)² is ¾ slope². The core's part peaks at s = 0, the rest at the steepest place.
        let curve = 0.75 * (slope * slope * s2 * e + first_slope * first_slope * core);
        let relative = curve + (slope * edge_slope + 0.5 * edge_curve) * variance;
        // The horizon's kink cuts the block off somewhere. What it gives there is next to nothing, so no share of that
        // is allowed, only one of the texel.
        let toe = SOFT_TOE as f32;
        let kink = match self.kernel {
            Kernel::GgxSoft if near2 < 2.0 * (1.0 + toe) && far2 > 2.0 * (1.0 - toe) => 0.25 / toe * variance,
            Kernel::Ndf | Kernel::GgxNl if near2 < 2.0 && far2 > 2.0 => 0.4 * edge_slope * variance.sqrt(),
            _ => 0.0,
        };
        let peak = self.a / (self.a + 0.5 * self.b * near2);
        let peak = peak * peak;
        let gradient = peak * (first_slope + edge_slope) * far.min(1.5);
        let bent = peak * relative;
        let fits = (relative <= allowance.of_block
            || (bent * block.light <= light && bent * block.square <= OF_SQUARE * square))
            && (light == 0.0
                || (gradient * block.colour_moment <= OF_COLOUR * light
                    && gradient * block.level_moment <= OF_LEVELS * light
                    && gradient * block.square_moment <= OF_COLOUR * square
                    && peak * kink * block.light <= OF_KINK * light
                    && peak * kink * block.square <= OF_KINK * square));
        if fits || block.light == 0.0 {
            return 1.0;
        }
        let of_texel = if light > 0.0 {
            (bent * block.light / light).max(bent * block.square / (OF_SQUARE * square))
        } else {
            f32::INFINITY
        };
        let over = (relative / allowance.of_block).min(of_texel);
        let cut =
            if light > 0.0 { peak * kink * (block.light / light).max(block.square / square) / OF_KINK } else { 0.0 };
        // Curvature's error falls with the square of the parts' size, a kink's with the size.
        let cut = if self.kernel == Kernel::GgxSoft { cut.sqrt() } else { cut };
        over.sqrt().max(cut).max(1.01)
    }

    /// Largest slope and curvature of the last factor where the cosine is `low` or more, as shares of it near 1.
    fn edge(&self, low: f32) -> (f32, f32) {
        match self.kernel {
            Kernel::GgxNl | Kernel::GgxSoft => (1.0, 0.0),
            Kernel::Ndf if low <= 0.6 * self.alpha => (2.0 / self.alpha, 3.0 / (self.alpha * self.alpha)),
            Kernel::Ndf => {
                let bent = self.a / (low * low * low);
                (0.5 * bent, 1.5 * bent / low)
            }
        }
    }
}

/// Adds a pixel as parts × parts points of equal radiance.
fn divide(tree: &Tree<'_>, pixel: u32, sums: &[f32], parts: f32, points: &mut Points) {
    let width = tree.source.width;
    let (x, y) = (pixel % width, pixel / width);
    let [top, bottom] = [y, y + 1].map(|row| tree.parallels[row as usize]);
    let tall = top.latitude - bottom.latitude;
    let middle = 0.5 * (top.latitude + bottom.latitude);
    let wide = 2.0 * std::f64::consts::PI / f64::from(width) * libm::cos(middle);
    // Parts along the shorter side are fewer, so that they are square.
    let parts = f64::from(parts);
    let longer = tall.max(wide);
    let [count_x, count_y] = [wide, tall].map(|side| (parts * side / longer).ceil().max(1.0) as u32);
    let half_variance = |side: f64, count: u32| (side / f64::from(count)).powi(2) / 24.0;
    let half_variance = (half_variance(wide, count_x) + half_variance(tall, count_y)) as f32;
    let share = 1.0 / (count_x * count_y) as f32;
    let meridian = |i: u32| {
        let lambda = longitude(f64::from(x) + (f64::from(i) + 0.5) / f64::from(count_x), width);
        [libm::sin(lambda) as f32, -libm::cos(lambda) as f32]
    };
    let meridians: [[f32; 2]; MAX_PARTS as usize] =
        std::array::from_fn(|i| if (i as u32) < count_x { meridian(i as u32) } else { [0.0; 2] });
    let step = (top.sine - bottom.sine) / f64::from(count_y);
    for j in 0..count_y {
        let sine = top.sine - (f64::from(j) + 0.5) * step;
        let (sine, cosine) = (sine as f32, (1.0 - sine * sine).max(0.0).sqrt() as f32);
        for [s, c] in &meridians[..count_x as usize] {
            points.places.push([cosine * s, sine, cosine * c, half_variance]);
            points.sums.extend(sums.iter().map(|sum| sum * share));
        }
    }
}
