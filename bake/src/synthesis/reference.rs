//! The synthesis by definition, in f64: every candidate against every neighbour texel by texel, every path of a cut, and
//! look-ups by pasting patches into an image. Slow, for tests on small samples; shares only input types and the random
//! numbers with the bake.

mod images;

pub use images::{Image, entries, pasted, pasted_tiles};

use super::choose::{CROWDING, Radii, SHORTLIST};
use super::options::SynthesisOptions;
use crate::normal_map::NormalMap;
use crate::rng::{ItemRng, Purpose};
use glint_formats::Wrap;

/// Sample texel (column, row).
pub type Texel = (u32, u32);

/// Eq. 7's vectors (√α n, √(1−α) J) of a sample, from their mean, as multiples of 1/2047 of the largest number in any.
pub struct ReferenceFeatures {
    width: i64,
    height: i64,
    vectors: Vec<[f64; 6]>,
}

impl ReferenceFeatures {
    /// Vectors of a sample; `rounded` to whole multiples, or exact.
    pub fn new(sample: &NormalMap, alpha: f64, rounded: bool) -> ReferenceFeatures {
        let (width, height) = (i64::from(sample.width), i64::from(sample.height));
        let normal = |i: i64, j: i64| {
            let (i, j) = match sample.wrap {
                Wrap::Repeat => ((i + width) % width, (j + height) % height),
                Wrap::Clamp => (i.max(0).min(width - 1), j.max(0).min(height - 1)),
            };
            let [x, y] = sample.projected[(j * width + i) as usize];
            [f64::from(x), f64::from(y)]
        };
        let mut vectors = Vec::new();
        for j in 0..height {
            for i in 0..width {
                let n = normal(i, j);
                let (left, right, up, down) = (normal(i - 1, j), normal(i + 1, j), normal(i, j - 1), normal(i, j + 1));
                let mut vector = [0.0; 6];
                for axis in 0..2 {
                    vector[axis] = n[axis] * alpha.sqrt();
                    vector[2 + axis] = (right[axis] - left[axis]) * (0.5 * (1.0 - alpha).sqrt());
                    vector[4 + axis] = (down[axis] - up[axis]) * (0.5 * (1.0 - alpha).sqrt());
                }
                vectors.push(vector);
            }
        }
        for k in 0..6 {
            let mean = vectors.iter().map(|v| v[k]).sum::<f64>() / vectors.len() as f64;
            vectors.iter_mut().for_each(|v| v[k] -= mean);
        }
        let largest = vectors.iter().flatten().fold(0.0f64, |most, v| most.max(v.abs()));
        for v in vectors.iter_mut().flatten() {
            let multiple = if largest > 0.0 { *v * (2047.0 / largest) } else { 0.0 };
            *v = if rounded { multiple.round() } else { multiple };
        }
        ReferenceFeatures { width, height, vectors }
    }

    /// Eq. 7 of two texels of the sample, any integers.
    pub fn distance(&self, a: (i64, i64), b: (i64, i64)) -> f64 {
        let at = |(x, y): (i64, i64)| (y.rem_euclid(self.height) * self.width + x.rem_euclid(self.width)) as usize;
        let (a, b) = (self.vectors[at(a)], self.vectors[at(b)]);
        (0..6).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
    }

    /// Mean distance of neighbours inside the sample, along rows and along columns, as the units of errors are defined.
    pub fn units(&self) -> [f64; 2] {
        let mean = |dx: i64, dy: i64| {
            let mut all = Vec::new();
            for y in 0..self.height - dy {
                for x in 0..self.width - dx {
                    all.push(self.distance((x, y), (x + dx, y + dy)));
                }
            }
            if all.is_empty() { 0.0 } else { all.iter().sum::<f64>() / all.len() as f64 }
        };
        let (rows, columns) = (mean(1, 0), mean(0, 1));
        let most = rows.max(columns);
        if most == 0.0 { [1.0, 1.0] } else { [rows.max(most * 0.01), columns.max(most * 0.01)] }
    }
}

/// Every aligned offset at which a patch lies in the sample, row by row.
pub fn offsets(sample: &NormalMap, options: &SynthesisOptions) -> Vec<[u16; 2]> {
    let mut all = Vec::new();
    for y in 0..sample.height {
        for x in 0..sample.width {
            let inside = sample.wrap == Wrap::Repeat
                || (x >= options.overlap
                    && y >= options.overlap
                    && x + options.patch <= sample.width
                    && y + options.patch <= sample.height);
            if inside && x.is_multiple_of(options.alignment) && y.is_multiple_of(options.alignment) {
                all.push([x as u16, y as u16]);
            }
        }
    }
    all
}

/// The offset of every patch of a grid, by trying all [`offsets`] for each in raster order.
pub fn choose(
    sample: &NormalMap,
    options: &SynthesisOptions,
    (columns, rows): (u32, u32),
    radii: Radii,
) -> Vec<[u16; 2]> {
    let features = ReferenceFeatures::new(sample, options.alpha, true);
    let units = features.units();
    let offsets = offsets(sample, options);
    let mut used = vec![0u32; offsets.len()];
    let mut placed: Vec<usize> = Vec::new();
    for at in 0..columns * rows {
        let (column, row) = (i64::from(at % columns), i64::from(at / columns));
        let average = f64::max(1.0, f64::from(at) / offsets.len() as f64);
        // The patch at a place of the torus: the candidate itself at its own, none where none is placed yet.
        let patch_at = |x: i64, y: i64, candidate: usize| {
            let place = y.rem_euclid(i64::from(rows)) * i64::from(columns) + x.rem_euclid(i64::from(columns));
            if place == i64::from(at) { Some(candidate) } else { placed.get(place as usize).copied() }
        };
        let (mut errors, mut cuts) = (Vec::new(), Vec::new());
        let mut overlaps = 0.0;
        for candidate in 0..offsets.len() {
            let (mut error, mut cut) = (0.0, 0.0);
            overlaps = 0.0;
            // Left, above, right, below.
            for (dx, dy) in [(-1, 0), (0, -1), (1, 0), (0, 1)] {
                let Some(other) = patch_at(column + dx, row + dy, candidate) else { continue };
                // A lone row or column meets itself on either side of one overlap.
                let own = (column + dx).rem_euclid(i64::from(columns)) == column
                    && (row + dy).rem_euclid(i64::from(rows)) == row;
                if own && dx + dy < 0 {
                    continue;
                }
                let (first, second) = if dx + dy < 0 { (other, candidate) } else { (candidate, other) };
                let below = dy != 0;
                let mean = overlap_mean(&features, options, offsets[first], offsets[second], below);
                error += mean / units[usize::from(below)];
                cut += cut_mean(&features, options, offsets[first], offsets[second], below) / units[usize::from(below)];
                overlaps += 1.0;
            }
            errors.push(error);
            cuts.push(cut * (1.0 + CROWDING * f64::from(used[candidate]) / average));
        }
        let goes_on = |first: usize, second: usize, axis: usize| {
            let size = [sample.width, sample.height];
            (0..2).all(|k| {
                let moved = u32::from(offsets[first][k]) + if k == axis { options.patch } else { 0 };
                let found = u32::from(offsets[second][k]);
                if sample.wrap == Wrap::Repeat { moved % size[k] == found } else { moved == found }
            })
        };
        // Patches in a row, the candidate's among them, each of which goes on where the one before ends.
        let run = |candidate: usize, axis: usize| {
            let [dx, dy] = [[1, 0], [0, 1]][axis];
            let ring = i64::from([columns, rows][axis]);
            let at = |k: i64| patch_at(column + dx * k, row + dy * k, candidate);
            let joined = |k: i64| matches!((at(k), at(k + 1)), (Some(a), Some(b)) if goes_on(a, b, axis));
            let after = (0..ring - 1).take_while(|&k| joined(k)).count();
            let before = (0..ring - 1).take_while(|&k| joined(-k - 1)).count();
            (1 + before + after) as u32
        };
        let longest = [sample.width, sample.height].map(|side| u32::max(side / options.patch, 2) - 1);
        let barred: Vec<bool> = (0..offsets.len())
            .map(|candidate| {
                (0..2).any(|axis| run(candidate, axis) > longest[axis])
                    || (0..placed.len()).any(|other| {
                        let around = |d: i64, n: u32| d.rem_euclid(i64::from(n)).min((-d).rem_euclid(i64::from(n)));
                        let dx = around(other as i64 % i64::from(columns) - column, columns);
                        let dy = around(other as i64 / i64::from(columns) - row, rows);
                        let apart = dx.max(dy);
                        let shared = shared(sample, options.patch, offsets[candidate], offsets[placed[other]]);
                        (apart <= i64::from(radii.alike) && shared > 0.5)
                            || (apart <= i64::from(radii.nearly_equal) && shared > 0.75)
                    })
            })
            .collect();
        let all_barred = barred.iter().all(|&b| b);
        let allowed: Vec<usize> = (0..offsets.len()).filter(|&c| all_barred || !barred[c]).collect();
        let rank = |c: usize| (errors[c], used[c], c);
        let better = |c: usize| allowed.iter().filter(|&&d| rank(d) < rank(c)).count();
        let listed: Vec<usize> = allowed.iter().copied().filter(|&c| better(c) < SHORTLIST).collect();
        let least = listed.iter().map(|&c| cuts[c]).fold(f64::INFINITY, f64::min);
        let limit = (options.error_tolerance * overlaps).max(least * 1.1);
        let good: Vec<usize> = listed.into_iter().filter(|&c| cuts[c] <= limit).collect();
        let fewest = good.iter().map(|&c| used[c]).min().expect("the best is among them");
        let equal: Vec<usize> = good.into_iter().filter(|&c| used[c] == fewest).collect();
        let draw = ItemRng::new(options.seed, Purpose::Patches, at).below(equal.len() as u32);
        used[equal[draw as usize]] += 1;
        placed.push(equal[draw as usize]);
    }
    placed.into_iter().map(|c| offsets[c]).collect()
}

/// Mean distance over the overlap of two patches, the second right of the first or below it, rounded down.
pub fn overlap_mean(
    features: &ReferenceFeatures,
    options: &SynthesisOptions,
    first: [u16; 2],
    second: [u16; 2],
    below: bool,
) -> f64 {
    let (patch, overlap) = (i64::from(options.patch), i64::from(options.overlap));
    let (mut sum, mut count) = (0.0, 0.0);
    for along in -overlap..patch {
        for across in -overlap..0 {
            let (a, b) = if below {
                ((along, across + patch), (along, across))
            } else {
                ((across + patch, along), (across, along))
            };
            let of = |offset: [u16; 2], (x, y): (i64, i64)| (i64::from(offset[0]) + x, i64::from(offset[1]) + y);
            sum += features.distance(of(first, a), of(second, b));
            count += 1.0;
        }
    }
    if count == 0.0 { 0.0 } else { f64::floor(sum / count) }
}

/// Mean distance along the best path through the overlap of two patches, the second right of the first or below it.
pub fn cut_mean(
    features: &ReferenceFeatures,
    options: &SynthesisOptions,
    first: [u16; 2],
    second: [u16; 2],
    below: bool,
) -> f64 {
    let (patch, overlap) = (i64::from(options.patch), i64::from(options.overlap));
    // Least sums of paths from the place (along, across) on, from the last row upwards.
    let mut rest = vec![0.0; overlap as usize];
    for along in (-overlap..patch).rev() {
        let texel = |across: i64| {
            let (a, b) = if below {
                ((along, across + patch), (along, across))
            } else {
                ((across + patch, along), (across, along))
            };
            let of = |offset: [u16; 2], (x, y): (i64, i64)| (i64::from(offset[0]) + x, i64::from(offset[1]) + y);
            features.distance(of(first, a), of(second, b))
        };
        let on = |k: i64| {
            let next = (k - 1).max(0)..=(k + 1).min(overlap - 1);
            texel(k - overlap) + next.map(|k| rest[k as usize]).fold(f64::INFINITY, f64::min)
        };
        rest = (0..overlap).map(on).collect();
    }
    let least = rest.into_iter().fold(f64::INFINITY, f64::min);
    if overlap == 0 { 0.0 } else { least / (patch + overlap) as f64 }
}

/// Share of a patch's texels that another shows too, moved the short way.
fn shared(sample: &NormalMap, patch: u32, a: [u16; 2], b: [u16; 2]) -> f64 {
    let apart = |a: u16, b: u16, side: u32| {
        let d = i64::from(a.abs_diff(b));
        if sample.wrap == Wrap::Repeat { d.min(i64::from(side) - d) } else { d }
    };
    let (dx, dy) = (apart(a[0], b[0], sample.width), apart(a[1], b[1], sample.height));
    let both = |d: i64| (0..i64::from(patch)).filter(|v| (d..d + i64::from(patch)).contains(v)).count() as f64;
    both(dx) * both(dy) / f64::from(patch).powi(2)
}

/// The least sum of a path through `cost` (rows of `overlap`), by trying every path.
pub fn least_path(cost: &[u32], overlap: usize) -> f64 {
    fn from(cost: &[u32], overlap: usize, row: usize, column: usize) -> f64 {
        let here = f64::from(cost[row * overlap + column]);
        if (row + 1) * overlap == cost.len() {
            return here;
        }
        let next = column.saturating_sub(1)..=(column + 1).min(overlap - 1);
        here + next.map(|c| from(cost, overlap, row + 1, c)).fold(f64::INFINITY, f64::min)
    }
    (0..overlap).map(|c| from(cost, overlap, 0, c)).fold(f64::INFINITY, f64::min)
}
