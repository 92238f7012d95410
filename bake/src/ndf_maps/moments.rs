//! Mean and covariance of the projected normals under a footprint on NDF maps, from the moments that are baked of every node.
//!
//! Light from all around sees the mean normal and the roughness of a footprint, for which its peaks do not matter: the nodes that its
//! density is read from (Xing et al. 2024, section 6.3) give their moments in place of their tables.

use super::baked::{BakedNdfMaps, Material};
use super::eval::{EvalSettings, Terms, matrix};
use super::owners::{OWNERS_UNTIL, SHARES_FROM, Shares, cells_around, ramp};
use super::view::{next_probe, patches_share, probes};
use crate::footprint::Footprint;
use crate::moments::{MomentSums, Moments};
use crate::windows::ellipse::{Ellipse, ellipse};
use glam::{Mat2, Vec2, Vec3};
use glint_formats::ndf_maps::PlacementKind;
use std::f32::consts::SQRT_2;

impl BakedNdfMaps {
    /// Baked moments of a node.
    pub fn node_moments(&self, node: u32) -> Moments {
        let record = self.moments[node as usize];
        Moments { mean: Vec2::from(record.mean()), covariance: Vec3::from(record.covariance()) }
    }
}

/// Moments of projected normals in the example as a palette entry shows them: s = m⁻¹ s_local.
fn turned_moments(local: Moments, normal_to_local: Mat2) -> Moments {
    let m = normal_to_local.inverse();
    let Vec3 { x: xx, y: xy, z: yy } = local.covariance;
    let of = |a: Vec2, b: Vec2| a.x * b.x * xx + (a.x * b.y + a.y * b.x) * xy + a.y * b.y * yy;
    let (row_x, row_y) = (m.row(0), m.row(1));
    Moments { mean: m * local.mean, covariance: Vec3::new(of(row_x, row_x), of(row_x, row_y), of(row_y, row_y)) }
}

impl Material {
    /// Adds what an ellipse in the example sees, `weight` together: the map's normals while all of it is narrower than the finest windows,
    /// and windows around its probes.
    fn add_moments(&self, class: u32, local: &Ellipse, weight: f32, sums: &mut MomentSums) {
        let normal = matrix(self.placement.palette[class as usize].normal_to_local);
        let in_patches = patches_share(local.major, self.maps.params.finest_variance);
        if in_patches > 0.0 {
            // Four places, √2 standard deviations away along the axes, have the moments of a Gaussian up to the third.
            let lobe = self.maps.params.intrinsic_roughness * self.maps.params.intrinsic_roughness;
            let (along, across) = (local.axis * local.major, local.axis.perp() * local.minor);
            for step in [along, -along, across, -across] {
                let mean = self.normal(local.mean + SQRT_2 * step);
                let own = Moments { mean, covariance: Vec3::new(lobe, 0.0, lobe) };
                sums.moments_add(0.25 * weight * in_patches, turned_moments(own, normal));
            }
        }
        if in_patches < 1.0 {
            let probes = probes(local);
            let blend = self.blend(probes.variance);
            let mut k = 0.0;
            loop {
                let part = probes.weight(k);
                if part <= 0.0 {
                    break;
                }
                let place = local.mean + local.axis * (k * probes.step);
                let mut terms = Terms::default();
                self.windows(class, place, blend, weight * (1.0 - in_patches) * part / probes.total, &mut terms);
                for term in &terms.nodes {
                    sums.moments_add(term.weight, turned_moments(self.maps.node_moments(term.node), normal));
                }
                k = next_probe(k);
            }
        }
    }

    /// Adds what a footprint sees of a surface of `count` × `count` cells of `edge` texels: of each owner at its centre, and of the whole
    /// example under each transform, as the density's terms do.
    fn stochastic_moments(
        &self,
        footprint: &Footprint,
        (count, edge): (u32, f32),
        settings: EvalSettings,
        sums: &mut MomentSums,
    ) {
        let cells = cells_around(footprint.mean, count, edge);
        let seen = Ellipse { mean: cells.mean, ..ellipse(footprint).shortened(settings.max_ratio) };
        let size = seen.minor * self.most_texels() / self.size().max_element();
        let in_shares = ramp(size, SHARES_FROM);
        let in_owners = 1.0 - ramp(size, OWNERS_UNTIL);
        let mut shares = Shares::default();
        if in_shares > 0.0 {
            self.probed_shares(&seen, cells, in_shares, &mut shares);
        }
        if in_owners > 0.0 {
            let variance = seen.major * seen.minor;
            for owner in self.owners_at(cells, seen.mean, variance) {
                if owner.weight > 0.0 {
                    let from_centre = Ellipse { mean: seen.mean + owner.pull(variance) - owner.centre, ..seen };
                    let local = from_centre.transformed(self.position_to_local(owner.class), owner.offset);
                    shares[owner.class as usize] -= in_shares * in_owners * owner.weight;
                    self.add_moments(owner.class, &local, in_owners * owner.weight, sums);
                }
            }
        }
        let node = self.maps.params.levels.last().map_or(0, |level| level.first_node);
        let whole = self.maps.node_moments(node);
        for (share, entry) in shares.into_iter().zip(&self.placement.palette) {
            if share != 0.0 {
                sums.moments_add(share, turned_moments(whole, matrix(entry.normal_to_local)));
            }
        }
    }

    /// Mean and covariance of the projected normals that a footprint (surface texels) sees, their lobes with them.
    pub fn moments(&self, footprint: &Footprint, settings: EvalSettings) -> Moments {
        let mut sums = MomentSums::default();
        match self.placement.params.kind {
            PlacementKind::Tiled => {
                let position = self.position_to_local(0);
                let within = self.tiled_place(position, footprint.mean);
                let seen = ellipse(footprint).transformed(position, Vec2::ZERO).shortened(settings.max_ratio);
                self.add_moments(0, &Ellipse { mean: within, ..seen }, 1.0, &mut sums);
            }
            PlacementKind::Stochastic { cells_x, cell_texels, .. } => {
                self.stochastic_moments(footprint, (cells_x, cell_texels), settings, &mut sums);
            }
        }
        sums.moments_whole(self.maps.params.intrinsic_roughness * self.maps.params.intrinsic_roughness)
    }
}
