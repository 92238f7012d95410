//! Errors of pairs of candidates side by side and one above the other: over whole overlaps, and along the best cut.
//!
//! Section 5.1.1, step 3 of Tan et al. 2022 compares a new patch with what lies under its overlap. Here it is compared
//! with its neighbours as they are in the sample, without the cuts through them, so that the error of a pair is known
//! once for all places ([`PairErrors`]). Where features are sparse, as scratches are, nearly all of an overlap is hidden by the
//! cut of step 4, and only features that the cut must cross will be seen to end there ([`CutErrors`]).

use super::features::{COUNT, Feature, Features, distance};
use super::options::SynthesisOptions;
use super::seams::least_sum;
use crate::progress::Progress;
use multiversion::multiversion;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Offsets whose errors a thread finds at a time: their strips stay in cache while the others pass by.
const BLOCK: usize = 8;

/// Mean Eq. 7 distance over the overlap, rounded down, of every ordered pair of candidates.
pub(super) struct PairErrors {
    candidates: usize,
    beside: Vec<u32>,
    below: Vec<u32>,
}

impl PairErrors {
    /// Errors of the candidates at `offsets`. All 0 without overlap.
    pub(super) fn new(
        features: &Features,
        offsets: &[[u16; 2]],
        options: &SynthesisOptions,
        progress: &dyn Progress,
    ) -> PairErrors {
        let (patch, overlap) = (options.patch as i32, options.overlap as i32);
        let long = -overlap..patch;
        let (near, far) = (-overlap..0, patch - overlap..patch);
        let beside = [(far.clone(), long.clone()), (near.clone(), long.clone())];
        let below = [(long.clone(), far), (long, near)];
        let texels = (overlap * (patch + overlap)) as usize;
        let errors = |[older, newer]: [(Span, Span); 2]| {
            errors(
                &strips(features, offsets, older),
                &strips(features, offsets, newer),
                offsets.len(),
                texels,
                progress,
            )
        };
        PairErrors { candidates: offsets.len(), beside: errors(beside), below: errors(below) }
    }

    /// Error where `right` lies right of `left`.
    pub(super) fn beside(&self, left: usize, right: usize) -> u32 {
        self.beside[left * self.candidates + right]
    }

    /// Error where `lower` lies below `upper`.
    pub(super) fn below(&self, upper: usize, lower: usize) -> u32 {
        self.below[upper * self.candidates + lower]
    }
}

type Span = std::ops::Range<i32>;

/// The same rectangle of each candidate, given from its offset on.
fn strips(features: &Features, offsets: &[[u16; 2]], (columns, rows): (Span, Span)) -> Vec<i16> {
    let one = |&[x, y]: &[u16; 2]| {
        let columns = columns.clone();
        let row = move |dy| columns.clone().flat_map(move |dx| features.at(i32::from(x) + dx, i32::from(y) + dy));
        rows.clone().flat_map(row)
    };
    offsets.iter().flat_map(one).collect()
}

fn errors(older: &[i16], newer: &[i16], candidates: usize, texels: usize, progress: &dyn Progress) -> Vec<u32> {
    let mut out = vec![0; candidates * candidates];
    if texels == 0 {
        return out;
    }
    let strip = texels * COUNT;
    out.par_chunks_mut(BLOCK * candidates).enumerate().for_each(|(block, rows)| {
        for (c, newer) in newer.chunks_exact(strip).enumerate() {
            for (k, row) in rows.chunks_exact_mut(candidates).enumerate() {
                let older = &older[(block * BLOCK + k) * strip..][..strip];
                row[c] = (sum_of_squares(older, newer) / texels as u64) as u32;
            }
        }
        progress.advance((rows.len() / candidates) as u64);
    });
    out
}

/// Σ (a − b)², for |a|, |b| ≤ 2047.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn sum_of_squares(a: &[i16], b: &[i16]) -> u64 {
    // Arrays of a fixed length and arithmetic without checks become a few wide instructions. 96 squares of 4094 at most
    // stay below 2^31.
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<96>(), b.as_chunks::<96>());
    let mut sum = 0;
    for (a, b) in a.iter().zip(b) {
        let mut part = 0i32;
        for k in 0..96 {
            let d = i32::from(a[k].wrapping_sub(b[k]));
            part = part.wrapping_add(d.wrapping_mul(d));
        }
        sum += part as u64;
    }
    let square = |(&a, &b): (&i16, &i16)| (i64::from(a) - i64::from(b)).pow(2) as u64;
    sum + a_rest.iter().zip(b_rest).map(square).sum::<u64>()
}

/// In place of the sum of a pair that nobody has asked for, or that is larger.
const UNKNOWN: u32 = u32::MAX;

/// Mean Eq. 7 distances along the cuts between candidates. Each is found when first asked for, since most never are.
pub(super) struct CutErrors<'a> {
    features: &'a Features,
    offsets: &'a [[u16; 2]],
    patch: i32,
    overlap: i32,
    /// Sums along the cut of each ordered pair side by side, then of each one above the other.
    sums: Vec<AtomicU32>,
}

impl<'a> CutErrors<'a> {
    /// Overlaps of the candidates at `offsets`.
    pub(super) fn new(features: &'a Features, offsets: &'a [[u16; 2]], options: &SynthesisOptions) -> CutErrors<'a> {
        let sums = (0..2 * offsets.len().pow(2)).map(|_| AtomicU32::new(UNKNOWN)).collect();
        CutErrors { features, offsets, patch: options.patch as i32, overlap: options.overlap as i32, sums }
    }

    /// Mean distance along the best cut where candidate `second` lies right of `first`, or `below` it; neighbours are taken
    /// as they are in the sample. 0 without overlap.
    pub(super) fn between(&self, first: usize, second: usize, below: bool) -> f64 {
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
