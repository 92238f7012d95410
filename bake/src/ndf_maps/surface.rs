//! Which tiles or lobes a footprint sees on a surface covered with examples, with bounded work.
//!
//! Xing et al. 2024, section 6.3. Tiles are chosen by the footprint's minor axis; their shares are the Gaussian
//! footprint at the tile's centre, widened by the tile's own extent, normalised in the end. Below the finest tile the
//! footprint is split in narrower Gaussians, each seen as one lobe. On a stochastic surface every sub-region is asked
//! for its owner; a footprint over many cells sees the top tile under each transform, by the share of cells that use it,
//! where the paper visits every example.

use super::eval::{LobeTerm, Material, Terms, TileTerm, matrix};
use crate::footprint::Footprint;
use glam::{DVec2, Mat2, Vec2};
use glint_formats::ndf_maps::{Level, PlacementKind};

/// Tiles lie within this many standard deviations of the footprint's centre; 0.6 % of its mass is farther out.
const REACH: f32 = 3.2;
/// A narrower Gaussian's standard deviation over its distance from the next: their sum ripples by 0.5 %.
const SPLIT_WIDTH: f32 = 0.55;
/// Distance of narrower Gaussians at most, in example texels.
const SPLIT_TEXELS: f32 = 0.5;
/// Terms of one kind at most, in the area of the footprint's ellipse.
const MAX_TERMS: f32 = 2048.0;
/// From this minor axis on (in example edges) shares of tiled examples are even to 1.4 % and the top tile is enough.
const TOP_TILE_SIGMA: f32 = 0.5;
/// From this minor axis on (in cells) a stochastic surface is seen as shares of transforms.
const CLASS_SIGMA_CELLS: f32 = 1.0;

/// Choice between speed and accuracy at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvalSettings {
    /// Largest tile in standard deviations of the footprint's minor axis.
    pub tile_sigmas: f32,
}

impl Default for EvalSettings {
    fn default() -> EvalSettings {
        EvalSettings { tile_sigmas: 1.0 }
    }
}

/// A Gaussian by its principal axes.
#[derive(Clone, Copy, Debug)]
struct Ellipse {
    mean: Vec2,
    major_axis: Vec2,
    minor: f32,
    major: f32,
}

impl Ellipse {
    fn new(footprint: &Footprint) -> Ellipse {
        let (minor, major, axis) = footprint.principal();
        Ellipse {
            mean: footprint.mean.as_vec2(),
            major_axis: axis.as_vec2(),
            minor: minor as f32,
            major: major as f32,
        }
    }

    /// Widened by a box of edge `edge`.
    fn widened(&self, edge: f32) -> Ellipse {
        let extra = edge * edge / 12.0;
        Ellipse {
            minor: (self.minor * self.minor + extra).sqrt(),
            major: (self.major * self.major + extra).sqrt(),
            ..*self
        }
    }

    /// Density at x.
    fn density(&self, x: Vec2) -> f32 {
        let d = x - self.mean;
        let along = d.dot(self.major_axis) / self.major;
        let across = d.perp_dot(self.major_axis) / self.minor;
        (-0.5 * (along * along + across * across)).exp() / (2.0 * std::f32::consts::PI * self.minor * self.major)
    }

    /// Half the height of the ellipse of `REACH` standard deviations.
    fn reach_y(&self) -> f32 {
        let e = self.major_axis;
        REACH * ((e.y * self.major).powi(2) + (e.x * self.minor).powi(2)).sqrt()
    }

    /// The ellipse's range of x at height y, if it reaches there.
    fn span_x(&self, y: f32) -> Option<(f32, f32)> {
        let e = self.major_axis;
        let (p, q) = (1.0 / (self.major * self.major), 1.0 / (self.minor * self.minor));
        let a = e.x * e.x * p + e.y * e.y * q;
        let b = e.x * e.y * (p - q);
        let dy = y - self.mean.y;
        let inner = REACH * REACH * a - dy * dy * p * q;
        if inner < 0.0 {
            return None;
        }
        let half = inner.sqrt() / a;
        let middle = self.mean.x - b / a * dy;
        Some((middle - half, middle + half))
    }
}

/// Calls `visit(i, j)` for the cells of a grid of `edge` whose centres lie in the ellipse and in the box `low … high`.
fn for_each_cell(ellipse: &Ellipse, edge: f32, low: Vec2, high: Vec2, mut visit: impl FnMut(i32, i32)) {
    let index = |x: f32| (x / edge - 0.5).ceil() as i32;
    let reach = ellipse.reach_y();
    for j in index((ellipse.mean.y - reach).max(low.y))..index((ellipse.mean.y + reach).min(high.y)) {
        let y = (j as f32 + 0.5) * edge;
        if let Some((x0, x1)) = ellipse.span_x(y) {
            for i in index(x0.max(low.x))..index(x1.min(high.x)) {
                visit(i, j);
            }
        }
    }
}

const EVERYWHERE: (Vec2, Vec2) = (Vec2::NEG_INFINITY, Vec2::INFINITY);

impl Material {
    /// The terms of a footprint (surface texels). Shares sum to 1; a footprint of zero size is a point.
    pub fn gather(&self, footprint: &Footprint, settings: EvalSettings) -> Terms {
        let mut terms = Terms::default();
        match self.placement.params.kind {
            PlacementKind::Tiled => self.gather_tiled(footprint, settings, &mut terms),
            PlacementKind::Stochastic { cells_x, cell_texels, .. } => {
                let cells = Cells { count: cells_x as i32, edge: cell_texels };
                self.gather_stochastic(footprint, cells, settings, &mut terms);
            }
        }
        normalise(&mut terms);
        terms
    }

    fn gather_tiled(&self, footprint: &Footprint, settings: EvalSettings, terms: &mut Terms) {
        let to_local = self.position_to_local(0);
        let local = reduced(&footprint.transformed(to_local.as_dmat2(), DVec2::ZERO), self.example_size());
        let ellipse = Ellipse::new(&local);
        match self.level_for(&ellipse, settings, f32::INFINITY) {
            Some(level) if level.tiles_x * level.tiles_y == 1 => {
                terms.tiles.push(TileTerm { tile: level.first_tile, class: 0, weight: 1.0 });
            }
            Some(level) => self.gather_tiles(&ellipse, &level, 0, EVERYWHERE, |_| 1.0, terms),
            None => self.gather_lobes(footprint, |_| (0, Vec2::ZERO, Vec2::ZERO), terms),
        }
    }

    /// The coarsest level that resolves the footprint, None when lobes are needed; tiles are at most `max_edge`.
    fn level_for(&self, ellipse: &Ellipse, settings: EvalSettings, max_edge: f32) -> Option<Level> {
        let levels = &self.maps.params.levels;
        let size = self.example_size().max_element() as f32;
        if ellipse.minor >= TOP_TILE_SIGMA * size && max_edge >= size {
            return levels.last().copied();
        }
        let wanted = (settings.tile_sigmas * ellipse.minor).min(max_edge);
        // Long thin footprints take coarser tiles rather than more than MAX_TERMS of them.
        let least = 2.0 * REACH * (ellipse.minor.max(1e-3) * ellipse.major / MAX_TERMS).sqrt();
        let too_many_lobes = ellipse.major * ellipse.minor.max(SPLIT_TEXELS) > MAX_TERMS / 160.0;
        let mut chosen = None;
        for level in levels {
            let edge = level.tile_texels as f32;
            if edge <= wanted || edge <= least || (chosen.is_none() && too_many_lobes) {
                chosen = Some(*level);
            }
        }
        chosen
    }

    /// Adds the tiles of `level` (example texels) with shares times `visible(centre)`.
    fn gather_tiles(
        &self,
        ellipse: &Ellipse,
        level: &Level,
        class: u32,
        (low, high): (Vec2, Vec2),
        visible: impl Fn(Vec2) -> f32,
        terms: &mut Terms,
    ) {
        let edge = level.tile_texels as f32;
        let size = self.example_size();
        let (cut_x, cut_y) = (size.x as u32 % level.tile_texels, size.y as u32 % level.tile_texels);
        let widened = ellipse.widened(edge);
        let whole = cut_x == 0 && cut_y == 0;
        // Tiles of a cut level do not lie on one grid over the repeating example; walk their slots, of which the last
        // in a row is narrower.
        for_each_slot(&widened, level, size.as_vec2(), whole, low, high, |tile, centre, area| {
            let share = area * widened.density(centre) * visible(centre);
            if share > 0.0 {
                terms.tiles.push(TileTerm { tile, class, weight: share });
            }
        });
    }

    /// Splits the footprint in narrower Gaussians and adds one lobe each. `owner(x)` gives, for a surface position, the
    /// palette entry, the example's centre on the surface and the example point that lies there.
    fn gather_lobes(&self, footprint: &Footprint, owner: impl Fn(Vec2) -> (u32, Vec2, Vec2), terms: &mut Terms) {
        let ellipse = Ellipse::new(footprint);
        let texel = self.smallest_texel();
        let (major, minor) = (Split::new(ellipse.major, texel), Split::new(ellipse.minor, texel));
        let minor_axis = -ellipse.major_axis.perp();
        let narrow = outer(ellipse.major_axis) * (major.width * major.width)
            + outer(minor_axis) * (minor.width * minor.width);
        let roughness = self.maps.params.intrinsic_roughness;
        let total = major.total() * minor.total();
        for b in -minor.count..=minor.count {
            for a in -major.count..=major.count {
                let (x, y) = (a as f32 * major.step, b as f32 * minor.step);
                let weight = major.share(x) * minor.share(y) / total;
                if weight * total < 1e-4 {
                    continue;
                }
                let at = ellipse.mean + ellipse.major_axis * x + minor_axis * y;
                let (class, centre, offset) = owner(at);
                let to_local = self.position_to_local(class);
                let to_surface = matrix(self.placement.palette[class as usize].normal_to_local).inverse();
                let (s, jacobian) = self.maps.normal_and_jacobian(to_local * (at - centre) + offset);
                let j = to_surface * jacobian * to_local;
                let covariance = j * narrow * j.transpose()
                    + to_surface * to_surface.transpose() * (roughness * roughness);
                terms.lobes.push(LobeTerm::new(to_surface * s, covariance, weight));
            }
        }
    }

    fn gather_stochastic(&self, footprint: &Footprint, cells: Cells, settings: EvalSettings, terms: &mut Terms) {
        let period = DVec2::splat(cells.count as f64 * cells.edge as f64);
        let footprint = reduced(footprint, period);
        let ellipse = Ellipse::new(&footprint);
        let region = 0.5 * cells.edge;
        let regions = (2.0 * REACH).powi(2) * ellipse.major * ellipse.minor.max(region) / (region * region);
        if ellipse.minor >= CLASS_SIGMA_CELLS * cells.edge || regions > MAX_TERMS {
            return self.gather_classes(&ellipse, cells, terms);
        }
        let in_texels = Ellipse {
            minor: ellipse.minor / self.smallest_texel(),
            major: ellipse.major / self.smallest_texel(),
            ..ellipse
        };
        let Some(level) = self.level_for(&in_texels, settings, region / self.smallest_texel()) else {
            return self.gather_lobes(&footprint, |at| self.owner_at(at, cells), terms);
        };
        // A sub-region counts when its centre is near the footprint, widened by the sub-region's diagonal.
        let near = ellipse.widened(region * 1.5);
        for_each_cell(&near, region, EVERYWHERE.0, EVERYWHERE.1, |i, j| {
            self.gather_region(&footprint, &level, cells, (i, j), terms);
        });
    }

    /// Tiles that sub-region (i, j) shows of its owner.
    fn gather_region(&self, footprint: &Footprint, level: &Level, cells: Cells, at: (i32, i32), terms: &mut Terms) {
        let region = 0.5 * cells.edge;
        let middle = Vec2::new(at.0 as f32 + 0.5, at.1 as f32 + 0.5) * region;
        let (class, centre, offset) = self.owner_at(middle, cells);
        let to_local = self.position_to_local(class);
        let shift = offset - to_local * centre;
        let ellipse = Ellipse::new(&footprint.transformed(to_local.as_dmat2(), shift.as_dvec2()));
        let to_surface = to_local.inverse();
        let edge = level.tile_texels as f32 * to_surface.determinant().abs().sqrt();
        let extent = (to_local.x_axis.abs() + to_local.y_axis.abs()) * (0.5 * (region + edge));
        let local_middle = to_local * middle + shift;
        // How much of a tile lies in the sub-region, as if the tile were a box along the surface's axes.
        let visible = |x: Vec2| {
            let d = (to_surface * (x - local_middle)).abs();
            let inside = (Vec2::splat(0.5 * (region + edge)) - d) / edge;
            let inside = inside.clamp(Vec2::ZERO, Vec2::ONE);
            inside.x * inside.y
        };
        let span = (local_middle - extent, local_middle + extent);
        self.gather_tiles(&ellipse, level, class, span, visible, terms);
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
    fn gather_classes(&self, ellipse: &Ellipse, cells: Cells, terms: &mut Terms) {
        let least = 2.0 * REACH * (ellipse.minor * ellipse.major / MAX_TERMS).sqrt();
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
            for_each_cell(&widened, block, EVERYWHERE.0, EVERYWHERE.1, |i, j| {
                let centre = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) * block;
                self.add_shares(mip, i, j, widened.density(centre) * block * block, cells, &mut shares);
            });
        }
        let top = self.maps.params.levels.last().map_or(0, |level| level.first_tile);
        for (class, weight) in shares.into_iter().enumerate() {
            if weight > 0.0 {
                terms.tiles.push(TileTerm { tile: top, class: class as u32, weight });
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

    /// Edge of the smallest example texel on the surface, in surface texels.
    fn smallest_texel(&self) -> f32 {
        let mut stretch = 0.0f32;
        for record in &self.placement.palette {
            let m = matrix(record.position_to_local);
            stretch = stretch.max(m.x_axis.length()).max(m.y_axis.length());
        }
        1.0 / stretch.max(1e-6)
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

/// Narrower Gaussians that sum to one of standard deviation `sigma`: `2 count + 1` of them, `step` apart.
struct Split {
    count: i32,
    step: f32,
    width: f32,
    spread: f32,
}

impl Split {
    fn new(sigma: f32, texel: f32) -> Split {
        let step = SPLIT_TEXELS * texel;
        let width = SPLIT_WIDTH * step;
        if sigma <= width {
            return Split { count: 0, step: 0.0, width: sigma, spread: 1.0 };
        }
        let spread = (sigma * sigma - width * width).sqrt();
        Split { count: (REACH * spread / step).ceil() as i32, step, width, spread }
    }

    /// Share of the Gaussian at distance x, relative to the middle one's.
    fn share(&self, x: f32) -> f32 {
        (-0.5 * (x / self.spread).powi(2)).exp()
    }

    fn total(&self) -> f32 {
        (-self.count..=self.count).map(|k| self.share(k as f32 * self.step)).sum()
    }
}

fn outer(v: Vec2) -> Mat2 {
    Mat2::from_cols(v * v.x, v * v.y)
}

/// The footprint moved by whole periods so that its centre lies in the first one.
fn reduced(footprint: &Footprint, period: DVec2) -> Footprint {
    let mean = footprint.mean - (footprint.mean / period).floor() * period;
    Footprint { mean, covariance: footprint.covariance }
}

/// Calls `visit(tile, centre, area)` for a level's tiles over the repeating example, within the ellipse and the box.
fn for_each_slot(
    ellipse: &Ellipse,
    level: &Level,
    size: Vec2,
    whole: bool,
    low: Vec2,
    high: Vec2,
    mut visit: impl FnMut(u32, Vec2, f32),
) {
    let edge = level.tile_texels as f32;
    let (nx, ny) = (level.tiles_x as i32, level.tiles_y as i32);
    let tile = |i: i32, j: i32| level.first_tile + (j.rem_euclid(ny) * nx + i.rem_euclid(nx)) as u32;
    if whole {
        for_each_cell(ellipse, edge, low, high, |i, j| {
            visit(tile(i, j), Vec2::new(i as f32 + 0.5, j as f32 + 0.5) * edge, edge * edge);
        });
        return;
    }
    // Slot k of an axis: whole periods, then tiles of `edge`, the last one cut at the example's end.
    let slot = |k: i32, n: i32, length: f32| {
        let start = k.div_euclid(n) as f32 * length + k.rem_euclid(n) as f32 * edge;
        let end = (start + edge).min((k.div_euclid(n) + 1) as f32 * length);
        (0.5 * (start + end), end - start)
    };
    let first = |x: f32, n: i32, length: f32| {
        let period = (x / length).floor();
        period as i32 * n + ((x - period * length) / edge) as i32
    };
    let reach = ellipse.reach_y();
    let (y0, y1) = ((ellipse.mean.y - reach).max(low.y), (ellipse.mean.y + reach).min(high.y));
    for j in first(y0, ny, size.y)..=first(y1, ny, size.y) {
        let (y, tall) = slot(j, ny, size.y);
        let Some((x0, x1)) = ellipse.span_x(y) else { continue };
        for i in first(x0.max(low.x), nx, size.x)..=first(x1.min(high.x), nx, size.x) {
            let (x, wide) = slot(i, nx, size.x);
            visit(tile(i, j), Vec2::new(x, y), wide * tall);
        }
    }
}

fn normalise(terms: &mut Terms) {
    // A footprint has tiles or lobes, never both; lobes are normalised where they are made.
    let total: f32 = terms.tiles.iter().map(|t| t.weight).sum();
    if total > 0.0 {
        for term in &mut terms.tiles {
            term.weight /= total;
        }
    }
}
