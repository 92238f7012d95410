//! Which texel of the sample a texel of the surface shows, from the stored bytes: integer twin of `eval.wgsl`. Tan et al. 2022,
//! section 5.1.1; corner tiles for surfaces without end. A look-up reads one offset and at most six entries of paths.
//!
//! A block of the surface that shows one whole block of the sample may be answered by a cell of the sample's MIP:
//! [`Synthesis::block_source`] says when that is exact, [`Synthesis::nominal_block`] when it is but for seams.

use super::baked::Synthesis;
use super::paths::{Place, floor_div};
use super::{grid, tiles};
use glint_formats::synthesis::CORNER_TILES;

impl Synthesis {
    /// The patch that shows a texel of the surface, which goes on in all directions: (x, y) may be any integers.
    pub fn place(&self, x: i32, y: i32) -> Place {
        if self.uniform.arrangement == CORNER_TILES { tiles::place(self, x, y) } else { grid::place(self, x, y) }
    }

    fn in_sample(&self, place: Place) -> (u32, u32) {
        let offset = self.offsets[place.patch_index as usize].map(i32::from);
        (
            floor_div(offset[0] + place.x, self.uniform.sample_width as i32).1 as u32,
            floor_div(offset[1] + place.y, self.uniform.sample_height as i32).1 as u32,
        )
    }

    /// The sample texel (column, row) that the surface shows at (x, y), which may be any integers.
    pub fn source_texel(&self, x: i32, y: i32) -> (u32, u32) {
        self.in_sample(self.place(x, y))
    }

    /// Whether a block of `size` texels from `v` on, along an axis of `side` texels, is one of the sample's cells.
    fn fits(&self, v: u32, side: u32, size: i32, step: u32) -> bool {
        let crosses = self.uniform.wrap == 0 && side.is_multiple_of(step);
        v.is_multiple_of(step) && (v as i32 + size <= side as i32 || crosses)
    }

    fn aligned(&self, place: Place, size: i32, step: u32) -> Option<(u32, u32)> {
        let (x, y) = self.in_sample(place);
        let fits =
            self.fits(x, self.uniform.sample_width, size, step) && self.fits(y, self.uniform.sample_height, size, step);
        fits.then_some((x, y))
    }

    /// The block of `size` texels of the sample that the one at the surface texel (x, y) shows as a whole, as its first texel,
    /// where the sample's cells of that size begin at all multiples of `step`; those of a sample that repeats in whole steps go
    /// on across its edge. `None` where a seam may cross the block, or where its source is no such cell.
    ///
    /// A bilinear look-up in the block reaches half a texel beyond it, where the neighbour's texels begin.
    pub fn block_source(&self, x: i32, y: i32, size: i32, step: u32) -> Option<(u32, u32)> {
        let edge = self.uniform.patch_texels as i32;
        let mut low = 0;
        let mut high = edge - self.uniform.overlap as i32;
        if self.uniform.arrangement == CORNER_TILES {
            low = (self.uniform.margin + self.uniform.overlap) as i32;
            high = edge - low;
        }
        let lx = floor_div(x, edge).1;
        let ly = floor_div(y, edge).1;
        if lx < low || ly < low || lx + size > high || ly + size > high {
            return None;
        }
        self.aligned(self.place(x, y), size, step)
    }

    /// The sample texel at which a block of `size` texels at the surface texel (x, y) would begin if the patch at its middle
    /// showed all of it.
    pub fn nominal_texel(&self, x: i32, y: i32, size: i32) -> (u32, u32) {
        let half = size / 2;
        let middle = self.place(x.wrapping_add(half), y.wrapping_add(half));
        self.in_sample(Place { x: middle.x - half, y: middle.y - half, ..middle })
    }

    /// The block of the sample that most of the block of `size` texels at the surface texel (x, y) shows: that of the
    /// patch at its middle, as if the patch had no seams. `None` where the block is larger than a patch, or its source
    /// does not begin at a multiple of `step`, or leaves the sample.
    pub fn nominal_block(&self, x: i32, y: i32, size: i32, step: u32) -> Option<(u32, u32)> {
        let edge = self.uniform.patch_texels as i32;
        if floor_div(x, edge).1 + size > edge || floor_div(y, edge).1 + size > edge {
            return None;
        }
        let half = size / 2;
        let middle = self.place(x + half, y + half);
        self.aligned(Place { x: middle.x - half, y: middle.y - half, ..middle }, size, step)
    }
}
