//! From a sample to a surface of patches: offsets, then seams (Tan et al. 2022, section 5.1.1, steps 2 to 6).
//!
//! A patch covers its block of a grid and `overlap` texels left of it and above it, so that blocks keep their place and
//! most of a patch is whole cells of the sample. Its left and its upper cut run through the corner too; there a texel is
//! the new patch's when both give it to the patch.

use super::baked::Synthesis;
use super::candidates::{Candidates, Runs};
use super::choose::{Choice, Radii};
use super::corner_tiles::corner_tiles;
use super::features::{Feature, Features, distance};
use super::options::{SynthesisOptions, Target};
use super::pair_errors::{CutErrors, PairErrors};
use super::quality::measure;
use super::seams::{cut, push_path};
use crate::error::Result;
use crate::normal_map::NormalMap;
use crate::progress::Progress;
use glint_formats::synthesis::Layout;

/// Synthesises the surface that `options` asks for from a sample.
///
/// # Errors
/// `BadOption` for options without a meaning, `BadInput` for a sample too small for a patch, `LimitExceeded` for a
/// surface or tables too large.
pub fn bake(sample: &NormalMap, options: &SynthesisOptions, progress: &dyn Progress) -> Result<Synthesis> {
    options.validate_for(sample)?;
    let features = Features::new(sample, options.alpha);
    let candidates = Candidates::new(sample, options);
    let mut synthesis = match options.target {
        Target::Patches { width, height } => quilt(&features, &candidates, options, (width, height), progress),
        Target::Unbounded { colours, variants } => {
            corner_tiles(&features, &candidates, options, (colours, variants), progress)
        }
    };
    synthesis.params.measured = measure(&synthesis, sample);
    Ok(synthesis)
}

fn quilt(
    features: &Features,
    candidates: &Candidates,
    options: &SynthesisOptions,
    (width, height): (u32, u32),
    progress: &dyn Progress,
) -> Synthesis {
    let (columns, rows) = (width.div_ceil(options.patch), height.div_ceil(options.patch));
    progress.begin("patch errors", 2 * candidates.len() as u64);
    let errors = PairErrors::new(features, &candidates.offsets, options, progress);
    progress.end();
    progress.begin("patches", 2 * u64::from(columns) * u64::from(rows));
    let (sample_width, sample_height) = features.size();
    let choice = Choice {
        candidates,
        errors: &errors,
        cuts: CutErrors::new(features, &candidates.offsets, options),
        columns,
        rows,
        units: features.neighbour_distance(),
        tolerance: options.error_tolerance,
        radii: Radii::of(u64::from(sample_width) * u64::from(sample_height), options.patch),
        runs: Runs::new(candidates, features.size(), features.wrap(), options.patch),
        seed: options.seed,
    };
    let placed = choice.run(progress);
    let offsets: Vec<[u16; 2]> = placed.iter().map(|&c| candidates.offsets[c as usize]).collect();
    let layout = Layout::Patches { width, height, columns, rows };
    let params = options.params(features.size(), features.wrap(), layout);
    let grid =
        Grid { features, offsets: &offsets, columns, rows, patch: params.patch as i32, overlap: options.overlap };
    let shape = params.patch_path();
    let mut paths: Vec<[Vec<u32>; 2]> = Vec::with_capacity(offsets.len());
    let mut seams = Vec::with_capacity(params.seam_words() as usize);
    for at in 0..columns * rows {
        let cuts = grid.cuts(at, &paths);
        for path in &cuts {
            push_path(path, shape, &mut seams);
        }
        paths.push(cuts);
        progress.advance(1);
    }
    progress.end();
    Synthesis::new(params, offsets, seams)
}

/// Patches that have their place, and those among them whose cuts are known.
struct Grid<'a> {
    features: &'a Features,
    offsets: &'a [[u16; 2]],
    columns: u32,
    rows: u32,
    patch: i32,
    overlap: u32,
}

impl Grid<'_> {
    /// The patch `dx`, `dy` away on the torus.
    fn neighbour(&self, at: u32, dx: u32, dy: u32) -> u32 {
        let (column, row) = (at % self.columns, at / self.columns);
        (row + dy) % self.rows * self.columns + (column + dx) % self.columns
    }

    /// The left and the upper cut of patch `at`. Entry r is of row (column) r − overlap of the patch. Patches whose cuts
    /// are not known yet, as those across the edge of the first row and column, end with their blocks.
    fn cuts(&self, at: u32, known: &[[Vec<u32>; 2]]) -> [Vec<u32>; 2] {
        let overlap = self.overlap as i32;
        let rows = -overlap..self.patch;
        let cost = |x: i32, y: i32| {
            let new = self.texel(at, x, y);
            distance(self.under(at, x, y, known), new)
        };
        let left: Vec<u32> =
            rows.clone().flat_map(|y| (-overlap..0).map(move |x| (x, y))).map(|(x, y)| cost(x, y)).collect();
        let upper: Vec<u32> = rows.flat_map(|x| (-overlap..0).map(move |y| (x, y))).map(|(x, y)| cost(x, y)).collect();
        [cut(&left, self.overlap as usize), cut(&upper, self.overlap as usize)]
    }

    fn texel(&self, patch: u32, x: i32, y: i32) -> Feature {
        let [ox, oy] = self.offsets[patch as usize];
        self.features.at(i32::from(ox) + x, i32::from(oy) + y)
    }

    /// What lies under the overlap of patch `at` before it is placed, at its texel (x, y).
    fn under(&self, at: u32, x: i32, y: i32, known: &[[Vec<u32>; 2]]) -> Feature {
        let (columns, rows, patch, overlap) = (self.columns, self.rows, self.patch, self.overlap as i32);
        let cut = |patch: u32, which: usize, along: i32| {
            known.get(patch as usize).map(|cuts| cuts[which][(along + overlap) as usize] as i32 - overlap)
        };
        let left = self.neighbour(at, columns - 1, 0);
        let up = self.neighbour(at, 0, rows - 1);
        if y >= 0 {
            return self.texel(left, x + patch, y);
        }
        // Beside a corner: of the patch above and its right neighbour, which covers the last texels of its block.
        if x >= 0 {
            let up_right = self.neighbour(at, 1, rows - 1);
            return match cut(up_right, 0, y + patch) {
                Some(from) if x - patch >= from => self.texel(up_right, x - patch, y + patch),
                _ => self.texel(up, x, y + patch),
            };
        }
        // The corner: the block of the patch above left, under the patch above, under the left one.
        match (cut(left, 1, x + patch), cut(up, 0, y + patch)) {
            (Some(from), _) if y >= from => self.texel(left, x + patch, y),
            (_, Some(from)) if x >= from => self.texel(up, x, y + patch),
            _ => self.texel(self.neighbour(at, columns - 1, rows - 1), x + patch, y + patch),
        }
    }
}
