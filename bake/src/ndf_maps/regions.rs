//! A surface of examples placed at random: sub-regions, their owners, and what they show under a footprint.
//!
//! Xing et al. 2024, section 6.3, Fig. 3, sums every tile of every sub-region. Two deviations: a footprint over many cells sees the
//! top tile under each transform, by the share of cells that use it, where the paper visits every example; and settings for
//! pictures see the surface as textures are filtered along a footprint's axes, at places evenly spaced along both, each as the
//! tile that holds it in the example that shows there, whether or not all of the tile shows. Neighbours then do the same work,
//! whatever borders lie between them.

use super::baked::Material;
use super::ellipse::{EVERYWHERE, Ellipse, Grid, REACH, ellipse, for_each_cell};
use super::eval::{EvalSettings, Gathered, TileTerm};
use super::view::{Detail, LOBE_TEXELS, MOST_OF_TERMS, View};
use crate::footprint::Footprint;
use glam::{DVec2, IVec2, UVec2, Vec2};

/// Sub-regions of a stochastic surface that a footprint visits at most.
const MAX_REGIONS: f32 = 64.0;
/// From this minor axis on (in sub-regions) a sub-region's middle tells its share to 2.4 %, and one top tile, if enough, all of it.
const WHOLE_REGION_SIGMA: f32 = 0.5;
/// From this minor axis on (in cells) a stochastic surface is seen as shares of transforms.
const CLASS_SIGMA_CELLS: f32 = 1.0;
/// Places lie within this many standard deviations of the footprint's centre; with their tiles they spread as it does.
const PROBE_REACH: f32 = 1.5;
/// Edge of their tiles, at most, and their distance along the major axis, relative to that along the minor axis.
const PROBE_TILE: f32 = 1.35;

/// Grid of a stochastic placement as a footprint sees it: positions are relative to the corner of the base cell, which keeps
/// their digits far from the origin.
#[derive(Clone, Copy)]
pub(super) struct Cells {
    /// Cells along an axis.
    count: i32,
    /// Edge of a cell in surface texels.
    edge: f32,
    /// The cell that holds the footprint's centre, within the first period.
    base: IVec2,
    /// The footprint's centre.
    mean: Vec2,
}

/// The grid of `count` × `count` cells of `edge` texels around a footprint's centre.
pub(super) fn cells_around(mean: DVec2, count: u32, edge: f32) -> Cells {
    let cell = (mean / edge as f64).floor();
    let base = cell - (cell / count as f64).floor() * count as f64;
    Cells { count: count as i32, edge, base: base.as_ivec2(), mean: (mean - cell * edge as f64).as_vec2() }
}

/// Two numbers from 0 to 1 in 16 bits each.
fn unorm_pair(bits: u32) -> Vec2 {
    Vec2::new((bits & 0xffff) as f32, (bits >> 16) as f32) / 65535.0
}

/// Whose example a sub-region shows.
struct Owner {
    /// Palette entry.
    class: u32,
    /// Centre on the surface, relative to the base cell.
    centre: Vec2,
    /// Example point that lies at the centre.
    offset: Vec2,
}

impl Material {
    /// Owner of a sub-region, by its index from the base cell's first one on.
    fn owner_of(&self, cells: Cells, region: IVec2) -> Owner {
        let regions = 2 * cells.count;
        let at = 2 * cells.base + region;
        let owner = self.placement.noise[(at.y.rem_euclid(regions) * regions + at.x.rem_euclid(regions)) as usize];
        let [x, y] = owner.neighbour();
        let cell: IVec2 = (region >> 1i32) + IVec2::new(x, y);
        Owner {
            class: owner.class(),
            centre: (cell.as_vec2() + unorm_pair(owner.centre)) * cells.edge,
            offset: unorm_pair(owner.offset) * self.size(),
        }
    }

    /// Adds what a sub-region, by its index and middle, shows of its owner under the footprint.
    fn region(
        &self,
        footprint: &Ellipse,
        cells: Cells,
        (region, middle): (IVec2, Vec2),
        settings: EvalSettings,
        gathered: &mut Gathered,
    ) {
        let edge = 0.5 * cells.edge;
        let owner = self.owner_of(cells, region);
        let position = self.position_to_local(owner.class);
        let from_centre = Ellipse { mean: footprint.mean - owner.centre, ..*footprint };
        let view = View {
            ellipse: from_centre.transformed(position, owner.offset),
            middle: position * (middle - owner.centre) + owner.offset,
            to_surface: position.inverse(),
            scale: position.determinant().abs().sqrt().recip(),
            half: 0.5 * edge,
            extent: position.x_axis.abs() + position.y_axis.abs(),
            class: owner.class,
        };
        match self.detail(&view.ellipse, settings) {
            // Where places are seen, not tiles, all that comes here is seen as boxes: next to a transform that shears, or one of
            // more texels.
            Detail::Tiles(_) if settings.probes > 0 => self.boxes(&view, LOBE_TEXELS, gathered),
            Detail::Tiles(level) if self.is_top(level) && footprint.minor >= WHOLE_REGION_SIGMA * edge => {
                let weight = edge * edge * footprint.widened_gaussian(edge, middle);
                gathered.add(TileTerm { tile: self.top_tile(), class: owner.class, weight });
            }
            Detail::Tiles(level) => self.tiles(&view, settings, level, gathered),
            Detail::Boxes(edge) => self.boxes(&view, edge, gathered),
        }
    }

    /// Adds what the sub-regions near a footprint show.
    fn regions(&self, ellipse: &Ellipse, cells: Cells, settings: EvalSettings, gathered: &mut Gathered) {
        let edge = 0.5 * cells.edge;
        // A sub-region counts when its centre is near the footprint, widened so that a point reaches its corners.
        let widened = ellipse.widened(edge * 1.2);
        for_each_cell(&widened, Grid { origin: 0.0, edge }, EVERYWHERE, |i, j, middle| {
            self.region(ellipse, cells, (IVec2::new(i, j), middle), settings, gathered);
        });
    }

    /// What shows at a surface position relative to the base cell: palette entry and example texels, not yet within the example.
    fn shown_at(&self, cells: Cells, place: Vec2) -> (u32, Vec2) {
        let owner = self.owner_of(cells, (place / (0.5 * cells.edge)).floor().as_ivec2());
        (owner.class, self.position_to_local(owner.class) * (place - owner.centre) + owner.offset)
    }

    /// Adds `weight` times the shares of the palette's entries in one texel of the class texture.
    fn class_shares(&self, cells: Cells, mip: u32, block: IVec2, weight: f32, shares: &mut [f32]) {
        let layers = shares.len().div_ceil(4);
        let first: usize = (0..mip).map(|m| ((cells.count >> m) as usize).pow(2) * layers * 4).sum();
        let size = cells.count >> mip;
        let texel = (block.y.rem_euclid(size) * size + block.x.rem_euclid(size)) as usize;
        for (class, share) in shares.iter_mut().enumerate() {
            let at = first + ((class / 4) * (size * size) as usize + texel) * 4 + class % 4;
            *share += weight * self.placement.classes[at] as f32 / 255.0;
        }
    }

    /// Adds the top tile under every transform, by the share of cells that use it.
    fn classes(&self, ellipse: &Ellipse, cells: Cells, settings: EvalSettings, gathered: &mut Gathered) {
        let most = MOST_OF_TERMS * settings.max_terms as f32;
        let (mut mip, mut block) = (0, cells.edge);
        while 1 << mip < cells.count
            && (2.0 * block <= settings.tile_sigmas * ellipse.minor || ellipse.pieces(block) > most)
        {
            mip += 1;
            block *= 2.0;
        }
        let mut shares = vec![0.0f32; self.placement.params.palette_len as usize];
        if 1 << mip == cells.count {
            self.class_shares(cells, mip, IVec2::ZERO, 1.0, &mut shares);
        } else {
            // The block that holds the base cell, and where it begins.
            let first = cells.base >> mip;
            let origin = ((first << mip) - cells.base).as_vec2() * cells.edge;
            let widened = ellipse.widened(block);
            // At a smaller reach a footprint might lie between the middles of its blocks.
            let widened = Ellipse { mean: widened.mean - origin, reach: REACH, ..widened };
            for_each_cell(&widened, Grid { origin: 0.0, edge: block }, EVERYWHERE, |i, j, centre| {
                let weight = widened.gaussian(centre) * block * block;
                self.class_shares(cells, mip, first + IVec2::new(i, j), weight, &mut shares);
            });
        }
        for (class, weight) in shares.into_iter().enumerate() {
            if weight > 0.0 {
                gathered.add(TileTerm { tile: self.top_tile(), class: class as u32, weight });
            }
        }
    }

    /// Adds the tiles that show at places under a footprint, `settings.probes` of them along its minor axis.
    fn probes(&self, ellipse: &Ellipse, cells: Cells, settings: EvalSettings, gathered: &mut Gathered) {
        let most = settings.max_terms as f32;
        let extent = 2.0 * PROBE_REACH * Vec2::new(ellipse.major, ellipse.minor);
        let step = (extent.y / settings.probes as f32).min(cells.edge).max((extent.x * extent.y / most).sqrt());
        // A quarter of a step more is no reason for another place.
        let steps = extent / Vec2::new(PROBE_TILE * step, step);
        let count = (steps - 0.25).ceil().clamp(Vec2::ONE, Vec2::splat(most));
        // Tiles of a level are twice as large as those before.
        let levels = &self.maps.params.levels;
        let finer = levels.iter().take_while(|level| level.tile_texels as f32 <= PROBE_TILE * step).count();
        let level = levels[finer.max(1) - 1];
        let last = UVec2::new(level.tiles_x, level.tiles_y) - 1;
        for j in 0..count.y as u32 {
            for i in 0..count.x as u32 {
                let t = (Vec2::new(i as f32, j as f32) + 0.5) * (2.0 * PROBE_REACH / count) - PROBE_REACH;
                let weight = (-0.5 * t.length_squared()).exp();
                let away = ellipse.axis * (ellipse.major * t.x) + ellipse.axis.perp() * (ellipse.minor * t.y);
                let (class, x) = self.shown_at(cells, ellipse.mean + away);
                let local = x - (x / self.size()).floor() * self.size();
                let index = (local / level.tile_texels as f32).as_uvec2().min(last);
                let tile = level.first_tile + index.y * level.tiles_x + index.x;
                gathered.add(TileTerm { tile, class, weight });
            }
        }
    }

    /// Example texels a surface texel, by area, under the transform that has most.
    pub(super) fn most_texels(&self) -> f32 {
        let palette = 0..self.placement.palette.len() as u32;
        palette.map(|class| self.position_to_local(class).determinant().abs().sqrt()).fold(0.0, f32::max)
    }

    /// Adds what a footprint sees of a surface of `count` × `count` cells of `edge` texels: sub-regions, places, or shares of
    /// transforms.
    pub(super) fn stochastic(
        &self,
        footprint: &Footprint,
        (count, edge): (u32, f32),
        settings: EvalSettings,
        gathered: &mut Gathered,
    ) {
        let cells = cells_around(footprint.mean, count, edge);
        let ellipse = Ellipse { mean: cells.mean, ..ellipse(footprint, settings.reach) };
        let region = 0.5 * cells.edge;
        let regions = 4.0 * REACH * REACH * ellipse.major * ellipse.minor.max(region) / (region * region);
        let many = regions > MAX_REGIONS.min(settings.max_terms as f32);
        if ellipse.minor >= CLASS_SIGMA_CELLS * cells.edge || many {
            return self.classes(&ellipse, cells, settings, gathered);
        }
        if settings.probes > 0 {
            // As the example of most texels sees it, so that those seen as boxes are few.
            let most = self.most_texels();
            let seen = Ellipse { major: most * ellipse.major, minor: most * ellipse.minor, ..ellipse };
            if matches!(self.detail(&seen, settings), Detail::Tiles(_)) {
                return self.probes(&ellipse, cells, settings, gathered);
            }
        }
        self.regions(&ellipse, cells, settings, gathered);
        // None has a share: the place alone.
        if gathered.share <= 0.0 {
            let (class, local) = self.shown_at(cells, ellipse.mean);
            self.point(class, local, gathered);
        }
    }
}
