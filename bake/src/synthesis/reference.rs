//! The synthesis by definition, in f64: every candidate against every neighbour texel by texel, every path of a cut, and
//! look-ups by pasting patches into an image. Slow, for tests on small samples; shares only input types and the random
//! numbers with the bake.

use super::baked::Synthesis;
use super::choose::{CROWDING, Radii, SHORTLIST};
use super::options::SynthesisOptions;
use crate::normal_map::NormalMap;
use crate::rng::{ItemRng, Purpose};
use glint_formats::Wrap;
use glint_formats::synthesis::{Layout, PathShape};

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

/// Entries of path number `path` of paths of one shape that begin at word `first`.
pub fn entries(surface: &Synthesis, first: usize, path: usize, shape: PathShape) -> Vec<u32> {
    let words = &surface.seams[first + path * shape.words as usize..][..shape.words as usize];
    let mut bits = Vec::new();
    for word in words {
        let used = shape.per_word * shape.bits;
        bits.extend((0..used).map(|bit| word >> bit & 1));
    }
    let entry = |k: usize| (0..shape.bits as usize).map(|b| bits[k * shape.bits as usize + b] << b).sum();
    if shape.bits == 0 { vec![0; shape.entries as usize] } else { (0..shape.entries as usize).map(entry).collect() }
}

/// An image of sample texels, with its first column and row.
pub struct Image {
    /// Surface column and row of the first texel.
    pub origin: (i64, i64),
    /// Columns.
    pub width: i64,
    /// Texels row by row; `None` where nothing was pasted.
    pub texels: Vec<Option<Texel>>,
}

impl Image {
    /// An empty image.
    pub fn new(origin: (i64, i64), width: i64, height: i64) -> Image {
        Image { origin, width, texels: vec![None; (width * height) as usize] }
    }

    /// What is pasted at a texel of the surface; `None` outside too.
    pub fn at(&self, x: i64, y: i64) -> Option<Texel> {
        self.texels.get(self.index(x, y)?).copied().flatten()
    }

    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let (x, y) = (x - self.origin.0, y - self.origin.1);
        ((0..self.width).contains(&x) && y >= 0).then(|| (y * self.width + x) as usize)
    }

    /// Pastes the texels (x, y) of a patch for which `shows` holds; its texel (0, 0) lies at `at` and shows `offset`.
    pub fn paste(
        &mut self,
        surface: &Synthesis,
        at: (i64, i64),
        offset: [u16; 2],
        range: std::ops::Range<i64>,
        shows: &dyn Fn(i64, i64) -> bool,
    ) {
        for y in range.clone() {
            for x in range.clone() {
                let index = self.index(at.0 + x, at.1 + y);
                let Some(texel) = index.and_then(|index| self.texels.get_mut(index)) else { continue };
                if shows(x, y) {
                    let column = (i64::from(offset[0]) + x).rem_euclid(i64::from(surface.params.sample_width));
                    let row = (i64::from(offset[1]) + y).rem_euclid(i64::from(surface.params.sample_height));
                    *texel = Some((column as u32, row as u32));
                }
            }
        }
    }
}

/// The surface of a grid of patches, by pasting them in raster order into an image of one period; called with the image
/// before each is pasted, its column and row, its left and its upper path.
///
/// # Panics
/// When the surface is no grid of patches.
pub fn pasted(surface: &Synthesis, mut before: impl FnMut(&Image, (u32, u32), [&[u32]; 2])) -> Image {
    let Layout::Patches { columns, rows, .. } = surface.params.layout else { panic!("expected a grid of patches") };
    let (patch, overlap) = (i64::from(surface.params.patch), i64::from(surface.params.overlap));
    let mut image = Image::new((0, 0), i64::from(columns) * patch, i64::from(rows) * patch);
    // One more row and column: the first ones again, whose overlaps lie on the last.
    for row in 0..=rows {
        for column in 0..=columns {
            let number = (row % rows * columns + column % columns) as usize;
            let [left, upper] = [0, 1].map(|k| entries(surface, 0, 2 * number + k, surface.params.patch_path()));
            before(&image, (column, row), [&left, &upper]);
            let at = (i64::from(column) * patch, i64::from(row) * patch);
            image.paste(surface, at, surface.offsets[number], -overlap..patch, &|x, y| {
                (x >= 0 || x + overlap >= i64::from(left[(y + overlap) as usize]))
                    && (y >= 0 || y + overlap >= i64::from(upper[(x + overlap) as usize]))
            });
        }
    }
    image
}

/// A window of `tiles`² corner tiles from the tile `first` on, by pasting: corner patches, then middle patches over them.
/// `corner` and `variant` are the hashes of the lattice. Texels away from the edges of tiles, which middle patches hide,
/// are pasted as well.
///
/// # Panics
/// When the surface has no corner tiles.
pub fn pasted_tiles(
    surface: &Synthesis,
    first: (i64, i64),
    tiles: i64,
    corner: impl Fn(i64, i64) -> u32,
    variant: impl Fn(i64, i64) -> u32,
) -> Image {
    let Layout::CornerTiles { colours, variants, margin, .. } = surface.params.layout else { panic!("expected tiles") };
    let params = &surface.params;
    let (edge, overlap, margin_texels) = (i64::from(params.patch), i64::from(params.overlap), i64::from(margin));
    let (half, reach) = (edge / 2, margin_texels + overlap);
    let mut image = Image::new((first.0 * edge, first.1 * edge), tiles * edge, tiles * edge);
    let shape = params.colour_path(margin);
    for j in first.1..=first.1 + tiles {
        for i in first.0..=first.0 + tiles {
            let pair = |other: u32, which: usize| {
                entries(surface, 0, (2 * (other * colours + corner(i, j)) + which as u32) as usize, shape)
            };
            let (left, upper) = (pair(corner(i - 1, j), 0), pair(corner(i, j - 1), 1));
            // A corner patch goes from half an edge before its corner; its cut is known around the corner only.
            let cut = |path: &[u32], along: i64| match along - half + reach {
                k if (0..2 * reach).contains(&k) => i64::from(path[k as usize]) - overlap,
                _ => 0,
            };
            let at = (i * edge - half, j * edge - half);
            image.paste(surface, at, surface.offsets[corner(i, j) as usize], -overlap..edge, &|x, y| {
                let (x_cut, y_cut) = (cut(&left, y.max(0)), cut(&upper, x.max(0)));
                (x >= 0 || (y >= 0 && x >= x_cut)) && (y >= 0 || (x >= 0 && y >= y_cut))
            });
        }
    }
    let pairs = (colours * colours * 2 * shape.words) as usize;
    let shape = params.middle_path(margin);
    for j in first.1..first.1 + tiles {
        for i in first.0..first.0 + tiles {
            let corners = [corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)];
            let number = corners.iter().rev().fold(0, |all, colour| all * colours + colour) * variants + variant(i, j);
            let sides: [Vec<u32>; 4] =
                std::array::from_fn(|side| entries(surface, pairs, 4 * number as usize + side, shape));
            let offset = surface.offsets[(colours + number) as usize];
            image.paste(surface, (i * edge, j * edge), offset, margin_texels..edge - margin_texels, &|x, y| {
                let (x, y) = (x - margin_texels, y - margin_texels);
                let last = edge - 2 * margin_texels - 1;
                [(x, y), (y, x), (last - x, y), (last - y, x)]
                    .iter()
                    .zip(&sides)
                    .all(|(&(depth, along), side)| depth >= i64::from(side[along as usize]))
            });
        }
    }
    image
}
