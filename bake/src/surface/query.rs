//! What a footprint on a synthesised surface sees, as a sum over placed cells of the sample, with bounded work.
//!
//! Tan et al. 2022, section 5.2, splits a footprint at the edges of patches, and takes unclustered lobes at seams. Here each
//! level is walked by blocks of its cells' edge. A block that lies clear of seams is one cell of the sample, moved.
//! Where seams cross, the cells of all patches that show a corner of the block are read, and of each the quarters of
//! lobes that lie where the surface shows that patch. Smaller blocks are read by blocks of the finest level, and those by boxes
//! of a texel, which follow every seam; boxes are also all that footprints of a texel or two see.

use super::Surface;
use crate::footprint::Footprint;
use crate::lobes::boxes::bilinear;
use crate::lobes::eval::{self, Frame, Lobe, Patch, Query, SeenLobe, ellipse, frame, query, row};
use crate::lobes::quality::Gathered;
use crate::lobes::query::{Detail, Lod, QuerySettings};
use glam::{DVec2, Mat2, Vec2};
use glint_formats::Wrap;
use glint_formats::lobes::Filter;
use glint_formats::synthesis::Layout;

/// A surface without end is taken to repeat after as many patches as fit into this many texels, so that places have digits.
const MOST_TEXELS: i64 = 1 << 30;

/// Choice between speed and accuracy at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceSettings {
    /// Choice of levels.
    pub query: QuerySettings,
    /// Edge in texels of a level's cells from which on blocks that seams cross are read by the parts of lobes that each
    /// patch owns; those of smaller ones by blocks of the finest level and boxes.
    pub owned_from: u32,
    /// Geometric mean of the footprint's deviations, in texels, from which on all but the finest blocks are read so.
    pub owned_sigma: f32,
    /// Largest range of normals in a box at a seam, over σ_r, that is not halved.
    pub box_range: f32,
    /// Footprint's major deviation, in texels, up to which boxes at seams are halved along both axes.
    pub halves_until: f32,
    /// Whether a block that seams cross is read as that of the patch at its middle, as if there were no seams, and boxes as
    /// those of the patch at the footprint's middle.
    pub whole_blocks: bool,
}

impl SurfaceSettings {
    /// Few lobes, for pictures: those of [`QuerySettings::realtime`], and no work at seams.
    pub fn realtime() -> SurfaceSettings {
        SurfaceSettings { query: QuerySettings::realtime(), whole_blocks: true, ..SurfaceSettings::default() }
    }
}

impl Default for SurfaceSettings {
    fn default() -> SurfaceSettings {
        SurfaceSettings {
            query: QuerySettings::default(),
            owned_from: 32,
            owned_sigma: 14.0,
            box_range: 2.0,
            halves_until: 6.0,
            whole_blocks: false,
        }
    }
}

/// Bits 0, 2, 4 … of a number as a number of their own.
fn even_bits(v: u32) -> i32 {
    let mut bits = v & 0x5555_5555;
    bits = (bits | bits >> 1) & 0x3333_3333;
    bits = (bits | bits >> 2) & 0x0f0f_0f0f;
    bits = (bits | bits >> 4) & 0x00ff_00ff;
    ((bits | bits >> 8) & 0xffff) as i32
}

/// A footprint by its axes. Its centre is relative to a texel of the surface, a corner of blocks of every level.
#[derive(Clone, Copy, Debug)]
struct View {
    frame: Frame,
    origin: [i32; 2],
}

/// A footprint on a surface, and where what it sees goes.
struct SurfaceQuery<'a, V: FnMut(&SeenLobe)> {
    surface: &'a Surface,
    view: View,
    query: Query,
    settings: &'a SurfaceSettings,
    visit: V,
}

impl<V: FnMut(&SeenLobe)> SurfaceQuery<'_, V> {
    /// Adds what the surface shows of a level under the footprint. Returns the number of blocks or boxes visited.
    fn add(&mut self, detail: Detail) -> u32 {
        let (frame, reach) = (self.view.frame, self.settings.query.reach_of(detail));
        let levels = &self.surface.lobes.params.levels;
        let last = levels.len() - 1;
        let (edge, origin) = match detail {
            Detail::Whole => return self.add_whole(),
            Detail::Cells(level) if level == last => return self.add_whole(),
            Detail::Cells(level) => (levels[level].cell_texels as f32, 0.0),
            // Boxes of a bilinear map begin at texel centres, where its patches do.
            Detail::Boxes(edge) => (edge, self.box_origin()),
        };
        let index = |x: f32| ((x - origin) / edge).floor() as i32;
        let ellipse = ellipse(&frame, reach);
        let top = ellipse.top;
        let mut visited = 0;
        for j in index(frame.mean.y - top)..=index(frame.mean.y + top) {
            let y = origin + j as f32 * edge;
            let row = row(&ellipse, origin, edge, y);
            for i in row.0..=row.1 {
                match detail {
                    Detail::Cells(level) if self.settings.whole_blocks => {
                        self.add_nominal_block(level, [i * edge as i32, j * edge as i32]);
                    }
                    Detail::Cells(level) => self.add_block(level, [i * edge as i32, j * edge as i32]),
                    _ => self.add_box(Vec2::new(origin + (i as f32 + 0.5) * edge, y + 0.5 * edge), Vec2::splat(edge)),
                }
                visited += 1;
            }
        }
        visited
    }

    fn box_origin(&self) -> f32 {
        if self.surface.lobes.params.filter == Filter::Linear { 0.5 } else { 0.0 }
    }

    /// Adds the block of a level's edge whose first texel lies `at` from the origin, as one block where that can be read, else
    /// by its quarters and theirs, down to the finest level.
    fn add_block(&mut self, level: usize, at: [i32; 2]) {
        let levels = &self.surface.lobes.params.levels;
        let finest = levels[0].cell_texels as i32;
        let frame = &self.view.frame;
        let large = (frame.minor * frame.major).sqrt() >= self.settings.owned_sigma;
        let owned = levels[level].cell_texels >= self.settings.owned_from || large;
        // Blocks of the finest level in the order of their quarters: those of a larger block follow each other.
        let mut block = 0u32;
        while block < 1 << (2 * level) {
            let place = [at[0] + finest * even_bits(block), at[1] + finest * even_bits(block >> 1)];
            let mut size = if block == 0 { level } else { block.trailing_zeros() as usize / 2 };
            while size > 0 && !self.add_whole_block(size, place, owned) {
                size -= 1;
            }
            if size == 0 && !self.add_whole_block(0, place, false) {
                self.add_texels(place, finest as u32);
            }
            block += 1 << (2 * size);
        }
    }

    /// Adds a block as if it had no seams: the cell of the sample at which the patch at its middle begins there, or the last
    /// before it.
    fn add_nominal_block(&mut self, level: usize, at: [i32; 2]) {
        let params = &self.surface.lobes.params;
        let grid = &params.levels[level];
        let step = params.step(grid.cell_texels);
        let [x, y] = self.on_surface(at);
        let (sx, sy) = self.surface.synthesis.nominal_texel(x, y, grid.cell_texels as i32);
        let first = |v: u32, cells: u32| (v / step).min(cells - 1) * step;
        self.add_cell(level, [first(sx, grid.cells_x), first(sy, grid.cells_y)], at, false);
    }

    /// Adds a block by cells of its own edge, if `owned` where seams cross too; says whether there are such.
    fn add_whole_block(&mut self, level: usize, at: [i32; 2], owned: bool) -> bool {
        let params = &self.surface.lobes.params;
        let edge = params.levels[level].cell_texels;
        let step = params.step(edge);
        let [x, y] = self.on_surface(at);
        if let Some((sx, sy)) = self.surface.synthesis.block_source(x, y, edge as i32, step) {
            self.add_cell(level, [sx, sy], at, false);
            return true;
        }
        if !owned {
            return false;
        }
        let Some((cells, count)) = self.surface.cells_at_corners([x, y], edge, step) else { return false };
        for cell in &cells[..count] {
            self.add_cell(level, *cell, at, true);
        }
        true
    }

    /// Adds the boxes of a block of `edge` texels. Those of a bilinear map lie between texel centres; at the block's border
    /// they are half as wide.
    fn add_texels(&mut self, at: [i32; 2], edge: u32) {
        let (shift, last) = if self.box_origin() > 0.0 { (0.5, edge) } else { (0.0, edge - 1) };
        let span = |k: u32| ((k as f32 - shift).max(0.0), (k as f32 - shift + 1.0).min(edge as f32));
        for j in 0..=last {
            let (y0, y1) = span(j);
            for i in 0..=last {
                let (x0, x1) = span(i);
                let corner = Vec2::new(at[0] as f32 + 0.5 * (x0 + x1), at[1] as f32 + 0.5 * (y0 + y1));
                self.add_halved(corner, Vec2::new(x1 - x0, y1 - y0));
            }
        }
    }

    /// Adds the lobes of the cell at sample texel `source` where the block `at` lies; if `owned`, the parts of them that the
    /// surface shows there.
    fn add_cell(&mut self, level: usize, source: [u32; 2], at: [i32; 2], owned: bool) {
        let lobes = &self.surface.lobes;
        let params = &lobes.params;
        let grid = &params.levels[level];
        let step = params.step(grid.cell_texels);
        let stored = lobes.level(level);
        let first = grid.first_lobe + (source[1] / step * grid.cells_x + source[0] / step) * params.lobes_per_cell;
        let corner = Vec2::new(at[0] as f32, at[1] as f32);
        let [x, y] = self.on_surface(at);
        for index in first..first + params.lobes_per_cell {
            let lobe = lobes.lobe(&stored, index);
            if lobe.weight <= 0.0 {
                continue;
            }
            if !owned {
                self.add_lobe(&lobe, corner);
                continue;
            }
            let last = grid.cell_texels as i32 - 1;
            let mut shown = [false; 4];
            for k in 0..4 {
                let place = lobe.position + eval::quarter_offset(&lobe, eval::QUARTERS[k]);
                let (px, py) = ((place.x as i32).clamp(0, last), (place.y as i32).clamp(0, last));
                let found = self.surface.synthesis.source_texel(x.wrapping_add(px), y.wrapping_add(py));
                shown[k] = found == ((source[0] + px as u32) % params.width, (source[1] + py as u32) % params.height);
            }
            if shown != [false; 4] {
                self.add_lobe(&eval::part_of(&lobe, shown), corner);
            }
        }
    }

    /// Adds a lobe whose position is relative to `corner`.
    fn add_lobe(&mut self, lobe: &Lobe, corner: Vec2) {
        let d = self.view.frame.mean - corner - lobe.position;
        (self.visit)(&eval::seen(&self.query, lobe, d));
    }

    /// Adds the box of this width and height around `centre`.
    fn add_box(&mut self, centre: Vec2, size: Vec2) {
        let place = if self.settings.whole_blocks { self.nominal_patch_at(centre) } else { self.patch_at(centre) };
        self.add_lobe(&eval::box_lobe(&place, size), centre);
    }

    /// Adds the box of this width and height around `centre`, halved along each axis over which its normals spread so far
    /// that they are no Gaussian: cells beside it hold lobes of fewer normals.
    fn add_halved(&mut self, centre: Vec2, size: Vec2) {
        let Patch { normal, jacobian, twist } = self.patch_at(centre);
        let most = self.settings.box_range * self.query.roughness;
        let ranges = [jacobian.x_axis.length() * size.x, jacobian.y_axis.length() * size.y];
        // Larger footprints see many boxes: there only the wider range is halved.
        let least = if self.view.frame.major <= self.settings.halves_until { 0.0 } else { ranges[0].max(ranges[1]) };
        let [columns, rows] = ranges.map(|range| if range > most && range >= least { 2 } else { 1 });
        let part = size / Vec2::new(columns as f32, rows as f32);
        for j in 0..rows {
            for i in 0..columns {
                let d = part * (Vec2::new(i as f32, j as f32) + 0.5) - 0.5 * size;
                let here = normal + jacobian * d + twist * (d.x * d.y);
                let slopes = jacobian + Mat2::from_cols(twist * d.y, twist * d.x);
                let place = Patch { normal: here, jacobian: slopes, twist };
                self.add_lobe(&eval::box_lobe(&place, part), centre + d);
            }
        }
    }

    /// Normal, Jacobian and twist of the surface at a place.
    fn patch_at(&self, u: Vec2) -> Patch {
        filtered(self.surface.lobes.params.filter, u, |i, j| {
            let [x, y] = self.on_surface([i, j]);
            let (sx, sy) = self.surface.synthesis.source_texel(x, y);
            self.surface.lobes.texel(sx as i32, sy as i32)
        })
    }

    /// The same as if the patch that shows the footprint's middle showed all places.
    fn nominal_patch_at(&self, u: Vec2) -> Patch {
        let middle = self.view.frame.mean.floor();
        let (i0, j0) = (middle.x as i32, middle.y as i32);
        let [x, y] = self.on_surface([i0, j0]);
        let (sx, sy) = self.surface.synthesis.source_texel(x, y);
        filtered(self.surface.lobes.params.filter, u, |i, j| {
            self.surface.lobes.texel(sx as i32 + i - i0, sy as i32 + j - j0)
        })
    }

    /// Adds the lobes of the last level, every place alike.
    fn add_whole(&mut self) -> u32 {
        let lobes = &self.surface.lobes;
        lobes.cells(&self.query, &lobes.level(lobes.params.levels.len() - 1), 0.0, true, &mut self.visit);
        1
    }

    fn on_surface(&self, at: [i32; 2]) -> [i32; 2] {
        [self.view.origin[0].wrapping_add(at[0]), self.view.origin[1].wrapping_add(at[1])]
    }
}

/// The bilinear patch of texels at a place, or the nearest texel, which has no slopes.
fn filtered(filter: Filter, u: Vec2, texel: impl Fn(i32, i32) -> Vec2) -> Patch {
    if filter == Filter::Nearest {
        let normal = texel(u.x.floor() as i32, u.y.floor() as i32);
        return Patch { normal, jacobian: Mat2::ZERO, twist: Vec2::ZERO };
    }
    let p = u - 0.5;
    let cell = p.floor();
    let (i, j) = (cell.x as i32, cell.y as i32);
    bilinear(texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1), p - cell)
}

impl Surface {
    /// P-NDF at the projected normal `s` of a footprint on the surface: density over the disk, 0 outside it.
    pub fn p_ndf(&self, footprint: &Footprint, s: Vec2, roughness: f32, settings: &SurfaceSettings) -> f32 {
        if s.length_squared() > 1.0 {
            return 0.0;
        }
        let view = self.view(footprint);
        self.lod(&view, settings).density(|detail| self.sum(view, s, detail, roughness, settings))
    }

    fn sum(&self, view: View, s: Vec2, detail: Detail, roughness: f32, settings: &SurfaceSettings) -> (f32, f32) {
        let (mut sum, mut share) = (0.0, 0.0);
        let visit = |seen: &SeenLobe| {
            sum += seen.density(s);
            share += seen.share;
        };
        SurfaceQuery { surface: self, view, query: query(view.frame, roughness), settings, visit }.add(detail);
        (sum, share)
    }

    /// The lobes that a footprint sees, shares summing to 1.
    pub fn gather(&self, footprint: &Footprint, roughness: f32, settings: &SurfaceSettings) -> Gathered {
        let view = self.view(footprint);
        Gathered::of(&self.lod(&view, settings), |list, detail| self.add(list, view, detail, roughness, settings))
    }

    /// The lobes that a footprint sees at one level.
    pub fn gather_detail(
        &self,
        footprint: &Footprint,
        detail: Detail,
        roughness: f32,
        settings: &SurfaceSettings,
    ) -> Gathered {
        let view = self.view(footprint);
        let mut gathered = Gathered::default();
        gathered.add_level(detail, 1.0, |list, detail| self.add(list, view, detail, roughness, settings));
        gathered
    }

    /// Adds the lobes that a footprint sees at one level to a list.
    fn add(
        &self,
        list: &mut Vec<SeenLobe>,
        view: View,
        detail: Detail,
        roughness: f32,
        settings: &SurfaceSettings,
    ) -> u32 {
        let visit = |seen: &SeenLobe| list.push(*seen);
        SurfaceQuery { surface: self, view, query: query(view.frame, roughness), settings, visit }.add(detail)
    }

    /// The levels that serve a footprint; the last of the lobes is the whole surface.
    pub fn levels_for(&self, footprint: &Footprint, settings: &SurfaceSettings) -> Lod {
        self.lod(&self.view(footprint), settings)
    }

    fn lod(&self, view: &View, settings: &SurfaceSettings) -> Lod {
        self.lobes.lod(&view.frame, &settings.query)
    }

    /// Axes of a footprint, its centre in the surface's first period and then relative to a corner of a largest block near
    /// it, where places have the most digits.
    fn view(&self, footprint: &Footprint) -> View {
        let params = &self.synthesis.params;
        let patch = i64::from(params.patch);
        let period = match params.layout {
            Layout::Patches { columns, rows, .. } => [i64::from(columns) * patch, i64::from(rows) * patch],
            Layout::CornerTiles { .. } => [MOST_TEXELS / patch * patch; 2],
        };
        let block = |mean: f64, period: i64| {
            let place = mean - (mean / period as f64).floor() * period as f64;
            let first = (place / patch as f64).floor() * patch as f64;
            (place - first, first as i32)
        };
        let (x, left) = block(footprint.mean.x, period[0]);
        let (y, upper) = block(footprint.mean.y, period[1]);
        View { frame: frame(&Footprint { mean: DVec2::new(x, y), ..*footprint }), origin: [left, upper] }
    }

    /// Cells of `edge` texels of the patches that the block at surface texel `at` shows at its corners, and their number.
    /// `None` where one of them is not in the sample.
    fn cells_at_corners(&self, at: [i32; 2], edge: u32, step: u32) -> Option<([[u32; 2]; 4], usize)> {
        let (mut cells, mut count) = ([[0; 2]; 4], 0);
        let params = &self.lobes.params;
        let first = |shown: u32, within: u32, side: u32| {
            let place = match params.wrap {
                Wrap::Repeat => (shown + side - within % side) % side,
                Wrap::Clamp => shown.checked_sub(within).filter(|first| first + edge <= side)?,
            };
            place.is_multiple_of(step).then_some(place)
        };
        for corner in 0..4 {
            let (dx, dy) = ((corner & 1) * (edge - 1), (corner >> 1) * (edge - 1));
            let [x, y] = [at[0].wrapping_add(dx as i32), at[1].wrapping_add(dy as i32)];
            let (sx, sy) = self.synthesis.source_texel(x, y);
            let cell = [first(sx, dx, params.width)?, first(sy, dy, params.height)?];
            if !cells[..count].contains(&cell) {
                cells[count] = cell;
                count += 1;
            }
        }
        Some((cells, count))
    }
}
