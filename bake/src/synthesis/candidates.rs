//! Offsets that a patch may have, and which of them show the same part of the sample.

use super::options::SynthesisOptions;
use crate::normal_map::NormalMap;
use crate::rng::ItemRng;
use glint_formats::ndf_maps::Wrap;

/// Purpose of the random numbers that thin out candidates.
const PURPOSE: u32 = 50;

/// The offsets among which patches are chosen.
pub struct Candidates {
    /// Offsets in texels, row by row.
    pub offsets: Vec<[u16; 2]>,
    sides: [i32; 2],
    wrap: Wrap,
    patch: i32,
}

impl Candidates {
    /// All aligned offsets whose patch lies in the sample; where they are more than wanted, a seeded choice of them.
    /// There is one at least when the options fit the sample.
    pub fn new(sample: &NormalMap, options: &SynthesisOptions) -> Candidates {
        let axis = |side: u32| -> Vec<u16> {
            let (first, last) = match sample.wrap {
                Wrap::Repeat => (0, side - 1),
                Wrap::Clamp => (options.first_offset(), side - options.patch),
            };
            (first..=last).step_by(options.alignment as usize).map(|offset| offset as u16).collect()
        };
        let (columns, rows) = (axis(sample.width), axis(sample.height));
        let mut picked: Vec<u32> = (0..columns.len() as u32 * rows.len() as u32).collect();
        if picked.len() > options.max_candidates as usize {
            picked = ItemRng::new(options.seed, PURPOSE, 0).permutation(picked.len() as u32);
            picked.truncate(options.max_candidates as usize);
            picked.sort_unstable();
        }
        let offset = |at: u32| [columns[at as usize % columns.len()], rows[at as usize / columns.len()]];
        Candidates {
            offsets: picked.into_iter().map(offset).collect(),
            sides: [sample.width as i32, sample.height as i32],
            wrap: sample.wrap,
            patch: options.patch as i32,
        }
    }

    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.offsets.len()
    }

    /// Texels along x and y between two offsets, the short way round where the sample repeats.
    fn apart(&self, a: usize, b: usize) -> [i32; 2] {
        std::array::from_fn(|axis| {
            let d = (i32::from(self.offsets[a][axis]) - i32::from(self.offsets[b][axis])).abs();
            if self.wrap == Wrap::Repeat { d.min(self.sides[axis] - d) } else { d }
        })
    }

    /// Whether two patches share more than half of their texels: side by side they would be seen as a repetition.
    pub fn alike(&self, a: usize, b: usize) -> bool {
        self.shared(a, b) * 2 > self.patch * self.patch
    }

    /// Whether two patches share more than three quarters of their texels.
    pub fn nearly_equal(&self, a: usize, b: usize) -> bool {
        self.shared(a, b) * 4 > 3 * self.patch * self.patch
    }

    fn shared(&self, a: usize, b: usize) -> i32 {
        let [x, y] = self.apart(a, b);
        (self.patch - x).max(0) * (self.patch - y).max(0)
    }
}
