//! What a footprint reads on a surface covered with examples, side by side or at random.
//!
//! Xing et al. 2024, section 6.3. Places far from the origin keep their digits: a position is brought within the example, or within
//! its cell, before it is rounded.

use super::baked::Material;
use super::eval::{EvalSettings, Terms, matrix};
use super::view::{Blend, next_probe, patches_share, probes};
use crate::footprint::Footprint;
use crate::windows::ellipse::{Ellipse, ellipse};
use crate::windows::patch::{bilinear, inside_disk};
use glam::{DVec2, Mat2, Vec2};
use glint_formats::ndf_maps::PlacementKind;

impl Material {
    /// The point of a tiled example that lies at a surface position, within the example.
    pub(super) fn tiled_place(&self, position: Mat2, place: DVec2) -> Vec2 {
        let size = self.size().as_dvec2();
        let local = position.as_dmat2() * place;
        (local - (local / size).floor() * size).as_vec2()
    }

    /// Adds what a footprint sees of a surface tiled with one example.
    fn tiled(&self, footprint: &Footprint, settings: EvalSettings, terms: &mut Terms) {
        let position = self.position_to_local(0);
        let within = self.tiled_place(position, footprint.mean);
        let seen = ellipse(footprint).transformed(position, Vec2::ZERO).shortened(settings.max_ratio);
        let seen = Ellipse { mean: within, ..seen };
        let in_patches = patches_share(seen.minor, self.maps.params.finest_variance);
        if in_patches < 1.0 {
            let probes = probes(&seen);
            let blend = self.blend(probes.variance);
            // Probes go over to the coarser level one after another.
            let mut coarser = blend.coarser * probes.total;
            let mut k = 0.0;
            loop {
                let weight = probes.weight(k);
                if weight <= 0.0 {
                    break;
                }
                let place = within + seen.axis * (k * probes.step);
                let blend = Blend { level: blend.level, coarser: (coarser / weight).clamp(0.0, 1.0) };
                self.windows(0, place, blend, weight / probes.total * (1.0 - in_patches), terms);
                coarser -= weight;
                k = next_probe(k);
            }
        }
        if in_patches > 0.0 {
            self.patches(0, &seen, settings, in_patches, terms);
        }
    }

    /// The terms of a footprint (surface texels). Shares sum to 1; a footprint of zero size is a point.
    pub fn gather(&self, footprint: &Footprint, settings: EvalSettings) -> Terms {
        let mut terms = Terms::default();
        match self.placement.params.kind {
            PlacementKind::Tiled => self.tiled(footprint, settings, &mut terms),
            PlacementKind::Stochastic { cells_x, cell_texels, .. } => {
                self.stochastic(footprint, (cells_x, cell_texels), settings, &mut terms);
            }
        }
        let jacobian = |class: u32| matrix(self.placement.palette[class as usize].normal_to_local).determinant().abs();
        terms.nodes.iter_mut().for_each(|term| term.weight *= jacobian(term.class));
        terms.patches.iter_mut().for_each(|term| term.weight *= jacobian(term.class));
        terms
    }

    /// Bilinear projected normal at an example point; the example repeats.
    pub fn normal(&self, local: Vec2) -> Vec2 {
        let at = (local + 0.5).floor();
        let f = local + 0.5 - at;
        bilinear(self.maps.patch(at.as_ivec2()), f)
    }

    /// Density at the surface's projected normal `s` of the normal at the example point `local`, with its intrinsic lobe, seen through a
    /// palette entry.
    pub fn point(&self, class: u32, local: Vec2, s: Vec2) -> f32 {
        let to_local = matrix(self.placement.palette[class as usize].normal_to_local);
        let normal = self.normal(local);
        let d = to_local * s - normal;
        let sigma = self.maps.params.intrinsic_roughness;
        let mass = inside_disk(normal, sigma);
        let density =
            (-0.5 * d.length_squared() / (sigma * sigma)).exp() / (std::f32::consts::TAU * sigma * sigma * mass);
        to_local.determinant().abs() * density
    }
}
