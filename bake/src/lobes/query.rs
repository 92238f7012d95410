//! What a footprint sees, as a sum over placed cells, with bounded work.
//!
//! Tan et al. 2022, section 5.2. Levels: boxes of the map itself (a texel or less), then the stored levels, then the whole
//! map seen alike. The level follows from the footprint's minor axis, λ = 1 + log₂(σ / σ₁) with σ₁ = `cell_sigmas` cells
//! of the finest stored level, raised where a long footprint would visit too many cells. Boxes give way to stored cells
//! sooner, since their number grows with the footprint's area. Two levels are interpolated as
//! Eq. 9 means it, the finer by the weight that falls with λ (as printed, the weights belong to the wrong levels), but stored
//! levels only over the second half of the way between them.
//!
//! A cell is visited where it lies: [`Query::add_cell`] takes its address in the map and how far it was moved from there.

use super::bake::BakedLobes;
use super::eval::{self, Frame, SeenLobe};
use super::quantise::Scales;
use super::span::{Slot, slots, span_x};
use crate::footprint::Footprint;
use crate::wrap::filtered_texels;
use glam::{DVec2, IVec2, Mat2, Vec2};
use glint_formats::Wrap;
use glint_formats::lobes::Filter;

/// Choice between speed and accuracy at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuerySettings {
    /// Footprint's minor deviation, over the edge of a level's cells, from which on the level is read, alone at first.
    pub cell_sigmas: f32,
    /// Footprint's minor deviation, over the edge of the finest cells, up to which boxes alone are read.
    pub boxes_until: f32,
    /// And from which on no boxes are.
    pub cells_from: f32,
    /// Edge of the largest boxes over the footprint's minor deviation.
    pub box_sigmas: f32,
    /// Cells a level that a footprint visits, about.
    pub max_cells: f32,
    /// Boxes that a footprint visits, about.
    pub max_boxes: f32,
    /// Footprints reach this far, in standard deviations.
    pub reach: f32,
    /// The same where cells are read, whose lobes reach beyond them.
    pub cells_reach: f32,
    /// Part of the way from a stored level to the next over which both are read, above 0 to 1.
    pub blend: f32,
}

impl QuerySettings {
    /// Few lobes, for pictures: about two cells of the map's lobes, or some twenty boxes, a footprint. What that costs in error
    /// stands in docs/viewer-report.md beside the time.
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

    /// How far footprints reach at a level, in standard deviations.
    pub fn reach_of(&self, detail: Detail) -> f32 {
        if matches!(detail, Detail::Boxes(_)) { self.reach } else { self.cells_reach }
    }
}

impl Default for QuerySettings {
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

/// Cells a footprint may visit, over π and less h² (see [`BakedLobes::lod`]), at least: a map of a texel would allow none.
const LEAST_BUDGET: f32 = 0.05;

/// What a level is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// Boxes of this edge, in texels.
    Boxes(f32),
    /// Cells of a stored level.
    Cells(usize),
    /// The lobes of the last level, every place alike.
    Whole,
}

/// Two neighbouring levels and the weight of the coarser.
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
    fn weighted(&self) -> impl Iterator<Item = (Detail, f32)> + use<> {
        [(self.finer, 1.0 - self.fraction), (self.coarser, self.fraction)].into_iter().filter(|level| level.1 > 0.0)
    }

    /// Density of both levels together; `sum` gives a level's sums of densities and of shares.
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

    /// Lobes of both levels together; `add` adds those of a level to a list and gives the cells and boxes visited.
    pub(crate) fn gather(&self, mut add: impl FnMut(&mut Vec<SeenLobe>, Detail) -> u32) -> Gathered {
        let mut gathered = Gathered::default();
        for (detail, weight) in self.weighted() {
            gathered.add_level(detail, weight, &mut add);
        }
        gathered
    }
}

/// A footprint on a map, and where what it sees goes.
pub struct Query<'a, V: FnMut(&SeenLobe)> {
    lobes: &'a BakedLobes,
    frame: Frame,
    roughness: f32,
    visit: V,
}

impl<'a, V: FnMut(&SeenLobe)> Query<'a, V> {
    /// A query that hands every lobe it sees to `visit`.
    pub fn new(lobes: &'a BakedLobes, frame: Frame, roughness: f32, visit: V) -> Query<'a, V> {
        Query { lobes, frame, roughness, visit }
    }

    /// Adds the lobes of cell (`cell[0]`, `cell[1]`) of a stored level, moved by `displacement` texels from where it lies in
    /// the map.
    pub fn add_cell(&mut self, level: usize, cell: [u32; 2], displacement: Vec2) {
        let grid = &self.lobes.params.levels[level];
        let corner = Vec2::new(cell[0] as f32, cell[1] as f32) * grid.cell_texels as f32 + displacement;
        let per_cell = self.lobes.params.lobes_per_cell;
        let first = grid.first_lobe + (cell[1] * grid.cells_x + cell[0]) * per_cell;
        let scales = Scales::new(&self.lobes.params, grid);
        for index in first..first + per_cell {
            let lobe = self.lobes.lobe(index, &scales);
            if lobe.weight > 0.0 {
                let seen = eval::seen(&lobe, self.frame.mean - corner - lobe.position, &self.frame, self.roughness);
                (self.visit)(&seen);
            }
        }
    }

    /// Adds the box of `edge` texels around `centre` in the map, moved by `displacement`.
    pub fn add_box(&mut self, centre: Vec2, edge: f32, displacement: Vec2) {
        let (normal, jacobian, twist) = self.lobes.surface_at(centre);
        let lobe = eval::box_lobe(normal, jacobian, twist, Vec2::splat(edge));
        let seen = eval::seen(&lobe, self.frame.mean - centre - displacement, &self.frame, self.roughness);
        (self.visit)(&seen);
    }

    /// Adds the lobes of the last level, every place alike.
    pub fn add_whole(&mut self) {
        self.lobes.visit_whole(self.roughness, &mut self.visit);
    }

    /// Adds what the repeated map shows of a level under the footprint. Returns the number of cells or boxes visited.
    pub fn add_repeated(&mut self, detail: Detail, reach: f32) -> u32 {
        let params = &self.lobes.params;
        let (width, height) = (params.width as f32, params.height as f32);
        let frame = self.frame;
        let mut visited = 0;
        match detail {
            Detail::Whole => {
                self.add_whole();
                visited = 1;
            }
            Detail::Cells(level) => {
                let grid = &params.levels[level];
                let edge = grid.cell_texels as f32;
                let top = frame.reach_y(reach);
                for row in slots(frame.mean.y - top, frame.mean.y + top, height, edge, grid.cells_y) {
                    let Some((x0, x1)) = span_x(&frame, reach, row.start, row.end) else { continue };
                    for Slot { index, copy, .. } in slots(x0, x1, width, edge, grid.cells_x) {
                        self.add_cell(level, [index, row.index], Vec2::new(copy * width, row.copy * height));
                        visited += 1;
                    }
                }
            }
            Detail::Boxes(edge) => {
                // Boxes of a bilinear map begin at texel centres, where its patches do.
                let origin = if params.filter == Filter::Linear { 0.5 } else { 0.0 };
                let top = frame.reach_y(reach);
                let index = |x: f32| ((x - origin) / edge).floor() as i32;
                for j in index(frame.mean.y - top)..=index(frame.mean.y + top) {
                    let y = origin + (j as f32 + 0.5) * edge;
                    let Some((x0, x1)) = span_x(&frame, reach, y - 0.5 * edge, y + 0.5 * edge) else { continue };
                    let copy_y = (y / height).floor() * height;
                    for i in index(x0)..=index(x1) {
                        let x = origin + (i as f32 + 0.5) * edge;
                        let copy = Vec2::new((x / width).floor() * width, copy_y);
                        self.add_box(Vec2::new(x, y) - copy, edge, copy);
                        visited += 1;
                    }
                }
            }
        }
        visited
    }
}

impl BakedLobes {
    /// The two levels that serve a footprint, and how they are mixed.
    pub fn lod(&self, frame: &Frame, settings: &QuerySettings) -> Lod {
        let levels = self.params.levels.len();
        let finest = self.params.levels[0].cell_texels as f32;
        // Cells of edge c = σ / cell_sigmas that the footprint's ellipse touches: about π (r a + h c) (r b + h c) / c² with
        // its half axes r a, r b and h c half a cell's mean width. Solved for the σ at which they are `max_cells`.
        let (a, b, h) = (settings.reach * frame.major, settings.reach * frame.minor, 0.45);
        // A map narrower than the finest cells cuts them short, and as many times more of them lie under a footprint.
        let whole = |side: u32| (side as f32 / finest).min(1.0);
        let allowed = settings.max_cells * whole(self.params.width) * whole(self.params.height);
        let budget = (allowed / std::f32::consts::PI - h * h).max(LEAST_BUDGET);
        let edge = (h * (a + b) + (h * h * (a + b) * (a + b) + 4.0 * budget * a * b).sqrt()) / (2.0 * budget);
        let sigma = frame.minor.max(edge * settings.cell_sigmas);
        let cells = 1.0 + libm::log2f(sigma / (finest * settings.cell_sigmas));
        // Boxes end by the footprint's size, or where there would be more of them than allowed, be they whole texels.
        let by_size = libm::log2f(sigma / (finest * settings.boxes_until))
            / libm::log2f(settings.cells_from / settings.boxes_until);
        let by_count =
            1.0 + libm::log2f(std::f32::consts::PI * (a + h) * (b + h) / settings.max_boxes) / settings.blend;
        let boxes = by_size.max(by_count).clamp(0.0, 1.0);
        let lambda = if boxes < 1.0 { boxes } else { cells.clamp(1.0, (levels + 1) as f32) };
        let finer = (lambda.floor() as usize).min(levels);
        let detail = |level: usize| match level {
            0 => Detail::Boxes(self.box_edge(frame, settings)),
            _ if level <= levels => Detail::Cells(level - 1),
            _ => Detail::Whole,
        };
        let fraction = lambda - finer as f32;
        // The finer of two stored levels serves alone at first: nearer to the map, and only one level is read.
        let late = |fraction: f32| (1.0 - (1.0 - fraction) / settings.blend).max(0.0);
        let fraction = if finer == 0 { fraction } else { late(fraction) };
        Lod { finer: detail(finer), coarser: detail(finer + 1), fraction }
    }

    /// Edge of the boxes that a footprint is resolved in: a power of two, at most a texel.
    pub(super) fn box_edge(&self, frame: &Frame, settings: &QuerySettings) -> f32 {
        // The seam of a clamped map cuts through whole-texel boxes.
        let own_map = self.params.step_texels == 0;
        let clamped = own_map && self.params.wrap == Wrap::Clamp && self.params.filter == Filter::Linear;
        let mut edge = if clamped { 0.5 } else { 1.0 };
        let (a, b) = (settings.reach * frame.major, settings.reach * frame.minor);
        while edge > settings.box_sigmas * frame.minor && edge > 2.0 * eval::LEAST_SIGMA {
            let half = 0.5 * edge;
            if std::f32::consts::PI * (a + half) * (b + half) > settings.max_boxes * half * half {
                break;
            }
            edge = half;
        }
        edge
    }

    /// P-NDF at the projected normal `s` of a footprint on the repeated map: density over the disk, 0 outside it.
    pub fn p_ndf(&self, footprint: &Footprint, s: Vec2, roughness: f32, settings: &QuerySettings) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let frame = self.frame(footprint);
        self.lod(&frame, settings).density(|detail| {
            let (mut sum, mut share) = (0.0, 0.0);
            let visit = |seen: &SeenLobe| {
                sum += seen.density(s);
                share += seen.share;
            };
            Query::new(self, frame, roughness, visit).add_repeated(detail, settings.reach_of(detail));
            (sum, share)
        })
    }

    /// The lobes that a footprint sees on the repeated map, shares summing to 1.
    pub fn gather(&self, footprint: &Footprint, roughness: f32, settings: &QuerySettings) -> Gathered {
        let frame = self.frame(footprint);
        self.lod(&frame, settings).gather(|to, at| self.add(to, &frame, at, roughness, settings.reach_of(at)))
    }

    /// The lobes that a footprint sees at one level.
    pub fn gather_detail(&self, footprint: &Footprint, detail: Detail, roughness: f32, reach: f32) -> Gathered {
        let frame = self.frame(footprint);
        let mut gathered = Gathered::default();
        gathered.add_level(detail, 1.0, |list, detail| self.add(list, &frame, detail, roughness, reach));
        gathered
    }

    /// Adds the lobes that a footprint sees at one level to a list.
    pub(super) fn add(
        &self,
        list: &mut Vec<SeenLobe>,
        frame: &Frame,
        detail: Detail,
        roughness: f32,
        reach: f32,
    ) -> u32 {
        Query::new(self, *frame, roughness, |seen: &SeenLobe| list.push(*seen)).add_repeated(detail, reach)
    }

    /// Hands the lobes of the last level, every place alike, to `visit`.
    pub(crate) fn visit_whole(&self, roughness: f32, visit: &mut impl FnMut(&SeenLobe)) {
        let top = &self.params.levels[self.params.levels.len() - 1];
        let scales = Scales::new(&self.params, top);
        for index in top.first_lobe..top.first_lobe + top.cells_x * top.cells_y * self.params.lobes_per_cell {
            let lobe = self.lobe(index, &scales);
            if lobe.weight > 0.0 {
                visit(&eval::seen_whole(&lobe, roughness));
            }
        }
    }

    /// Axes of a footprint, its centre moved by whole periods into the map, where positions have the most digits.
    pub(super) fn frame(&self, footprint: &Footprint) -> Frame {
        let size = DVec2::new(self.params.width as f64, self.params.height as f64);
        let mean = footprint.mean - (footprint.mean / size).floor() * size;
        Frame::new(&Footprint { mean, ..*footprint })
    }

    /// Projected normal, Jacobian ∂s/∂u and twist ∂²s/∂u∂v at a place in the map.
    fn surface_at(&self, u: Vec2) -> (Vec2, Mat2, Vec2) {
        bilinear(self.params.filter, u, |i, j| self.texel(i, j))
    }
}

/// Projected normal, Jacobian ∂s/∂u and twist ∂²s/∂u∂v of filtered texels at a place.
pub(crate) fn bilinear(filter: Filter, u: Vec2, texel: impl Fn(i32, i32) -> Vec2) -> (Vec2, Mat2, Vec2) {
    if filter == Filter::Nearest {
        return (texel(u.x.floor() as i32, u.y.floor() as i32), Mat2::ZERO, Vec2::ZERO);
    }
    let (IVec2 { x: i, y: j }, f) = filtered_texels(u);
    let (s00, s10, s01, s11) = (texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1));
    let top = s00 + (s10 - s00) * f.x;
    let bottom = s01 + (s11 - s01) * f.x;
    let twist = s11 - s10 - s01 + s00;
    let along = s10 - s00 + twist * f.y;
    (top + (bottom - top) * f.y, Mat2::from_cols(along, bottom - top), twist)
}

/// Sum of shares below which f32 cannot tell what a footprint sees; the last level is the best that is known then.
const LEAST_SHARE: f32 = 1e-30;

/// What a footprint sees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gathered {
    /// Lobes; shares sum to 1.
    pub lobes: Vec<SeenLobe>,
    /// Cells and boxes visited.
    pub cells: u32,
}

impl Gathered {
    /// Adds what a footprint sees of a level by `add`, shares summing to `weight`.
    pub(crate) fn add_level(
        &mut self,
        detail: Detail,
        weight: f32,
        mut add: impl FnMut(&mut Vec<SeenLobe>, Detail) -> u32,
    ) {
        let first = self.lobes.len();
        self.cells += add(&mut self.lobes, detail);
        let share = |list: &[SeenLobe]| list.iter().map(|seen| seen.share).sum::<f32>();
        if share(&self.lobes[first..]) < LEAST_SHARE {
            self.lobes.truncate(first);
            add(&mut self.lobes, Detail::Whole);
        }
        let scale = weight / share(&self.lobes[first..]);
        self.lobes[first..].iter_mut().for_each(|seen| seen.share *= scale);
    }

    /// Density at `s`, 0 outside the disk.
    pub fn density(&self, s: Vec2) -> f32 {
        if s.length_squared() > 1.0 { 0.0 } else { self.lobes.iter().map(|seen| seen.density(s)).sum() }
    }
}
