//! A surface of examples placed at random: sub-regions, their owners, and what they show under a footprint.
//!
//! Xing et al. 2024, section 6.3, Fig. 3, gives each sub-region the example whose centre is nearest to it, with a border between
//! neighbours. Here owners fade into each other: at a place the four sub-regions around count by smooth weights, so that a surface
//! has no borders and neighbours of one owner show it undivided. A wide footprint sees the whole example under each transform, by the
//! share that it has of the sub-regions there, where the paper visits every example.

use super::baked::Material;
use super::eval::{EvalSettings, NodeTerm, Terms};
use super::view::{next_probe, patches_share, probes};
use crate::footprint::Footprint;
use crate::windows::ellipse::{Ellipse, ellipse};
use glam::{DVec2, IVec2, Vec2};
use glint_formats::ndf_maps::MAX_PALETTE;

/// Width in which neighbouring sub-regions fade into each other, in edges of one.
const FADE: f32 = 1.0;
/// From where to where shares of transforms come in, by a footprint's minor axis in edges of the example. From there on what owners show
/// counts by its difference from the whole example.
pub(super) const SHARES_FROM: [f32; 2] = [0.16, 0.2];
/// From where to where what owners show goes out: Gaussians so wide see all of an example that goes on beyond its edge.
pub(super) const OWNERS_UNTIL: [f32; 2] = [0.35, 0.5];
/// Variance along an axis of a sub-region with the borders in which it fades, 1/12 + FADE²/20, in squares of its edge.
const REGION_VARIANCE: f32 = 0.133_333;

/// Shares of the palette's entries.
pub(super) type Shares = [f32; MAX_PALETTE as usize];

/// From 0 to 1 over a range.
pub(super) fn ramp(x: f32, [from, to]: [f32; 2]) -> f32 {
    ((x - from) / (to - from)).clamp(0.0, 1.0)
}

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
    pub mean: Vec2,
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
    pub class: u32,
    /// Centre on the surface, relative to the base cell.
    pub centre: Vec2,
    /// Example point that lies at the centre.
    pub offset: Vec2,
    /// Its part of the place.
    pub weight: f32,
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
    pub(super) fn owners_at(&self, cells: Cells, place: Vec2, variance: f32) -> [Owner; 4] {
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
    pub(super) fn pull(&self, variance: f32) -> Vec2 {
        self.gradient * (variance / self.weight)
    }
}

impl Material {
    /// Adds the probes of an ellipse, `weight` together: at each, what its owners show there. Takes `less` of each owner's weight off the
    /// share of its palette entry.
    fn owned_windows(
        &self,
        ellipse: &Ellipse,
        cells: Cells,
        weight: f32,
        less: f32,
        shares: &mut Shares,
        terms: &mut Terms,
    ) {
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
                    let share = weight * part / probes.total * owner.weight;
                    shares[owner.class as usize] -= less * share;
                    self.windows(owner.class, local, blend, share, terms);
                }
            }
            before += part;
            k = next_probe(k);
        }
    }

    /// Adds the patches that an ellipse's owners show, `weight` together. Takes `less` of each owner's weight off the share of its palette
    /// entry.
    fn owned_patches(
        &self,
        ellipse: &Ellipse,
        cells: Cells,
        (weight, less): (f32, f32),
        settings: EvalSettings,
        shares: &mut Shares,
        terms: &mut Terms,
    ) {
        for owner in self.owners_at(cells, ellipse.mean, ellipse.major * ellipse.minor) {
            if owner.weight > 0.0 {
                let position = self.position_to_local(owner.class);
                let from_centre = Ellipse { mean: ellipse.mean - owner.centre, ..*ellipse };
                let local = from_centre.transformed(position, owner.offset);
                shares[owner.class as usize] -= less * weight * owner.weight;
                self.patches(owner.class, &local, settings, weight * owner.weight, terms);
            }
        }
    }

    /// Adds `weight` times the palette entry of a sub-region, by its index.
    fn region_class(&self, cells: Cells, region: IVec2, weight: f32, shares: &mut Shares) {
        let regions = 2 * cells.count;
        let texel = region.y.rem_euclid(regions) * regions + region.x.rem_euclid(regions);
        shares[self.placement.noise[texel as usize].class() as usize] += weight;
    }

    /// Adds `weight` times the shares of the palette's entries in one texel of the class texture.
    fn class_window(&self, cells: Cells, mip: u32, at: IVec2, weight: f32, shares: &mut Shares) {
        let first: usize = (0..mip).map(|m| ((2 * cells.count as usize) >> m).pow(2)).sum();
        let size = (2 * cells.count) >> mip;
        let texel = first + (at.y.rem_euclid(size) * size + at.x.rem_euclid(size)) as usize;
        for (share, byte) in shares.iter_mut().zip(self.placement.classes[texel]) {
            *share += weight / 255.0 * f32::from(byte);
        }
    }

    /// Adds `weight` times the shares of the palette's entries in what a round Gaussian of a variance (texels²) sees around a place
    /// relative to the base cell.
    ///
    /// Sub-regions that are read linearly are seen through a variance of 1/6, in squares of their edge, and mip m of the class texture
    /// through 4ᵐ⁺¹/6; two in shares 1 − c and c have every variance between theirs.
    fn class_shares(&self, cells: Cells, place: Vec2, variance: f32, weight: f32, shares: &mut Shares) {
        let edge = 0.5 * cells.edge;
        let last = (2 * cells.count).trailing_zeros() + 1;
        let size = (6.0 * (variance / (edge * edge) + REGION_VARIANCE)).max(1.0);
        // The exponent of 4.
        let exponent = ((size.to_bits() >> 23) - 127) / 2;
        let level = exponent.min(last);
        let coarser = if level == last { 0.0 } else { (size * f32::from_bits((127 - 2 * level) << 23) - 1.0) / 3.0 };
        let at = 2.0 * cells.base.as_vec2() + place / edge - 0.5;
        for (level, part) in [(level, 1.0 - coarser), (level + 1, coarser)] {
            if part > 0.0 {
                let mip = level.max(1) - 1;
                let at = at * f32::from_bits((127 - mip) << 23);
                let texel = at.floor();
                let f = at - texel;
                for (x, y, share) in [
                    (0, 0, (1.0 - f.x) * (1.0 - f.y)),
                    (1, 0, f.x * (1.0 - f.y)),
                    (0, 1, (1.0 - f.x) * f.y),
                    (1, 1, f.x * f.y),
                ] {
                    let texel = texel.as_ivec2() + IVec2::new(x, y);
                    if level == 0 {
                        self.region_class(cells, texel, part * weight * share, shares);
                    } else {
                        self.class_window(cells, mip, texel, part * weight * share, shares);
                    }
                }
            }
        }
    }

    /// Adds, `weight` together, the shares that the palette's entries have in what the probes of an ellipse see.
    pub(super) fn probed_shares(&self, ellipse: &Ellipse, cells: Cells, weight: f32, shares: &mut Shares) {
        let probes = probes(ellipse);
        let mut seen = Shares::default();
        let mut k = 0.0;
        loop {
            let part = probes.weight(k);
            if part <= 0.0 {
                break;
            }
            let place = ellipse.mean + ellipse.axis * (k * probes.step);
            self.class_shares(cells, place, probes.variance, part, &mut seen);
            k = next_probe(k);
        }
        // Eight bits do not sum to one.
        let total: f32 = seen.iter().sum();
        for (share, seen) in shares.iter_mut().zip(seen) {
            *share += weight / total * seen;
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
        let in_example = seen.minor * self.most_texels();
        let size = in_example / self.size().max_element();
        let in_shares = ramp(size, SHARES_FROM);
        let in_owners = 1.0 - ramp(size, OWNERS_UNTIL);
        let in_patches = in_owners * patches_share(in_example, self.maps.params.finest_variance);
        let in_windows = in_owners - in_patches;
        let mut shares = Shares::default();
        if in_shares > 0.0 {
            self.probed_shares(&seen, cells, in_shares, &mut shares);
        }
        if in_windows > 0.0 {
            self.owned_windows(&seen, cells, in_windows, in_shares, &mut shares, terms);
        }
        if in_patches > 0.0 {
            self.owned_patches(&seen, cells, (in_patches, in_shares), settings, &mut shares, terms);
        }
        let node = self.maps.params.levels.last().map_or(0, |level| level.first_node);
        for (class, share) in shares.into_iter().enumerate() {
            if share != 0.0 {
                terms.nodes.push(NodeTerm { node, class: class as u32, weight: share });
            }
        }
    }
}
