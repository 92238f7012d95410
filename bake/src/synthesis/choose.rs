//! Which part of the sample each patch shows: section 5.1.1, step 3, of Tan et al. 2022.
//!
//! Patches are placed in raster order. Of the candidates within the error tolerance one is picked by the seed, and where
//! there is none, one of least error. Deviations:
//! - errors are in units of the distance of neighbours in the sample, along rows for patches side by side, along columns
//!   for those above: across the streaks of a brushed map texels differ anyway, along them a seam is seen;
//! - an error next to the least (within 10 %) is as good as the least;
//! - the grid is a torus: a patch also fits the neighbours across the edge that are placed already, so the surface repeats
//!   without a seam;
//! - of the candidates within tolerance the least used are preferred, so that the surface has the normals of the sample in
//!   nearly the same shares;
//! - patches that show much the same as one near by are left out ([`Radii`]), or the eye finds the repetition.

use super::candidates::{Candidates, Likeness};
use super::strips::PairErrors;
use crate::progress::Progress;
use crate::rng::ItemRng;

/// Purpose of the random numbers that choose patches.
pub(super) const PURPOSE: u32 = 51;

/// How much larger than the least error, relatively, an error is that counts as equal to it.
const SLACK: f64 = 0.1;

/// Picks a candidate: of those whose error is `limit` at most, which one is at least, the least used; of these one by
/// chance. Barred ones are left out unless all are.
pub(super) fn pick(
    errors: &[f64],
    barred: &[bool],
    used: &[u32],
    limit: impl Fn(&[f64]) -> f64,
    rng: &mut ItemRng,
) -> usize {
    let any = barred.contains(&false);
    let allowed: Vec<usize> = (0..errors.len()).filter(|&c| !any || !barred[c]).collect();
    let limit = limit(&allowed.iter().map(|&c| errors[c]).collect::<Vec<f64>>());
    let good: Vec<usize> = allowed.into_iter().filter(|&c| errors[c] <= limit).collect();
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
pub struct Choice<'a> {
    /// Offsets to choose from.
    pub candidates: &'a Candidates,
    /// Their errors.
    pub errors: &'a PairErrors,
    /// Columns of patches.
    pub columns: u32,
    /// Rows of patches.
    pub rows: u32,
    /// Mean distance of neighbours in the sample along rows and along columns.
    pub units: [f64; 2],
    /// Mean error of an overlap, in units, up to which candidates are equally good.
    pub tolerance: f64,
    /// What may not be near.
    pub radii: Radii,
    /// Seed.
    pub seed: u64,
}

impl Choice<'_> {
    /// The candidate of every patch, row by row.
    pub fn run(&self, progress: &dyn Progress) -> Vec<u32> {
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
        let (errors, overlaps) = self.sums(column, row, placed);
        let barred = self.barred(column, row, placed);
        let mut rng = ItemRng::new(self.seed, PURPOSE, at);
        let tolerance = self.tolerance * overlaps;
        let least = |errors: &[f64]| errors.iter().copied().fold(f64::INFINITY, f64::min);
        pick(&errors, &barred, used, |errors| tolerance.max(least(errors) * (1.0 + SLACK)), &mut rng)
    }

    /// Sum over the overlaps with placed neighbours of every candidate's mean error, in units, and how many overlaps those
    /// are.
    fn sums(&self, column: u32, row: u32, placed: &[u32]) -> (Vec<f64>, f64) {
        let (columns, rows) = (self.columns, self.rows);
        let here = row * columns + column;
        let neighbour = |dx: u32, dy: u32| (row + dy) % rows * columns + (column + dx) % columns;
        let known = |at: u32| placed.get(at as usize).map(|&c| c as usize);
        let mut sums = vec![0.0; self.candidates.len()];
        let mut overlaps = 0.0;
        let mut add = |error: &dyn Fn(usize) -> u32, unit: f64| {
            for (c, sum) in sums.iter_mut().enumerate() {
                *sum += f64::from(error(c)) / unit;
            }
            overlaps += 1.0;
        };
        let [along_rows, along_columns] = self.units;
        if let Some(left) = known(neighbour(columns - 1, 0)) {
            let errors = self.errors.all_beside(left);
            add(&|c| errors[c], along_rows);
        }
        if let Some(up) = known(neighbour(0, rows - 1)) {
            let errors = self.errors.all_below(up);
            add(&|c| errors[c], along_columns);
        }
        // The only patch of a row or column is its own neighbour.
        let (right, down) = (neighbour(1, 0), neighbour(0, 1));
        if known(right).is_some() || right == here {
            add(&|c| self.errors.beside(c, known(right).unwrap_or(c)), along_rows);
        }
        if known(down).is_some() || down == here {
            add(&|c| self.errors.below(c, known(down).unwrap_or(c)), along_columns);
        }
        (sums, overlaps)
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
        barred
    }
}
