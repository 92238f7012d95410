//! Patches that show the sample on and on: of a sample that repeats they fit without any seam, and would tile the surface
//! with it.
//!
//! Tan et al. 2022 leave this open: their step 3 would choose such a patch every time.

use super::candidates::Candidates;
use glint_formats::Wrap;
use std::collections::BTreeMap;

/// Which candidate goes on where another ends, and how many in a row may.
pub struct Runs {
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
    pub fn new(candidates: &Candidates, size: (u32, u32), wrap: Wrap, patch: u32) -> Runs {
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
    pub fn too_long(
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
