//! Which tiles or lobes a footprint sees on a surface covered with examples, with bounded work.
//!
//! Xing et al. 2024, section 6.3. Tiles are chosen by the footprint's minor axis; their shares are the Gaussian
//! footprint at the tile's centre, widened by the tile's own extent, normalised in the end. Below the finest tile
//! the example is divided in boxes, each seen as one lobe. On a stochastic surface every sub-region is asked
//! for its owner; a footprint over many cells sees the top tile under each transform, by the share of cells that use it,
//! where the paper visits every example.

use super::cells::Cells;
use super::ellipse::{EVERYWHERE, Ellipse, FINEST_TEXELS, Grid, REACH, Slot, for_each_cell, for_each_tile};
use super::eval::{LobeTerm, Material, Terms, TileTerm, matrix};
use crate::footprint::Footprint;
use glam::{DVec2, IVec2, Mat2, Vec2};
use glint_formats::ndf_maps::{Level, PlacementKind};

/// Edge of the boxes that are seen as lobes, at most, in example texels: those boxes are the bilinear cells.
const LOBE_TEXELS: f32 = 1.0;
/// Sub-regions of a stochastic surface that a footprint visits at most.
const MAX_REGIONS: f32 = 64.0;
/// From this minor axis on (in sub-regions) a sub-region's middle tells its share to 2.4 %, and one top tile, if enough, all of it.
const WHOLE_REGION_SIGMA: f32 = 0.5;
/// From this minor axis on (in example edges) shares of tiled examples are even to 1.4 % and the top tile is enough.
const TOP_TILE_SIGMA: f32 = 0.5;
/// Pieces under a footprint that is widened by their own size, at most, relative to `max_terms`: thin footprints are seen in
/// pieces wider than they are.
const MOST_OF_TERMS: f32 = 4.0;
/// A tile that a sub-region cuts is split from this share on, relative to an even share of `max_terms`.
const SPLIT_FROM: f32 = 2.0;
/// From this minor axis on (in cells) a stochastic surface is seen as shares of transforms.
const CLASS_SIGMA_CELLS: f32 = 1.0;

/// Choice between speed and accuracy at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvalSettings {
    /// Largest tile in standard deviations of the footprint's minor axis.
    pub tile_sigmas: f32,
    /// Largest box that is seen as one lobe, likewise.
    pub lobe_sigmas: f32,
    /// Tiles, lobes or sub-regions in the area of the footprint's ellipse, at most, but for those that sub-regions cut; a footprint that
    /// would need more sees coarser ones.
    pub max_terms: u32,
    /// How often a tile that a sub-region shows only in part is split.
    pub splits: u32,
    /// Pieces lie within this many standard deviations of the footprint's centre; 2 % of its mass is beyond 2.8, 14 % beyond 2.
    pub reach: f32,
    /// Places along a footprint's minor axis where a stochastic surface is seen, each as one tile; 0 for all tiles of all sub-regions.
    pub probes: u32,
}

impl Default for EvalSettings {
    fn default() -> EvalSettings {
        EvalSettings { tile_sigmas: 1.0, lobe_sigmas: 0.75, max_terms: 128, splits: 1, reach: REACH, probes: 0 }
    }
}

/// What a footprint is resolved in.
#[derive(Clone, Copy, Debug)]
enum Detail {
    /// Tiles of a level.
    Tiles(Level),
    /// Boxes of this edge in example texels, each one lobe.
    Boxes(f32),
}

/// Terms with the sum of their shares.
#[derive(Default)]
pub(super) struct Gathered {
    terms: Terms,
    share: f32,
}

impl Material {
    /// The terms of a footprint (surface texels). Shares sum to 1; a footprint of zero size is a point.
    pub fn gather(&self, footprint: &Footprint, settings: EvalSettings) -> Terms {
        let mut gathered = Gathered::default();
        match self.placement.params.kind {
            PlacementKind::Tiled => self.gather_tiled(footprint, settings, &mut gathered),
            PlacementKind::Stochastic { cells_x, cell_texels, .. } => {
                let cells = Cells::around(footprint.mean, cells_x as i32, cell_texels);
                self.gather_stochastic(footprint, cells, settings, &mut gathered);
            }
        }
        let Gathered { mut terms, share } = gathered;
        for term in &mut terms.tiles {
            let to_local = matrix(self.placement.palette[term.class as usize].normal_to_local);
            term.weight *= to_local.determinant().abs() / share;
        }
        for lobe in &mut terms.lobes {
            lobe.peak /= share;
        }
        terms
    }

    fn gather_tiled(&self, footprint: &Footprint, settings: EvalSettings, gathered: &mut Gathered) {
        let to_local = self.position_to_local(0);
        let mean = within_period(to_local.as_dmat2() * footprint.mean, self.example_size());
        let ellipse = Ellipse { mean, ..Ellipse::new(footprint, settings.reach).transformed(to_local, Vec2::ZERO) };
        let size = self.example_size().max_element() as f32;
        if ellipse.minor >= TOP_TILE_SIGMA * size {
            return gathered.add_tile(TileTerm { tile: self.top_tile(), class: 0, weight: 1.0 });
        }
        match self.detail_for(&ellipse, settings) {
            Detail::Tiles(level) if level.first_tile == self.top_tile() => {
                gathered.add_tile(TileTerm { tile: level.first_tile, class: 0, weight: 1.0 });
            }
            Detail::Tiles(level) => {
                for_each_tile(&ellipse.widened(level.tile_texels as f32), &level, self.size(), EVERYWHERE, |slot| {
                    let weight = slot.area() * ellipse.widened(slot.size.x.max(slot.size.y)).density(slot.centre);
                    gathered.add_tile(TileTerm { tile: slot.tile, class: 0, weight });
                });
            }
            Detail::Boxes(edge) => {
                let widened = ellipse.widened(edge);
                for_each_cell(&widened, boxes(edge), EVERYWHERE, |_, _, centre| {
                    self.add_lobe(&ellipse, centre, edge, 0, edge * edge * widened.density(centre), gathered);
                });
                if gathered.share <= 0.0 {
                    self.add_lobe(&ellipse, ellipse.mean, 0.0, 0, 1.0, gathered);
                }
            }
        }
    }

    /// The coarsest tiles or boxes that resolve a footprint in the example.
    fn detail_for(&self, ellipse: &Ellipse, settings: EvalSettings) -> Detail {
        // Long thin footprints take coarser pieces rather than more than `max_terms` of them.
        let least = 2.0 * REACH * (ellipse.minor.max(FINEST_TEXELS) * ellipse.major / settings.max_terms as f32).sqrt();
        let few = |edge: f32| edge >= least && ellipse.pieces(edge) <= MOST_OF_TERMS * settings.max_terms as f32;
        let mut chosen = None;
        for level in &self.maps.params.levels {
            let edge = level.tile_texels as f32;
            let finer_is_enough = few(chosen.map_or(LOBE_TEXELS, |Level { tile_texels, .. }| tile_texels as f32));
            if edge <= settings.tile_sigmas * ellipse.minor || !finer_is_enough {
                chosen = Some(*level);
            }
        }
        if let Some(level) = chosen {
            return Detail::Tiles(level);
        }
        let mut edge = LOBE_TEXELS;
        while edge > FINEST_TEXELS && edge > settings.lobe_sigmas * ellipse.minor && few(0.5 * edge) {
            edge *= 0.5;
        }
        Detail::Boxes(edge)
    }

    /// Adds the box of `edge` around the example point `centre`, which has `weight` of the footprint `ellipse`.
    fn add_lobe(&self, ellipse: &Ellipse, centre: Vec2, edge: f32, class: u32, weight: f32, gathered: &mut Gathered) {
        let gradient = if edge > 0.0 { ellipse.log_gradient(centre) } else { Vec2::ZERO };
        let sigma = self.maps.params.intrinsic_roughness;
        let to_local = matrix(self.placement.palette[class as usize].normal_to_local);
        let normal = self.maps.normal_and_jacobian(centre);
        gathered.terms.lobes.push(LobeTerm::new(normal, edge, sigma, to_local, weight, gradient));
        gathered.share += weight;
    }

    fn gather_stochastic(&self, footprint: &Footprint, cells: Cells, settings: EvalSettings, gathered: &mut Gathered) {
        let ellipse = Ellipse { mean: cells.mean, ..Ellipse::new(footprint, settings.reach) };
        let region = 0.5 * cells.edge;
        let regions = (2.0 * REACH).powi(2) * ellipse.major * ellipse.minor.max(region) / (region * region);
        if ellipse.minor >= CLASS_SIGMA_CELLS * cells.edge || regions > MAX_REGIONS.min(settings.max_terms as f32) {
            return self.gather_classes(&ellipse, cells, settings, gathered);
        }
        if settings.probes > 0 {
            // As the example of most texels sees it, so that those seen as boxes are few.
            let most = self.most_example_texels();
            let seen = Ellipse { major: most * ellipse.major, minor: most * ellipse.minor, ..ellipse };
            if matches!(self.detail_for(&seen, settings), Detail::Tiles(_)) {
                return self.gather_probes(&ellipse, cells, settings, gathered);
            }
        }
        // A sub-region counts when its centre is near the footprint, widened so that a point reaches its corners.
        for_each_cell(
            &ellipse.widened(region * 1.2),
            Grid { origin: 0.0, edge: region },
            EVERYWHERE,
            |i, j, middle| {
                self.gather_region(&ellipse, cells, (IVec2::new(i, j), middle), settings, gathered);
            },
        );
        if gathered.share <= 0.0 {
            let (class, centre, offset) = self.owner_of((ellipse.mean / region).floor().as_ivec2(), cells);
            let local = self.position_to_local(class) * (ellipse.mean - centre) + offset;
            self.add_lobe(&ellipse, local, 0.0, class, 1.0, gathered);
        }
    }

    /// What a sub-region, by its index and middle, shows of its owner under the footprint.
    fn gather_region(
        &self,
        footprint: &Ellipse,
        cells: Cells,
        (index, middle): (IVec2, Vec2),
        settings: EvalSettings,
        gathered: &mut Gathered,
    ) {
        let region = 0.5 * cells.edge;
        let (class, centre, offset) = self.owner_of(index, cells);
        let to_local = self.position_to_local(class);
        let from_centre = Ellipse { mean: footprint.mean - centre, ..*footprint };
        let view = RegionView {
            ellipse: from_centre.transformed(to_local, offset),
            middle: to_local * (middle - centre) + offset,
            to_surface: to_local.inverse(),
            scale: to_local.determinant().abs().sqrt().recip(),
            half: 0.5 * region,
            extent: to_local.x_axis.abs() + to_local.y_axis.abs(),
            class,
        };
        let detail = match self.detail_for(&view.ellipse, settings) {
            // Next to a transform that shears, or one of more texels.
            Detail::Tiles(_) if settings.probes > 0 => Detail::Boxes(LOBE_TEXELS),
            detail => detail,
        };
        match detail {
            Detail::Tiles(level)
                if level.first_tile == self.top_tile() && footprint.minor >= WHOLE_REGION_SIGMA * region =>
            {
                let weight = region * region * footprint.widened(region).density(middle);
                gathered.add_tile(TileTerm { tile: level.first_tile, class, weight });
            }
            Detail::Tiles(level) => {
                let edge = level.tile_texels as f32;
                let (low, high) = view.span(edge);
                let holding = (low + 0.5 * edge, high - 0.5 * edge);
                for_each_tile(&view.ellipse.widened(edge), &level, self.size(), holding, |slot| {
                    self.add_visible(&view, &level, slot, settings, gathered);
                });
            }
            Detail::Boxes(edge) => {
                let widened = view.ellipse.widened(edge);
                for_each_cell(&widened, boxes(edge), view.span(edge), |_, _, centre| {
                    let weight = edge * edge * widened.density(centre) * view.visible(centre, edge);
                    if weight > 0.0 {
                        self.add_lobe(&view.ellipse, centre, edge, view.class, weight, gathered);
                    }
                });
            }
        }
    }

    /// Adds a tile by how much of it the sub-region shows; one that is cut is split in its four children first, as often
    /// as `splits` allows.
    fn add_visible(
        &self,
        view: &RegionView,
        level: &Level,
        slot: Slot,
        settings: EvalSettings,
        gathered: &mut Gathered,
    ) {
        let edge = slot.size.x.max(slot.size.y);
        let visible = view.visible(slot.centre, edge);
        if visible <= 0.0 {
            return;
        }
        let weight = slot.area() * view.ellipse.widened(edge).density(slot.centre) * visible;
        let index = self.maps.params.levels.iter().position(|l| l.first_tile == level.first_tile).unwrap_or(0);
        if visible >= 1.0 || settings.splits == 0 || index == 0 || weight * (settings.max_terms as f32) < SPLIT_FROM {
            return gathered.add_tile(TileTerm { tile: slot.tile, class: view.class, weight });
        }
        let finer = self.maps.params.levels[index - 1];
        let less = EvalSettings { splits: settings.splits - 1, ..settings };
        for child in slot.children(level, &finer) {
            self.add_visible(view, &finer, child, less, gathered);
        }
    }

    /// The top tile under every transform, by the share of cells that use it: of blocks in the full reach, else there might be none.
    fn gather_classes(&self, ellipse: &Ellipse, cells: Cells, settings: EvalSettings, gathered: &mut Gathered) {
        let most = MOST_OF_TERMS * settings.max_terms as f32;
        let (mut mip, mut block) = (0, cells.edge);
        while 1 << mip < cells.count
            && (2.0 * block <= settings.tile_sigmas * ellipse.minor || ellipse.pieces(block) > most)
        {
            mip += 1;
            block *= 2.0;
        }
        let palette = self.placement.params.palette_len as usize;
        let mut shares = vec![0.0f32; palette];
        let widened = ellipse.widened(block);
        if 1 << mip == cells.count {
            self.add_shares(mip, IVec2::ZERO, 1.0, cells, &mut shares);
        } else {
            // The block that holds the base cell, and where it begins.
            let first = cells.base >> mip;
            let origin = ((first << mip) - cells.base).as_vec2() * cells.edge;
            let from_first = Ellipse { mean: widened.mean - origin, reach: REACH, ..widened };
            for_each_cell(&from_first, Grid { origin: 0.0, edge: block }, EVERYWHERE, |i, j, centre| {
                let weight = from_first.density(centre) * block * block;
                self.add_shares(mip, first + IVec2::new(i, j), weight, cells, &mut shares);
            });
        }
        for (class, weight) in shares.into_iter().enumerate() {
            if weight > 0.0 {
                gathered.add_tile(TileTerm { tile: self.top_tile(), class: class as u32, weight });
            }
        }
    }

    /// Adds `weight` times the shares of one texel of the class texture.
    fn add_shares(&self, mip: u32, block: IVec2, weight: f32, cells: Cells, shares: &mut [f32]) {
        let layers = shares.len().div_ceil(4);
        let first: usize = (0..mip).map(|m| ((cells.count >> m) as usize).pow(2) * layers * 4).sum();
        let size = cells.count >> mip;
        let texel = (block.y.rem_euclid(size) * size + block.x.rem_euclid(size)) as usize;
        for (class, share) in shares.iter_mut().enumerate() {
            let at = first + ((class / 4) * (size * size) as usize + texel) * 4 + class % 4;
            *share += weight * self.placement.classes[at] as f32 / 255.0;
        }
    }

    pub(super) fn position_to_local(&self, class: u32) -> Mat2 {
        matrix(self.placement.palette[class as usize].position_to_local)
    }

    fn example_size(&self) -> DVec2 {
        DVec2::new(self.maps.params.width as f64, self.maps.params.height as f64)
    }

    pub(super) fn size(&self) -> Vec2 {
        self.example_size().as_vec2()
    }

    fn top_tile(&self) -> u32 {
        self.maps.params.levels.last().map_or(0, |level| level.first_tile)
    }
}

impl Gathered {
    pub(super) fn add_tile(&mut self, term: TileTerm) {
        self.share += term.weight;
        self.terms.tiles.push(term);
    }
}

/// A sub-region as the example that shows in it sees it.
struct RegionView {
    /// The footprint in example texels.
    ellipse: Ellipse,
    /// The sub-region's middle in example texels.
    middle: Vec2,
    to_surface: Mat2,
    /// Surface texels an example texel, by area.
    scale: f32,
    /// Half the sub-region's edge in surface texels.
    half: f32,
    /// Half the box, in example texels, around a sub-region of half edge 1.
    extent: Vec2,
    class: u32,
}

impl RegionView {
    /// How much of a piece of `edge` around `x` lies in the sub-region, as if it were a box along the surface's axes.
    fn visible(&self, x: Vec2, edge: f32) -> f32 {
        let edge = edge * self.scale;
        let d = (self.to_surface * (x - self.middle)).abs();
        let inside = ((Vec2::splat(self.half + 0.5 * edge) - d) / edge).clamp(Vec2::ZERO, Vec2::ONE);
        inside.x * inside.y
    }

    /// Box in example texels that holds the centres of all pieces of `edge` that the sub-region may show.
    fn span(&self, edge: f32) -> (Vec2, Vec2) {
        let reach = self.extent * (self.half + 0.5 * edge * self.scale);
        (self.middle - reach, self.middle + reach)
    }
}

/// Boxes of an edge that divides a texel; those of a whole texel are the bilinear cells.
fn boxes(edge: f32) -> Grid {
    Grid { origin: -0.5, edge }
}

/// A position moved by whole periods into the first one.
fn within_period(x: DVec2, period: DVec2) -> Vec2 {
    (x - (x / period).floor() * period).as_vec2()
}
