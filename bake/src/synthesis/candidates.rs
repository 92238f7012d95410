//! Offsets that a patch may have, which of them show the same part of the sample, and which go on where others end.

use super::options::SynthesisOptions;
use crate::normal_map::NormalMap;
use crate::rng::{ItemRng, Purpose};
use glint_formats::Wrap;
use std::collections::{BTreeMap, BTreeSet};

/// How much of a patch another shows too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(super) enum Likeness {
    /// Half of its texels at most.
    Different,
    /// More than half: near by, they would be seen as a repetition.
    Alike,
    /// More than three quarters.
    NearlyEqual,
}

/// The offsets among which patches are chosen.
pub(super) struct Candidates {
    /// Offsets in texels, row by row.
    pub(super) offsets: Vec<[u16; 2]>,
    likeness: Vec<Likeness>,
}

impl Candidates {
    /// All aligned offsets whose patch lies in the sample; where they are more than wanted, a seeded choice of them.
    /// There is one at least when the options fit the sample.
    pub(super) fn new(sample: &NormalMap, options: &SynthesisOptions) -> Candidates {
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
    pub(super) fn len(&self) -> usize {
        self.offsets.len()
    }

    /// How much of a candidate's patch every other shows.
    pub(super) fn likeness(&self, candidate: usize) -> &[Likeness] {
        &self.likeness[candidate * self.len()..][..self.len()]
    }

    /// Whether two patches share more than half of their texels.
    pub(super) fn alike(&self, a: usize, b: usize) -> bool {
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

/// Which candidate goes on where another ends, and how many in a row may. Of a sample that repeats, patches that show it on and
/// on fit without any seam, and would tile the surface with it. Tan et al. 2022 leave this open: their step 3 would choose such
/// a patch every time.
pub(super) struct Runs {
    /// The candidate right of each one in the sample, and the one below it.
    next: [Vec<Option<u32>>; 2],
    /// Likewise the one left of it, and the one above it.
    previous: [Vec<Option<u32>>; 2],
    /// Most patches in a row, along each axis.
    most: [u32; 2],
}

impl Runs {
    /// Runs of patches of this edge in a sample of this size. As many may follow each other as in a sample that does not
    /// repeat, one at least.
    pub(super) fn new(candidates: &Candidates, size: (u32, u32), wrap: Wrap, patch: u32) -> Runs {
        let index: BTreeMap<[u16; 2], u32> = candidates.offsets.iter().copied().zip(0..).collect();
        let moved = |&[x, y]: &[u16; 2], axis: usize| {
            let (mut x, mut y) = (u32::from(x), u32::from(y));
            if axis == 0 {
                x += patch
            } else {
                y += patch
            }
            if wrap == Wrap::Repeat {
                (x, y) = (x % size.0, y % size.1);
            }
            index.get(&[x as u16, y as u16]).copied()
        };
        let next = [0, 1].map(|axis| candidates.offsets.iter().map(|at| moved(at, axis)).collect::<Vec<_>>());
        let previous = [0, 1].map(|axis: usize| {
            let mut previous = vec![None; candidates.len()];
            for (first, second) in (0..).zip(&next[axis]) {
                if let Some(second) = second {
                    previous[*second as usize] = Some(first);
                }
            }
            previous
        });
        let most = [size.0, size.1].map(|side| (side / patch).saturating_sub(1).max(1));
        Runs { next, previous, most }
    }

    /// The candidates that would make a run too long at a place along `axis` (0 across, 1 down). `before(k)` is the patch k
    /// places before it, `after(k)` the one after it, k from 1 on; none where nothing is placed yet.
    pub(super) fn too_long(
        &self,
        axis: usize,
        before: impl Fn(u32) -> Option<u32>,
        after: impl Fn(u32) -> Option<u32>,
    ) -> impl Iterator<Item = usize> {
        let (next, previous) = (&self.next[axis], &self.previous[axis]);
        let (on, up_to) = (length(previous, &before, self.most[axis]), length(next, &after, self.most[axis]));
        let following = before(1).and_then(|patch| next[patch as usize]);
        let leading = after(1).and_then(|patch| previous[patch as usize]);
        let most = self.most[axis];
        [following, leading].into_iter().flatten().filter_map(move |candidate| {
            let joined = |end: Option<u32>, run: u32| if end == Some(candidate) { run } else { 0 };
            let run = 1 + joined(following, on) + joined(leading, up_to);
            (run > most).then_some(candidate as usize)
        })
    }
}

/// Patches in a row from the first on, each of which `step` leads to from the one before; `most` at most.
fn length(step: &[Option<u32>], patch: impl Fn(u32) -> Option<u32>, most: u32) -> u32 {
    let mut here = patch(1);
    let mut length = 0;
    while let Some(at) = here {
        length += 1;
        let there = patch(length + 1);
        here = there.filter(|_| length < most && there == step[at as usize]);
    }
    length
}
