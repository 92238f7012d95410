//! What a footprint reads on a surface covered with examples, side by side or at random.
//!
//! Xing et al. 2024, section 6.3. Places far from the origin keep their digits: a position is brought within the example, or
//! within its cell, before it is rounded.

use super::baked::Material;
use super::ellipse::{Ellipse, ellipse};
use super::eval::{EvalSettings, Gathered, Terms, TileTerm, matrix};
use super::view::{Detail, View};
use crate::footprint::Footprint;
use glam::{DVec2, Mat2, Vec2};
use glint_formats::ndf_maps::PlacementKind;

/// From this minor axis on (in example edges) shares of tiled examples are even to 1.4 % and the top tile is enough.
const TOP_TILE_SIGMA: f32 = 0.5;

impl Material {
    /// The point of a tiled example that lies at a surface position, within the example.
    fn tiled_place(&self, position: Mat2, place: DVec2) -> Vec2 {
        let size = self.size().as_dvec2();
        let local = position.as_dmat2() * place;
        (local - (local / size).floor() * size).as_vec2()
    }

    /// Adds what a footprint sees of a surface tiled with one example.
    fn tiled(&self, footprint: &Footprint, settings: EvalSettings, gathered: &mut Gathered) {
        let position = self.position_to_local(0);
        let within = self.tiled_place(position, footprint.mean);
        let transformed = ellipse(footprint, settings.reach).transformed(position, Vec2::ZERO);
        let ellipse = Ellipse { mean: within, ..transformed };
        let detail = self.detail(&ellipse, settings);
        let wide = ellipse.minor >= TOP_TILE_SIGMA * self.size().max_element();
        if wide || matches!(detail, Detail::Tiles(level) if self.is_top(level)) {
            return gathered.add(TileTerm { tile: self.top_tile(), class: 0, weight: 1.0 });
        }
        // A sub-region without end.
        let view = View {
            ellipse,
            middle: within,
            to_surface: Mat2::IDENTITY,
            scale: 1.0,
            half: 1e20,
            extent: Vec2::ONE,
            class: 0,
        };
        match detail {
            Detail::Tiles(level) => self.tiles(&view, settings, level, gathered),
            Detail::Boxes(edge) => self.boxes(&view, edge, gathered),
        }
        // None has a share: the place alone.
        if gathered.share <= 0.0 {
            self.point(0, within, gathered);
        }
    }

    /// The terms of a footprint (surface texels). Shares sum to 1; a footprint of zero size is a point.
    pub fn gather(&self, footprint: &Footprint, settings: EvalSettings) -> Terms {
        let mut gathered = Gathered::default();
        match self.placement.params.kind {
            PlacementKind::Tiled => self.tiled(footprint, settings, &mut gathered),
            PlacementKind::Stochastic { cells_x, cell_texels, .. } => {
                self.stochastic(footprint, (cells_x, cell_texels), settings, &mut gathered);
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
}
