//! A surface of examples placed at random: sub-regions, their owners, and what they show under a footprint.
//!
//! Xing et al. 2024, section 6.3, Fig. 3, gives each sub-region the example whose centre is nearest to it, with a border between
//! neighbours. Here owners fade into each other: at a place the four sub-regions around count by smooth weights, so that a surface
//! has no borders and neighbours of one owner show it undivided. A footprint over many cells sees the whole example under each
//! transform, by the share of sub-regions that use it, where the paper visits every example.

use super::baked::Material;
use super::ellipse::{Ellipse, ellipse};
use super::eval::{EvalSettings, NodeTerm, Terms};
use super::view::{next_probe, patches_share, probes};
use crate::footprint::Footprint;
use glam::{DVec2, IVec2, Vec2};

/// Width in which neighbouring sub-regions fade into each other, in edges of one.
const FADE: f32 = 1.0;
/// Where probes of owners go over to sums over sub-regions, by their minor axis, and those to shares of transforms, by the geometric
/// mean of both axes: from and to, in edges of a sub-region.
const REGIONS_FROM: [f32; 2] = [0.15, 0.25];
const CLASSES_FROM: [f32; 2] = [0.8, 1.2];
/// Variance along an axis of a sub-region with the borders in which it fades, 1/12 + FADE²/20, in squares of its edge.
const REGION_VARIANCE: f32 = 0.1333;
/// Sub-regions count up to this many standard deviations of the footprint that is widened by them: (1 − q/8)² of the squared distance q
/// in them, whose variance is that of the Gaussian.
const REGIONS_REACH: f32 = 2.828_427;

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

/// Whose example sub-regions show, and how much of a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Owner {
    /// Palette entry.
    class: u32,
    /// Centre on the surface, relative to the base cell.
    centre: Vec2,
    /// Example point that lies at the centre.
    offset: Vec2,
    /// Its part of the place.
    weight: f32,
    /// How that changes along the surface, per texel.
    gradient: Vec2,
}

impl Material {
    /// Owner of a sub-region, by its index from the base cell's first one on, with the part `weight` of a place.
    fn owner_of(&self, cells: Cells, region: IVec2, weight: f32, gradient: Vec2) -> Owner {
        let regions = 2 * cells.count;
        let at = 2 * cells.base + region;
        let owner = self.placement.noise[(at.y.rem_euclid(regions) * regions + at.x.rem_euclid(regions)) as usize];
        let [x, y] = owner.neighbour();
        let cell: IVec2 = (region >> 1i32) + IVec2::new(x, y);
        Owner {
            class: owner.class(),
            centre: (cell.as_vec2() + unorm_pair(owner.centre)) * cells.edge,
            offset: unorm_pair(owner.offset) * self.size(),
            weight,
            gradient,
        }
    }

    /// The owners of the four sub-regions around a place relative to the base cell, as a round Gaussian of a variance (texels²) there sees
    /// them: the slope of a smoothstep of width W has the variance W²/20. One that owns several has the weight of all in the first, and
    /// none in the others.
    fn owners_at(&self, cells: Cells, place: Vec2, variance: f32) -> [Owner; 4] {
        let edge = 0.5 * cells.edge;
        let at = place / edge - 0.5;
        let cell = at.floor();
        let part = at - cell;
        let region = cell.as_ivec2();
        // Weights that begin and end level, so that their gradients, too, have no jumps.
        let fade = (FADE * FADE + 20.0 * variance / (edge * edge)).sqrt().min(1.0);
        let t = ((part - 0.5) / fade + 0.5).clamp(Vec2::ZERO, Vec2::ONE);
        let f = t * t * (3.0 - 2.0 * t);
        let g = 1.0 - f;
        let d = 6.0 * t * (1.0 - t) / (fade * edge);
        let mut owners = [
            self.owner_of(cells, region, g.x * g.y, Vec2::new(-d.x * g.y, -g.x * d.y)),
            self.owner_of(cells, region + IVec2::new(1, 0), f.x * g.y, Vec2::new(d.x * g.y, -f.x * d.y)),
            self.owner_of(cells, region + IVec2::new(0, 1), g.x * f.y, Vec2::new(-d.x * f.y, g.x * d.y)),
            self.owner_of(cells, region + IVec2::new(1, 1), f.x * f.y, Vec2::new(d.x * f.y, f.x * d.y)),
        ];
        for k in 1..4 {
            for j in 0..k {
                if owners[k].weight > 0.0 && owners[j].centre == owners[k].centre {
                    owners[j].weight += owners[k].weight;
                    owners[j].gradient += owners[k].gradient;
                    owners[k].weight = 0.0;
                }
            }
        }
        owners
    }
}

impl Owner {
    /// How far a round Gaussian of a variance (texels²) times the owner's weight lies from the Gaussian itself: variance · gradient /
    /// weight, of the weight as the Gaussian sees it.
    fn pull(&self, variance: f32) -> Vec2 {
        self.gradient * (variance / self.weight)
    }
}

impl Material {
    /// Adds the probes of an ellipse, `weight` together: at each, what its owners show there.
    fn owned_windows(&self, ellipse: &Ellipse, cells: Cells, weight: f32, terms: &mut Terms) {
        let probes = probes(ellipse);
        let mut before = 0.0;
        let mut k = 0.0;
        loop {
            let part = probes.weight(k);
            if part <= 0.0 {
                break;
            }
            let place = ellipse.mean + ellipse.axis * (k * probes.step);
            for owner in self.owners_at(cells, place, probes.variance) {
                if owner.weight > 0.0 {
                    let position = self.position_to_local(owner.class);
                    let mut blend = self.blend(probes.variance * position.determinant().abs());
                    // Probes go over to the coarser level one after another.
                    blend.coarser = ((blend.coarser * probes.total - before) / part).clamp(0.0, 1.0);
                    let seen = place + owner.pull(probes.variance) - owner.centre;
                    let local = position * seen + owner.offset;
                    self.windows(owner.class, local, blend, weight * part / probes.total * owner.weight, terms);
                }
            }
            before += part;
            k = next_probe(k);
        }
    }

    /// Adds what the sub-regions under an ellipse show, `weight` together: of each what lies around the middle of its product with the
    /// footprint.
    fn regions(&self, ellipse: &Ellipse, cells: Cells, weight: f32, terms: &mut Terms) {
        let edge = 0.5 * cells.edge;
        let own = REGION_VARIANCE * edge * edge;
        let (axis, side) = (ellipse.axis, ellipse.axis.perp());
        let (major2, minor2) = (ellipse.major * ellipse.major + own, ellipse.minor * ellipse.minor + own);
        // What a footprint sees of a sub-region has the variance of their product, here the mean of both axes.
        let variance = 0.5 * own * (ellipse.major * ellipse.major / major2 + ellipse.minor * ellipse.minor / minor2);
        let reach = REGIONS_REACH / edge;
        let mean = ellipse.mean / edge - 0.5;
        let within = Ellipse { mean, axis, major: reach * major2.sqrt(), minor: reach * minor2.sqrt() };
        let half = within.half_height();
        let first = terms.nodes.len();
        let mut total = 0.0;
        let mut y = (mean.y - half).ceil();
        while y <= mean.y + half {
            let [from, to] = within.span_x(y);
            let mut x = from.ceil();
            while x <= to {
                let middle = (Vec2::new(x, y) + 0.5) * edge;
                let away = middle - ellipse.mean;
                let (along, across) = (away.dot(axis), away.dot(side));
                let q = along * along / major2 + across * across / minor2;
                let t = (1.0 - q / (REGIONS_REACH * REGIONS_REACH)).max(0.0);
                let share = t * t;
                let owner = self.owner_of(cells, IVec2::new(x as i32, y as i32), share, Vec2::ZERO);
                let position = self.position_to_local(owner.class);
                let seen = middle - axis * (along * own / major2) - side * (across * own / minor2) - owner.centre;
                let local = position * seen + owner.offset;
                let mut blend = self.blend(variance * position.determinant().abs());
                // Every fourth sub-region goes over to the coarser level after the other.
                let at = 2 * cells.base + IVec2::new(x as i32, y as i32);
                let turn = (at.x + 2 * at.y).rem_euclid(4) as f32;
                blend.coarser = (4.0 * blend.coarser - turn).clamp(0.0, 1.0);
                self.windows(owner.class, local, blend, share, terms);
                total += share;
                x += 1.0;
            }
            y += 1.0;
        }
        terms.nodes[first..].iter_mut().for_each(|term| term.weight *= weight / total);
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

    /// Adds the whole example under every transform, by the share of sub-regions that use it, `weight` together.
    fn classes(&self, ellipse: &Ellipse, cells: Cells, weight: f32, terms: &mut Terms) {
        // Blocks that are read linearly have a standard deviation of half their edge.
        let last = cells.count.trailing_zeros() as f32;
        let lod = (2.0 * (ellipse.major * ellipse.minor).sqrt() / cells.edge).log2().clamp(0.0, last);
        let mut shares = vec![0.0f32; self.placement.params.palette_len as usize];
        for (mip, part) in [(lod.floor(), 1.0 - lod.fract()), (lod.floor() + 1.0, lod.fract())] {
            if part > 0.0 {
                let at = (cells.base.as_vec2() + ellipse.mean / cells.edge) * (-mip).exp2() - 0.5;
                let block = at.floor();
                let f = at - block;
                for (x, y, share) in [
                    (0, 0, (1.0 - f.x) * (1.0 - f.y)),
                    (1, 0, f.x * (1.0 - f.y)),
                    (0, 1, (1.0 - f.x) * f.y),
                    (1, 1, f.x * f.y),
                ] {
                    let block = block.as_ivec2() + IVec2::new(x, y);
                    self.class_shares(cells, mip as u32, block, part * share, &mut shares);
                }
            }
        }
        let total: f32 = shares.iter().sum();
        let node = self.maps.params.levels.last().map_or(0, |level| level.first_node);
        for (class, share) in shares.into_iter().enumerate() {
            if share > 0.0 {
                terms.nodes.push(NodeTerm { node, class: class as u32, weight: weight * share / total });
            }
        }
    }

    /// Example texels a surface texel, by area, under the transform that has most.
    pub(super) fn most_texels(&self) -> f32 {
        let palette = 0..self.placement.palette.len() as u32;
        palette.map(|class| self.position_to_local(class).determinant().abs().sqrt()).fold(0.0, f32::max)
    }

    /// Adds what a footprint sees of a surface of `count` × `count` cells of `edge` texels.
    pub(super) fn stochastic(
        &self,
        footprint: &Footprint,
        (count, edge): (u32, f32),
        settings: EvalSettings,
        terms: &mut Terms,
    ) {
        let cells = cells_around(footprint.mean, count, edge);
        let seen = Ellipse { mean: cells.mean, ..ellipse(footprint).shortened(settings.max_ratio) };
        let size = seen.minor / (0.5 * cells.edge);
        // Sub-regions are as many as its area.
        let wide = (seen.major * seen.minor).sqrt() / (0.5 * cells.edge);
        let ramp = |size: f32, range: [f32; 2]| ((size - range[0]) / (range[1] - range[0])).clamp(0.0, 1.0);
        let in_classes = ramp(wide, CLASSES_FROM);
        let in_regions = ramp(size, REGIONS_FROM) * (1.0 - in_classes);
        let in_patches = (1.0 - in_classes - in_regions)
            * patches_share(seen.minor * self.most_texels(), self.maps.params.finest_variance);
        let in_windows = 1.0 - in_classes - in_regions - in_patches;
        if in_windows > 0.0 {
            self.owned_windows(&seen, cells, in_windows, terms);
        }
        if in_patches > 0.0 {
            for owner in self.owners_at(cells, seen.mean, seen.major * seen.minor) {
                if owner.weight > 0.0 {
                    let position = self.position_to_local(owner.class);
                    let from_centre = Ellipse { mean: seen.mean - owner.centre, ..seen };
                    let local = from_centre.transformed(position, owner.offset);
                    self.patches(owner.class, &local, settings, in_patches * owner.weight, terms);
                }
            }
        }
        if in_regions > 0.0 {
            self.regions(&seen, cells, in_regions, terms);
        }
        if in_classes > 0.0 {
            self.classes(&seen, cells, in_classes, terms);
        }
    }
}
