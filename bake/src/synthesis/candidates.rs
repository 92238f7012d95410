//! Offsets that a patch may have, and which of them show the same part of the sample.

use super::options::SynthesisOptions;
use crate::normal_map::NormalMap;
use crate::rng::{ItemRng, Purpose};
use glint_formats::Wrap;
use std::collections::BTreeSet;

/// How much of a patch another shows too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Likeness {
    /// Half of its texels at most.
    Different,
    /// More than half: near by, they would be seen as a repetition.
    Alike,
    /// More than three quarters.
    NearlyEqual,
}

/// The offsets among which patches are chosen.
pub struct Candidates {
    /// Offsets in texels, row by row.
    pub offsets: Vec<[u16; 2]>,
    likeness: Vec<Likeness>,
}

impl Candidates {
    /// All aligned offsets whose patch lies in the sample; where they are more than wanted, a seeded choice of them.
    /// There is one at least when the options fit the sample.
    pub fn new(sample: &NormalMap, options: &SynthesisOptions) -> Candidates {
        let axis = |side: u32| -> Vec<u16> {
            let (first, last) = options.offset_range(side, sample.wrap);
            (first..=last).step_by(options.alignment as usize).map(|offset| offset as u16).collect()
        };
        let (columns, rows) = (axis(sample.width), axis(sample.height));
        let all = columns.len() as u32 * rows.len() as u32;
        let wanted = options.max_candidates;
        let mut rng = ItemRng::new(options.seed, Purpose::Candidates, 0);
        let mut picked: Vec<u32> = if all <= wanted {
            (0..all).collect()
        } else if all / 4 <= wanted {
            rng.permutation(all)[..wanted as usize].to_vec()
        } else {
            // Few of many: drawing anew what was drawn before takes less than an order of them all.
            let mut drawn = BTreeSet::new();
            while drawn.len() < wanted as usize {
                drawn.insert(rng.below(all));
            }
            drawn.into_iter().collect()
        };
        picked.sort_unstable();
        let offset = |at: u32| [columns[at as usize % columns.len()], rows[at as usize / columns.len()]];
        let offsets: Vec<[u16; 2]> = picked.into_iter().map(offset).collect();
        let likeness =
            offsets.iter().flat_map(|&a| offsets.iter().map(move |&b| likeness(sample, options.patch, a, b)));
        Candidates { likeness: likeness.collect(), offsets }
    }

    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.offsets.len()
    }

    /// Whether there are none, which options that fit the sample rule out.
    pub fn is_empty(&self) -> bool {
        self.offsets.is_empty()
    }

    /// How much of a candidate's patch every other shows.
    pub fn likeness(&self, candidate: usize) -> &[Likeness] {
        &self.likeness[candidate * self.len()..][..self.len()]
    }

    /// Whether two patches share more than half of their texels.
    pub fn alike(&self, a: usize, b: usize) -> bool {
        self.likeness(a)[b] >= Likeness::Alike
    }
}

/// How much two patches share, moved the short way round where the sample repeats.
fn likeness(sample: &NormalMap, patch: u32, a: [u16; 2], b: [u16; 2]) -> Likeness {
    let sides = [sample.width, sample.height];
    let shared: u32 = (0..2)
        .map(|axis| {
            let d = u32::from(a[axis].abs_diff(b[axis]));
            patch.saturating_sub(if sample.wrap == Wrap::Repeat { d.min(sides[axis] - d) } else { d })
        })
        .product();
    match shared {
        _ if shared * 4 > 3 * patch * patch => Likeness::NearlyEqual,
        _ if shared * 2 > patch * patch => Likeness::Alike,
        _ => Likeness::Different,
    }
}
