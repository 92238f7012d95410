//! Which lobes a footprint sees on the repeated map, with bounded work, as `query.wgsl` has it.
//!
//! Tan et al. 2022, section 5.2. Levels: boxes of the map itself (a texel or less), then the stored levels, then the whole
//! map seen alike. The level follows from the footprint's minor axis, λ = 1 + log₂(σ / σ₁) with σ₁ = `cell_sigmas` cells
//! of the finest stored level, raised where a long footprint would visit too many cells. Boxes give way to stored cells
//! sooner, since their number grows with the footprint's area. Two levels are interpolated as
//! Eq. 9 means it, the finer by the weight that falls with λ (as printed, the weights belong to the wrong levels), but stored
//! levels only over the second half of the way between them.

use super::baked::BakedLobes;
use super::eval::{ConditionalLobe, Ellipse, Frame, LEAST_SIGMA, Query, conditional, ellipse, ellipse_span, query};
use crate::footprint::Footprint;
use glam::Vec2;
use glint_formats::Wrap;
use glint_formats::lobes::{Filter, LevelUniform};
use std::f32::consts::PI;

/// Choice between speed and accuracy at run time. Standard deviations are those of the footprint, edges those of cells and boxes, both
/// in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuerySettings {
    /// Minor standard deviation over a stored level's edge from which on that level is read, at first without the next one.
    pub cell_sigmas: f32,
    /// Minor standard deviation over the finest stored edge up to which boxes alone are read.
    pub boxes_until: f32,
    /// Minor standard deviation over the finest stored edge from which on no boxes are read; above `boxes_until`.
    pub cells_from: f32,
    /// Edge of the largest boxes over the minor standard deviation.
    pub box_sigmas: f32,
    /// Cells of a level that a footprint visits, about.
    pub max_cells: f32,
    /// Boxes that a footprint visits, about.
    pub max_boxes: f32,
    /// Standard deviations that a footprint reaches where boxes are read.
    pub reach: f32,
    /// Standard deviations that a footprint reaches where cells are read, whose lobes reach beyond them.
    pub cells_reach: f32,
    /// Part of the way from a stored level to the next over which both are read, above 0 to 1.
    pub blend: f32,
}

impl Default for QuerySettings {
    /// Those that a bake measures its error with.
    fn default() -> QuerySettings {
        QuerySettings {
            cell_sigmas: 0.7,
            boxes_until: 0.25,
            cells_from: 0.375,
            box_sigmas: 0.25,
            max_cells: 32.0,
            max_boxes: 1024.0,
            reach: 3.0,
            cells_reach: 3.0,
            blend: 0.5,
        }
    }
}

impl QuerySettings {
    /// Few lobes, for pictures: about two cells of the map's lobes, or some twenty boxes, a footprint. What that costs in error
    /// stands in docs/reports/frames.md beside the time.
    pub fn realtime() -> QuerySettings {
        QuerySettings {
            cell_sigmas: 0.18,
            boxes_until: 0.22,
            cells_from: 0.24,
            box_sigmas: 1.1,
            max_cells: 2.0,
            max_boxes: 48.0,
            reach: 1.8,
            cells_reach: 1.1,
            blend: 0.15,
        }
    }

    /// Standard deviations that a footprint reaches at a level.
    pub(crate) fn reach_of(&self, detail: Detail) -> f32 {
        if matches!(detail, Detail::Boxes(_)) { self.reach } else { self.cells_reach }
    }
}

/// Sum of shares below which f32 cannot tell what a footprint sees; the last level is the best that is known then.
pub(super) const LEAST_SHARE: f32 = 1e-30;
/// Half of a cell's mean width, over its edge.
const HALF_WIDTH: f32 = 0.45;
/// Cells a footprint may visit, over π and less h² (see [`BakedLobes::lod`]), at least: a map of a texel would allow none.
const LEAST_BUDGET: f32 = 0.05;

/// What a level is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// Boxes of this edge, in texels.
    Boxes(f32),
    /// Cells of a stored level, 0 the finest.
    Cells(usize),
    /// The lobes of the last stored level, every place alike.
    Whole,
}

/// Two neighbouring levels and how they are mixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lod {
    /// The finer level.
    pub finer: Detail,
    /// The coarser level.
    pub coarser: Detail,
    /// Weight of the coarser; the finer has the rest.
    pub fraction: f32,
}

impl Lod {
    /// Levels that are read, with their weights.
    pub(super) fn weighted(&self) -> impl Iterator<Item = (Detail, f32)> + use<> {
        [(self.finer, 1.0 - self.fraction), (self.coarser, self.fraction)].into_iter().filter(|level| level.1 > 0.0)
    }

    /// Density of both levels together (Eq. 9); `sum` gives a level's sums of densities and of shares. Where a level has no
    /// share that f32 can tell, the whole map stands for it.
    pub(crate) fn density(&self, mut sum: impl FnMut(Detail) -> (f32, f32)) -> f32 {
        let mut density = 0.0;
        for (detail, weight) in self.weighted() {
            let (mut densities, mut share) = sum(detail);
            if share < LEAST_SHARE {
                (densities, share) = sum(Detail::Whole);
            }
            density += weight * densities / share;
        }
        density
    }
}

/// A cell's place on one axis of the repeated map.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slot {
    /// Index of the cell in the map.
    index: u32,
    /// Copy of the map.
    copy: f32,
}

/// The first of the cells of `edge` texels, `count` of them in every `length`, that touch what lies above `low`.
fn first_slot(low: f32, length: f32, edge: f32, count: u32) -> Slot {
    let copy = (low / length).floor();
    Slot { index: (((low - copy * length) / edge) as u32).min(count - 1), copy }
}

fn next_slot(slot: Slot, count: u32) -> Slot {
    if slot.index + 1 >= count {
        return Slot { index: 0, copy: slot.copy + 1.0 };
    }
    Slot { index: slot.index + 1, ..slot }
}

/// Range of x of an ellipse over a row of cells of `edge` texels that begins at `start`, in a map of this size; none if they miss
/// each other.
fn cells_span(ellipse: &Ellipse, size: Vec2, start: f32, edge: f32, row: Slot) -> Option<(f32, f32)> {
    ellipse_span(ellipse, start, (start + edge).min((row.copy + 1.0) * size.y))
}

impl BakedLobes {
    /// Edge of the boxes that a footprint is resolved in: a power of two, at most a texel.
    pub(super) fn box_edge(&self, frame: &Frame, settings: &QuerySettings) -> f32 {
        // The seam of a clamped map cuts through whole-texel boxes.
        let own_map = self.params.step_texels == 0;
        let clamped = own_map && self.params.wrap == Wrap::Clamp && self.params.filter == Filter::Linear;
        let mut edge = if clamped { 0.5 } else { 1.0 };
        let a = settings.reach * frame.major;
        let b = settings.reach * frame.minor;
        while edge > settings.box_sigmas * frame.minor && edge > 2.0 * LEAST_SIGMA {
            let half = 0.5 * edge;
            if PI * (a + half) * (b + half) > settings.max_boxes * half * half {
                break;
            }
            edge = half;
        }
        edge
    }

    /// Level up to which a footprint reads cells of a map: from where it would visit half of the last level's on, all of them alike come
    /// in, which serve it alone where it would visit as many as there are.
    fn most_level(&self, frame: &Frame, settings: &QuerySettings) -> f32 {
        let levels = self.params.levels.len();
        // The last level of a surface is the whole.
        if self.params.step_texels != 0 {
            return (levels + 1) as f32;
        }
        let last = &self.params.levels[levels - 1];
        let reach = settings.cells_reach / last.cell_texels as f32;
        let visited = PI * (reach * frame.major + HALF_WIDTH) * (reach * frame.minor + HALF_WIDTH);
        let share = 1.0 + libm::log2f(visited / (last.cells_x * last.cells_y) as f32);
        levels as f32 + share.clamp(0.0, 1.0)
    }

    /// The two levels that serve a footprint, and how they are mixed (Eq. 9).
    pub fn lod(&self, frame: &Frame, settings: &QuerySettings) -> Lod {
        let levels = self.params.levels.len();
        let finest = self.params.levels[0].cell_texels as f32;
        // Cells of edge c = σ / cell_sigmas that the footprint's ellipse touches: about π (r a + h c) (r b + h c) / c² with
        // its half axes r a, r b and h c half a cell's mean width. Solved for the σ at which they are `max_cells`.
        let a = settings.reach * frame.major;
        let b = settings.reach * frame.minor;
        let h = HALF_WIDTH;
        // A map narrower than the finest cells cuts them short, and as many times more of them lie under a footprint.
        let whole = |side: u32| (side as f32 / finest).min(1.0);
        let allowed = settings.max_cells * whole(self.params.width) * whole(self.params.height);
        let budget = (allowed / PI - h * h).max(LEAST_BUDGET);
        let edge = (h * (a + b) + (h * h * (a + b) * (a + b) + 4.0 * budget * a * b).sqrt()) / (2.0 * budget);
        let sigma = frame.minor.max(edge * settings.cell_sigmas);
        let cells = 1.0 + libm::log2f(sigma / (finest * settings.cell_sigmas));
        // Boxes end by the footprint's size, or where there would be more of them than allowed, be they whole texels.
        let by_size = libm::log2f(sigma / (finest * settings.boxes_until))
            / libm::log2f(settings.cells_from / settings.boxes_until);
        let by_count = 1.0 + libm::log2f(PI * (a + h) * (b + h) / settings.max_boxes) / settings.blend;
        let boxes = by_size.max(by_count).clamp(0.0, 1.0);
        let cells = cells.clamp(1.0, (levels + 1) as f32).min(self.most_level(frame, settings));
        let lambda = if boxes < 1.0 { boxes } else { cells };
        let finer = (lambda.floor() as usize).min(levels);
        let detail = |level: usize| match level {
            0 => Detail::Boxes(self.box_edge(frame, settings)),
            _ if level <= levels => Detail::Cells(level - 1),
            _ => Detail::Whole,
        };
        let mut fraction = lambda - finer as f32;
        if finer != 0 {
            // The finer of two stored levels serves alone at first: nearer to the map, and only one level is read.
            fraction = (1.0 - (1.0 - fraction) / settings.blend).max(0.0);
        }
        Lod { finer: detail(finer), coarser: detail(finer + 1), fraction }
    }

    /// Hands the lobes of a cell whose first lobe is `first` and whose corner lies at `corner` to `visit`.
    pub(crate) fn cell(
        &self,
        query: &Query,
        level: &LevelUniform,
        first: u32,
        corner: Vec2,
        visit: &mut impl FnMut(&ConditionalLobe),
    ) {
        let d = query.frame.mean - corner;
        for k in 0..self.params.lobes_per_cell {
            let lobe = self.lobe(level, first + k);
            if lobe.weight > 0.0 {
                visit(&conditional(query, &lobe, d - lobe.position));
            }
        }
    }

    /// Hands the lobes of a stored level's cells under the footprint on the repeated map to `visit`. `whole` sees each of the level's
    /// cells once, as a footprint does that sees every place alike. Returns the number of cells.
    pub(crate) fn cells(
        &self,
        query: &Query,
        level: &LevelUniform,
        reach: f32,
        whole: bool,
        visit: &mut impl FnMut(&ConditionalLobe),
    ) -> u32 {
        let per_cell = self.params.lobes_per_cell;
        if whole {
            let alike = Query { along: Vec2::ZERO, across: Vec2::ZERO, ..*query };
            let count = level.cells_x * level.cells_y;
            (0..count).for_each(|cell| self.cell(&alike, level, level.first_lobe + cell * per_cell, Vec2::ZERO, visit));
            return count;
        }
        let size = Vec2::new(self.params.width as f32, self.params.height as f32);
        let edge = level.cell_texels as f32;
        let frame = &query.frame;
        let ellipse = ellipse(frame, reach);
        let start = |slot: Slot, length: f32| slot.copy * length + slot.index as f32 * edge;
        let mut visited = 0;
        let mut row = first_slot(frame.mean.y - ellipse.top, size.y, edge, level.cells_y);
        while start(row, size.y) <= frame.mean.y + ellipse.top {
            if let Some((low, high)) = cells_span(&ellipse, size, start(row, size.y), edge, row) {
                let mut slot = first_slot(low, size.x, edge, level.cells_x);
                while start(slot, size.x) <= high {
                    let place = Vec2::new(slot.index as f32, row.index as f32);
                    let corner = place * edge + Vec2::new(slot.copy, row.copy) * size;
                    let first = level.first_lobe + (row.index * level.cells_x + slot.index) * per_cell;
                    self.cell(query, level, first, corner, visit);
                    visited += 1;
                    slot = next_slot(slot, level.cells_x);
                }
            }
            row = next_slot(row, level.cells_y);
        }
        visited
    }

    /// Hands the lobes of a level under the footprint on the repeated map to `visit`. Returns the number of cells or boxes; the whole
    /// map counts as one.
    pub(super) fn level_sum(
        &self,
        query: &Query,
        detail: Detail,
        reach: f32,
        visit: &mut impl FnMut(&ConditionalLobe),
    ) -> u32 {
        match detail {
            Detail::Boxes(edge) => self.boxes(query, edge, reach, visit),
            Detail::Cells(level) => self.cells(query, &self.level(level), reach, false, visit),
            Detail::Whole => {
                self.cells(query, &self.level(self.params.levels.len() - 1), reach, true, visit);
                1
            }
        }
    }

    /// P-NDF at the projected normal `s` of a footprint on the repeated map: density over the disk, 0 outside it.
    pub fn p_ndf(&self, footprint: &Footprint, s: Vec2, roughness: f32, settings: &QuerySettings) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let query = query(self.frame_in_map(footprint), roughness);
        self.lod(&query.frame, settings).density(|detail| {
            let (mut sum, mut share) = (0.0, 0.0);
            let mut visit = |lobe: &ConditionalLobe| {
                sum += lobe.density(s);
                share += lobe.share;
            };
            self.level_sum(&query, detail, settings.reach_of(detail), &mut visit);
            (sum, share)
        })
    }
}
