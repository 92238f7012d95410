//! The minimum-error boundary cut (Tan et al. 2022, section 5.1.1, step 4; Efros and Freeman 2001), and its bits.

use glint_formats::synthesis::PathShape;

/// The path through `cost` (rows of `overlap` entries) with the least sum, whose entries differ by 1 at most from one row
/// to the next. Entry r is the column of row r that the path goes through. Of equal paths the one that is leftmost at the
/// last row, then at the row before, and so on. Empty where there is nothing to choose.
pub fn cut(cost: &[u32], overlap: usize) -> Vec<u32> {
    if overlap == 0 {
        return Vec::new();
    }
    let rows = cost.len() / overlap;
    let mut best = vec![0u64; cost.len()];
    for r in 0..rows {
        for c in 0..overlap {
            let before = if r == 0 { 0 } else { best[(r - 1) * overlap + least(&best, r - 1, c, overlap)] };
            best[r * overlap + c] = before + u64::from(cost[r * overlap + c]);
        }
    }
    let mut path = vec![0u32; rows];
    let mut at = 0;
    for r in (0..rows).rev() {
        at = if r + 1 == rows { leftmost(&best, r, 0..overlap, overlap) } else { least(&best, r, at, overlap) };
        path[r] = at as u32;
    }
    path
}

/// The sum of the path that [`cut`] finds; 0 where there is nothing to choose.
pub fn least_sum(cost: &[u32], overlap: usize) -> u64 {
    if overlap == 0 {
        return 0;
    }
    // One entry on either side that no path goes through.
    const NONE: u64 = u64::MAX / 2;
    let mut best = vec![0u64; overlap + 2];
    let mut next = vec![NONE; overlap + 2];
    (best[0], best[overlap + 1]) = (NONE, NONE);
    for row in cost.chunks_exact(overlap) {
        for ((sum, before), &here) in next[1..=overlap].iter_mut().zip(best.windows(3)).zip(row) {
            *sum = before[0].min(before[1]).min(before[2]) + u64::from(here);
        }
        std::mem::swap(&mut best, &mut next);
    }
    best.into_iter().min().unwrap_or(0)
}

/// The column of row `r`, beside `c` or at it, where sums are least.
fn least(best: &[u64], r: usize, c: usize, overlap: usize) -> usize {
    leftmost(best, r, c.saturating_sub(1)..(c + 2).min(overlap), overlap)
}

fn leftmost(best: &[u64], r: usize, columns: std::ops::Range<usize>, overlap: usize) -> usize {
    let mut at = columns.start;
    for c in columns {
        if best[r * overlap + c] < best[r * overlap + at] {
            at = c;
        }
    }
    at
}

/// Appends a path to the words of a seam section.
pub fn push_path(path: &[u32], shape: PathShape, words: &mut Vec<u32>) {
    for entries in path.chunks(shape.per_word.max(1) as usize).take(shape.words as usize) {
        let word = entries.iter().enumerate().map(|(k, entry)| entry << (k as u32 * shape.bits)).sum();
        words.push(word);
    }
}
