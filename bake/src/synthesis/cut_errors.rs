//! What the best seam between two patches cuts through: the mean Eq. 7 distance along it.
//!
//! Tan et al. 2022, section 5.1.1, step 3, compares all of an overlap. Where features are sparse, as scratches are, nearly
//! all of that is hidden by the cut of step 4, and only features that the cut must cross will be seen to end there.

use super::features::{Feature, Features, distance};
use super::options::SynthesisOptions;
use super::seams::least_sum;
use std::sync::atomic::{AtomicU32, Ordering};

/// In place of the sum of a pair that nobody has asked for, or that is larger.
const UNKNOWN: u32 = u32::MAX;

/// Errors along the cuts between candidates. Each is found when first asked for, since most never are.
pub struct CutErrors<'a> {
    features: &'a Features,
    offsets: &'a [[u16; 2]],
    patch: i32,
    overlap: i32,
    /// Sums along the cut of each ordered pair side by side, then of each one above the other.
    sums: Vec<AtomicU32>,
}

impl<'a> CutErrors<'a> {
    /// Overlaps of the candidates at `offsets`.
    pub fn new(features: &'a Features, offsets: &'a [[u16; 2]], options: &SynthesisOptions) -> CutErrors<'a> {
        let sums = (0..2 * offsets.len().pow(2)).map(|_| AtomicU32::new(UNKNOWN)).collect();
        CutErrors { features, offsets, patch: options.patch as i32, overlap: options.overlap as i32, sums }
    }

    /// Mean distance along the best cut where candidate `second` lies right of `first`, or `below` it; neighbours are taken
    /// as they are in the sample. 0 without overlap.
    pub fn between(&self, first: usize, second: usize, below: bool) -> f64 {
        let count = self.offsets.len();
        let known = &self.sums[(usize::from(below) * count + first) * count + second];
        let sum = match known.load(Ordering::Relaxed) {
            UNKNOWN => {
                let sum = least_sum(&self.cost(first, second, below), self.overlap as usize);
                known.store(u32::try_from(sum).unwrap_or(UNKNOWN), Ordering::Relaxed);
                sum
            }
            sum => u64::from(sum),
        };
        sum as f64 / f64::from(self.patch + self.overlap)
    }

    /// Distances of texels across the overlap, row by row along the cut.
    fn cost(&self, first: usize, second: usize, below: bool) -> Vec<u32> {
        let (patch, overlap) = (self.patch, self.overlap);
        let length = patch + overlap;
        let mut cost = vec![0; (overlap * length) as usize];
        // Rows of the sample, whichever way the cut runs: it goes along them where one patch lies below the other.
        let (rows, columns) = if below { (overlap, length) } else { (length, overlap) };
        let moved = if below { (0, patch) } else { (patch, 0) };
        let (mut old, mut new) =
            (vec![Feature::default(); columns as usize], vec![Feature::default(); columns as usize]);
        let row_of = |candidate: usize, (x, y): (i32, i32), row: &mut [Feature]| {
            let [left, upper] = self.offsets[candidate].map(i32::from);
            self.features.copy_row(left + x, upper + y, row);
        };
        for row in 0..rows {
            row_of(first, (moved.0 - overlap, moved.1 + row - overlap), &mut old);
            row_of(second, (-overlap, row - overlap), &mut new);
            for (column, (&a, &b)) in old.iter().zip(&new).enumerate() {
                let at = if below { column as i32 * overlap + row } else { row * overlap + column as i32 };
                cost[at as usize] = distance(a, b);
            }
        }
        cost
    }
}
