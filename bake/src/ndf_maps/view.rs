//! What a part of the surface shows of one placed example under a footprint: which tiles or boxes, with bounded work.
//!
//! Xing et al. 2024, section 6.3. Tiles are chosen by the footprint's minor axis; their shares are the Gaussian footprint at the
//! tile's centre, widened by the tile's own extent, normalised in the end. Below the finest tile the example is divided in boxes,
//! each seen as one lobe.

use super::baked::Material;
use super::ellipse::{Ellipse, FINEST_TEXELS, Grid, REACH, for_each_cell, next_slot, slot_at};
use super::eval::{EvalSettings, Gathered, LobeTerm, TileTerm, matrix};
use glam::{Mat2, Vec2};

/// Edge of the boxes that are seen as lobes, at most, in example texels: those boxes are the bilinear cells.
pub(super) const LOBE_TEXELS: f32 = 1.0;
/// Pieces under a footprint that is widened by their own size, at most, relative to `max_terms`: thin footprints are seen in
/// pieces wider than they are.
pub(super) const MOST_OF_TERMS: f32 = 4.0;
/// A tile that a sub-region cuts is split from this share on, relative to an even share of `max_terms`.
const SPLIT_FROM: f32 = 2.0;

/// What is visible of one placed example, and how the footprint lies on it; tiled examples are visible everywhere.
pub(super) struct View {
    /// The footprint in example texels.
    pub(super) ellipse: Ellipse,
    /// The sub-region's middle in example texels.
    pub(super) middle: Vec2,
    /// Example offsets → surface offsets.
    pub(super) to_surface: Mat2,
    /// Surface texels an example texel, by area.
    pub(super) scale: f32,
    /// Half the sub-region's edge in surface texels.
    pub(super) half: f32,
    /// Half the box, in example texels, around a sub-region of half edge 1.
    pub(super) extent: Vec2,
    /// Palette entry of the example.
    pub(super) class: u32,
}

impl View {
    /// How much of a piece of `edge` around `x` lies in the sub-region, as if it were a box along the surface's axes.
    fn visible(&self, x: Vec2, edge: f32) -> f32 {
        let size = edge * self.scale;
        let d = (self.to_surface * (x - self.middle)).abs();
        let inside = ((Vec2::splat(self.half + 0.5 * size) - d) / size).clamp(Vec2::ZERO, Vec2::ONE);
        inside.x * inside.y
    }
}

/// Whether pieces of `edge` are few enough.
fn few(ellipse: &Ellipse, settings: EvalSettings, least: f32, edge: f32) -> bool {
    edge >= least && ellipse.pieces(edge) <= MOST_OF_TERMS * settings.max_terms as f32
}

/// What a footprint is resolved in.
#[derive(Clone, Copy, Debug)]
pub(super) enum Detail {
    /// Tiles of the level of this index.
    Tiles(usize),
    /// Boxes of this edge in example texels, each one lobe.
    Boxes(f32),
}

impl Material {
    /// The coarsest tiles or boxes that resolve a footprint in the example.
    pub(super) fn detail(&self, ellipse: &Ellipse, settings: EvalSettings) -> Detail {
        // Long thin footprints take coarser pieces rather than more than `max_terms` of them.
        let area = ellipse.minor.max(FINEST_TEXELS) * ellipse.major;
        let least = 2.0 * REACH * (area / settings.max_terms as f32).sqrt();
        let mut chosen = None;
        let mut finer = LOBE_TEXELS;
        for (index, level) in self.maps.params.levels.iter().enumerate() {
            let edge = level.tile_texels as f32;
            if edge <= settings.tile_sigmas * ellipse.minor || !few(ellipse, settings, least, finer) {
                chosen = Some(index);
                finer = edge;
            }
        }
        if let Some(index) = chosen {
            return Detail::Tiles(index);
        }
        let mut edge = LOBE_TEXELS;
        while edge > FINEST_TEXELS
            && edge > settings.lobe_sigmas * ellipse.minor
            && few(ellipse, settings, least, 0.5 * edge)
        {
            edge *= 0.5;
        }
        Detail::Boxes(edge)
    }

    /// Adds the tile at column and row `index` of a level, in the example's period that begins at `period`, by how much of it the
    /// sub-region shows; one that is cut is split in its four children first, as often as `settings.splits` allows.
    fn visible_tile(
        &self,
        view: &View,
        settings: EvalSettings,
        level: usize,
        period: Vec2,
        index: [u32; 2],
        gathered: &mut Gathered,
    ) {
        let record = &self.maps.params.levels[level];
        if index[0] >= record.tiles_x || index[1] >= record.tiles_y {
            return;
        }
        let low = period + Vec2::new(index[0] as f32, index[1] as f32) * record.tile_texels as f32;
        let size = (low + record.tile_texels as f32).min(period + self.size()) - low;
        let centre = low + 0.5 * size;
        let edge = size.max_element();
        let visible = view.visible(centre, edge);
        if visible <= 0.0 {
            return;
        }
        let weight = size.x * size.y * view.ellipse.widened_gaussian(edge, centre) * visible;
        let split =
            visible < 1.0 && settings.splits > 0 && level > 0 && weight * settings.max_terms as f32 >= SPLIT_FROM;
        if !split {
            let tile = record.first_tile + index[1] * record.tiles_x + index[0];
            return gathered.add(TileTerm { tile, class: view.class, weight });
        }
        let settings = EvalSettings { splits: settings.splits - 1, ..settings };
        for child in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let index = [2 * index[0] + child[0], 2 * index[1] + child[1]];
            self.visible_tile(view, settings, level - 1, period, index, gathered);
        }
    }

    /// Adds the tiles of a level that the widened footprint reaches and the sub-region may show, row by row.
    pub(super) fn tiles(&self, view: &View, settings: EvalSettings, level: usize, gathered: &mut Gathered) {
        let record = &self.maps.params.levels[level];
        let (edge, size) = (record.tile_texels as f32, self.size());
        let widened = view.ellipse.widened(edge);
        let shown = view.extent * (view.half + 0.5 * edge * view.scale) - 0.5 * edge;
        let (low, high) = (view.middle - shown, view.middle + shown);
        let reach = widened.reach_y();
        let last = (widened.mean.y + reach).min(high.y);
        let mut row = slot_at((widened.mean.y - reach).max(low.y), record.tiles_y, size.y, edge);
        loop {
            let start = row.period + row.index as f32 * edge;
            if start > last || start.is_nan() || last.is_nan() {
                return;
            }
            let y = 0.5 * (start + (start + edge).min(row.period + size.y));
            if let Some((x0, x1)) = widened.span_x(y) {
                let last = x1.min(high.x);
                let mut column = slot_at(x0.max(low.x), record.tiles_x, size.x, edge);
                while column.period + column.index as f32 * edge <= last {
                    let period = Vec2::new(column.period, row.period);
                    self.visible_tile(view, settings, level, period, [column.index, row.index], gathered);
                    column = next_slot(column, record.tiles_x, size.x);
                }
            }
            row = next_slot(row, record.tiles_y, size.y);
        }
    }

    /// Adds boxes of `edge`, each one lobe; those of a whole texel are the bilinear cells.
    pub(super) fn boxes(&self, view: &View, edge: f32, gathered: &mut Gathered) {
        // Box in example texels that holds the centres of all boxes that the sub-region may show.
        let extent = view.extent * (view.half + 0.5 * edge * view.scale);
        let span = (view.middle - extent, view.middle + extent);
        let widened = view.ellipse.widened(edge);
        for_each_cell(&widened, Grid { origin: -0.5, edge }, span, |_, _, centre| {
            let weight = edge * edge * widened.gaussian(centre) * view.visible(centre, edge);
            if weight > 0.0 {
                let gradient = view.ellipse.log_gradient(centre);
                self.add_lobe(view.class, centre, edge, weight, gradient, gathered);
            }
        });
    }

    /// Adds the example point `local` as one lobe of no extent.
    pub(super) fn point(&self, class: u32, local: Vec2, gathered: &mut Gathered) {
        self.add_lobe(class, local, 0.0, 1.0, Vec2::ZERO, gathered);
    }

    /// Adds the box of `edge` around the example point `centre`, which has `weight` of a footprint whose logarithm has the
    /// gradient `gradient` there.
    fn add_lobe(&self, class: u32, centre: Vec2, edge: f32, weight: f32, gradient: Vec2, gathered: &mut Gathered) {
        let sigma = self.maps.params.intrinsic_roughness;
        let to_local = matrix(self.placement.palette[class as usize].normal_to_local);
        let normal = self.maps.normal_and_jacobian(centre);
        gathered.terms.lobes.push(LobeTerm::new(normal, edge, sigma, to_local, weight, gradient));
        gathered.share += weight;
    }

    /// The tile that covers the example.
    pub(super) fn top_tile(&self) -> u32 {
        self.maps.params.levels.last().map_or(0, |level| level.first_tile)
    }

    /// Whether a level is the last, of one tile.
    pub(super) fn is_top(&self, level: usize) -> bool {
        level + 1 == self.maps.params.levels.len()
    }

    /// Surface offsets → example offsets under a palette entry.
    pub(super) fn position_to_local(&self, class: u32) -> Mat2 {
        matrix(self.placement.palette[class as usize].position_to_local)
    }

    /// Width and height of the example in texels.
    pub(super) fn size(&self) -> Vec2 {
        Vec2::new(self.maps.params.width as f32, self.maps.params.height as f32)
    }
}
