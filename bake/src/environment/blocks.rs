//! Which blocks of the source a group of texels may take as points: the error bound of the filter.
//!
//! With s the distance of a texel's direction from a block's mean, u = a + b s²/2 and k = (a/u)², t over the block's light
//! has a variance of at most s² e + 0.4 e² (e the block's spread). A point at the mean is wrong by
//!
//! - ½ k_tt Var t = 3 (b/u)² k Var t of the block's light (its first moment about the mean is 0), most of which
//!   [`super::filter_sum`] puts right,
//! - the same with the derivatives of the last factor, cosine or masking,
//! - |k_s| times the first moments that colour, squared luminance and indicators have about the mean of luminance.
//!
//! A block is taken when the first two are below a share of what it gives or of what the texel will have, and the last
//! below a share of what the texel will have. Pixels are constant; one that cannot be taken whole is divided evenly.

use super::filter_sum::{Directions, LANES, Points};
use super::kernel::Lobe;
use super::tree::{Block, Tree, longitude};
use glam::Vec3;
use glint_formats::environment::Kernel;

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
    alpha: f32,
    /// s² where b² s² / u² is largest.
    steepest: f32,
}

impl Bound {
    /// The bound of a lobe.
    pub fn new(lobe: &Lobe) -> Bound {
        let (a, b) = (lobe.a as f32, lobe.b as f32);
        let steepest = if b > 0.0 { 2.0 * a / b } else { 4.0 };
        Bound { a, b, kernel: lobe.kernel, alpha: a.sqrt(), steepest }
    }

    /// Gathers the points of a group among the blocks of `stack` and below, and empties it. Blocks that the group may
    /// not take, but that are no larger than `leave`, are put off: smaller groups within may take them.
    pub fn gather(
        &self,
        tree: &Tree,
        group: &Group,
        allowance: &Allowance,
        stack: &mut Vec<u32>,
        points: &mut Points,
        mut put_off: Option<(f32, &mut Vec<u32>)>,
    ) {
        points.clear();
        while let Some(index) = stack.pop() {
            let block = &tree.blocks[index as usize];
            let distance = Vec3::from(block.mean).distance(group.centre);
            let reach = block.radius + group.radius;
            let near = (distance - reach).max(0.0);
            // All of the block lies below every texel's horizon.
            if near * near > 2.0 {
                continue;
            }
            let parts = self.parts(block, near, distance + reach, allowance);
            if parts <= 1.0 {
                points.places.push([block.mean[0], block.mean[1], block.mean[2], block.spread]);
                let first = index as usize * tree.channels;
                points.sums.extend_from_slice(&tree.sums[first..first + tree.channels]);
                continue;
            }
            if let Some((leave, list)) = &mut put_off
                && block.radius <= *leave
            {
                list.push(index);
            } else if block.second == 0 {
                divide(tree, index, parts.min(MAX_PARTS).ceil(), points);
            } else {
                stack.push(block.second);
                stack.push(index + 1);
            }
        }
    }

    /// 1 when the block may be a point; else into how many parts along its side it would have to be divided.
    fn parts(&self, block: &Block, near: f32, far: f32, allowance: &Allowance) -> f32 {
        let (near2, far2) = (near * near, far * far);
        let s2 = self.steepest.clamp(near2, far2);
        let slope = 2.0 * self.b / (self.a + 0.5 * self.b * s2);
        let first_slope = 2.0 * self.b / (self.a + 0.5 * self.b * near2);
        let e = block.spread;
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
        let kink = if near2 < 2.0 && far2 > 2.0 { 0.4 * edge_slope * variance.sqrt() } else { 0.0 };
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
        // Curvature's error falls with the square of the parts' size, the kink's with the size.
        over.sqrt().max(cut).max(1.01)
    }

    /// Largest slope and curvature of the last factor where the cosine is `low` or more, as shares of it near 1.
    fn edge(&self, low: f32) -> (f32, f32) {
        match self.kernel {
            Kernel::GgxNl => (1.0, 0.0),
            Kernel::Ndf if low <= 0.6 * self.alpha => (2.0 / self.alpha, 3.0 / (self.alpha * self.alpha)),
            Kernel::Ndf => {
                let bent = self.a / (low * low * low);
                (0.5 * bent, 1.5 * bent / low)
            }
        }
    }
}

/// Adds a pixel as parts × parts points of equal radiance.
fn divide(tree: &Tree, index: u32, parts: f32, points: &mut Points) {
    let block = &tree.blocks[index as usize];
    let (x, y) = (block.pixel % tree.width, block.pixel / tree.width);
    let [top, bottom] = [y, y + 1].map(|row| tree.rows[row as usize]);
    let tall = top[1] - bottom[1];
    let middle = 0.5 * (top[1] + bottom[1]);
    let wide = 2.0 * std::f64::consts::PI / f64::from(tree.width) * libm::cos(middle);
    // Parts along the shorter side are fewer, so that they are square.
    let parts = f64::from(parts);
    let longer = tall.max(wide);
    let [count_x, count_y] = [wide, tall].map(|side| (parts * side / longer).ceil().max(1.0) as u32);
    let spread = |side: f64, count: u32| (side / f64::from(count)).powi(2) / 24.0;
    let spread = (spread(wide, count_x) + spread(tall, count_y)) as f32;
    let share = 1.0 / (count_x * count_y) as f32;
    let sums = &tree.sums[index as usize * tree.channels..][..tree.channels];
    let meridian = |i: u32| {
        let lambda = longitude(f64::from(x) + (f64::from(i) + 0.5) / f64::from(count_x), tree.width);
        [libm::sin(lambda) as f32, -libm::cos(lambda) as f32]
    };
    let meridians: [[f32; 2]; MAX_PARTS as usize] =
        std::array::from_fn(|i| if (i as u32) < count_x { meridian(i as u32) } else { [0.0; 2] });
    let step = (top[0] - bottom[0]) / f64::from(count_y);
    for j in 0..count_y {
        let sine = top[0] - (f64::from(j) + 0.5) * step;
        let (sine, cosine) = (sine as f32, (1.0 - sine * sine).max(0.0).sqrt() as f32);
        for [s, c] in &meridians[..count_x as usize] {
            points.places.push([cosine * s, sine, cosine * c, spread]);
            points.sums.extend(sums.iter().map(|sum| sum * share));
        }
    }
}
