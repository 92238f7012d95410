//! Errors of every pair of candidates side by side and one above the other.
//!
//! Section 5.1.1, step 3 of Tan et al. 2022 compares a new patch with what lies under its overlap. Here it is compared
//! with its neighbours as they are in the sample, without the cuts through them, so that the error of a pair is known
//! once for all places.

use super::features::{COUNT, Features};
use super::options::SynthesisOptions;
use crate::progress::Progress;
use multiversion::multiversion;
use rayon::prelude::*;

/// Offsets whose errors a thread finds at a time: their strips stay in cache while the others pass by.
const BLOCK: usize = 8;

/// Mean Eq. 7 distance over the overlap, rounded down, of every ordered pair of candidates.
pub struct PairErrors {
    candidates: usize,
    beside: Vec<u32>,
    below: Vec<u32>,
}

impl PairErrors {
    /// Errors of the candidates at `offsets`. All 0 without overlap.
    pub fn new(
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
    pub fn beside(&self, left: usize, right: usize) -> u32 {
        self.beside[left * self.candidates + right]
    }

    /// Error where `lower` lies below `upper`.
    pub fn below(&self, upper: usize, lower: usize) -> u32 {
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
pub fn sum_of_squares(a: &[i16], b: &[i16]) -> u64 {
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
