//! Which part of the sample each patch shows: section 5.1.1, step 3, of Tan et al. 2022.
//!
//! Patches are placed in raster order. Of the candidates within the error tolerance one is picked by the seed, and where
//! there is none, one of least error. Deviations:
//! - errors are in units of the distance of neighbours in the sample, along rows for patches side by side, along columns
//!   for those above: across the streaks of a brushed map texels differ anyway, along them a seam is seen;
//! - of the candidates whose overlaps differ least, [`SHORTLIST`] of them, the error is what the best cuts go through
//!   ([`CutErrors`]), since that alone is seen;
//! - it counts as more the oftener a candidate has been used ([`CROWDING`]), and within 10 % of the least as the least;
//! - the grid is a torus: a patch also fits the neighbours across the edge that are placed already, so the surface repeats
//!   without a seam;
//! - of the candidates within tolerance the least used are preferred, so that the surface has the normals of the sample in
//!   nearly the same shares;
//! - patches that show much the same as one near by are left out ([`Radii`]), or the eye finds the repetition; so are those
//!   that would go on as the sample does for too long ([`Runs`]).

use super::candidates::{Candidates, Likeness, Runs};
use super::pair_errors::{CutErrors, PairErrors};
use crate::progress::Progress;
use crate::rng::{ItemRng, Purpose};
use rayon::prelude::*;

/// Candidates whose cuts are looked at for a patch. Of 512² texels of scratches and an overlap of 24, 200 are no better.
pub(super) const SHORTLIST: usize = 64;

/// How much, relatively, the error of a candidate rises when it has been used as often as candidates are on average.
pub(super) const CROWDING: f64 = 0.3;

/// How much larger than the least error, relatively, an error is that counts as equal to it.
const SLACK: f64 = 0.1;

/// Candidates that may be chosen: those not barred, or all where all are.
pub(super) fn allowed(barred: &[bool]) -> Vec<usize> {
    let any = barred.contains(&false);
    (0..barred.len()).filter(|&c| !any || !barred[c]).collect()
}

/// Picks one of the candidates `among`, whose errors are given in their order, `limit` being no less than the least: of
/// those within the limit the least used, of these one by chance.
pub(super) fn pick(among: &[usize], errors: &[f64], limit: f64, used: &[u32], rng: &mut ItemRng) -> usize {
    let good: Vec<usize> = among.iter().zip(errors).filter(|&(_, &e)| e <= limit).map(|(&c, _)| c).collect();
    let fewest = good.iter().map(|&c| used[c]).min().unwrap_or(0);
    let best: Vec<usize> = good.into_iter().filter(|&c| used[c] == fewest).collect();
    best[rng.below(best.len() as u32) as usize]
}

/// How many patches apart, along either axis, two patches lie that may be alike, and nearly equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Radii {
    /// Patches closer than this share half of their texels at most.
    pub alike: u32,
    /// Patches closer than this share three quarters of their texels at most.
    pub nearly_equal: u32,
}

impl Radii {
    /// The largest radii at which the patches around leave most of a sample of so many texels to choose from. A patch
    /// rules out offsets around its own: 0.61 patches where half of the texels are shared, 0.14 where three quarters are.
    pub fn of(sample_texels: u64, patch: u32) -> Radii {
        let patches = sample_texels as f64 / f64::from(patch).powi(2);
        // Placed before in raster order, within radius r: r (2r + 1) + r of them.
        let largest = |ruled_out: f64, share: f64, most: u32| {
            let fits = |r: &u32| f64::from(2 * r * (r + 1)) * ruled_out <= share * patches;
            (0..=most).take_while(fits).last().unwrap_or(0)
        };
        Radii { alike: largest(0.61, 0.5, 8), nearly_equal: largest(0.14, 0.35, 16) }
    }
}

/// The grid and what rules the choice.
pub(super) struct Choice<'a> {
    /// Offsets to choose from.
    pub(super) candidates: &'a Candidates,
    /// Their errors over whole overlaps.
    pub(super) errors: &'a PairErrors,
    /// Their errors along cuts.
    pub(super) cuts: CutErrors<'a>,
    /// Columns of patches.
    pub(super) columns: u32,
    /// Rows of patches.
    pub(super) rows: u32,
    /// Mean distance of neighbours in the sample along rows and along columns.
    pub(super) units: [f64; 2],
    /// Mean error along a cut, in units, up to which candidates are equally good.
    pub(super) tolerance: f64,
    /// What may not be near.
    pub(super) radii: Radii,
    /// What may not follow.
    pub(super) runs: Runs,
    /// Seed.
    pub(super) seed: u64,
}

impl Choice<'_> {
    /// The candidate of every patch, row by row.
    pub(super) fn run(&self, progress: &dyn Progress) -> Vec<u32> {
        let mut placed: Vec<u32> = Vec::with_capacity((self.columns * self.rows) as usize);
        let mut used = vec![0u32; self.candidates.len()];
        for at in 0..self.columns * self.rows {
            let picked = self.pick(at, &placed, &used);
            used[picked] += 1;
            placed.push(picked as u32);
            progress.advance(1);
        }
        placed
    }

    fn pick(&self, at: u32, placed: &[u32], used: &[u32]) -> usize {
        let (column, row) = (at % self.columns, at / self.columns);
        let overlaps = self.overlaps(column, row, placed);
        let mut among = allowed(&self.barred(column, row, placed));
        keep_best(&mut among, &self.sums(&overlaps), used);
        // As often as each would have been used if all were alike.
        let average = (placed.len() as f64 / self.candidates.len() as f64).max(1.0);
        let cut = |&c: &usize| self.cut(&overlaps, c) * (1.0 + CROWDING * f64::from(used[c]) / average);
        let cuts: Vec<f64> = among.par_iter().map(cut).collect();
        let least = cuts.iter().copied().fold(f64::INFINITY, f64::min);
        let limit = (self.tolerance * overlaps.len() as f64).max(least * (1.0 + SLACK));
        pick(&among, &cuts, limit, used, &mut ItemRng::new(self.seed, Purpose::Patches, at))
    }

    /// Overlaps of the patch with neighbours that are placed already, on the torus.
    fn overlaps(&self, column: u32, row: u32, placed: &[u32]) -> Vec<Overlap> {
        let (columns, rows) = (self.columns, self.rows);
        let here = row * columns + column;
        let side = |dx: u32, dy: u32, below: bool, after: bool| {
            let at = (row + dy) % rows * columns + (column + dx) % columns;
            // The only patch of a row or column is its own neighbour, on both sides by one overlap.
            let own = after && at == here;
            let other = placed.get(at as usize).map(|&c| c as usize);
            (own || other.is_some()).then_some(Overlap { other, below, after })
        };
        [
            side(columns - 1, 0, false, false),
            side(0, rows - 1, true, false),
            side(1, 0, false, true),
            side(0, 1, true, true),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Sum over the overlaps of every candidate's mean error, in units.
    fn sums(&self, overlaps: &[Overlap]) -> Vec<f64> {
        let mut sums = vec![0.0; self.candidates.len()];
        for overlap in overlaps {
            let unit = self.units[usize::from(overlap.below)];
            for (c, sum) in sums.iter_mut().enumerate() {
                let (first, second) = overlap.pair(c);
                let error =
                    if overlap.below { self.errors.below(first, second) } else { self.errors.beside(first, second) };
                *sum += f64::from(error) / unit;
            }
        }
        sums
    }

    /// Sum over the overlaps of a candidate's mean error along the best cut, in units.
    fn cut(&self, overlaps: &[Overlap], candidate: usize) -> f64 {
        let of = |overlap: &Overlap| {
            let (first, second) = overlap.pair(candidate);
            self.cuts.between(first, second, overlap.below) / self.units[usize::from(overlap.below)]
        };
        overlaps.iter().map(of).sum()
    }

    /// Candidates that show much the same as a patch near by, on the torus.
    fn barred(&self, column: u32, row: u32, placed: &[u32]) -> Vec<bool> {
        let mut barred = vec![false; self.candidates.len()];
        let reach = i64::from(self.radii.alike.max(self.radii.nearly_equal));
        let (columns, rows) = (i64::from(self.columns), i64::from(self.rows));
        // On a small torus a patch is met from several sides; each counts once, by its least distance.
        let span = |n: i64| if 2 * reach + 1 >= n { -(n / 2)..(n + 1) / 2 } else { -reach..reach + 1 };
        for dy in span(rows) {
            for dx in span(columns) {
                let at =
                    (i64::from(row) + dy).rem_euclid(rows) * columns + (i64::from(column) + dx).rem_euclid(columns);
                let distance = dx.abs().max(dy.abs()) as u32;
                let from = match distance {
                    d if d <= self.radii.alike => Likeness::Alike,
                    d if d <= self.radii.nearly_equal => Likeness::NearlyEqual,
                    _ => continue,
                };
                if let Some(&other) = placed.get(at as usize) {
                    let likeness = self.candidates.likeness(other as usize);
                    for (barred, &likeness) in barred.iter_mut().zip(likeness) {
                        *barred |= likeness >= from;
                    }
                }
            }
        }
        self.bar_runs(column, row, placed, &mut barred);
        barred
    }

    /// Bars candidates that would show the sample on and on.
    fn bar_runs(&self, column: u32, row: u32, placed: &[u32], barred: &mut [bool]) {
        let (columns, rows) = (self.columns, self.rows);
        let patch = |column: u32, row: u32| placed.get((row * columns + column) as usize).copied();
        // A row or column is a ring; past the place itself there is nothing more to see.
        let left = |k: u32| (k < columns).then(|| patch((column + columns - k) % columns, row)).flatten();
        let right = |k: u32| (k < columns).then(|| patch((column + k) % columns, row)).flatten();
        let above = |k: u32| (k < rows).then(|| patch(column, (row + rows - k) % rows)).flatten();
        let below = |k: u32| (k < rows).then(|| patch(column, (row + k) % rows)).flatten();
        for candidate in self.runs.too_long(0, left, right).chain(self.runs.too_long(1, above, below)) {
            barred[candidate] = true;
        }
    }
}

/// An overlap of the patch to be placed with a neighbour.
struct Overlap {
    /// The neighbour's candidate; none where it is the patch itself.
    other: Option<usize>,
    /// Whether one lies below the other, or beside it.
    below: bool,
    /// Whether the neighbour comes after the patch, right of it or below it.
    after: bool,
}

impl Overlap {
    /// The left (upper) candidate and the right (lower) one, `candidate` being the patch's.
    fn pair(&self, candidate: usize) -> (usize, usize) {
        let other = self.other.unwrap_or(candidate);
        if self.after { (candidate, other) } else { (other, candidate) }
    }
}

/// Keeps the [`SHORTLIST`] candidates of least error, of equal ones the least used, then the first: where a map is flat,
/// many are equal.
fn keep_best(among: &mut Vec<usize>, errors: &[f64], used: &[u32]) {
    among.sort_by(|&a, &b| errors[a].total_cmp(&errors[b]).then(used[a].cmp(&used[b])).then(a.cmp(&b)));
    among.truncate(SHORTLIST);
    among.sort_unstable();
}
