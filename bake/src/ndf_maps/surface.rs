//! Which tiles or lobes a footprint sees on a surface covered with examples, with bounded work.
//!
//! Xing et al. 2024, section 6.3. Tiles are chosen by the footprint's minor axis; their shares are the Gaussian
//! footprint at the tile's centre, widened by the tile's own extent, normalised in the end. Below the finest tile
//! the example is divided in boxes, each seen as one lobe. On a stochastic surface every sub-region is asked
//! for its owner; a footprint over many cells sees the top tile under each transform, by the share of cells that use it,
//! where the paper visits every example.

use super::ellipse::{EVERYWHERE, Ellipse, FINEST_TEXELS, Grid, REACH, Slot, for_each_cell, for_each_tile};
use super::eval::{LobeTerm, Material, Terms, TileTerm, matrix};
use crate::footprint::Footprint;
use glam::{DVec2, Mat2, Vec2};
use glint_formats::ndf_maps::{Level, PlacementKind};

/// Edge of the boxes that are seen as lobes, at most, in example texels: those boxes are the bilinear cells.
const LOBE_TEXELS: f32 = 1.0;
/// Sub-regions of a stochastic surface that a footprint visits at most.
const MAX_REGIONS: f32 = 64.0;
/// From this minor axis on (in example edges) shares of tiled examples are even to 1.4 % and the top tile is enough.
const TOP_TILE_SIGMA: f32 = 0.5;

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
    /// Tiles or lobes in the area of the footprint's ellipse, at most, but for those that sub-regions cut; a footprint that
    /// would need more sees coarser ones.
    pub max_terms: u32,
    /// How often a tile that a sub-region shows only in part is split.
    pub splits: u32,
}

impl Default for EvalSettings {
    fn default() -> EvalSettings {
        EvalSettings { tile_sigmas: 1.0, lobe_sigmas: 0.75, max_terms: 128, splits: 1 }
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
struct Gathered {
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
                let cells = Cells { count: cells_x as i32, edge: cell_texels };
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
        let local = reduced(&footprint.transformed(to_local.as_dmat2(), DVec2::ZERO), self.example_size());
        let ellipse = Ellipse::new(&local);
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
        let mut chosen = None;
        for level in &self.maps.params.levels {
            let edge = level.tile_texels as f32;
            let finer_is_enough = match chosen {
                None => LOBE_TEXELS >= least,
                Some(Level { tile_texels, .. }) => tile_texels as f32 >= least,
            };
            if edge <= settings.tile_sigmas * ellipse.minor || !finer_is_enough {
                chosen = Some(*level);
            }
        }
        if let Some(level) = chosen {
            return Detail::Tiles(level);
        }
        let mut edge = LOBE_TEXELS;
        while edge > FINEST_TEXELS && edge > settings.lobe_sigmas * ellipse.minor && 0.5 * edge >= least {
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
        let footprint = reduced(footprint, DVec2::splat(cells.count as f64 * cells.edge as f64));
        let ellipse = Ellipse::new(&footprint);
        let region = 0.5 * cells.edge;
        let regions = (2.0 * REACH).powi(2) * ellipse.major * ellipse.minor.max(region) / (region * region);
        if ellipse.minor >= CLASS_SIGMA_CELLS * cells.edge || regions > MAX_REGIONS {
            return self.gather_classes(&ellipse, cells, settings, gathered);
        }
        // A sub-region counts when its centre is near the footprint, widened so that a point reaches its corners.
        for_each_cell(
            &ellipse.widened(region * 1.2),
            Grid { origin: 0.0, edge: region },
            EVERYWHERE,
            |_, _, middle| {
                self.gather_region(&ellipse, cells, middle, settings, gathered);
            },
        );
        if gathered.share <= 0.0 {
            let (class, centre, offset) = self.owner_at(ellipse.mean, cells);
            let local = self.position_to_local(class) * (ellipse.mean - centre) + offset;
            self.add_lobe(&ellipse, local, 0.0, class, 1.0, gathered);
        }
    }

    /// What the sub-region around `middle` shows of its owner under the footprint.
    fn gather_region(
        &self,
        footprint: &Ellipse,
        cells: Cells,
        middle: Vec2,
        settings: EvalSettings,
        gathered: &mut Gathered,
    ) {
        let (class, centre, offset) = self.owner_at(middle, cells);
        let to_local = self.position_to_local(class);
        let shift = offset - to_local * centre;
        let view = RegionView {
            ellipse: footprint.transformed(to_local, shift),
            middle: to_local * middle + shift,
            to_surface: to_local.inverse(),
            scale: to_local.determinant().abs().sqrt().recip(),
            half: 0.25 * cells.edge,
            extent: to_local.x_axis.abs() + to_local.y_axis.abs(),
            class,
        };
        match self.detail_for(&view.ellipse, settings) {
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

    /// Owner of surface position `at`: palette entry, centre on the surface, example point that lies at the centre.
    fn owner_at(&self, at: Vec2, cells: Cells) -> (u32, Vec2, Vec2) {
        let cell = (at / cells.edge).floor();
        let quadrant = ((at / cells.edge - cell) * 2.0).floor().clamp(Vec2::ZERO, Vec2::ONE);
        let (cx, cy) = (cell.x as i32, cell.y as i32);
        let own = self.placement.noise[cells.index(cx, cy)];
        let neighbour = own.class_and_owners >> (16 + 4 * (quadrant.x as u32 + 2 * quadrant.y as u32)) & 0xf;
        let (dx, dy) = ((neighbour % 3) as i32 - 1, (neighbour / 3) as i32 - 1);
        let owner = self.placement.noise[cells.index(cx + dx, cy + dy)];
        let unorm = |v: u32| Vec2::new((v & 0xffff) as f32, (v >> 16) as f32) / 65535.0;
        let centre = (Vec2::new((cx + dx) as f32, (cy + dy) as f32) + unorm(owner.centre)) * cells.edge;
        (owner.class_and_owners & 0xff, centre, unorm(owner.offset) * self.example_size().as_vec2())
    }

    /// The top tile under every transform, by the share of cells that use it.
    fn gather_classes(&self, ellipse: &Ellipse, cells: Cells, settings: EvalSettings, gathered: &mut Gathered) {
        let least = 2.0 * REACH * (ellipse.minor * ellipse.major / settings.max_terms as f32).sqrt();
        let mut mip = 0;
        while 1 << mip < cells.count && cells.edge * (2 << mip) as f32 <= ellipse.minor.max(least) {
            mip += 1;
        }
        let palette = self.placement.params.palette_len as usize;
        let mut shares = vec![0.0f32; palette];
        let block = cells.edge * (1 << mip) as f32;
        let widened = ellipse.widened(block);
        if 1 << mip == cells.count {
            self.add_shares(mip, 0, 0, 1.0, cells, &mut shares);
        } else {
            for_each_cell(&widened, Grid { origin: 0.0, edge: block }, EVERYWHERE, |i, j, centre| {
                self.add_shares(mip, i, j, widened.density(centre) * block * block, cells, &mut shares);
            });
        }
        for (class, weight) in shares.into_iter().enumerate() {
            if weight > 0.0 {
                gathered.add_tile(TileTerm { tile: self.top_tile(), class: class as u32, weight });
            }
        }
    }

    /// Adds `weight` times the shares of one texel of the class texture.
    fn add_shares(&self, mip: u32, i: i32, j: i32, weight: f32, cells: Cells, shares: &mut [f32]) {
        let layers = shares.len().div_ceil(4);
        let first: usize = (0..mip).map(|m| ((cells.count >> m) as usize).pow(2) * layers * 4).sum();
        let size = cells.count >> mip;
        let texel = (j.rem_euclid(size) * size + i.rem_euclid(size)) as usize;
        for (class, share) in shares.iter_mut().enumerate() {
            let at = first + ((class / 4) * (size * size) as usize + texel) * 4 + class % 4;
            *share += weight * self.placement.classes[at] as f32 / 255.0;
        }
    }

    fn position_to_local(&self, class: u32) -> Mat2 {
        matrix(self.placement.palette[class as usize].position_to_local)
    }

    fn example_size(&self) -> DVec2 {
        DVec2::new(self.maps.params.width as f64, self.maps.params.height as f64)
    }

    fn size(&self) -> Vec2 {
        self.example_size().as_vec2()
    }

    fn top_tile(&self) -> u32 {
        self.maps.params.levels.last().map_or(0, |level| level.first_tile)
    }
}

impl Gathered {
    fn add_tile(&mut self, term: TileTerm) {
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

/// Grid of a stochastic placement.
#[derive(Clone, Copy)]
struct Cells {
    count: i32,
    edge: f32,
}

impl Cells {
    fn index(&self, x: i32, y: i32) -> usize {
        (y.rem_euclid(self.count) * self.count + x.rem_euclid(self.count)) as usize
    }
}

/// Boxes of an edge that divides a texel; those of a whole texel are the bilinear cells.
fn boxes(edge: f32) -> Grid {
    Grid { origin: -0.5, edge }
}

/// The footprint moved by whole periods so that its centre lies in the first one.
fn reduced(footprint: &Footprint, period: DVec2) -> Footprint {
    let mean = footprint.mean - (footprint.mean / period).floor() * period;
    Footprint { mean, covariance: footprint.covariance }
}
