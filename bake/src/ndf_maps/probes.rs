//! A stochastic surface at a few places under a footprint, each seen as one tile: for real-time settings.
//!
//! Xing et al. 2024, section 6.3, sums every tile of every sub-region under a footprint. Here the surface is seen as textures are
//! filtered along a footprint's axes: at places evenly spaced along both, each as the tile that holds it in the example that shows
//! there, whether or not all of the tile shows. Neighbours do the same work, whatever borders lie between them.

use super::cells::Cells;
use super::ellipse::Ellipse;
use super::eval::{Material, TileTerm};
use super::surface::{EvalSettings, Gathered};
use glam::{UVec2, Vec2};

/// Places lie within this many standard deviations of the footprint's centre; with their tiles they spread as it does.
const PROBE_REACH: f32 = 1.5;
/// Edge of their tiles, at most, and their distance along the major axis, relative to that along the minor axis.
const PROBE_TILE: f32 = 1.35;

impl Material {
    /// Adds the tiles that show at places under a footprint, `probes` of them along its minor axis.
    pub(super) fn gather_probes(
        &self,
        ellipse: &Ellipse,
        cells: Cells,
        settings: EvalSettings,
        gathered: &mut Gathered,
    ) {
        let extent = 2.0 * PROBE_REACH * Vec2::new(ellipse.major, ellipse.minor);
        let step = (extent.y / settings.probes as f32)
            .min(cells.edge)
            .max((extent.x * extent.y / settings.max_terms as f32).sqrt());
        // A quarter of a step more is no reason for another place.
        let count = (extent / Vec2::new(PROBE_TILE * step, step) - 0.25).ceil();
        let count = count.clamp(Vec2::ONE, Vec2::splat(settings.max_terms as f32));
        // Tiles of a level are twice as large as those before.
        let levels = &self.maps.params.levels;
        let finer = levels.iter().take_while(|level| level.tile_texels as f32 <= PROBE_TILE * step).count();
        let level = levels[finer.max(1) - 1];
        for j in 0..count.y as u32 {
            for i in 0..count.x as u32 {
                let t = (Vec2::new(i as f32, j as f32) + 0.5) * (2.0 * PROBE_REACH / count) - PROBE_REACH;
                let away =
                    ellipse.major_axis * (ellipse.major * t.x) + ellipse.major_axis.perp() * (ellipse.minor * t.y);
                let place = ellipse.mean + away;
                let (class, centre, offset) = self.owner_of((place / (0.5 * cells.edge)).floor().as_ivec2(), cells);
                let x = self.position_to_local(class) * (place - centre) + offset;
                let local = x - (x / self.size()).floor() * self.size();
                let last = UVec2::new(level.tiles_x, level.tiles_y) - 1;
                let at = (local / level.tile_texels as f32).as_uvec2().min(last);
                let tile = level.first_tile + at.y * level.tiles_x + at.x;
                gathered.add_tile(TileTerm { tile, class, weight: (-0.5 * t.length_squared()).exp() });
            }
        }
    }

    /// Example texels a surface texel, by area, under the transform that has most.
    pub fn most_example_texels(&self) -> f32 {
        let palette = 0..self.placement.palette.len() as u32;
        palette.map(|class| self.position_to_local(class).determinant().abs().sqrt()).fold(0.0, f32::max)
    }
}
