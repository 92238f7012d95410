//! Filters the source into a mip to an error bound, and the first mip by exact areas.
//!
//! Paper: sections 3.4 and 5, which filter by importance sampling with a sample count. Here a group of texels walks the
//! tree of the source from coarse to fine ([`super::blocks`]) and sums the blocks it may take as points, for all texels
//! and channels at once ([`super::filter_sum`]). Nothing is random, so a sun is as exact as a grey sky; sharp mips see
//! single pixels and parts of them in the core of the lobe, rough ones large blocks.

use super::blocks::{Allowance, Bound, Group};
use super::cube::texel_direction;
use super::filter_sum::{LANES, Points, filter_sum};
use super::image::luminance;
use super::kernel::Lobe;
use super::tree::Tree;
use crate::progress::Progress;
use glam::Vec3;
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
/// Below this roughness a lobe is no wider than some texels of its mip, and [`OF_SHARP`] times the error is allowed.
pub const SHARP: f64 = 0.04;
/// See [`SHARP`].
pub const OF_SHARP: f64 = 4.0;

/// What the texels of a mip have in common.
struct Filter<'a> {
    tree: &'a Tree,
    lobe: &'a Lobe,
    bound: Bound,
    size: u32,
    max_error: f64,
    /// Mean luminance of the source.
    mean: f64,
}

/// Texels of one mip, 6 · size² of `tree.channels` numbers each: face by face, row by row. Means under the lobe.
pub fn filter_mip(tree: &Tree, lobe: &Lobe, size: u32, max_error: f64, progress: &dyn Progress) -> Vec<f64> {
    // Half of what is allowed, since some texels of a sharp mip look at a sun directly.
    let max_error = if lobe.a < SHARP * SHARP { 0.5 * OF_SHARP * max_error } else { max_error };
    let mean = f64::from(tree.blocks[0].light) / (4.0 * std::f64::consts::PI);
    let filter = Filter { tree, lobe, bound: Bound::new(lobe), size, max_error, mean };
    let edge = size.min(FIELD);
    let squares = squares_of(size, edge);
    let fields: Vec<Vec<f64>> = squares
        .par_iter()
        .map(|square| {
            let texels = filter.field(*square);
            progress.advance(u64::from(edge * edge));
            texels
        })
        .collect();
    let channels = tree.channels;
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

/// The squares of `edge` texels that a mip of `size` is divided in.
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
    /// Means of a field's texels, row by row. A texel brighter than the mip's mean has less error as a share, by the root
    /// of their ratio: then bright and dark texels weigh alike in the mip's root mean square. How bright a field gets is
    /// seen once it is done, so fields next to a sun are done twice.
    fn field(&self, field: Square) -> Vec<f64> {
        let texels = self.field_within(field, 1.0);
        let light = texels.chunks_exact(self.tree.channels).map(|t| luminance([t[0], t[1], t[2]]));
        let share = (self.mean / light.fold(self.mean, f64::max)).sqrt();
        if share < ALIKE { self.field_within(field, share) } else { texels }
    }

    /// Means of a field's texels to `share` of the error.
    fn field_within(&self, field: Square, share: f64) -> Vec<f64> {
        let channels = self.tree.channels;
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
        let allowance = self.allowance(&whole, &groups, share);
        let (mut far, mut near) = (Points::default(), Points::default());
        let (mut stack, mut put_off) = (vec![0], Vec::new());
        self.bound.gather(self.tree, &whole, &allowance, &mut stack, &mut far, Some((largest, &mut put_off)));
        let mut texels = vec![0.0; (field.edge * field.edge) as usize * channels];
        let mut totals = vec![0.0; channels * LANES];
        for (square, group) in &groups {
            stack.extend_from_slice(&put_off);
            self.bound.gather(self.tree, group, &allowance, &mut stack, &mut near, None);
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
    fn allowance(&self, whole: &Group, groups: &[(Square, Group)], share: f64) -> Allowance {
        let centres: Vec<Vec3> = groups.iter().map(|(_, group)| group.centre).collect();
        let look = Group { radius: whole.radius, centre: whole.centre, ..Group::new(&centres) };
        let coarse = Allowance { of_block: FIRST_LOOK, of_texel: [0.0; 2] };
        let (mut points, mut stack) = (Points::default(), vec![0]);
        let mut totals = vec![0.0; self.tree.channels * LANES];
        self.bound.gather(self.tree, &look, &coarse, &mut stack, &mut points, None);
        filter_sum(&points, self.tree.channels, &look.directions, self.lobe, &mut totals);
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
