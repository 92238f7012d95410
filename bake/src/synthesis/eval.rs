//! Which texel of the sample a texel of the surface shows, from the stored bytes: integer twin of the WGSL of the same
//! names. A look-up reads one offset and at most six entries of paths; there are no loops.
//!
//! A block of the surface that shows one whole block of the sample may be answered by a cell of the sample's MIP:
//! [`Synthesis::source_block`] says when that is exact, [`Synthesis::nominal_block`] when it is but for seams.

use super::Synthesis;
use super::eval_tiles::{Tiles, tile_source};
use glint_formats::Wrap;
use glint_formats::synthesis::{Layout, PathShape};

/// Edge of the finest blocks, in texels: the cells of the finest clustered level.
pub const FINEST_BLOCK: i32 = 8;

/// A texel of the sample and the patch that shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Record of the patch's offset.
    pub patch: u32,
    /// Column in the sample.
    pub x: u32,
    /// Row in the sample.
    pub y: u32,
}

/// A patch and the surface texel that its texel (0, 0) would lie at, relative to the texel looked up.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub patch: u32,
    pub x: i32,
    pub y: i32,
}

impl Synthesis {
    /// The sample texel (column, row) that the surface shows at (x, y), which may be any integers: the surface goes on in
    /// all directions.
    pub fn source_texel(&self, x: i32, y: i32) -> (u32, u32) {
        let source = self.source(x, y);
        (source.x, source.y)
    }

    /// The same with the patch it comes from.
    pub fn source(&self, x: i32, y: i32) -> Source {
        let place = self.place(x, y);
        let (x, y) = self.in_sample(place);
        Source { patch: place.patch, x, y }
    }

    /// The block of the sample that the block (bx, by) of 8 · 2^log2_size texels a side shows as one whole, as its first
    /// texel; that is a multiple of the block's edge along both axes. `None` where a seam may cross the block, or where
    /// the patch is not aligned to such blocks, or is smaller.
    ///
    /// A bilinear look-up in the block reaches half a texel beyond it, where the neighbour's texels begin.
    pub fn source_block(&self, bx: i32, by: i32, log2_size: u32) -> Option<(u32, u32)> {
        let size = FINEST_BLOCK << log2_size.min(16);
        self.block_source(bx.wrapping_mul(size), by.wrapping_mul(size), size, size as u32)
    }

    /// The block of `size` texels at the surface texel (x, y), as [`Synthesis::source_block`], where the sample's cells of
    /// that size begin at all multiples of `step`; those of a sample that repeats in whole steps go on across its edge.
    pub fn block_source(&self, x: i32, y: i32, size: i32, step: u32) -> Option<(u32, u32)> {
        let (low, high) = self.untouched();
        let edge = self.params.patch as i32;
        let inside = |v: i32| v.rem_euclid(edge) >= low && v.rem_euclid(edge) + size <= high;
        if !inside(x) || !inside(y) { None } else { self.aligned(self.place(x, y), size, step) }
    }

    /// The block of the sample that most of the block of `size` texels at the surface texel (x, y) shows: that of the
    /// patch at its middle, as if the patch had no seams. `None` where the block is larger than a patch, or its source
    /// does not begin at a multiple of `step`, or leaves the sample.
    pub fn nominal_block(&self, x: i32, y: i32, size: i32, step: u32) -> Option<(u32, u32)> {
        let edge = self.params.patch as i32;
        if x.rem_euclid(edge) + size > edge || y.rem_euclid(edge) + size > edge {
            return None;
        }
        let half = size / 2;
        let place = self.place(x + half, y + half);
        self.aligned(Place { x: place.x - half, y: place.y - half, ..place }, size, step)
    }

    /// The sample texel at which a block of `size` texels at the surface texel (x, y) would begin if the patch at its middle
    /// showed all of it.
    pub fn nominal_texel(&self, x: i32, y: i32, size: i32) -> (u32, u32) {
        let half = size / 2;
        let place = self.place(x.wrapping_add(half), y.wrapping_add(half));
        self.in_sample(Place { x: place.x - half, y: place.y - half, ..place })
    }

    fn aligned(&self, place: Place, size: i32, step: u32) -> Option<(u32, u32)> {
        let (x, y) = self.in_sample(place);
        let crosses = |side: u32| self.params.wrap == Wrap::Repeat && side.is_multiple_of(step);
        let fits = |v: u32, side: u32| v.is_multiple_of(step) && (v as i32 + size <= side as i32 || crosses(side));
        (fits(x, self.params.sample_width) && fits(y, self.params.sample_height)).then_some((x, y))
    }

    /// First and last texel, along both axes of a patch or tile, that no neighbour can claim.
    fn untouched(&self) -> (i32, i32) {
        let (patch, overlap) = (self.params.patch as i32, self.params.overlap as i32);
        match self.params.layout {
            Layout::Patches { .. } => (0, patch - overlap),
            Layout::CornerTiles { margin, .. } => {
                let border = margin as i32 + overlap;
                (border, patch - border)
            }
        }
    }

    fn in_sample(&self, place: Place) -> (u32, u32) {
        let [ox, oy] = self.offsets[place.patch as usize];
        let wrapped = |offset: u16, v: i32, side: u32| (i32::from(offset) + v).rem_euclid(side as i32) as u32;
        (wrapped(ox, place.x, self.params.sample_width), wrapped(oy, place.y, self.params.sample_height))
    }

    fn place(&self, x: i32, y: i32) -> Place {
        match self.params.layout {
            Layout::Patches { columns, rows, .. } => self.grid_place(x, y, columns as i32, rows as i32),
            Layout::CornerTiles { colours, variants, margin, hash_seed } => {
                tile_source(self, Tiles { colours, variants, margin: margin as i32, hash_seed }, x, y)
            }
        }
    }

    /// The patch that shows a texel of the grid. Its block's own patch does, unless a neighbour right or below claims it;
    /// of several the last in raster order.
    fn grid_place(&self, x: i32, y: i32, columns: i32, rows: i32) -> Place {
        let (patch, overlap) = (self.params.patch as i32, self.params.overlap as i32);
        let (bx, by) = (x.div_euclid(patch).rem_euclid(columns), y.div_euclid(patch).rem_euclid(rows));
        let (lx, ly) = (x.rem_euclid(patch), y.rem_euclid(patch));
        let (right, below) = ((bx + 1) % columns, (by + 1) % rows);
        let (near_right, near_below) = (lx >= patch - overlap, ly >= patch - overlap);
        let diagonal = (below * columns + right) as u32;
        if near_right
            && near_below
            && lx - patch >= self.cut(diagonal, 0, ly - patch)
            && ly - patch >= self.cut(diagonal, 1, lx - patch)
        {
            return Place { patch: diagonal, x: lx - patch, y: ly - patch };
        }
        let lower = (below * columns + bx) as u32;
        if near_below && ly - patch >= self.cut(lower, 1, lx) {
            return Place { patch: lower, x: lx, y: ly - patch };
        }
        let beside = (by * columns + right) as u32;
        if near_right && lx - patch >= self.cut(beside, 0, ly) {
            return Place { patch: beside, x: lx - patch, y: ly };
        }
        Place { patch: (by * columns + bx) as u32, x: lx, y: ly }
    }

    /// Where the left (`which` 0) or upper (1) cut of a patch lies at its row (column) `along`: its first own texel.
    fn cut(&self, patch: u32, which: u32, along: i32) -> i32 {
        let shape = self.params.patch_path();
        let overlap = self.params.overlap as i32;
        self.path_entry((2 * patch + which) * shape.words, shape, (along + overlap) as u32) as i32 - overlap
    }

    /// Entry `k` of the path that begins at word `first`.
    pub(super) fn path_entry(&self, first: u32, shape: PathShape, k: u32) -> u32 {
        if shape.bits == 0 {
            return 0;
        }
        let word = self.seams[(first + k / shape.per_word) as usize];
        word >> (k % shape.per_word * shape.bits) & ((1 << shape.bits) - 1)
    }
}
