//! The grid of a stochastic placement as a footprint sees it, and whose example a sub-region shows. Xing et al. 2024, section 6.2.

use super::eval::Material;
use glam::{DVec2, IVec2, Vec2};

/// Grid of a stochastic placement as a footprint sees it: positions are relative to the corner of the base cell, which keeps
/// their digits far from the origin.
#[derive(Clone, Copy)]
pub(super) struct Cells {
    /// Cells along an axis.
    pub(super) count: i32,
    /// Edge of a cell in surface texels.
    pub(super) edge: f32,
    /// The cell that holds the footprint's centre, within the first period.
    pub(super) base: IVec2,
    /// The footprint's centre.
    pub(super) mean: Vec2,
}

impl Cells {
    pub(super) fn around(mean: DVec2, count: i32, edge: f32) -> Cells {
        let cell = (mean / edge as f64).floor();
        let base = cell - (cell / count as f64).floor() * count as f64;
        Cells { count, edge, base: base.as_ivec2(), mean: (mean - cell * edge as f64).as_vec2() }
    }

    /// Noise texel of a cell relative to the base.
    fn index(&self, cell: IVec2) -> usize {
        let at = self.base + cell;
        (at.y.rem_euclid(self.count) * self.count + at.x.rem_euclid(self.count)) as usize
    }
}

impl Material {
    /// Owner of a sub-region: palette entry, centre on the surface, example point that lies at the centre.
    pub(super) fn owner_of(&self, region: IVec2, cells: Cells) -> (u32, Vec2, Vec2) {
        let (cell, quadrant) = (region >> 1, region & 1);
        let own = self.placement.noise[cells.index(cell)];
        let neighbour = own.class_and_owners >> (16 + 4 * (quadrant.x + 2 * quadrant.y)) & 0xf;
        let cell = cell + IVec2::new((neighbour % 3) as i32 - 1, (neighbour / 3) as i32 - 1);
        let owner = self.placement.noise[cells.index(cell)];
        let unorm = |v: u32| Vec2::new((v & 0xffff) as f32, (v >> 16) as f32) / 65535.0;
        let centre = (cell.as_vec2() + unorm(owner.centre)) * cells.edge;
        (owner.class_and_owners & 0xff, centre, unorm(owner.offset) * self.size())
    }
}
