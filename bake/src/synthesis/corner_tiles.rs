//! A surface without end and without period: corner tiles made of patches of the sample.
//!
//! The paper's look-up grows with the surface. Corner tiles (Lagae and Dutré 2006) do not: each corner of a lattice gets
//! one of C colours by hash of its integer coordinates, and a tile is known by the colours of its four corners, so C⁴
//! tiles cover the plane and any two neighbours fit. Here a tile holds no texels, only offsets and seams into the same
//! sample, so that nothing else is stored twice:
//! - a colour is a patch of the sample, its middle at the corner. Where two of them meet, in the middle of a tile's edge,
//!   there is a cut, which depends on the two colours alone. Only what lies within `margin + overlap` of an edge is seen;
//! - over that lies the tile's middle patch, of the sample's best for these four, between four cuts at `margin` from the
//!   edge. It hides the place where four corner patches meet.

use super::baked::Synthesis;
use super::candidates::{Candidates, Likeness};
use super::choose::{allowed, pick};
use super::features::{COUNT, Feature, Features, distance};
use super::options::SynthesisOptions;
use super::pair_errors::sum_of_squares;
use super::seams::{cut, push_path};

use crate::progress::Progress;
use crate::rng::{ItemRng, Purpose};
use glint_formats::synthesis::Layout;
use rayon::prelude::*;

/// A middle patch is one of the best 1 / [`BEST_OF`] of the candidates: the best alone would be the same few everywhere.
const BEST_OF: usize = 8;
/// A middle patch that has been seen once, before it is divided among those that resemble it.
const ONCE: u32 = 1 << 16;
/// Sets of corner patches among which one is chosen.
const DRAWS: u32 = 32;

/// Synthesises tiles of `colours` corner colours, `variants` for each four of them.
pub(super) fn corner_tiles(
    features: &Features,
    candidates: &Candidates,
    options: &SynthesisOptions,
    (colours, variants): (u32, u32),
    progress: &dyn Progress,
) -> Synthesis {
    let hash_seed = (options.seed ^ options.seed >> 32) as u32;
    let layout = Layout::CornerTiles { colours, variants, margin: options.margin(), hash_seed };
    let params = options.params(features.size(), features.wrap(), layout);
    let frame = Frame {
        features,
        candidates,
        edge: options.patch as i32,
        overlap: options.overlap as i32,
        margin: options.margin() as i32,
        units: features.neighbour_distance(),
    };
    let corners = frame.corner_patches(colours as usize, options.seed);
    let mut seams = Vec::with_capacity(params.seam_words() as usize);
    let mut pairs = Vec::new();
    let shape = params.colour_path(options.margin());
    for a in 0..colours as usize {
        for b in 0..colours as usize {
            let cuts = [false, true].map(|below| frame.pair_cut(corners[a], corners[b], below));
            cuts.iter().for_each(|path| push_path(path, shape, &mut seams));
            pairs.push(cuts);
        }
    }
    let base = Base { frame: &frame, corners: &corners, pairs: &pairs };
    let tiles = (colours.pow(4) * variants) as usize;
    progress.begin("corner tiles", 2 * tiles as u64);
    let middles = base.middle_patches(tiles, variants as usize, options, progress);
    let shape = params.middle_path(options.margin());
    let cuts: Vec<[Vec<u32>; 4]> =
        (0..tiles).into_par_iter().map(|tile| base.middle_cuts(tile / variants as usize, middles[tile])).collect();
    for path in cuts.iter().flatten() {
        push_path(path, shape, &mut seams);
    }
    progress.advance(tiles as u64);
    progress.end();
    let offsets = corners.iter().chain(&middles).map(|&c| candidates.offsets[c]).collect();
    Synthesis::new(params, offsets, seams)
}

/// Sizes of a tile, and the sample it is made of.
struct Frame<'a> {
    features: &'a Features,
    candidates: &'a Candidates,
    edge: i32,
    overlap: i32,
    margin: i32,
    /// Mean distance of neighbours in the sample along rows and along columns.
    units: [f64; 2],
}

impl Frame<'_> {
    fn texel(&self, candidate: usize, x: i32, y: i32) -> Feature {
        let [ox, oy] = self.candidates.offsets[candidate];
        self.features.at(i32::from(ox) + x, i32::from(oy) + y)
    }

    /// Costs across the overlap of two corner patches side by side (or one below the other): rows from `margin + overlap`
    /// before the tile's edge, which goes through their middles, to as many after it.
    fn pair_costs(&self, first: usize, second: usize, below: bool) -> Vec<u32> {
        let reach = self.margin + self.overlap;
        let half = self.edge / 2;
        let mut costs = Vec::with_capacity((2 * reach * self.overlap) as usize);
        for along in half - reach..half + reach {
            for across in -self.overlap..0 {
                let at = |v: i32| if below { (along, v) } else { (v, along) };
                let ((ax, ay), (bx, by)) = (at(across + self.edge), at(across));
                costs.push(distance(self.texel(first, ax, ay), self.texel(second, bx, by)));
            }
        }
        costs
    }

    fn pair_cut(&self, first: usize, second: usize, below: bool) -> Vec<u32> {
        cut(&self.pair_costs(first, second, below), self.overlap as usize)
    }

    /// Error of the second corner patch beside and below the first, in units of the distance of neighbours.
    fn pair_error(&self, first: usize, second: usize) -> f64 {
        let sum = |below| self.pair_costs(first, second, below).into_iter().map(u64::from).sum::<u64>() as f64;
        sum(false) / self.units[0] + sum(true) / self.units[1]
    }

    /// Corner patches: of [`DRAWS`] seeded sets the one whose patches fit each other best. None shows much of what another
    /// does, as far as the sample has enough. More draws would find patches that are all alike where they meet, and every
    /// tile would show it.
    fn corner_patches(&self, colours: usize, seed: u64) -> Vec<usize> {
        let drawn = |draw: u32| {
            let mut rng = ItemRng::new(seed, Purpose::CornerPatches, draw);
            let mut picked: Vec<usize> = Vec::new();
            while picked.len() < colours {
                let mut from: Vec<usize> = (0..self.candidates.len()).filter(|&c| self.apart(c, &picked)).collect();
                if from.is_empty() {
                    from.extend(0..self.candidates.len());
                }
                picked.push(from[rng.below(from.len() as u32) as usize]);
            }
            picked
        };
        let sets: Vec<Vec<usize>> = (0..DRAWS).map(drawn).collect();
        let error = |set: &Vec<usize>| -> f64 {
            set.iter().flat_map(|&a| set.iter().map(move |&b| (a, b))).map(|(a, b)| self.pair_error(a, b)).sum()
        };
        let errors: Vec<f64> = sets.par_iter().map(error).collect();
        let mut best = 0;
        for k in 0..sets.len() {
            if errors[k] < errors[best] {
                best = k;
            }
        }
        sets[best].clone()
    }

    fn apart(&self, candidate: usize, picked: &[usize]) -> bool {
        picked.iter().all(|&other| !self.candidates.alike(candidate, other))
    }

    /// The texels of a tile that lie under the cuts of its middle patch: left, upper, right, lower; of each side row by
    /// row (column by column), from the border inwards.
    fn sides(&self) -> [Vec<(i32, i32)>; 4] {
        let (near, far) = (self.margin, self.edge - self.margin);
        let side = |at: &dyn Fn(i32, i32) -> (i32, i32)| {
            (near..far)
                .flat_map(|along| (0..self.overlap).map(move |depth| (along, depth)))
                .map(|(a, d)| at(a, d))
                .collect()
        };
        [
            side(&|along, depth| (near + depth, along)),
            side(&|along, depth| (along, near + depth)),
            side(&|along, depth| (far - 1 - depth, along)),
            side(&|along, depth| (along, far - 1 - depth)),
        ]
    }
}

/// The corner patches with the cuts between them, before middle patches are laid over.
struct Base<'a> {
    frame: &'a Frame<'a>,
    corners: &'a [usize],
    /// Cuts of each pair of colours: beside, below.
    pairs: &'a [[Vec<u32>; 2]],
}

impl Base<'_> {
    /// Corner patches of tile `tile` (without its variant): upper left, upper right, lower left, lower right.
    fn colours_of(&self, tile: usize) -> [usize; 4] {
        let colours = self.corners.len();
        std::array::from_fn(|k| tile / colours.pow(k as u32) % colours)
    }

    /// What the corner patches show at texel (x, y) of a tile, which lies within `margin + overlap` of its edge.
    fn texel(&self, colours: [usize; 4], x: i32, y: i32) -> Feature {
        let half = self.frame.edge / 2;
        let nearest = |v: i32| usize::from(v >= half);
        let (mut column, mut row) = (nearest(x), nearest(y));
        let (beside, below) = ([2 * row, 2 * row + 1], [column, column + 2]);
        if column == 0 && x - half >= self.cut_at(beside.map(|k| colours[k]), 0, y) {
            column = 1;
        }
        if row == 0 && y - half >= self.cut_at(below.map(|k| colours[k]), 1, x) {
            row = 1;
        }
        let local = |v: i32, second: usize| if second == 1 { v - half } else { v + half };
        self.frame.texel(self.corners[colours[2 * row + column]], local(x, column), local(y, row))
    }

    fn cut_at(&self, [first, second]: [usize; 2], which: usize, along: i32) -> i32 {
        let (edge, reach) = (self.frame.edge, self.frame.margin + self.frame.overlap);
        let path = &self.pairs[first * self.corners.len() + second][which];
        match along {
            _ if path.is_empty() => 0,
            k if k < reach => path[(k + reach) as usize] as i32 - self.frame.overlap,
            k if k >= edge - reach => path[(k + reach - edge) as usize] as i32 - self.frame.overlap,
            _ => 0,
        }
    }

    /// Texels under the cuts of a tile's middle patch, one side after another.
    fn ring(&self, tile: usize) -> Vec<i16> {
        let colours = self.colours_of(tile);
        let texels = self.frame.sides().concat();
        texels.into_iter().flat_map(|(x, y)| self.texel(colours, x, y)).collect()
    }

    /// The middle patch of every tile. Of the candidates within tolerance, or of the best, the one least seen so far, then
    /// by the seed. Not the corner patches, nor twice much the same under the same four colours.
    fn middle_patches(
        &self,
        tiles: usize,
        variants: usize,
        options: &SynthesisOptions,
        progress: &dyn Progress,
    ) -> Vec<usize> {
        let (frame, count) = (self.frame, self.frame.candidates.len());
        let sides = frame.sides().concat();
        let side = sides.len() / 4 * COUNT;
        let tolerance = options.error_tolerance * sides.len() as f64;
        let rings: Vec<i16> = (0..count)
            .into_par_iter()
            .flat_map_iter(|c| sides.iter().flat_map(move |&(x, y)| frame.texel(c, x, y)))
            .collect();
        let error = |of: &[i16], ring: &[i16]| -> f64 {
            let side = |k: usize| sum_of_squares(&of[k * side..][..side], &ring[k * side..][..side]) as f64;
            (side(0) + side(2)) / frame.units[0] + (side(1) + side(3)) / frame.units[1]
        };
        let resembling: Vec<u32> = (0..count)
            .map(|c| frame.candidates.likeness(c).iter().filter(|&&l| l == Likeness::NearlyEqual).count() as u32)
            .collect();
        let mut used = vec![0u32; count];
        let mut picked: Vec<usize> = Vec::with_capacity(tiles);
        for tile in 0..tiles / variants {
            let ring = self.ring(tile);
            let errors: Vec<f64> =
                (0..count).into_par_iter().map(|c| error(&rings[c * 4 * side..][..4 * side], &ring)).collect();
            let corners = self.colours_of(tile).map(|colour| self.corners[colour]);
            for variant in 0..variants {
                let siblings = &picked[picked.len() - variant..];
                let barred: Vec<bool> = (0..count)
                    .map(|c| corners.iter().chain(siblings).any(|&other| frame.candidates.alike(c, other)))
                    .collect();
                let mut rng = ItemRng::new(options.seed, Purpose::MiddlePatches, picked.len() as u32);
                let among = allowed(&barred);
                let errors: Vec<f64> = among.iter().map(|&c| errors[c]).collect();
                let mut sorted = errors.clone();
                sorted.sort_by(f64::total_cmp);
                let limit = tolerance.max(sorted[(sorted.len() - 1) / BEST_OF]);
                let chosen = pick(&among, &errors, limit, &used, &mut rng);
                // What shows nearly the same has been seen as well. Shares are by how many do, or candidates at the rim of
                // the sample, which fewer resemble, would be preferred.
                for (c, &likeness) in frame.candidates.likeness(chosen).iter().enumerate() {
                    if likeness == Likeness::NearlyEqual {
                        used[c] += ONCE / resembling[c];
                    }
                }
                picked.push(chosen);
                progress.advance(1);
            }
        }
        picked
    }

    /// The four cuts of a tile's middle patch.
    fn middle_cuts(&self, tile: usize, middle: usize) -> [Vec<u32>; 4] {
        let colours = self.colours_of(tile);
        self.frame.sides().map(|side| {
            let cost = |&(x, y): &(i32, i32)| distance(self.texel(colours, x, y), self.frame.texel(middle, x, y));
            cut(&side.iter().map(cost).collect::<Vec<u32>>(), self.frame.overlap as usize)
        })
    }
}
